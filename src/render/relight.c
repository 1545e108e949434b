/* SPDX-License-Identifier: Apache-2.0
 *
 * A folder of materials, rendered.
 */
#include "image/srgb.h"
#include "base/file.h"
#include "material/result.h"
#include "render/doubt.h"
#include "render/layers.h"
#include "render/smooth.h"

#include <igi/image.h>
#include <igi/scene.h>

#include <jansson.h>
#include <math.h>

void igi_relight_options_init(igi_relight_options *options)
{
    *options = (igi_relight_options){.struct_size = sizeof *options};
    igi_render_options_init(&options->render);
}

typedef struct relighting {
    igi_context *ctx;
    const igi_relight_options *options;
    const char *output;
    const igi_renderer *renderer;
    igi_doubt *doubt; /* NULL: nobody asks */
    json_t *sigmas;   /* of each picture */
    int bands;
    float exposure; /* of PNG: the first frame's, for all; 0: not yet known */
} relighting;

static igi_status save(const relighting *r, const igi_image *image, const char *name,
                       const char *ending)
{
    char *path = NULL;
    IGI_TRY(igi_strprintf(r->ctx, &path, "%s/%s%s", r->output, name, ending));
    igi_status status = igi_image_save_exr(r->ctx, image, IGI_EXR_FLOAT, path);
    igi_free(path);
    return status;
}

static igi_status save_png(relighting *r, const layered_frame *f, const char *name)
{
    igi_status status = IGI_OK;
    char *path = NULL;
    uint8_t *png = NULL;
    size_t size;
    if (!(r->exposure > 0)) IGI_TRY_GOTO(layered_frame_exposure(r->ctx, f, &r->exposure));
    IGI_TRY_GOTO(igi_strprintf(r->ctx, &path, "%s/%s.png", r->output, name));
    IGI_TRY_GOTO(
        igi_srgb_png(r->ctx, f->layers[LAYER_PICTURE], r->bands, r->exposure, &png, &size));
    status = igi_file_save(r->ctx, path, png, size);
cleanup:
    igi_image_free_bytes(png);
    igi_free(path);
    return status;
}

static igi_status save_sigma(relighting *r, const igi_frame *frame, uint64_t key,
                             const igi_image *picture)
{
    igi_image *sigma = NULL;
    igi_picture_doubt found;
    IGI_TRY(igi_doubt_picture(r->ctx, r->doubt, &frame->camera, key, picture, &sigma, &found));
    igi_status status = save(r, sigma, frame->name, ".sigma.exr");
    igi_image_destroy(sigma);
    if (json_object_set_new(
            r->sigmas, frame->name,
            json_pack("{s:f, s:f}", "pixel", found.pixel, "picture", found.picture)))
        return igi_fail(r->ctx, IGI_E_DATA, "%s: the image's name is not UTF-8; rename it",
                        frame->name);
    if (!r->options->doubt) return status;
    r->options->doubt[0] = fmax(r->options->doubt[0], found.pixel);
    r->options->doubt[1] = fmax(r->options->doubt[1], found.picture);
    return status;
}

static igi_status render_frame(relighting *r, const igi_frame *frame, uint64_t key)
{
    const igi_relight_options *o = r->options;
    igi_status status = IGI_OK;
    layered_frame f;
    igi_image *joined = NULL;
    IGI_TRY(layered_frame_render(r->ctx, r->renderer, &frame->camera, key, &o->render,
                                 o->target_error, o->layers || o->preview, r->bands, &f));
    if (o->preview)
        IGI_TRY_GOTO(igi_smooth_indirect(r->ctx, r->renderer, &frame->camera,
                                         f.layers[LAYER_PICTURE], f.layers[LAYER_DIRECT],
                                         f.layers[LAYER_ALBEDO]));
    if (o->target_error > 0 && f.noise > o->target_error)
        igi_warn(r->ctx, "%s: its noise is still %.3g %% after %d paths a pixel", frame->name,
                 100 * f.noise, f.samples);
    if (o->noise) *o->noise = fmax(*o->noise, f.noise);
    IGI_TRY_GOTO(save(r, f.layers[LAYER_PICTURE], frame->name, ".exr"));
    if (o->variance) IGI_TRY_GOTO(save(r, f.layers[LAYER_VARIANCE], frame->name, ".variance.exr"));
    if (o->layers) IGI_TRY_GOTO(layered_frame_join(r->ctx, &f, &joined));
    if (o->layers) IGI_TRY_GOTO(save(r, joined, frame->name, ".layers.exr"));
    if (o->png) IGI_TRY_GOTO(save_png(r, &f, frame->name));
    if (r->doubt) IGI_TRY_GOTO(save_sigma(r, frame, key, f.layers[LAYER_PICTURE]));
cleanup:
    igi_image_destroy(joined);
    layered_frame_clear(&f);
    return status;
}

/* All pictures, and how uncertain they are. */
static igi_status render_frames(relighting *r, const igi_materials *materials,
                                const igi_frame *frames, size_t count)
{
    igi_status status = IGI_OK;
    char *path = NULL;
    bool own_lights = !r->options->lights;
    if (r->options->sigma) {
        if (r->options->doubt) r->options->doubt[0] = r->options->doubt[1] = 0;
        igi_stage_begin(r->ctx, "doubt");
        IGI_TRY_GOTO(igi_doubt_create(r->ctx, r->renderer, materials,
                                      own_lights ? materials->light_std : NULL, &r->doubt));
        r->sigmas = json_object();
    }
    igi_stage_begin(r->ctx, "rendering");
    for (size_t i = 0; i < count; i++) IGI_TRY_GOTO(render_frame(r, &frames[i], i));
    if (!r->sigmas) goto cleanup;
    IGI_TRY_GOTO(igi_strprintf(r->ctx, &path, "%s/sigma.json", r->output));
    status = igi_file_save_json(r->ctx, path, r->sigmas, 4);
cleanup:
    igi_doubt_destroy(r->doubt);
    json_decref(r->sigmas);
    igi_free(path);
    return status;
}

static igi_status measure(const relighting *r)
{
    const igi_relight_options *o = r->options;
    char *table = NULL;
    double noise = 0;
    igi_stage_begin(r->ctx, "sensors");
    IGI_TRY(igi_strprintf(r->ctx, &table, "%s/illuminance.csv", r->output));
    igi_status status = igi_sensors_measure(r->ctx, r->renderer, o->sensors, &o->render,
                                            o->target_error, table, &noise);
    if (o->noise) *o->noise = fmax(*o->noise, noise);
    igi_free(table);
    return status;
}

/* Those of a single pass, which is all there is without a target. */
static double paths_of(const igi_frame *frames, size_t count, const igi_relight_options *options)
{
    double pixels = 0;
    for (size_t i = 0; i < count; i++)
        pixels += (double)frames[i].camera.width * (double)frames[i].camera.height;
    return pixels * options->render.samples;
}

igi_status igi_relight(igi_context *ctx, const char *folder, const char *cameras,
                       const igi_relight_options *options, const char *output)
{
    igi_status status = IGI_OK;
    igi_scene *scene = NULL;
    igi_materials *materials = NULL;
    igi_light *lights = NULL;
    igi_frame *frames = NULL;
    igi_renderer *renderer = NULL;
    size_t light_count = 0, count = 0;
    if (options->struct_size != sizeof *options)
        return igi_fail(ctx, IGI_E_USAGE, "relight: options were not initialized");
    igi_stage_begin(ctx, "scene");
    IGI_TRY_GOTO(igi_result_load(ctx, folder, &scene, &materials));
    if (options->insert) IGI_TRY_GOTO(igi_result_insert(ctx, scene, materials, options->insert));
    if (options->edits) IGI_TRY_GOTO(igi_materials_edit(ctx, materials, options->edits));
    if (options->lights)
        IGI_TRY_GOTO(igi_lights_load(ctx, scene, options->lights, &lights, &light_count));
    if (cameras) IGI_TRY_GOTO(igi_frames_load(ctx, cameras, &frames, &count));
    IGI_TRY_GOTO(
        igi_renderer_create(ctx, scene, materials, options->lights ? lights : materials->lights,
                            options->lights ? light_count : materials->light_count, &renderer));
    igi_relight_options adjusted = *options;
    if (options->method != IGI_RENDER_PATH) {
        igi_stage_begin(ctx, igi_render_method_name(options->method));
        IGI_TRY_GOTO(
            igi_renderer_set_method(ctx, renderer, options->method, &adjusted.render.max_depth));
    } else if (options->preview) {
        igi_stage_begin(ctx, "radiosity");
        IGI_TRY_GOTO(igi_renderer_add_cache(ctx, renderer));
    } else {
        igi_stage_begin(ctx, "radiosity");
        IGI_TRY_GOTO(igi_renderer_expect(ctx, renderer, paths_of(frames, count, options)));
    }
    if (options->noise) *options->noise = 0;
    relighting r = {.ctx = ctx,
                    .options = &adjusted,
                    .output = output,
                    .renderer = renderer,
                    .bands = scene->bands};
    IGI_TRY_GOTO(render_frames(&r, materials, frames, count));
    if (options->sensors) IGI_TRY_GOTO(measure(&r));
cleanup:
    igi_stage_begin(ctx, NULL);
    igi_renderer_destroy(renderer);
    igi_frames_destroy(frames, count);
    igi_lights_destroy(lights, light_count);
    igi_materials_destroy(materials);
    igi_scene_destroy(scene);
    return status;
}
