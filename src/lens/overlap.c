/* SPDX-License-Identifier: Apache-2.0
 *
 * Vignetting from overlapping photographs of a known scene (Goldman 2010, with the geometry given):
 * a matt place sends the same light everywhere, so ln L_i - ln L_j = ln V(p_i) - ln V(p_j), linear
 * in the coefficients of ln V for a given centre. The scene's own brightness drops out.
 *
 * Only places that are even over 3 x 3 pixels in both photographs count, so that a pixel's error in
 * a camera's pose does not, and not lamps, which may be saturated.
 */
#include "base/context.h"
#include "lens/lens_private.h"
#include "lens/photographs.h"
#include "scene/camera.h"
#include "trace/trace.h"

#include <math.h>
#include <string.h>

#define MOST_PAIRS 400000
/* Largest over smallest of the pixels around. */
#define EVEN 1.25

typedef struct session {
    const igi_scene *scene;
    igi_photographs *photographs;
    igi_camera *cameras; /* [frame_count] */
    igi_tracer *tracer;
    float **planes; /* [frame_count][height][width] mean over 3 x 3 pixels and bands; 0: unusable */
    igi_vignetting_pairs pairs;
} session;

/* The mean around a pixel, or 0 where it is uneven. */
static float even_mean(const igi_image *image, int bands, int x, int y)
{
    double sum = 0, low = HUGE_VAL, high = 0;
    if (x < 1 || y < 1 || x + 2 > image->width || y + 2 > image->height) return 0;
    for (int v = y - 1; v <= y + 1; v++)
        for (int u = x - 1; u <= x + 1; u++) {
            const float *p = image->samples + ((size_t)v * (size_t)image->width + (size_t)u) *
                                                  (size_t)image->channels;
            double value = 0;
            for (int b = 0; b < bands; b++) value += (double)p[b] / bands;
            if (!(value > 0 && value < 1e30)) return 0;
            sum += value;
            low = fmin(low, value), high = fmax(high, value);
        }
    return high < EVEN * EVEN * low ? (float)(sum / 9) : 0;
}

static igi_status load_plane(igi_context *ctx, session *s, size_t frame)
{
    igi_image *image = NULL;
    char *warning = NULL;
    IGI_TRY(igi_photographs_load(ctx, s->photographs, frame, &image, &warning));
    igi_status status = IGI_OK;
    const igi_camera *first = &s->cameras[0];
    if (warning) igi_warn(ctx, "%s", warning);
    igi_free(warning);
    if (image->width != first->width || image->height != first->height ||
        image->channels < s->scene->bands)
        status = igi_fail(ctx, IGI_E_DATA,
                          "%s: not of the first image's size; calibrate the images "
                          "of one camera",
                          s->scene->frames[frame].name);
    else status = IGI_ALLOC(ctx, (size_t)image->width * (size_t)image->height, &s->planes[frame]);
    for (int i = 0; status == IGI_OK && i < image->width * image->height; i++)
        s->planes[frame][i] = even_mean(image, s->scene->bands, i % image->width, i / image->width);
    igi_image_destroy(image);
    return status;
}

static igi_status add_pair(igi_context *ctx, igi_vignetting_pairs *pairs, const double a[2],
                           const double b[2], double log_ratio)
{
    size_t need = pairs->count + 1;
    void *grown = igi_grow(ctx, pairs->a, &pairs->capacity[0], need, sizeof *pairs->a);
    if (!grown) return IGI_E_SYSTEM;
    pairs->a = grown;
    if (!(grown = igi_grow(ctx, pairs->b, &pairs->capacity[1], need, sizeof *pairs->b)))
        return IGI_E_SYSTEM;
    pairs->b = grown;
    grown = igi_grow(ctx, pairs->log_ratios, &pairs->capacity[2], need, sizeof *pairs->log_ratios);
    if (!grown) return IGI_E_SYSTEM;
    pairs->log_ratios = grown;
    memcpy(pairs->a[pairs->count], a, 2 * sizeof *a);
    memcpy(pairs->b[pairs->count], b, 2 * sizeof *b);
    pairs->log_ratios[pairs->count++] = log_ratio;
    return IGI_OK;
}

/* Where a later frame sees the point, if it does. */
static igi_status pair_with(igi_context *ctx, session *s, size_t other, igi_vec point,
                            igi_vec normal, const double at[2], double light)
{
    const igi_camera *camera = &s->cameras[other];
    igi_vec centre = igi_camera_centre(camera), way = igi_sub(centre, point);
    double seen[2];
    if (!(igi_dot(normal, way) > .1f * igi_length(way)) ||
        !igi_camera_project(camera, point, &seen[0], &seen[1]) ||
        !(seen[0] >= 0 && seen[1] >= 0 && seen[0] < camera->width && seen[1] < camera->height))
        return IGI_OK;
    size_t pixel = (size_t)seen[1] * (size_t)camera->width + (size_t)seen[0];
    double theirs = (double)s->planes[other][pixel];
    if (!(theirs > 0) || igi_occluded(s->tracer, point, centre)) return IGI_OK;
    return add_pair(ctx, &s->pairs, at, seen, log(light / theirs));
}

static igi_status pair_frame(igi_context *ctx, session *s, size_t frame, int step)
{
    const igi_camera *camera = &s->cameras[frame];
    const igi_mesh *mesh = &s->scene->mesh;
    igi_vec centre = igi_camera_centre(camera);
    for (int y = step / 2; y < camera->height; y += step)
        for (int x = step / 2; x < camera->width; x += step) {
            double light = (double)s->planes[frame][(size_t)y * (size_t)camera->width + (size_t)x];
            const double at[2] = {x + .5, y + .5};
            if (!(light > 0)) continue;
            igi_hit hit = igi_trace(s->tracer, centre, igi_camera_direction(camera, at[0], at[1]));
            if (hit.triangle == IGI_NO_HIT ||
                s->scene->regions[mesh->regions[hit.triangle]].emitter)
                continue;
            igi_vec normal = igi_tracer_normal(s->tracer, hit.triangle);
            if (hit.back) normal = igi_scale(normal, -1);
            igi_vec point = igi_triangle_point(mesh, hit.triangle, hit.u, hit.v);
            point = igi_madd(point, normal, 2 * igi_tracer_epsilon(s->tracer));
            for (size_t other = frame + 1; other < s->scene->frame_count; other++)
                IGI_TRY(pair_with(ctx, s, other, point, normal, at, light));
        }
    return IGI_OK;
}

static igi_status pair_frames(igi_context *ctx, session *s)
{
    const igi_camera *first = &s->cameras[0];
    double frames = (double)s->scene->frame_count;
    double all = (double)first->width * first->height * frames * (frames - 1) / 2;
    int step = (int)ceil(sqrt(all / MOST_PAIRS));
    for (size_t i = 0; i < s->scene->frame_count; i++) IGI_TRY(load_plane(ctx, s, i));
    for (size_t i = 0; i < s->scene->frame_count; i++) {
        IGI_TRY(igi_progress(ctx, (double)i / frames));
        IGI_TRY(pair_frame(ctx, s, i, step > 2 ? step : 2));
    }
    return IGI_OK;
}

igi_status igi_calibrate_overlap(igi_context *ctx, const igi_scene *scene,
                                 igi_calibration **calibration)
{
    igi_status status = IGI_OK;
    session s = {.scene = scene};
    igi_calibration *own = NULL, **target = *calibration ? calibration : &own;
    if (scene->frame_count < 2)
        return igi_fail(ctx, IGI_E_DATA,
                        "%s: vignetting shows where photographs overlap; one is "
                        "not enough",
                        scene->folder);
    igi_stage_begin(ctx, "overlap");
    IGI_TRY_GOTO(igi_photographs_open_as_taken(ctx, scene, &s.photographs));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, scene->frame_count, &s.cameras));
    for (size_t i = 0; i < scene->frame_count; i++)
        s.cameras[i] = igi_photographs_camera(s.photographs, i);
    const igi_photo shape = {.width = s.cameras[0].width, .height = s.cameras[0].height};
    IGI_TRY_GOTO(igi_calibration_for(ctx, scene->folder, &shape, target));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, scene->frame_count, &s.planes));
    IGI_TRY_GOTO(igi_tracer_create(ctx, &scene->mesh, &s.tracer));
    IGI_TRY_GOTO(pair_frames(ctx, &s));
    const int size[2] = {shape.width, shape.height};
    IGI_TRY_GOTO(igi_vignetting_fit_pairs(ctx, &s.pairs, size, &(*target)->vignetting));
    *calibration = *target;
    own = NULL;
cleanup:
    igi_stage_begin(ctx, NULL);
    for (size_t i = 0; s.planes && i < scene->frame_count; i++) igi_free(s.planes[i]);
    igi_free(s.planes);
    igi_free(s.cameras);
    igi_photographs_close(s.photographs);
    igi_free(s.pairs.a);
    igi_free(s.pairs.b);
    igi_free(s.pairs.log_ratios);
    igi_tracer_destroy(s.tracer);
    igi_calibration_destroy(own);
    return status;
}
