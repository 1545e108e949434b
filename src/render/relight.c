/* SPDX-License-Identifier: Apache-2.0
 *
 * A folder of materials, rendered: of a recovery with the mesh of its scene.glb, or of a truth with
 * the scene.obj beside it.
 */
#include "render/render.h"
#include "scene/mesh.h"

#include <igi/image.h>
#include <igi/scene.h>

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

static const igi_material *find(const igi_materials *materials, const char *region)
{
    for (size_t i = 0; i < materials->count; i++)
        if (strcmp(materials->materials[i].region, region) == 0) return &materials->materials[i];
    return NULL;
}

/* Marks the emitters, and has the materials' lights name the scene's regions. */
static void join(igi_scene *scene, igi_materials *materials)
{
    scene->bands = materials->bands;
    for (size_t i = 0; i < scene->region_count; i++) {
        const igi_material *m = find(materials, scene->regions[i].name);
        scene->regions[i].emitter = m && m->emitter;
    }
    for (size_t k = 0; k < materials->light_count; k++) {
        igi_light *light = &materials->lights[k];
        if (light->region < 0) continue;
        const char *name = materials->materials[light->region].region;
        light->region = -1;
        for (size_t i = 0; i < scene->region_count; i++)
            if (strcmp(scene->regions[i].name, name) == 0) light->region = (int)i;
    }
}

static igi_status save(igi_context *ctx, const igi_image *image, const char *folder,
                       const char *name, const char *ending)
{
    char *path = NULL;
    IGI_TRY(igi_strprintf(ctx, &path, "%s/%s%s", folder, name, ending));
    igi_status status = igi_image_save_exr(ctx, image, IGI_EXR_FLOAT, path);
    igi_free(path);
    return status;
}

static igi_status render_frame(igi_context *ctx, const igi_renderer *renderer, int bands,
                               const igi_frame *frame, uint64_t key,
                               const igi_render_options *options, bool variance, const char *output)
{
    igi_status status = IGI_OK;
    igi_image *picture = NULL, *spread = NULL;
    int width = frame->camera.width, height = frame->camera.height;
    IGI_TRY_GOTO(igi_image_create(ctx, width, height, bands, &picture));
    if (variance) IGI_TRY_GOTO(igi_image_create(ctx, width, height, bands, &spread));
    IGI_TRY_GOTO(igi_renderer_frames(ctx, renderer, &frame->camera, 1, options, key, &picture,
                                     variance ? &spread : NULL));
    IGI_TRY_GOTO(save(ctx, picture, output, frame->name, ".exr"));
    if (variance) IGI_TRY_GOTO(save(ctx, spread, output, frame->name, ".variance.exr"));
cleanup:
    igi_image_destroy(picture);
    igi_image_destroy(spread);
    return status;
}

igi_status igi_relight(igi_context *ctx, const char *folder, const char *lights_path,
                       const char *cameras, const igi_render_options *options, bool variance,
                       const char *output)
{
    igi_status status = IGI_OK;
    igi_scene *scene = NULL;
    igi_materials *materials = NULL;
    igi_light *lights = NULL;
    igi_frame *frames = NULL;
    igi_renderer *renderer = NULL;
    size_t light_count = 0, count = 0;
    igi_stage_begin(ctx, "scene");
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &scene));
    IGI_TRY_GOTO(igi_materials_load(ctx, folder, &materials));
    IGI_TRY_GOTO(load_mesh(ctx, folder, scene));
    join(scene, materials);
    if (lights_path) IGI_TRY_GOTO(igi_lights_load(ctx, scene, lights_path, &lights, &light_count));
    IGI_TRY_GOTO(igi_frames_load(ctx, cameras, &frames, &count));
    IGI_TRY_GOTO(
        igi_renderer_create(ctx, scene, materials, lights_path ? lights : materials->lights,
                            lights_path ? light_count : materials->light_count, &renderer));
    igi_stage_begin(ctx, "rendering");
    for (size_t i = 0; i < count; i++)
        IGI_TRY_GOTO(
            render_frame(ctx, renderer, scene->bands, &frames[i], i, options, variance, output));
cleanup:
    igi_stage_begin(ctx, NULL);
    igi_renderer_destroy(renderer);
    igi_frames_destroy(frames, count);
    igi_lights_destroy(lights, light_count);
    igi_materials_destroy(materials);
    igi_scene_destroy(scene);
    return status;
}
