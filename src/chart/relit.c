/* SPDX-License-Identifier: Apache-2.0 */
#include "chart/relit.h"

#include "scene/file_text.h"

#include <igi/render.h>

#include <math.h>
#include <string.h>

static igi_status render(igi_context *ctx, const chart_relit *r, const igi_materials *materials,
                         igi_image **picture)
{
    igi_render_options options;
    igi_render_options_init(&options);
    options.samples = r->samples;
    return igi_render(ctx, r->scene, materials, r->lights, r->light_count, &r->camera, &options,
                      picture, NULL);
}

igi_status chart_relit_begin(igi_context *ctx, const igi_materials *truth, chart_relit *r)
{
    return render(ctx, r, truth, &r->want);
}

static igi_status load(igi_context *ctx, const char *folder, const char *lights_path,
                       const char *cameras, chart_relit *r)
{
    igi_status status = IGI_OK;
    char *path = NULL;
    igi_materials *truth = NULL;
    igi_frame *frames = NULL;
    size_t frame_count = 0;
    IGI_TRY_GOTO(igi_scene_load(ctx, folder, &r->own_scene));
    r->scene = r->own_scene;
    IGI_TRY_GOTO(igi_strprintf(ctx, &path, "%s/truth", folder));
    IGI_TRY_GOTO(igi_materials_load(ctx, path, &truth));
    IGI_TRY_GOTO(igi_lights_load(ctx, r->scene, lights_path, &r->own_lights, &r->light_count));
    r->lights = r->own_lights;
    IGI_TRY_GOTO(igi_frames_load(ctx, cameras, &frames, &frame_count));
    r->camera = frames[0].camera;
    IGI_TRY_GOTO(chart_relit_begin(ctx, truth, r));
cleanup:
    igi_frames_destroy(frames, frame_count);
    igi_materials_destroy(truth);
    igi_free(path);
    return status;
}

igi_status chart_relit_load(igi_context *ctx, const char *folder, int samples, chart_relit *r)
{
    igi_status status = IGI_OK;
    char *lights = NULL, *cameras = NULL;
    *r = (chart_relit){.samples = samples};
    IGI_TRY_GOTO(igi_strprintf(ctx, &lights, "%s/relit/lights.json", folder));
    IGI_TRY_GOTO(igi_strprintf(ctx, &cameras, "%s/relit/transforms.json", folder));
    if (igi_file_exists(lights) && igi_file_exists(cameras))
        IGI_TRY_GOTO(load(ctx, folder, lights, cameras, r));
cleanup:
    igi_free(lights);
    igi_free(cameras);
    return status;
}

/* Merged regions, and missing ones, have no material of their own. */
static bool has_all(const igi_scene *scene, const igi_materials *got)
{
    for (size_t r = 0; r < scene->region_count; r++) {
        size_t i = 0;
        while (i < got->count && strcmp(got->materials[i].region, scene->regions[r].name) != 0) i++;
        if (i == got->count && !scene->regions[r].emitter) return false;
    }
    return true;
}

igi_status chart_relit_error(igi_context *ctx, const chart_relit *r, const igi_materials *got,
                             double *error)
{
    igi_image *have = NULL;
    double wrong = 0, all = 0;
    *error = (double)NAN;
    if (!r->want || !has_all(r->scene, got)) return IGI_OK;
    IGI_TRY(render(ctx, r, got, &have));
    size_t count = (size_t)have->width * (size_t)have->height * (size_t)have->channels;
    for (size_t i = 0; i < count; i++) {
        wrong += fabs((double)have->samples[i] - (double)r->want->samples[i]);
        all += (double)r->want->samples[i];
    }
    if (all > 0) *error = wrong / all;
    igi_image_destroy(have);
    return IGI_OK;
}

void chart_relit_clear(chart_relit *r)
{
    igi_image_destroy(r->want);
    igi_lights_destroy(r->own_lights, r->own_lights ? r->light_count : 0);
    igi_scene_destroy(r->own_scene);
    *r = (chart_relit){.samples = 0};
}
