/* SPDX-License-Identifier: Apache-2.0 */
#include "diffuse/problem.h"

#include "scene/camera.h"

#include <string.h>

/* A pixel farther than this many standard deviations from its side's mean is left out: fireflies,
 * passers-by. Generous, because the noise of rendered and of real photographs is skewed, and
 * cutting a skewed tail biases the mean. */
#define OUTLIER_SIGMAS 6.0
#define FEW_PIXELS 5 /* below that, nothing can be told from an outlier */

static uint32_t side_of(const igi_problem *p, size_t i)
{
    uint32_t surface = p->observations->surface[i];
    uint32_t patch = igi_patch_at(p->patches, igi_surface_triangle(surface),
                                  p->observations->uv[2 * i], p->observations->uv[2 * i + 1]);
    return 2 * patch + (igi_surface_is_back(surface) ? 1u : 0u);
}

/* Counting sort: stable, so that observations of a side stay in the order of photographs. */
static igi_status sort_by_side(igi_context *ctx, igi_problem *p)
{
    size_t sides = 2 * p->patches->count, n = p->observations->count;
    uint32_t *side;
    IGI_TRY(IGI_ALLOC(ctx, sides + 2, &p->site_begin));
    IGI_TRY(IGI_ALLOC(ctx, n, &p->order));
    IGI_TRY(IGI_ALLOC(ctx, n, &side));
    for (size_t i = 0; i < n; i++) {
        side[i] = side_of(p, i);
        p->site_begin[side[i] + 2]++;
    }
    for (size_t s = 0; s < sides; s++) p->site_begin[s + 2] += p->site_begin[s + 1];
    for (size_t i = 0; i < n; i++) p->order[p->site_begin[side[i] + 1]++] = (uint32_t)i;
    igi_free(side);
    return IGI_OK;
}

static double brightness(const igi_problem *p, size_t observation)
{
    const float *radiance = p->observations->radiance + observation * (size_t)p->bands;
    double sum = 0;
    for (int b = 0; b < p->bands; b++) sum += (double)radiance[b];
    return sum / p->bands;
}

typedef struct spread {
    double mean, variance, low, high;
} spread;

/* Of the brightness of a side's pixels between the bounds. */
static spread spread_of(const igi_problem *p, uint32_t side, double low, double high)
{
    double sum = 0, squares = 0, n = 0;
    spread s = {0, 0, HUGE_VAL, -HUGE_VAL};
    for (size_t k = p->site_begin[side]; k < p->site_begin[side + 1]; k++) {
        double x = brightness(p, p->order[k]);
        if (x < low || x > high) continue;
        sum += x;
        squares += x * x;
        n++;
        s.low = fmin(s.low, x);
        s.high = fmax(s.high, x);
    }
    s.mean = n > 0 ? sum / n : 0;
    s.variance = n > 1 ? fmax(0, squares / n - s.mean * s.mean) * n / (n - 1) : 0;
    return s;
}

/* Narrows the bounds until nothing lies outside: outliers widen the spread that is to expose them. */
static spread core_of(const igi_problem *p, uint32_t side)
{
    spread s = spread_of(p, side, -HUGE_VAL, HUGE_VAL);
    if (igi_problem_seen_count(p, side) < FEW_PIXELS) return s;
    for (int i = 0; i < 3; i++) {
        double reach = OUTLIER_SIGMAS * sqrt(s.variance);
        if (s.low >= s.mean - reach && s.high <= s.mean + reach) break;
        s = spread_of(p, side, s.mean - reach, s.mean + reach);
    }
    return s;
}

static void average_side(igi_problem *p, uint32_t side)
{
    size_t bands = (size_t)p->bands;
    if (igi_problem_seen_count(p, side) == 0) return;
    spread core = core_of(p, side);
    double sum[IGI_MAX_BANDS] = {0}, kept = 0;
    for (size_t k = p->site_begin[side]; k < p->site_begin[side + 1]; k++) {
        double x = brightness(p, p->order[k]);
        if (x < core.low || x > core.high) continue;
        const float *radiance = p->observations->radiance + p->order[k] * bands;
        for (size_t b = 0; b < bands; b++) sum[b] += (double)radiance[b];
        kept++;
    }
    for (size_t b = 0; b < bands && kept > 0; b++)
        p->seen[side * bands + b] = (float)(sum[b] / kept);
    p->seen_var[side] = (float)(core.variance / fmax(kept, 1));
}

/* Radiance of a lamp whose value nobody gave: the mean over what the photographs show of its front. */
static void read_lamp(const igi_problem *p, igi_light *light, double std[IGI_MAX_BANDS])
{
    double sum[IGI_MAX_BANDS] = {0}, squares[IGI_MAX_BANDS] = {0}, n = 0;
    const igi_observations *o = p->observations;
    for (size_t i = 0; i < o->count; i++) {
        if (igi_surface_is_back(o->surface[i])) continue;
        if ((int)p->scene->mesh.regions[igi_surface_triangle(o->surface[i])] != light->region)
            continue;
        for (int b = 0; b < p->bands; b++) {
            double x = (double)o->radiance[i * (size_t)p->bands + (size_t)b];
            sum[b] += x;
            squares[b] += x * x;
        }
        n++;
    }
    if (n == 0) return;
    light->known = true;
    for (int b = 0; b < p->bands; b++) {
        light->value[b] = sum[b] / n;
        std[b] = sqrt(fmax(0, squares[b] / n - light->value[b] * light->value[b]) / n);
    }
}

static igi_status prepare_lights(igi_context *ctx, igi_problem *p)
{
    size_t count = p->scene->light_count;
    IGI_TRY(IGI_ALLOC(ctx, count, &p->lights));
    IGI_TRY(IGI_ALLOC(ctx, count, &p->light_std));
    for (size_t l = 0; l < count; l++) {
        p->lights[l] = p->scene->lights[l];
        if (p->lights[l].known) continue;
        if (p->lights[l].type == IGI_LIGHT_AREA) read_lamp(p, &p->lights[l], p->light_std[l]);
        if (!p->lights[l].known)
            return igi_fail(ctx, IGI_E_NO_ANSWER,
                            "lights[%zu]: its value is not given and no photograph shows it; give "
                            "\"%s\", or add a photograph of it",
                            l, p->lights[l].type == IGI_LIGHT_AREA ? "radiance" : "intensity");
    }
    return igi_lighting_create(ctx, p->scene, p->lights, count, &p->lighting);
}

igi_status igi_problem_create(igi_context *ctx, const igi_scene *scene, const igi_tracer *tracer,
                              const igi_observations *observations, const igi_patches *patches,
                              const igi_recover_options *options, igi_problem **problem)
{
    igi_problem *p = NULL;
    igi_status status = IGI_OK;
    *problem = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &p));
    *p = (igi_problem){.scene = scene,
                       .tracer = tracer,
                       .observations = observations,
                       .patches = patches,
                       .options = options,
                       .bands = scene->bands};
    IGI_TRY_GOTO(sort_by_side(ctx, p));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 2 * patches->count * (size_t)p->bands, &p->seen));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 2 * patches->count, &p->seen_var));
    for (uint32_t side = 0; side < 2 * patches->count; side++) average_side(p, side);
    IGI_TRY_GOTO(prepare_lights(ctx, p));
    *problem = p;
    p = NULL;
cleanup:
    igi_problem_destroy(p);
    return status;
}

void igi_problem_destroy(igi_problem *problem)
{
    if (!problem) return;
    igi_lighting_destroy(problem->lighting);
    igi_free(problem->lights);
    igi_free(problem->light_std);
    igi_free(problem->site_begin);
    igi_free(problem->order);
    igi_free(problem->seen);
    igi_free(problem->seen_var);
    igi_free(problem);
}

igi_sites igi_problem_sites(const igi_problem *problem)
{
    return (igi_sites){problem->site_begin, problem->order, problem->observations->surface,
                       problem->observations->uv};
}

float igi_footprint(const igi_problem *problem, size_t frame, uint32_t surface, float u, float v)
{
    const igi_camera *camera = &problem->scene->frames[frame].camera;
    uint32_t triangle = igi_surface_triangle(surface);
    igi_vec point = igi_triangle_point(&problem->scene->mesh, triangle, u, v);
    igi_vec d = igi_sub(point, igi_camera_centre(camera));
    float distance2 = igi_dot(d, d);
    float cosine = fabsf(igi_dot(d, igi_tracer_normal(problem->tracer, triangle))) /
                   sqrtf(distance2);
    return sqrtf(distance2 / (float)(camera->fl_x * camera->fl_y) / fmaxf(cosine, 0.02f));
}

igi_status igi_diffuse_create(igi_context *ctx, const igi_problem *problem, igi_diffuse **diffuse)
{
    igi_diffuse *d = NULL;
    igi_status status = IGI_OK;
    size_t regions = problem->scene->region_count;
    *diffuse = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &d));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions, &d->albedo));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions, &d->albedo_std));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions, &d->determined));
    IGI_TRY_GOTO(
        IGI_ALLOC(ctx, 2 * problem->patches->count * (size_t)problem->bands, &d->radiance));
    memcpy(d->radiance, problem->seen,
           2 * problem->patches->count * (size_t)problem->bands * sizeof(float));
    *diffuse = d;
    d = NULL;
cleanup:
    igi_diffuse_destroy(d);
    return status;
}

void igi_diffuse_destroy(igi_diffuse *diffuse)
{
    if (!diffuse) return;
    igi_free(diffuse->albedo);
    igi_free(diffuse->albedo_std);
    igi_free(diffuse->determined);
    igi_free(diffuse->radiance);
    igi_rows_destroy(diffuse->rows);
    igi_free(diffuse);
}
