/* SPDX-License-Identifier: Apache-2.0
 *
 * Light between surfaces is measured with the photographs, and light from lamps is stated: of a region
 * of one albedo rho, lit by lights l to the shares d_il of all that reaches its side i,
 *     a_i = rho (1 + sum s_l d_il),
 * where s_l is what the stated power of light l lacks. Least squares, robustly, about each region's
 * means; how well the s_l are known, regions left out in turn say (the jackknife), since what else
 * is wrong with a side (a lobe that was missed, light badly gathered) is alike over a region.
 */
#include "recover/doubt.h"
#include "recover/residuals.h"

#include "base/order.h"
#include "base/solve.h"

#include <string.h>

enum { LIGHTS = 6, SIDES = 400 /* of a region */ };
#define RAYS 4
#define FEWEST_SIDES 30
#define FEWEST_REGIONS 4
#define OFF 0.04
#define KNOWN 0.01 /* error of a scale at the least: irradiance is smoothed over patches */
#define OFF_SIGMAS 4.0
#define HUBER 2.0

typedef struct look {
    uint32_t region;
    double off, share[LIGHTS]; /* albedo over the region's mean, less 1; d_il */
    double weight;
} look;

typedef struct survey {
    const igi_problem *p;
    size_t tested;                      /* of these: */
    size_t light_count, lights[LIGHTS]; /* of the problem's, those that are tried */
    size_t regions, count;
    look *looks;                                         /* [count] */
    double *mean;                                        /* [regions] albedo */
    double (*shares)[LIGHTS];                            /* [regions] mean d */
    double *sides;                                       /* [regions] looked at */
    double *spread;                                      /* [regions] of the residuals, robust */
    double (*matrix)[LIGHTS * LIGHTS], (*right)[LIGHTS]; /* [regions] normal equations */
    double *scratch;                                     /* [count] */
} survey;

static double mean_of_value(const igi_problem *p, size_t light)
{
    double sum = 0;
    for (int b = 0; b < p->bands; b++) sum += p->lights[light].value[b] / p->bands;
    return sum;
}

/* Lights that photographs show are compared with those. Here they stand for what else is wrong with
 * direct and gathered light: without them, a bulb takes the blame. */
static bool shows(igi_light_type type)
{
    return type == IGI_LIGHT_AREA || type == IGI_LIGHT_AMBIENT;
}

static void choose_lights(survey *s)
{
    const igi_problem *p = s->p;
    for (size_t k = 0; k < p->light_count; k++) {
        bool given = p->scene->lights[p->light_of[k]].known;
        if (p->lights[k].type == IGI_LIGHT_ENV || !(mean_of_value(p, k) > 0)) continue;
        s->tested += given && !shows(p->lights[k].type);
        if (s->light_count < LIGHTS) s->lights[s->light_count] = k;
        s->light_count++;
    }
    if (s->light_count > LIGHTS) s->tested = 0; /* too many to be told apart */
}

/* What one side says; false: nothing. */
static bool look_at(const survey *s, const igi_field *field, uint32_t side, look *l)
{
    const igi_problem *p = s->p;
    float irradiance[IGI_MAX_BANDS];
    double all = 0;
    l->off = igi_residual_albedo(p, field, side);
    if (!(l->off > 0) || igi_field_has_edge(field, side)) return false;
    if (!igi_field_of_side(field, side, irradiance)) return false;
    for (int b = 0; b < p->bands; b++) all += (double)irradiance[b] / p->bands;
    igi_vec normal = igi_tracer_normal(p->tracer, p->patches->triangle[side >> 1]);
    if (side & 1) normal = igi_scale(normal, -1);
    for (size_t k = 0; k < s->light_count; k++) {
        double unit = (double)igi_light_irradiance(
            p->lighting, p->tracer, s->lights[k], igi_field_point(field, side), normal, RAYS, side);
        l->share[k] = unit * mean_of_value(p, s->lights[k]) / all;
    }
    return true;
}

/* An even choice of each region's sides. */
static void look_at_sides(survey *s, const igi_field *field, const bool *diffuse)
{
    const igi_patches *patches = s->p->patches;
    for (int pass = 0; pass < 2; pass++)
        for (uint32_t side = 0; side < 2 * patches->count; side++) {
            if (patches->triangle[side >> 1] == IGI_NO_HIT) continue;
            uint32_t r = igi_patch_region(patches, side >> 1);
            if (!diffuse[r] || igi_problem_seen_count(s->p, side) == 0) continue;
            if (pass == 0) s->sides[r]++;
            double share = SIDES / fmax(SIDES, s->sides[r]);
            look *l = &s->looks[s->count];
            if (pass == 0 || (double)(igi_hash64(side) >> 11) * 0x1p-53 >= share) continue;
            l->region = r;
            l->weight = 1;
            s->count += look_at(s, field, side, l);
        }
}

/* Weighted means of each region, and what is off them. */
static void centre(survey *s)
{
    double *weights = s->sides;
    memset(weights, 0, s->regions * sizeof *weights);
    for (size_t i = 0; i < s->count; i++) {
        const look *l = &s->looks[i];
        weights[l->region]++;
        s->mean[l->region] += l->off;
        for (size_t k = 0; k < s->light_count; k++) s->shares[l->region][k] += l->share[k];
    }
    for (size_t r = 0; r < s->regions; r++) {
        s->mean[r] /= fmax(1, weights[r]);
        for (size_t k = 0; k < s->light_count; k++) s->shares[r][k] /= fmax(1, weights[r]);
    }
    for (size_t i = 0; i < s->count; i++) {
        look *l = &s->looks[i];
        l->off = l->off / s->mean[l->region] - 1;
        for (size_t k = 0; k < s->light_count; k++) l->share[k] -= s->shares[l->region][k];
    }
}

static double residual(const survey *s, const look *l, const double *scales)
{
    double r = l->off;
    for (size_t k = 0; k < s->light_count; k++) r -= scales[k] * l->share[k];
    return r;
}

static void find_spreads(survey *s, const double *scales)
{
    for (size_t r = 0; r < s->regions; r++) {
        size_t n = 0;
        for (size_t i = 0; i < s->count; i++)
            if (s->looks[i].region == r) s->scratch[n++] = fabs(residual(s, &s->looks[i], scales));
        s->spread[r] = n >= FEWEST_SIDES ? fmax(1e-4, 1.4826 * igi_median(s->scratch, n))
                                         : HUGE_VAL;
    }
}

static void add_up(survey *s, const double *scales)
{
    size_t n = s->light_count;
    memset(s->matrix, 0, s->regions * sizeof *s->matrix);
    memset(s->right, 0, s->regions * sizeof *s->right);
    for (size_t i = 0; i < s->count; i++) {
        const look *l = &s->looks[i];
        double spread = s->spread[l->region];
        if (isinf(spread)) continue;
        double off = fabs(residual(s, l, scales)) / (HUBER * spread);
        double w = (off > 1 ? 1 / off : 1) / (spread * spread);
        for (size_t k = 0; k < n; k++) {
            s->right[l->region][k] += w * l->share[k] * l->off;
            for (size_t j = 0; j < n; j++)
                s->matrix[l->region][k * n + j] += w * l->share[k] * l->share[j];
        }
    }
}

/* Of all regions but one; false: a light cannot be told from the others. */
static bool solve(const survey *s, size_t without, double *scales)
{
    double matrix[LIGHTS * LIGHTS] = {0};
    size_t n = s->light_count;
    memset(scales, 0, LIGHTS * sizeof *scales);
    for (size_t r = 0; r < s->regions; r++) {
        if (r == without) continue;
        for (size_t k = 0; k < n * n; k++) matrix[k] += s->matrix[r][k];
        for (size_t k = 0; k < n; k++) scales[k] += s->right[r][k];
    }
    for (size_t k = 0; k < n; k++) matrix[k * n + k] += 1; /* a stated power is not off by much */
    return igi_solve_cholesky(matrix, n, scales, 1);
}

static size_t voices(const survey *s)
{
    size_t n = 0;
    for (size_t r = 0; r < s->regions; r++) n += !isinf(s->spread[r]);
    return n;
}

/* scales[k], and one standard deviation each. */
static bool fit(survey *s, double *scales, double *errors)
{
    memset(scales, 0, LIGHTS * sizeof *scales);
    memset(errors, 0, LIGHTS * sizeof *errors);
    for (int round = 0; round < 5; round++) {
        find_spreads(s, scales);
        add_up(s, scales);
        if (voices(s) < FEWEST_REGIONS || !solve(s, SIZE_MAX, scales)) return false;
    }
    double n = (double)voices(s);
    for (size_t r = 0; r < s->regions; r++) {
        double others[LIGHTS];
        if (isinf(s->spread[r])) continue;
        if (!solve(s, r, others)) return false;
        for (size_t k = 0; k < s->light_count; k++)
            errors[k] += (others[k] - scales[k]) * (others[k] - scales[k]) * (n - 1) / n;
    }
    for (size_t k = 0; k < s->light_count; k++) errors[k] = hypot(sqrt(errors[k]), KNOWN);
    return true;
}

static igi_status say(igi_context *ctx, const survey *s, size_t k, double scale, double error,
                      igi_materials *m)
{
    char *sentence;
    if (!(fabs(scale) > fmax(OFF, OFF_SIGMAS * error))) return IGI_OK;
    IGI_TRY(igi_strprintf(ctx, &sentence,
                          "lights[%zu]: where it reaches surfaces, they are as bright as if it had "
                          "%.3g +- %.2g times the power that is stated: check its power and its "
                          "place, and that no light is missing; or leave its power out to have it "
                          "solved",
                          s->p->light_of[s->lights[k]], fmax(0, 1 + scale), error));
    return igi_doubt_say(ctx, m, sentence);
}

static igi_status allocate(igi_context *ctx, survey *s)
{
    size_t most = 2 * s->p->patches->count;
    IGI_TRY(IGI_ALLOC(ctx, most + 1, &s->looks));
    IGI_TRY(IGI_ALLOC(ctx, most + 1, &s->scratch));
    IGI_TRY(IGI_ALLOC(ctx, s->regions, &s->mean));
    IGI_TRY(IGI_ALLOC(ctx, s->regions, &s->shares));
    IGI_TRY(IGI_ALLOC(ctx, s->regions, &s->sides));
    IGI_TRY(IGI_ALLOC(ctx, s->regions, &s->spread));
    IGI_TRY(IGI_ALLOC(ctx, s->regions, &s->matrix));
    return IGI_ALLOC(ctx, s->regions, &s->right);
}

igi_status igi_doubt_powers(igi_context *ctx, const igi_problem *p, const igi_field *field,
                            const bool *diffuse, igi_materials *m, double *off)
{
    igi_status status = IGI_OK;
    survey s = {.p = p, .regions = m->count};
    double scales[LIGHTS], errors[LIGHTS];
    choose_lights(&s);
    if (s.tested == 0) return IGI_OK;
    IGI_TRY_GOTO(allocate(ctx, &s));
    look_at_sides(&s, field, diffuse);
    igi_count_rays(ctx, s.count * s.light_count * RAYS);
    centre(&s);
    if (!fit(&s, scales, errors)) goto cleanup;
    for (size_t k = 0; k < s.light_count; k++) {
        const igi_light *light = &p->lights[s.lights[k]];
        if (shows(light->type) || !p->scene->lights[p->light_of[s.lights[k]]].known) continue;
        IGI_TRY_GOTO(say(ctx, &s, k, scales[k], errors[k], m));
        double sure = sqrt(fmax(0, scales[k] * scales[k] - errors[k] * errors[k]));
        for (size_t r = 0; r < s.regions; r++) off[r] = hypot(off[r], sure * s.shares[r][k]);
    }
cleanup:
    igi_free(s.looks);
    igi_free(s.scratch);
    igi_free(s.mean);
    igi_free(s.shares);
    igi_free(s.sides);
    igi_free(s.spread);
    igi_free(s.matrix);
    igi_free(s.right);
    return status;
}
