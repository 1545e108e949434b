/* SPDX-License-Identifier: Apache-2.0
 *
 * The algorithm of Yu, Debevec, Malik and Hawkins, Inverse Global Illumination (SIGGRAPH 1999).
 *
 * 1. Coarse elements, their mean radiance from the photographs, form factors.
 * 2. Delta S = 0. Diffuse albedo of each region by inverse radiosity.
 * 3. For each region, points in and around the highlights that are predicted; rho_d, rho_s and
 *    alpha of Ward's model by non-linear least squares, with the light of the whole room.
 * 4. Light from element j toward i is what the cameras saw of j plus Delta S, the difference of j's
 *    lobe toward i and toward them, traced one bounce. Again from 2 with these, until the parameters
 *    settle.
 * 5. Point by point: the photographs less the lobe, over the irradiance.
 *
 * Apart from the original: lamps are integrated in closed form, not taken as elements; the lobes of
 * an element toward its cameras are averaged over all photographs that show it, where the paper
 * chose one; alpha is searched for, not started from a guess. Like the original it knows one albedo
 * a region while it fits, has one radiance an element, and no pixel has an extent.
 */
#include "diffuse/coarse.h"
#include "diffuse/methods.h"
#include "specular/correction.h"
#include "specular/yu99.h"

#include "base/parallel.h"
#include "base/rng.h"
#include "scene/camera.h"
#include "transport/mesh_elements.h"

#include <string.h>

#define ROUNDS 5
#define SETTLED 5e-3 /* change of rho_s, and relative of alpha */
#define FIT_POINTS 300
#define ALBEDO_POINTS 1000
#define GLOSS_PIXELS 64 /* of an element, whose lobes toward the camera are averaged */
#define MAP_RAYS 32     /* of a patch, from which maps take their irradiance */
#define EXTRA_RAYS 256  /* of an element, for Delta S in its irradiance */

typedef struct yu99 {
    const igi_problem *problem;
    igi_coarse *coarse;
    igi_diffuse *diffuse;
    igi_lobe *lobes;             /* [regions] */
    size_t *begin;               /* [n + 1] photographs' pixels of each element: pixel[begin..) */
    uint32_t *pixel;             /* observations */
    uint32_t *element;           /* [2 patches] of each side, or IGI_NO_ELEMENT */
    float *mirrored;             /* [n][bands] of gloss, what came from surfaces, not from lamps */
    float *gloss, *extra;        /* [n][bands], see igi_coarse_solve */
    float *diffuse_part, *total; /* [2 patches][bands] */
} yu99;

static bool is_lamp(const yu99 *y, size_t region)
{
    return y->problem->scene->regions[region].emitter;
}

static const igi_lobe *lobe_of(const yu99 *y, size_t element)
{
    return &y->lobes[y->coarse->region[element]];
}

/* Which element each pixel and each side of a patch belongs to. */
static igi_status find_elements(igi_context *ctx, yu99 *y)
{
    const igi_problem *p = y->problem;
    const igi_observations *o = p->observations;
    const igi_elements *elements = y->coarse->elements;
    igi_rng rng = igi_rng_make(1, 1);
    for (uint32_t side = 0; side < 2 * p->patches->count; side++) {
        uint32_t triangle;
        float u, v;
        y->element[side] = IGI_NO_ELEMENT;
        if (!(p->patches->area[side >> 1] > 0)) continue;
        igi_patch_sample(p->patches, side >> 1, &rng, &triangle, &u, &v);
        y->element[side] = igi_elements_at(elements, triangle, u, v, side & 1);
    }
    uint32_t *of;
    IGI_TRY(IGI_ALLOC(ctx, o->count, &of));
    for (size_t i = 0; i < o->count; i++) {
        uint32_t surface = o->surface[i];
        of[i] = igi_elements_at(elements, igi_surface_triangle(surface), o->uv[2 * i],
                                o->uv[2 * i + 1], igi_surface_is_back(surface));
        if (of[i] != IGI_NO_ELEMENT) y->begin[of[i] + 2]++;
    }
    for (size_t e = 0; e < y->coarse->n; e++) y->begin[e + 2] += y->begin[e + 1];
    for (size_t i = 0; i < o->count; i++)
        if (of[i] != IGI_NO_ELEMENT) y->pixel[y->begin[of[i] + 1]++] = (uint32_t)i;
    igi_free(of);
    return IGI_OK;
}

static igi_radiance_field field_of(const yu99 *y)
{
    return (igi_radiance_field){y->problem, y->diffuse_part, y->total, y->lobes};
}

static igi_vec toward_camera(const igi_problem *p, size_t observation, igi_vec point)
{
    size_t frame = igi_observation_frame(p->observations, observation);
    return igi_normalize(igi_sub(igi_camera_centre(&p->scene->frames[frame].camera), point));
}

/* The lobe's part of what the photographs show of an element. */
static igi_status find_gloss(igi_context *ctx, void *user, size_t e, int worker)
{
    (void)worker;
    yu99 *y = user;
    const igi_problem *p = y->problem;
    const igi_observations *o = p->observations;
    igi_radiance_field field = field_of(y);
    size_t bands = y->coarse->bands, n = y->begin[e + 1] - y->begin[e];
    size_t taken = n < GLOSS_PIXELS ? n : GLOSS_PIXELS;
    float lamps[IGI_MAX_BANDS] = {0}, surfaces[IGI_MAX_BANDS] = {0};
    uint64_t rays = 0;
    igi_rng rng = igi_rng_make(igi_seed(ctx) + 2, e);
    for (size_t b = 0; b < bands; b++) y->gloss[e * bands + b] = y->mirrored[e * bands + b] = 0;
    if (lobe_of(y, e)->model == IGI_LAMBERT || is_lamp(y, y->coarse->region[e])) return IGI_OK;
    for (size_t k = 0; k < taken; k++) {
        size_t i = y->pixel[y->begin[e] + k * n / taken];
        uint32_t triangle = igi_surface_triangle(o->surface[i]);
        igi_vec point = igi_triangle_point(&p->scene->mesh, triangle, o->uv[2 * i],
                                           o->uv[2 * i + 1]);
        igi_vec normal = igi_tracer_normal(p->tracer, triangle);
        if (igi_surface_is_back(o->surface[i])) normal = igi_scale(normal, -1);
        rays += (uint64_t)igi_lobe_radiance(&field, lobe_of(y, e), point, normal,
                                            toward_camera(p, i, point), &rng, lamps, surfaces);
    }
    for (size_t b = 0; b < bands && taken > 0; b++) {
        y->mirrored[e * bands + b] = surfaces[b] / (float)taken;
        y->gloss[e * bands + b] = (lamps[b] + surfaces[b]) / (float)taken;
    }
    igi_count_rays(ctx, rays);
    return IGI_OK;
}

static void fill_field(yu99 *y)
{
    size_t bands = y->coarse->bands;
    for (uint32_t side = 0; side < 2 * y->problem->patches->count; side++) {
        uint32_t e = y->element[side];
        for (size_t b = 0; b < bands && e != IGI_NO_ELEMENT; b++) {
            float total = y->coarse->radiance[e * bands + b];
            y->total[side * bands + b] = total;
            y->diffuse_part[side * bands + b] = fmaxf(0, total - y->gloss[e * bands + b]);
        }
    }
}

/* Irradiance of an element by Delta S: what its rays bring beyond the mean radiance of what they
 * meet. */
static igi_status find_extra(igi_context *ctx, void *user, size_t e, int worker)
{
    (void)worker;
    yu99 *y = user;
    const igi_problem *p = y->problem;
    igi_radiance_field field = field_of(y);
    const igi_element *element = &y->coarse->elements->elements[e];
    size_t bands = y->coarse->bands;
    double shift[5], x[4], point[3], margin = 4 * (double)igi_tracer_epsilon(p->tracer);
    float sum[IGI_MAX_BANDS] = {0};
    uint64_t rays = EXTRA_RAYS;
    igi_rng rng = igi_rng_make(igi_seed(ctx) + 3, e);
    for (int d = 0; d < 5; d++) shift[d] = (double)igi_rng_float(&rng);
    for (int k = 0; k < EXTRA_RAYS; k++) {
        igi_kronecker(shift, k, 4, x);
        const igi_facet *facet = igi_elements_facet(y->coarse->elements, (uint32_t)e,
                                                    (k + shift[4]) / EXTRA_RAYS);
        igi_facet_point(facet, x[0], x[1], margin, point);
        igi_vec normal = igi_scale(igi_v_ofd(facet->normal), element->back ? -1 : 1);
        igi_vec origin = igi_v_ofd(point),
                toward = igi_cosine_direction(normal, (float)x[2], (float)x[3]);
        igi_hit hit = igi_trace(p->tracer, origin, toward);
        if (hit.triangle == IGI_NO_HIT) continue;
        uint32_t region = p->scene->mesh.regions[hit.triangle];
        if (is_lamp(y, region) || y->lobes[region].model == IGI_LAMBERT) continue;
        rays += (uint64_t)igi_radiance_toward(&field, origin, toward, &hit, &rng, sum);
        uint32_t side = igi_side_at(p->patches, hit.triangle, hit.u, hit.v, hit.back);
        const float *total = y->total + side * bands;
        for (size_t b = 0; b < bands; b++) sum[b] -= total[b];
    }
    for (size_t b = 0; b < bands; b++) y->extra[e * bands + b] = IGI_PIF / EXTRA_RAYS * sum[b];
    igi_count_rays(ctx, rays);
    return IGI_OK;
}

/* Steps 2 and 4: Delta S from the present lobes, and the diffuse half again. */
static igi_status solve_diffuse(igi_context *ctx, yu99 *y)
{
    igi_stage_begin(ctx, "diffuse");
    fill_field(y); /* lobes mirror what was seen */
    IGI_TRY(igi_parallel_for(ctx, y->coarse->n, find_gloss, y));
    fill_field(y);
    IGI_TRY(igi_parallel_for(ctx, y->coarse->n, find_extra, y));
    IGI_TRY(igi_coarse_solve(ctx, y->coarse, y->gloss, y->extra, y->diffuse));
    fill_field(y); /* with the unseen elements as they are now */
    return IGI_OK;
}

/* Step 3. The largest change of a parameter. */
static igi_status fit_lobes(igi_context *ctx, yu99 *y, igi_lobe_estimate *estimates, double *change)
{
    igi_radiance_field field = field_of(y);
    *change = 0;
    igi_stage_begin(ctx, "lobes");
    /* All regions are fitted to the light of the same lobes. */
    for (uint32_t r = 0; r < y->problem->scene->region_count; r++) {
        igi_yu99_samples *samples = NULL;
        if (is_lamp(y, r) || !y->diffuse->determined[r]) continue;
        IGI_TRY(igi_yu99_samples_create(ctx, &field, r, FIT_POINTS, true, &samples));
        igi_status status = igi_yu99_fit_lobe(ctx, samples, &estimates[r]);
        igi_yu99_samples_destroy(samples);
        IGI_TRY(status);
    }
    for (uint32_t r = 0; r < y->problem->scene->region_count; r++) {
        igi_lobe *lobe = &y->lobes[r], now = {.model = estimates[r].model};
        if (now.model != IGI_LAMBERT) {
            now.alpha = (float)estimates[r].alpha;
            for (size_t b = 0; b < y->coarse->bands; b++)
                now.specular[b] = (float)estimates[r].specular;
        }
        *change = fmax(*change, fabs((double)(now.specular[0] - lobe->specular[0])));
        if (now.model != IGI_LAMBERT && lobe->model != IGI_LAMBERT)
            *change = fmax(*change, fabs(log((double)(now.alpha / lobe->alpha))));
        *lobe = now;
    }
    return IGI_OK;
}

/* Step 5, its mean over each region: photographs less the lobe, over irradiance, point by point. */
static igi_status divide(igi_context *ctx, yu99 *y)
{
    igi_radiance_field field = field_of(y);
    igi_stage_begin(ctx, "albedo");
    for (uint32_t r = 0; r < y->problem->scene->region_count; r++) {
        igi_yu99_samples *samples = NULL;
        if (is_lamp(y, r) || !y->diffuse->determined[r]) continue;
        IGI_TRY(igi_yu99_samples_create(ctx, &field, r, ALBEDO_POINTS, false, &samples));
        if (samples->count > 1)
            y->diffuse->determined[r] = igi_yu99_albedo(
                samples, &y->lobes[r], y->diffuse->albedo[r], y->diffuse->albedo_std[r]);
        igi_yu99_samples_destroy(samples);
    }
    return IGI_OK;
}

static igi_status allocate(igi_context *ctx, yu99 *y)
{
    size_t sides = 2 * y->problem->patches->count, bands = y->coarse->bands, n = y->coarse->n;
    IGI_TRY(IGI_ALLOC(ctx, n + 2, &y->begin));
    IGI_TRY(IGI_ALLOC(ctx, y->problem->observations->count, &y->pixel));
    IGI_TRY(IGI_ALLOC(ctx, sides, &y->element));
    IGI_TRY(IGI_ALLOC(ctx, n * bands, &y->gloss));
    IGI_TRY(IGI_ALLOC(ctx, n * bands, &y->mirrored));
    IGI_TRY(IGI_ALLOC(ctx, n * bands, &y->extra));
    IGI_TRY(IGI_ALLOC(ctx, sides * bands, &y->diffuse_part));
    IGI_TRY(IGI_ALLOC(ctx, sides * bands, &y->total));
    return find_elements(ctx, y);
}

/* What maps and predictions need: the diffuse part of each side, and the lobes' part. */
static igi_status hand_on(igi_context *ctx, yu99 *y, igi_correction *correction)
{
    const igi_problem *p = y->problem;
    size_t bands = y->coarse->bands, sides = 2 * p->patches->count;
    igi_gather_options options = {.rays = MAP_RAYS, .light_points = MAP_RAYS / 3};
    igi_sites sites = igi_problem_sites(p);
    igi_stage_begin(ctx, "gather");
    IGI_TRY(igi_rows_create(ctx, p->scene, p->patches, p->tracer, p->lighting, &sites, &options,
                            &y->diffuse->rows));
    const igi_rows *rows = y->diffuse->rows;
    IGI_TRY(igi_correction_create(ctx, p, rows, correction));
    igi_coarse_hand_on(y->coarse, y->diffuse);
    for (uint32_t side = 0; side < sides; side++) {
        uint32_t e = y->element[side];
        if (e == IGI_NO_ELEMENT || igi_problem_seen_count(p, side) == 0) continue;
        for (size_t b = 0; b < bands; b++) {
            float *radiance = &y->diffuse->radiance[side * bands + b];
            correction->seen[side * bands + b] = y->gloss[e * bands + b];
            for (size_t v = correction->view_begin[side]; v < correction->view_begin[side + 1]; v++)
                for (size_t half = 0; half < 2; half++) {
                    size_t at = half * correction->view_begin[sides] + v;
                    float mirrored = y->mirrored[e * bands + b];
                    correction->surfaces[at * bands + b] = mirrored;
                    correction->lamps[at] += (y->gloss[e * bands + b] - mirrored) / (float)bands;
                }
            *radiance = fmaxf(0, *radiance - y->gloss[e * bands + b]);
        }
    }
    /* extra is beyond the mean of all that was seen; what is gathered now is the diffuse part */
    for (size_t row = 0; row < rows->count; row++) {
        uint32_t e = y->element[rows->side[row]];
        if (e == IGI_NO_ELEMENT) continue;
        for (size_t j = 0; j < y->coarse->n; j++) {
            float factor = (float)y->coarse->factors[e * y->coarse->n + j];
            for (size_t b = 0; b < bands && factor > 0; b++)
                correction->received[row * bands + b] += IGI_PIF * factor * y->gloss[j * bands + b];
        }
        for (size_t b = 0; b < bands; b++)
            correction->received[row * bands + b] += y->extra[e * bands + b];
    }
    y->diffuse->received = correction->received;
    return IGI_OK;
}

igi_status igi_yu99_create(igi_context *ctx, const igi_problem *problem, igi_diffuse *diffuse,
                           igi_specular **specular)
{
    igi_status status = IGI_OK;
    igi_specular *s = NULL;
    yu99 y = {.problem = problem, .diffuse = diffuse};
    double change = HUGE_VAL;
    int model = problem->options->model;
    *specular = NULL;
    if (model != IGI_ANY_MODEL && model != IGI_LAMBERT && model != IGI_WARD)
        return igi_fail(ctx, IGI_E_USAGE,
                        "--method yu99 knows Ward's model alone; leave --model out");
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &s));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, problem->scene->region_count, &s->estimates));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, problem->scene->region_count, &s->lobes));
    y.lobes = s->lobes;
    igi_stage_begin(ctx, "form factors");
    IGI_TRY_GOTO(igi_coarse_create(ctx, problem, &y.coarse));
    IGI_TRY_GOTO(allocate(ctx, &y));
    for (int round = 0; round < ROUNDS && change > SETTLED && model != IGI_LAMBERT; round++) {
        IGI_TRY_GOTO(solve_diffuse(ctx, &y));
        IGI_TRY_GOTO(fit_lobes(ctx, &y, s->estimates, &change));
    }
    IGI_TRY_GOTO(solve_diffuse(ctx, &y));
    IGI_TRY_GOTO(divide(ctx, &y));
    IGI_TRY_GOTO(hand_on(ctx, &y, &s->correction));
    *specular = s;
    s = NULL;
cleanup:
    igi_coarse_destroy(y.coarse);
    igi_free(y.begin);
    igi_free(y.pixel);
    igi_free(y.element);
    igi_free(y.gloss);
    igi_free(y.mirrored);
    igi_free(y.extra);
    igi_free(y.diffuse_part);
    igi_free(y.total);
    igi_specular_destroy(s);
    return status;
}
