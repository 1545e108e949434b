/* SPDX-License-Identifier: Apache-2.0
 *
 * A folder becomes a scene: manifest, mesh, cameras, then what only all of them together can show.
 */
#include <igi/scene.h>

#include "scene/brackets.h"
#include "scene/json.h"
#include "scene/scene_parts.h"
#include "scene/mesh.h"
#include "scene/photos.h"
#include "scene/plausible.h"
#include "scene/scene_notes.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* A file or folder that the manifest names. */
static igi_status named_path(igi_context *ctx, const igi_json *at, igi_scene *scene, char **path)
{
    const char *name;
    IGI_TRY(igi_json_string(ctx, at, &name));
    IGI_TRY(igi_path_join(ctx, scene->folder, name, path));
    igi_status status = igi_file_exists(*path) || igi_is_folder(*path)
                            ? igi_scene_note_file(ctx, scene, *path)
                            : igi_json_fail(
                                  ctx, at,
                                  "no readable file %s; correct the name, or put the file there",
                                  *path);
    if (status == IGI_OK) return IGI_OK;
    igi_free(*path);
    *path = NULL;
    return status;
}

static igi_status read_head(igi_context *ctx, const igi_json *root, igi_scene *scene)
{
    static const char *const known[] = {"igi",    "name",    "mesh",        "cameras",
                                        "lights", "regions", "calibration", "brackets"};
    IGI_TRY(igi_json_check_keys(ctx, root, known, sizeof known / sizeof known[0]));
    igi_json version = igi_json_member(root, "igi"), name = igi_json_member(root, "name");
    double number;
    const char *text = NULL;
    IGI_TRY(igi_json_number(ctx, &version, &number));
    if (number != 1)
        return igi_json_fail(ctx, &version, "is %g; this program reads version 1", number);
    if (!name.value) return igi_path_stem(ctx, scene->folder, &scene->name);
    IGI_TRY(igi_json_string(ctx, &name, &text));
    return igi_strdup(ctx, text, &scene->name);
}

static igi_status read_mesh(igi_context *ctx, const igi_json *root, igi_scene *scene)
{
    igi_json mesh = igi_json_member(root, "mesh"), regions = igi_json_member(root, "regions");
    char *path;
    IGI_TRY(named_path(ctx, &mesh, scene, &path));
    igi_status status = igi_mesh_load(ctx, scene, path);
    igi_free(path);
    if (status == IGI_OK && regions.value) status = igi_regions_read(ctx, &regions, scene);
    return status;
}

static igi_status read_cameras(igi_context *ctx, const igi_json *root, igi_scene *scene)
{
    igi_json cameras = igi_json_member(root, "cameras");
    igi_json brackets = igi_json_member(root, "brackets");
    igi_json calibration = igi_json_member(root, "calibration");
    char *path, *list = NULL;
    IGI_TRY(named_path(ctx, &cameras, scene, &path));
    igi_status status = IGI_OK;
    IGI_TRY_GOTO(igi_frames_load(ctx, path, &scene->frames, &scene->frame_count));
    if (calibration.value) IGI_TRY_GOTO(named_path(ctx, &calibration, scene, &scene->calibration));
    if (brackets.value) {
        IGI_TRY_GOTO(named_path(ctx, &brackets, scene, &list));
        IGI_TRY_GOTO(igi_brackets_read(ctx, list, scene));
    }
    IGI_TRY_GOTO(igi_photos_check(ctx, scene, path));
cleanup:
    igi_free(list);
    igi_free(path);
    return status;
}

/* Every emitter has a light: one that the manifest leaves out is of unknown radiance. */
static igi_status complete_lights(igi_context *ctx, igi_scene *scene)
{
    size_t missing = 0;
    for (size_t i = 0; i < scene->region_count; i++) missing += scene->regions[i].emitter;
    igi_light *all;
    IGI_TRY(IGI_ALLOC(ctx, scene->light_count + missing, &all));
    size_t count = scene->light_count;
    if (count) memcpy(all, scene->lights, count * sizeof *all);
    for (size_t i = 0; i < scene->region_count; i++) {
        if (!scene->regions[i].emitter) continue;
        bool has_light = false;
        for (size_t k = 0; k < scene->light_count; k++)
            has_light = has_light || all[k].region == (int)i;
        if (!has_light) all[count++] = (igi_light){.type = IGI_LIGHT_AREA, .region = (int)i};
    }
    igi_free(scene->lights);
    scene->lights = all;
    scene->light_count = count;
    return IGI_OK;
}

static igi_status read_lights(igi_context *ctx, const igi_json *root, igi_scene *scene)
{
    igi_json lights = igi_json_member(root, "lights"), regions = igi_json_member(root, "regions");
    if (lights.value)
        IGI_TRY(igi_lights_read(ctx, &lights, scene, &scene->lights, &scene->light_count));
    for (size_t i = 0; i < scene->light_count; i++) {
        if (scene->lights[i].region < 0) continue;
        igi_region *region = &scene->regions[scene->lights[i].region];
        igi_json at = igi_json_member(&regions, region->name);
        igi_json emitter = igi_json_member(&at, "emitter");
        if (emitter.value && !region->emitter)
            return igi_json_fail(ctx, &emitter,
                                 "is false, but an area light names the region; "
                                 "remove one of them");
        region->emitter = true;
    }
    return complete_lights(ctx, scene);
}

static igi_status read_manifest(igi_context *ctx, const char *path, igi_scene *scene)
{
    igi_json_file file;
    IGI_TRY(igi_json_load(ctx, path, &file));
    igi_json root = igi_json_root(&file);
    igi_status status = IGI_OK;
    IGI_TRY_GOTO(igi_json_object(ctx, &root));
    IGI_TRY_GOTO(read_head(ctx, &root, scene));
    IGI_TRY_GOTO(read_mesh(ctx, &root, scene));
    IGI_TRY_GOTO(read_cameras(ctx, &root, scene));
    IGI_TRY_GOTO(read_lights(ctx, &root, scene));
cleanup:
    igi_json_unload(&file);
    return status;
}

static igi_status fail_without_manifest(igi_context *ctx, const char *folder)
{
    char *materials;
    IGI_TRY(igi_path_join(ctx, folder, "materials.json", &materials));
    bool is_result = igi_file_exists(materials);
    igi_free(materials);
    return igi_fail(ctx, IGI_E_DATA,
                    is_result
                        ? "%s: is a result of igi recover; give the scene's folder"
                        : "%s: no scene.json in it; give the folder that has one, or write it "
                          "(README.md shows how)",
                    folder);
}

igi_status igi_scene_load(igi_context *context, const char *path, igi_scene **scene)
{
    *scene = NULL;
    igi_scene *s = NULL;
    char *manifest = NULL;
    igi_status status = IGI_OK;
    igi_stage_begin(context, "scene");
    IGI_TRY_GOTO(IGI_ALLOC(context, 1, &s));
    if (igi_is_folder(path)) {
        IGI_TRY_GOTO(igi_strdup(context, path, &s->folder));
        for (size_t n = strlen(path); n > 1 && path[n - 1] == '/'; n--) s->folder[n - 1] = 0;
        IGI_TRY_GOTO(igi_path_join(context, path, "scene.json", &manifest));
        if (access(manifest, F_OK) != 0) IGI_TRY_GOTO(fail_without_manifest(context, path));
    } else {
        IGI_TRY_GOTO(igi_path_folder(context, path, &s->folder));
        IGI_TRY_GOTO(igi_strdup(context, path, &manifest));
    }
    IGI_TRY_GOTO(igi_scene_note_file(context, s, manifest));
    IGI_TRY_GOTO(read_manifest(context, manifest, s));
    IGI_TRY_GOTO(igi_scene_check_plausible(context, s));
    *scene = s;
    s = NULL;
cleanup:
    igi_stage_begin(context, NULL);
    igi_free(manifest);
    igi_scene_destroy(s);
    return status;
}

void igi_scene_destroy(igi_scene *scene)
{
    if (!scene) return;
    for (size_t i = 0; i < scene->region_count; i++) igi_free(scene->regions[i].name);
    for (size_t i = 0; i < scene->file_count; i++) igi_free(scene->files[i]);
    for (size_t i = 0; i < scene->warning_count; i++) igi_free(scene->warnings[i]);
    igi_frames_destroy(scene->frames, scene->frame_count);
    igi_lights_destroy(scene->lights, scene->light_count);
    igi_free(scene->regions);
    igi_free(scene->files);
    igi_free(scene->warnings);
    igi_free(scene->mesh.positions);
    igi_free(scene->mesh.triangles);
    igi_free(scene->mesh.regions);
    igi_free(scene->mesh.uvs);
    igi_free(scene->calibration);
    igi_free(scene->name);
    igi_free(scene->folder);
    igi_free(scene);
}

igi_status igi_lights_load(igi_context *context, const igi_scene *scene, const char *path,
                           igi_light **lights, size_t *count)
{
    static const char *const known[] = {"lights", "igi", "name"};
    igi_json_file file;
    *lights = NULL;
    *count = 0;
    IGI_TRY(igi_json_load(context, path, &file));
    igi_json root = igi_json_root(&file), list = igi_json_member(&root, "lights");
    igi_status status = IGI_OK;
    IGI_TRY_GOTO(igi_json_check_keys(context, &root, known, sizeof known / sizeof known[0]));
    IGI_TRY_GOTO(igi_lights_read(context, &list, scene, lights, count));
    for (size_t i = 0; i < *count; i++) {
        int region = (*lights)[i].region;
        if (region < 0 || scene->regions[region].emitter) continue;
        igi_json at = igi_json_element(&list, i);
        status = igi_json_fail(context, &at,
                               "region \"%s\" is no emitter in scene.json; only those "
                               "can shine",
                               scene->regions[region].name);
        goto cleanup;
    }
cleanup:
    igi_json_unload(&file);
    if (status == IGI_OK) return IGI_OK;
    igi_lights_destroy(*lights, *count);
    *lights = NULL;
    *count = 0;
    return status;
}

void igi_lights_destroy(igi_light *lights, size_t count)
{
    for (size_t i = 0; lights && i < count; i++) igi_free(lights[i].file);
    igi_free(lights);
}
