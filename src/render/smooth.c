/* SPDX-License-Identifier: Apache-2.0
 *
 * An edge-avoiding wavelet (Dammertz et al. 2010) on indirect irradiance, pi (L - L_direct)/rho:
 * free of texture, and smooth but for creases. Three rounds of 5 x 5 pixels, 1, 2 and 4 apart. A
 * neighbour counts as far as it lies on the plane of the pixel and faces alike. The bias is light
 * that leaks some pixels along a crease; the variance falls by fifty or so.
 */
#include "render/smooth.h"

#include "base/parallel.h"
#include "render/path.h"
#include "scene/camera.h"

#include <string.h>

#define ROUNDS 3
#define BROAD_ALPHA 0.4f
#define OFF_PLANE 0.05f /* of the distance to the camera: a neighbour beyond it counts nothing */

typedef struct guide {
    igi_vec point, normal;
    float distance; /* 0: not smoothed */
} guide;

typedef struct job {
    const igi_renderer *renderer;
    const igi_camera *camera;
    guide *guides;
    const float *from;
    float *to;
    int bands, step;
} job;

static igi_status guide_line(igi_context *ctx, void *user, size_t y, int worker)
{
    (void)worker;
    job *j = user;
    igi_vec centre = igi_camera_centre(j->camera);
    for (int x = 0; x < j->camera->width; x++) {
        guide *g = &j->guides[y * (size_t)j->camera->width + (size_t)x];
        igi_vec d = igi_camera_direction(j->camera, x + .5, (double)y + .5);
        igi_hit hit = igi_trace(j->renderer->tracer, centre, d);
        if (hit.triangle == IGI_NO_HIT) continue;
        surface s;
        surface_at(j->renderer, &hit, d, &s);
        if (s.finish->absorbs) continue;
        if (s.finish->model != IGI_LAMBERT && s.finish->alpha < BROAD_ALPHA) continue;
        *g = (guide){s.point, s.normal, hit.distance};
    }
    igi_count_rays(ctx, (uint64_t)j->camera->width);
    return IGI_OK;
}

static float weight_of(const guide *a, const guide *b)
{
    static const int sharpness = 4; /* cos^16 */
    if (!(b->distance > 0)) return 0;
    float facing = fmaxf(0, igi_dot(a->normal, b->normal));
    float off = fabsf(igi_dot(a->normal, igi_sub(b->point, a->point))) / (OFF_PLANE * a->distance);
    for (int k = 0; k < sharpness; k++) facing *= facing;
    return off < 1 ? facing * (1 - off) : 0;
}

static igi_status smooth_line(igi_context *ctx, void *user, size_t line, int worker)
{
    (void)ctx;
    (void)worker;
    static const float kernel[3] = {3.0f / 8, 1.0f / 4, 1.0f / 16};
    const job *j = user;
    int w = j->camera->width, h = j->camera->height, y = (int)line;
    for (int x = 0; x < w; x++) {
        size_t at = (size_t)y * (size_t)w + (size_t)x;
        const guide *g = &j->guides[at];
        float sum[IGI_MAX_BANDS] = {0}, all = 0;
        for (int dy = -2; dy <= 2 && g->distance > 0; dy++)
            for (int dx = -2; dx <= 2; dx++) {
                int u = x + dx * j->step, v = y + dy * j->step;
                if (u < 0 || v < 0 || u >= w || v >= h) continue;
                size_t other = (size_t)v * (size_t)w + (size_t)u;
                float a = kernel[dx < 0 ? -dx : dx] * kernel[dy < 0 ? -dy : dy] *
                          weight_of(g, &j->guides[other]);
                for (int b = 0; b < j->bands; b++)
                    sum[b] += a * j->from[other * (size_t)j->bands + (size_t)b];
                all += a;
            }
        for (int b = 0; b < j->bands; b++) {
            size_t i = at * (size_t)j->bands + (size_t)b;
            j->to[i] = all > 0 ? sum[b] / all : j->from[i];
        }
    }
    return IGI_OK;
}

igi_status igi_smooth_indirect(igi_context *ctx, const igi_renderer *renderer,
                               const igi_camera *camera, igi_image *picture,
                               const igi_image *direct, const igi_image *albedo)
{
    igi_status status = IGI_OK;
    size_t pixels = (size_t)camera->width * (size_t)camera->height;
    size_t bands = (size_t)renderer->bands, count = pixels * bands;
    float *fields[2] = {NULL, NULL};
    job j = {.renderer = renderer, .camera = camera, .bands = renderer->bands};
    IGI_TRY_GOTO(IGI_ALLOC(ctx, pixels, &j.guides));
    for (int k = 0; k < 2; k++) IGI_TRY_GOTO(IGI_ALLOC(ctx, count, &fields[k]));
    IGI_TRY_GOTO(igi_parallel_for(ctx, (size_t)camera->height, guide_line, &j));
    /* Black pixels have no irradiance to speak of: nothing is divided by less than .01. */
    for (size_t i = 0; i < count; i++)
        fields[0][i] = (picture->samples[i] - direct->samples[i]) /
                       fmaxf(albedo->samples[i], 0.01f);
    for (int k = 0; k < ROUNDS; k++) {
        j.from = fields[k % 2];
        j.to = fields[1 - k % 2];
        j.step = 1 << k;
        IGI_TRY_GOTO(igi_parallel_for(ctx, (size_t)camera->height, smooth_line, &j));
    }
    for (size_t i = 0; i < count; i++)
        if (j.guides[i / bands].distance > 0)
            picture->samples[i] = direct->samples[i] +
                                  fields[ROUNDS % 2][i] * fmaxf(albedo->samples[i], 0.01f);
cleanup:
    igi_free(j.guides);
    igi_free(fields[0]);
    igi_free(fields[1]);
    return status;
}
