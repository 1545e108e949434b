/* SPDX-License-Identifier: Apache-2.0
 *
 * A clear pane of glass across the room's middle, which neither mesh nor method know of. What the
 * photographs show through it is dimmed, and what it mirrors lies over that:
 *     L = (1 - R) L_behind + R L_mirrored,  R = 2 r / (1 + r)
 * for two surfaces of Fresnel's reflectance r each. What the pane does to the light on the surfaces, at
 * most some per cent, is left out.
 */
#include "chart/sweep.h"

#include "render/path.h"
#include "scene/camera.h"

#define INDEX 1.5
#define PATHS 16
#define DEPTH 8
#define LOW 0.6f /* metres above the floor */
#define HIGH 1.6f

typedef struct pane {
    float left, right, y, bottom, top; /* a rectangle of constant y */
} pane;

/* Of one surface, light without polarisation. */
static double fresnel(double cosine)
{
    double inside = sqrt(1 - (1 - cosine * cosine) / (INDEX * INDEX));
    double s = (cosine - INDEX * inside) / (cosine + INDEX * inside),
           p = (INDEX * cosine - inside) / (INDEX * cosine + inside);
    return (s * s + p * p) / 2;
}

static bool meets(const pane *g, igi_vec eye, igi_vec d, float limit, igi_vec *at)
{
    float t = (g->y - eye.y) / d.y;
    if (!(t > 0 && t < limit)) return false;
    *at = igi_madd(eye, d, t);
    return at->x > g->left && at->x < g->right && at->z > g->bottom && at->z < g->top;
}

static void cover_frame(const igi_renderer *r, const pane *g, size_t frame, chart_subject *s)
{
    const igi_camera *camera = &s->scene->frames[frame].camera;
    igi_image *photo = s->photos[frame];
    igi_vec eye = igi_camera_centre(camera);
    for (int i = 0; i < photo->width * photo->height; i++) {
        igi_vec at, d = igi_camera_direction(camera, i % photo->width + .5,
                                             (double)(i / photo->width) + .5);
        igi_hit hit = igi_trace(r->tracer, eye, d);
        float mirrored[IGI_MAX_BANDS] = {0};
        if (!meets(g, eye, d, hit.triangle == IGI_NO_HIT ? INFINITY : hit.distance, &at)) continue;
        sampler points = {.key = igi_hash64(s->seed << 40 ^ frame << 24 ^ (uint64_t)i),
                          .mask = PATHS - 1};
        for (points.index = 0; points.index < PATHS; points.index++) {
            points.dimension = 0;
            trace_path(r, at, igi_v(d.x, -d.y, d.z), DEPTH, &points, mirrored, NULL);
        }
        double one = fresnel(fabs((double)d.y)), both = 2 * one / (1 + one);
        float *pixel = photo->samples + (size_t)i * (size_t)photo->channels;
        for (int b = 0; b < s->scene->bands; b++)
            pixel[b] = (float)((1 - both) * (double)pixel[b] + both * (double)mirrored[b] / PATHS);
    }
}

/* The pane is `severity` metres wide. */
static igi_status glass(igi_context *ctx, const chart_change *c, double severity, chart_subject *s)
{
    (void)c;
    igi_status status = IGI_OK;
    igi_renderer *r = NULL;
    igi_vec low, high;
    IGI_TRY_GOTO(
        igi_renderer_create(ctx, s->scene, s->truth, s->scene->lights, s->scene->light_count, &r));
    igi_tracer_size(r->tracer, &low, &high);
    float x = (low.x + high.x) / 2, half = (float)severity / 2;
    const pane g = {x - half, x + half, (low.y + high.y) / 2, low.z + LOW, low.z + HIGH};
    for (size_t f = 0; f < s->scene->frame_count; f++) cover_frame(r, &g, f, s);
cleanup:
    igi_renderer_destroy(r);
    return status;
}

const chart_perturbation chart_perturb_glass[] = {{"glass", true, glass}, {NULL, false, NULL}};
