/* SPDX-License-Identifier: Apache-2.0
 *
 * Views of one side of a patch show the same diffuse radiance d and different parts S of the lobe. In
 * each view the mean of L - S estimates d, with the pixels' noise, and with an error of S that grows
 * with S: where a window is mirrored, S is twenty times d, and a per cent of it is a fifth of d. So
 * views are weighted by
 *     1 / (noise^2 (d + S)^2 / pixels + (SPECULAR_ERROR S)^2),
 * and what is left of that error says how far the side is to be trusted beside its region's others.
 * S is estimated by few rays: weights that knew its chance errors would favour views where it came
 * out low. Two halves of the rays give each other their weights.
 */
#include "specular/side_views.h"

#include "base/order.h"
#include "scene/camera.h"

/* Of L and of S, relative: the second is what is left of wrong coefficients and coarse light. */
#define PIXEL_NOISE 0.05
#define SPECULAR_ERROR 0.05
/* Errors of a side that it shares with no highlight: of its irradiance, and of a black surface. */
#define SIDE_ERROR 0.05
#define DARK_SHARE 0.02
/* A pixel this far from what is predicted is a firefly, or shows something else. */
#define OUTLIER_SIGMAS 5.0
#define LEAST_OUTLIER 1.0
#define CUTS 4

typedef struct view {
    size_t begin, end;              /* of problem->order */
    double lobe[2][IGI_MAX_BANDS];  /* S by either half of the rays */
    double radiance[IGI_MAX_BANDS]; /* mean of L */
    double brightness[2], kept;     /* of S; pixels in the mean of L */
} view;

typedef struct side_views {
    const igi_radiance_field *field;
    const igi_problem *problem;
    uint32_t side;
    size_t bands, count;
    view views[IGI_SIDE_VIEWS];
} side_views;

/* The side's pixels come in the order of photographs. */
static void find_views(side_views *s, const igi_correction *c)
{
    const igi_problem *p = s->problem;
    size_t first = c->view_begin[s->side], at = 0, frame = 0;
    s->count = c->view_begin[s->side + 1] - first;
    for (size_t k = p->site_begin[s->side]; k < p->site_begin[s->side + 1]; k++) {
        frame = igi_observation_frame_near(p->observations, p->order[k], frame);
        while (at + 1 < s->count && c->view_frame[first + at] < frame) at++;
        view *v = &s->views[at];
        if (v->end == 0) *v = (view){.begin = k};
        v->end = k + 1;
    }
}

static uint64_t sample_view(const side_views *s, int samples, size_t number, igi_rng *rng, view *v,
                            igi_correction *correction)
{
    const igi_problem *p = s->problem;
    const igi_observations *o = p->observations;
    const igi_lobe *lobe = &s->field->lobes[igi_patch_region(p->patches, s->side >> 1)];
    size_t n = v->end - v->begin;
    uint64_t rays = 0;
    for (int k = 0; k < samples; k++) {
        float lamps[IGI_MAX_BANDS] = {0}, surfaces[IGI_MAX_BANDS] = {0};
        size_t at = (size_t)(((double)k + (double)igi_rng_float(rng)) / samples * (double)n);
        size_t i = p->order[v->begin + at];
        uint32_t triangle = igi_surface_triangle(o->surface[i]);
        igi_vec point = igi_triangle_point(&p->scene->mesh, triangle, o->uv[2 * i],
                                           o->uv[2 * i + 1]);
        igi_vec normal = igi_tracer_normal(p->tracer, triangle);
        if (s->side & 1) normal = igi_scale(normal, -1);
        igi_vec eye = igi_camera_centre(&p->scene->frames[igi_observation_frame(o, i)].camera);
        rays += (uint64_t)igi_lobe_radiance(s->field, lobe, point, normal,
                                            igi_normalize(igi_sub(eye, point)), rng, lamps,
                                            surfaces);
        size_t half = (size_t)(k % 2) * correction->view_begin[2 * p->patches->count] + number;
        for (size_t b = 0; b < s->bands; b++) {
            v->lobe[k % 2][b] += 2 * (double)(lamps[b] + surfaces[b]) / samples;
            correction->surfaces[half * s->bands + b] += 2 * surfaces[b] / (float)samples;
            correction->lamps[half] += 2 * lamps[b] / (float)(samples * (int)s->bands);
        }
    }
    for (int h = 0; h < 2; h++)
        for (size_t b = 0; b < s->bands; b++) v->brightness[h] += v->lobe[h][b] / (double)s->bands;
    return rays;
}

/* Relative difference of a pixel from what d and the view's S predict. */
static double deviation(const side_views *s, const view *v, size_t k, double d)
{
    const float *radiance = s->problem->observations->radiance;
    double l = igi_mean(radiance + s->problem->order[k] * s->bands, s->bands);
    double predicted = d + 0.5 * (v->brightness[0] + v->brightness[1]);
    return (l - predicted) / fmax(predicted, 1e-20);
}

/* Deviations below which a pixel is kept: cuts those far out, and again by the scatter of the rest. */
static double find_reach(const side_views *s, double d)
{
    double reach = HUGE_VAL;
    for (int cut = 0; cut < CUTS; cut++) {
        double n = 0, squares = 0, farthest = 0;
        for (size_t i = 0; i < s->count; i++)
            for (size_t k = s->views[i].begin; k < s->views[i].end; k++) {
                double x = fabs(deviation(s, &s->views[i], k, d));
                if (x > reach) continue;
                n++;
                squares += x * x;
                farthest = fmax(farthest, x);
            }
        if (n < 2) break;
        reach = fmax(LEAST_OUTLIER, OUTLIER_SIGMAS * sqrt(squares / n));
        if (farthest <= reach) break; /* it would cut nothing more */
    }
    return reach;
}

/* Means of L by view. */
static void average_views(side_views *s, double d)
{
    double reach = find_reach(s, d);
    for (size_t i = 0; i < s->count; i++) {
        view *v = &s->views[i];
        for (size_t k = v->begin; k < v->end; k++) {
            if (fabs(deviation(s, v, k, d)) > reach) continue;
            const float *l = s->problem->observations->radiance + s->problem->order[k] * s->bands;
            for (size_t b = 0; b < s->bands; b++) v->radiance[b] += (double)l[b];
            v->kept++;
        }
        for (size_t b = 0; b < s->bands && v->kept > 0; b++) v->radiance[b] /= v->kept;
    }
}

/* d of the side from all views; returns what errors of S leave in it. */
static double combine_views(const side_views *s, double d, double result[IGI_MAX_BANDS])
{
    double error = 0;
    for (size_t b = 0; b < s->bands; b++) result[b] = 0;
    for (int h = 0; h < 2; h++) {
        double total = 0, sum[IGI_MAX_BANDS] = {0}, wrong = 0;
        for (size_t i = 0; i < s->count; i++) {
            const view *v = &s->views[i];
            double lobe = v->brightness[1 - h], noise = PIXEL_NOISE * (d + lobe);
            double w = v->kept / (noise * noise + v->kept * pow(SPECULAR_ERROR * lobe, 2) + 1e-30);
            for (size_t b = 0; b < s->bands; b++) sum[b] += w * (v->radiance[b] - v->lobe[h][b]);
            total += w;
            wrong += w * SPECULAR_ERROR * lobe;
        }
        if (!(total > 0)) continue;
        for (size_t b = 0; b < s->bands; b++) result[b] += 0.5 * sum[b] / total;
        error += 0.5 * wrong / total;
    }
    return error;
}

uint64_t igi_side_views_part(const igi_radiance_field *field, uint32_t side, igi_side_effort effort,
                             const float *before, igi_side_level level, igi_rng *rng,
                             igi_correction *correction)
{
    const igi_problem *p = field->problem;
    size_t bands = (size_t)p->bands, first = correction->view_begin[side];
    side_views s = {.field = field, .problem = p, .side = side, .bands = bands};
    double d = fmax(0, igi_mean(before, bands)) + DARK_SHARE * level.seen;
    double result[IGI_MAX_BANDS], pixels = (double)igi_problem_seen_count(p, side);
    uint64_t rays = 0;
    find_views(&s, correction);
    for (size_t i = 0; i < s.count; i++) {
        double share = (double)(s.views[i].end - s.views[i].begin) / pixels;
        int own = 2 * (int)ceil(0.5 * share * effort.samples);
        rays += sample_view(&s, own < effort.of_view ? effort.of_view : own, first + i, rng,
                            &s.views[i], correction);
    }
    average_views(&s, d);
    double error = combine_views(&s, d, result);
    for (size_t b = 0; b < bands; b++)
        correction->seen[side * bands + b] = p->seen[side * bands + b] - (float)result[b];
    double own = SIDE_ERROR * (level.diffuse + DARK_SHARE * level.seen);
    correction->trust[side] = (float)(own * own / (own * own + error * error + 1e-30));
    return rays;
}
