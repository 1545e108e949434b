/* SPDX-License-Identifier: Apache-2.0 */
#include "diffuse/problem.h"

#include "observe/lamp_profile.h"
#include "scene/camera.h"

#include <string.h>

/* A pixel farther than this many standard deviations from its side's mean is left out: fireflies,
 * passers-by. Generous, because the noise of rendered and of real photographs is skewed, and
 * cutting a skewed tail biases the mean. */
#define OUTLIER_SIGMAS 6.0
/* A lamp of which more than this share is seen from behind, brightly, is turned around. */
#define BACK_SHARE 0.2
#define MOST_ERROR 0.3 /* relative, of a lamp that is read from pixels which show more than it */
#define FEW_PIXELS 5   /* below that, nothing can be told from an outlier */

uint32_t igi_problem_side_of(const igi_problem *problem, size_t observation)
{
    const igi_observations *o = problem->observations;
    uint32_t surface = o->surface[observation];
    return igi_side_at(problem->patches, igi_surface_triangle(surface), o->uv[2 * observation],
                       o->uv[2 * observation + 1], igi_surface_is_back(surface));
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
        side[i] = igi_problem_side_of(p, i);
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

/* What the photographs show of one side of a lamp. */
typedef struct lamp_side {
    double sum[IGI_MAX_BANDS], squares[IGI_MAX_BANDS], pixels;
} lamp_side;

static void look_at_lamp(const igi_problem *p, int region, lamp_side sides[2])
{
    const igi_observations *o = p->observations;
    for (size_t i = 0; i < o->count; i++) {
        if ((int)p->scene->mesh.regions[igi_surface_triangle(o->surface[i])] != region) continue;
        lamp_side *side = &sides[igi_surface_is_back(o->surface[i])];
        double profile = igi_observation_profile(p->scene, o, i);
        if (!(profile > 0)) continue;
        for (int b = 0; b < p->bands; b++) {
            double x = (double)o->radiance[i * (size_t)p->bands + (size_t)b] / profile;
            side->sum[b] += x;
            side->squares[b] += x * x;
        }
        side->pixels++;
    }
}

/* Of a lamp without clean pixels: from all that it shows in. */
static void read_small_lamp(const igi_problem *p, igi_light *light, double std[IGI_MAX_BANDS])
{
    const igi_observations *o = p->observations;
    igi_lamp_value seen = igi_lamps_sum(o->readings, o->reading_count, p->bands,
                                        (uint32_t)light->region);
    if (seen.photographs == 0) return;
    for (int b = 0; b < p->bands; b++)
        if (!(seen.error[b] < MOST_ERROR * seen.radiance[b])) return;
    light->known = true;
    memcpy(light->value, seen.radiance, sizeof seen.radiance);
    memcpy(std, seen.error, sizeof seen.error);
}

/* Radiance of a lamp whose value nobody gave: the mean over what is seen of its front, each pixel
 * over the profile toward its camera. */
static void read_lamp(const igi_problem *p, const lamp_side *front, igi_light *light,
                      double std[IGI_MAX_BANDS])
{
    double n = front->pixels;
    if (n == 0) {
        read_small_lamp(p, light, std);
        return;
    }
    light->known = true;
    for (int b = 0; b < p->bands; b++) {
        light->value[b] = front->sum[b] / n;
        std[b] = sqrt(fmax(0, front->squares[b] / n - light->value[b] * light->value[b]) / n);
    }
}

/* Light that leaves the back of a lamp: its triangles are turned the wrong way. */
static igi_status check_lamp(igi_context *ctx, const igi_problem *p, const igi_light *light,
                             const lamp_side sides[2])
{
    double n = sides[0].pixels + sides[1].pixels, back = 0, all = 0;
    if (sides[1].pixels <= BACK_SHARE * n) return IGI_OK;
    for (int b = 0; b < p->bands; b++) back += sides[1].sum[b] / sides[1].pixels;
    for (size_t i = 0; i < p->observations->count * (size_t)p->bands; i++)
        all += (double)p->observations->radiance[i] / (double)p->observations->count;
    if (back < 2 * all) return IGI_OK;
    return igi_fail(
        ctx, IGI_E_DATA,
        "%s: region '%s' is a lamp, but the photographs show light leaving its back; turn "
        "its triangles around (counter-clockwise is the front)",
        p->scene->folder, p->scene->regions[light->region].name);
}

/* Copies the scene's lights, environments once for each band. */
static igi_status split_lights(igi_context *ctx, igi_problem *p)
{
    size_t most = p->scene->light_count * (size_t)p->bands;
    IGI_TRY(IGI_ALLOC(ctx, most, &p->lights));
    IGI_TRY(IGI_ALLOC(ctx, most, &p->light_of));
    IGI_TRY(IGI_ALLOC(ctx, most, &p->light_std));
    IGI_TRY(IGI_ALLOC(ctx, most, &p->solved));
    for (size_t l = 0; l < p->scene->light_count; l++) {
        const igi_light *light = &p->scene->lights[l];
        int copies = light->type == IGI_LIGHT_ENV ? p->bands : 1;
        for (int c = 0; c < copies; c++, p->light_count++) {
            p->lights[p->light_count] = *light;
            p->light_of[p->light_count] = l;
            for (int b = 0; b < p->bands && copies > 1; b++)
                if (b != c) p->lights[p->light_count].value[b] = 0;
        }
    }
    return IGI_OK;
}

static igi_status prepare_lights(igi_context *ctx, igi_problem *p)
{
    IGI_TRY(split_lights(ctx, p));
    for (size_t l = 0; l < p->light_count; l++) {
        lamp_side sides[2] = {{{0}, {0}, 0}, {{0}, {0}, 0}};
        bool is_lamp = p->lights[l].type == IGI_LIGHT_AREA;
        if (is_lamp) look_at_lamp(p, p->lights[l].region, sides);
        if (is_lamp) IGI_TRY(check_lamp(ctx, p, &p->lights[l], sides));
        if (p->lights[l].known) continue;
        if (is_lamp) read_lamp(p, &sides[0], &p->lights[l], p->light_std[l]);
        bool solves = p->options->method == IGI_METHOD_PATCHES;
        p->solved[l] = !p->lights[l].known || (solves && is_lamp && sides[0].pixels == 0);
        if (p->solved[l] && !solves)
            return igi_fail(ctx, IGI_E_NO_ANSWER,
                            "lights[%zu]: its value is not given and no photograph shows it; give "
                            "it, add a photograph of it, or take the method that solves for it "
                            "(patches)",
                            p->light_of[l]);
    }
    return igi_lighting_create(ctx, p->scene, p->lights, p->light_count, &p->lighting);
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
    igi_free(problem->solved);
    igi_free(problem->light_of);
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
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions, &d->pattern_std));
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
    igi_free(diffuse->pattern_std);
    igi_free(diffuse->determined);
    igi_free(diffuse->radiance);
    igi_rows_destroy(diffuse->rows);
    igi_diffuse_forget_warnings(diffuse);
    igi_free(diffuse);
}

void igi_diffuse_forget_warnings(igi_diffuse *diffuse)
{
    for (size_t i = 0; i < diffuse->warning_count; i++) igi_free(diffuse->warnings[i]);
    igi_free(diffuse->warnings);
    diffuse->warnings = NULL;
    diffuse->warning_count = 0;
}
