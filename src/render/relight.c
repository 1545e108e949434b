/* SPDX-License-Identifier: Apache-2.0
 *
 * A folder of materials, rendered.
 */
#include "material/result.h"
#include "render/render.h"

#include <igi/image.h>
#include <igi/scene.h>

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
    IGI_TRY_GOTO(igi_result_load(ctx, folder, &scene, &materials));
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
