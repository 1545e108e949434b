/* SPDX-License-Identifier: Apache-2.0
 *
 * A folder of materials together with its mesh: of a recovery with its scene.glb, of a truth with
 * the scene.obj beside it.
 */
#include "material/result.h"
#include "material/material.h"

#include "scene/file_text.h"
#include "scene/mesh.h"

#include <jansson.h>
#include <string.h>

/* glTF is Y-up: (x,y,z) there is (x,-z,y) here. */
static void turn_z_up(igi_mesh *mesh)
{
    for (size_t i = 0; i < mesh->vertex_count; i++) {
        float *p = mesh->positions + 3 * i, y = p[1];
        p[1] = -p[2];
        p[2] = y;
    }
}

static igi_status load_mesh(igi_context *ctx, const char *folder, igi_scene *scene)
{
    static const char *const names[] = {"scene.glb", "../scene.obj"};
    for (size_t i = 0; i < 2; i++) {
        char *path = NULL;
        IGI_TRY(igi_path_join(ctx, folder, names[i], &path));
        bool there = igi_file_exists(path);
        igi_status status = there ? igi_mesh_load(ctx, scene, path) : IGI_OK;
        igi_free(path);
        if (there && status == IGI_OK && i == 0) turn_z_up(&scene->mesh);
        if (there || status != IGI_OK) return status;
    }
    return igi_fail(
        ctx, IGI_E_DATA,
        "%s: has no scene.glb, and no scene.obj lies beside it; give the folder that igi "
        "recover wrote, or a scene's truth folder",
        folder);
}

static int region_named(const igi_scene *scene, const char *name)
{
    for (size_t i = 0; i < scene->region_count; i++)
        if (strcmp(scene->regions[i].name, name) == 0) return (int)i;
    return -1;
}

/* Materials in the order of the scene's regions; those without a triangle come last. */
static igi_status sort(igi_context *ctx, const char *folder, const igi_scene *scene,
                       igi_materials *m)
{
    for (size_t k = 0; k < m->light_count; k++)
        if (m->lights[k].region >= 0)
            m->lights[k].region = region_named(scene, m->materials[m->lights[k].region].region);
    for (size_t i = 0; i < scene->region_count; i++) {
        size_t found = i;
        while (found < m->count && strcmp(m->materials[found].region, scene->regions[i].name) != 0)
            found++;
        if (found == m->count)
            return igi_fail(ctx, IGI_E_DATA, "%s: has no material for the region '%s' of the mesh",
                            folder, scene->regions[i].name);
        igi_material other = m->materials[i];
        m->materials[i] = m->materials[found];
        m->materials[found] = other;
    }
    return IGI_OK;
}

/* The n-th file that recovery has read, as manifest.json names it; NULL where that has none. */
static igi_status read_input(igi_context *ctx, const char *folder, size_t n, char **path)
{
    char *manifest = NULL;
    *path = NULL;
    IGI_TRY(igi_path_join(ctx, folder, "manifest.json", &manifest));
    json_t *root = json_load_file(manifest, 0, NULL);
    igi_free(manifest);
    const json_t *input = json_array_get(json_object_get(root, "inputs"), n);
    const char *named = json_string_value(json_object_get(input, "file"));
    igi_status status = named ? igi_strdup(ctx, named, path) : IGI_OK;
    json_decref(root);
    return status;
}

/* A light's file is named from the scene's folder: where scene.json was, or above a truth. One that
 * is in neither keeps its name, for the sentence of whoever opens it. */
static igi_status find_file(igi_context *ctx, const char *folder, igi_light *light)
{
    igi_status status = IGI_OK;
    char *manifest = NULL, *scene = NULL, *path = NULL;
    IGI_TRY_GOTO(read_input(ctx, folder, 0, &manifest));
    if (manifest) IGI_TRY_GOTO(igi_path_folder(ctx, manifest, &scene));
    else IGI_TRY_GOTO(igi_path_join(ctx, folder, "..", &scene));
    IGI_TRY_GOTO(igi_path_join(ctx, scene, light->file, &path));
    if (igi_file_exists(path)) {
        igi_free(light->file);
        light->file = path;
        path = NULL;
    }
cleanup:
    igi_free(path);
    igi_free(scene);
    igi_free(manifest);
    return status;
}

igi_status igi_result_load(igi_context *ctx, const char *folder, igi_scene **scene,
                           igi_materials **materials)
{
    igi_status status = IGI_OK;
    *scene = NULL;
    *materials = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, scene));
    IGI_TRY_GOTO(igi_materials_load(ctx, folder, materials));
    IGI_TRY_GOTO(load_mesh(ctx, folder, *scene));
    igi_scene *s = *scene;
    igi_materials *m = *materials;
    IGI_TRY_GOTO(igi_strdup(ctx, m->scene, &s->name));
    IGI_TRY_GOTO(sort(ctx, folder, s, m));
    while (m->count > s->region_count) igi_material_clear(&m->materials[--m->count]);
    s->bands = m->bands;
    for (size_t i = 0; i < s->region_count; i++) s->regions[i].emitter = m->materials[i].emitter;
    for (size_t i = 0; i < m->light_count; i++)
        if (m->lights[i].file) IGI_TRY_GOTO(find_file(ctx, folder, &m->lights[i]));
cleanup:
    if (status != IGI_OK) {
        igi_scene_destroy(*scene);
        igi_materials_destroy(*materials);
        *scene = NULL;
        *materials = NULL;
    }
    return status;
}

/* The cameras' file stands after scene.json and the mesh among what recovery has read. */
igi_status igi_result_cameras(igi_context *ctx, const char *folder, char **path)
{
    igi_status status = IGI_OK;
    char *named = NULL;
    *path = NULL;
    IGI_TRY_GOTO(read_input(ctx, folder, 2, &named));
    if (!named) IGI_TRY_GOTO(igi_path_join(ctx, folder, "../transforms.json", &named)); /* truth */
    if (!igi_file_exists(named)) goto cleanup;
    if (igi_ends_with(named, ".json")) status = igi_strdup(ctx, named, path);
    else status = igi_path_folder(ctx, named, path); /* COLMAP's */
cleanup:
    igi_free(named);
    return status;
}
