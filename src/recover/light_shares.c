/* SPDX-License-Identifier: Apache-2.0 */
#include "recover/light_shares.h"
#include "recover/residuals.h"

#include "base/order.h"
#include "base/solve.h"

#include <string.h>

enum { SIDES = 2000 /* of a region */ };
#define RAYS 4
#define FEWEST_SIDES 30
#define FEWEST_REGIONS 4
#define KNOWN 0.01 /* error of a scale at the least: irradiance is smoothed over patches */
#define HUBER 2.0

double igi_light_shares_value(const igi_problem *p, size_t light)
{
    double sum = 0;
    for (int b = 0; b < p->bands; b++) sum += p->lights[light].value[b] / p->bands;
    return sum;
}

bool igi_light_shares_shows(igi_light_type type)
{
    return type == IGI_LIGHT_AREA || type == IGI_LIGHT_AMBIENT;
}

static void choose_lights(igi_light_shares *s)
{
    const igi_problem *p = s->p;
    for (size_t k = 0; k < p->light_count; k++) {
        if (p->lights[k].type == IGI_LIGHT_ENV || !(igi_light_shares_value(p, k) > 0)) continue;
        if (s->light_count < IGI_SHARES_LIGHTS) s->lights[s->light_count] = k;
        s->light_count++;
    }
}

/* What one side says; false: nothing. */
static bool look_at(const igi_light_shares *s, const igi_field *field, uint32_t side, igi_look *l)
{
    const igi_problem *p = s->p;
    float irradiance[IGI_MAX_BANDS];
    double all = 0;
    l->off = igi_residual_albedo(p, field, s->materials, side);
    if (!(l->off > 0) || igi_field_has_edge(field, side)) return false;
    if (!igi_field_of_side(field, side, irradiance)) return false;
    for (int b = 0; b < p->bands; b++) all += (double)irradiance[b] / p->bands;
    l->received = all;
    l->point = igi_field_point(field, side);
    l->normal = igi_tracer_normal(p->tracer, p->patches->triangle[side >> 1]);
    if (side & 1) l->normal = igi_scale(l->normal, -1);
    for (size_t k = 0; k < s->light_count; k++) {
        double unit = (double)igi_light_irradiance(p->lighting, p->tracer, s->lights[k], l->point,
                                                   l->normal, RAYS, side);
        l->share[k] = unit * igi_light_shares_value(p, s->lights[k]) / all;
    }
    return true;
}

/* An even choice of each region's sides. */
static void look_at_sides(igi_light_shares *s, const igi_field *field)
{
    const igi_patches *patches = s->p->patches;
    for (int pass = 0; pass < 2; pass++)
        for (uint32_t side = 0; side < 2 * patches->count; side++) {
            if (patches->triangle[side >> 1] == IGI_NO_HIT) continue;
            uint32_t r = igi_patch_region(patches, side >> 1);
            if (igi_problem_seen_count(s->p, side) == 0) continue;
            if (pass == 0) s->sides[r]++;
            double share = SIDES / fmax(SIDES, s->sides[r]);
            igi_look *l = &s->looks[s->count];
            if (pass == 0 || (double)(igi_hash64(side) >> 11) * 0x1p-53 >= share) continue;
            l->region = r;
            s->count += look_at(s, field, side, l);
        }
}

/* Means of each region, and what is off them. */
static void centre(igi_light_shares *s)
{
    double *weights = s->sides;
    memset(weights, 0, s->regions * sizeof *weights);
    for (size_t i = 0; i < s->count; i++) {
        const igi_look *l = &s->looks[i];
        weights[l->region]++;
        s->mean[l->region] += l->off;
        for (size_t k = 0; k < s->light_count; k++) s->shares[l->region][k] += l->share[k];
    }
    for (size_t r = 0; r < s->regions; r++) {
        s->mean[r] /= fmax(1, weights[r]);
        for (size_t k = 0; k < s->light_count; k++) s->shares[r][k] /= fmax(1, weights[r]);
    }
    for (size_t i = 0; i < s->count; i++) {
        igi_look *l = &s->looks[i];
        l->off = l->off / s->mean[l->region] - 1;
        for (size_t k = 0; k < s->light_count; k++) l->share[k] -= s->shares[l->region][k];
    }
}

static double residual(const igi_light_shares *s, const igi_look *l)
{
    double r = l->off;
    for (size_t k = 0; k < s->light_count; k++) r -= s->scales[k] * l->share[k];
    return r;
}

static void find_spreads(igi_light_shares *s)
{
    for (size_t r = 0; r < s->regions; r++) {
        size_t n = 0;
        for (size_t i = 0; i < s->count; i++)
            if (s->looks[i].region == r) s->scratch[n++] = fabs(residual(s, &s->looks[i]));
        s->spread[r] = s->diffuse[r] && n >= FEWEST_SIDES
                           ? fmax(1e-4, 1.4826 * igi_median(s->scratch, n))
                           : HUGE_VAL;
    }
}

/* Weights by what is left, and means with them: sums over what is centred so need no more centring. */
static void weigh(igi_light_shares *s)
{
    memset(s->sums, 0, s->regions * sizeof *s->sums);
    for (size_t i = 0; i < s->count; i++) {
        igi_look *l = &s->looks[i];
        double spread = s->spread[l->region], *sum = s->sums[l->region];
        double off = fabs(residual(s, l)) / (HUBER * spread);
        l->weight = isinf(spread) ? 0 : (off > 1 ? 1 / off : 1) / (spread * spread);
        sum[0] += l->weight;
        sum[1] += l->weight * l->off;
        for (size_t k = 0; k < s->light_count; k++) sum[2 + k] += l->weight * l->share[k];
    }
    for (size_t i = 0; i < s->count; i++) {
        igi_look *l = &s->looks[i];
        const double *sum = s->sums[l->region];
        if (!(l->weight > 0)) continue;
        l->off -= sum[1] / sum[0];
        for (size_t k = 0; k < s->light_count; k++) l->share[k] -= sum[2 + k] / sum[0];
    }
}

static void add_up(igi_light_shares *s)
{
    size_t n = s->light_count;
    memset(s->matrix, 0, s->regions * sizeof *s->matrix);
    memset(s->right, 0, s->regions * sizeof *s->right);
    for (size_t i = 0; i < s->count; i++) {
        const igi_look *l = &s->looks[i];
        for (size_t k = 0; k < n && l->weight > 0; k++) {
            s->right[l->region][k] += l->weight * l->share[k] * l->off;
            for (size_t j = 0; j < n; j++)
                s->matrix[l->region][k * n + j] += l->weight * l->share[k] * l->share[j];
        }
    }
}

/* Of all regions but one; false: a light cannot be told from the others. */
static bool solve(const igi_light_shares *s, size_t without, double *scales)
{
    double matrix[IGI_SHARES_LIGHTS * IGI_SHARES_LIGHTS] = {0};
    size_t n = s->light_count;
    memset(scales, 0, IGI_SHARES_LIGHTS * sizeof *scales);
    for (size_t r = 0; r < s->regions; r++) {
        if (r == without) continue;
        for (size_t k = 0; k < n * n; k++) matrix[k] += s->matrix[r][k];
        for (size_t k = 0; k < n; k++) scales[k] += s->right[r][k];
    }
    for (size_t k = 0; k < n; k++) matrix[k * n + k] += 1; /* a stated power is not off by much */
    return igi_solve_cholesky(matrix, n, scales, 1);
}

static size_t voices(const igi_light_shares *s)
{
    size_t n = 0;
    for (size_t r = 0; r < s->regions; r++) n += !isinf(s->spread[r]);
    return n;
}

static bool fit(igi_light_shares *s)
{
    double *scales = s->scales, *errors = s->errors;
    for (int round = 0; round < 5; round++) {
        find_spreads(s);
        weigh(s);
        add_up(s);
        if (voices(s) < FEWEST_REGIONS || !solve(s, SIZE_MAX, scales)) return false;
    }
    double n = (double)voices(s);
    for (size_t r = 0; r < s->regions; r++) {
        double others[IGI_SHARES_LIGHTS];
        if (isinf(s->spread[r])) continue;
        if (!solve(s, r, others)) return false;
        for (size_t k = 0; k < s->light_count; k++)
            errors[k] += (others[k] - scales[k]) * (others[k] - scales[k]) * (n - 1) / n;
    }
    for (size_t k = 0; k < s->light_count; k++) errors[k] = hypot(sqrt(errors[k]), KNOWN);
    return true;
}

static igi_status allocate(igi_context *ctx, igi_light_shares *s)
{
    size_t most = 2 * s->p->patches->count;
    IGI_TRY(IGI_ALLOC(ctx, most + 1, &s->looks));
    IGI_TRY(IGI_ALLOC(ctx, most + 1, &s->scratch));
    IGI_TRY(IGI_ALLOC(ctx, s->regions, &s->mean));
    IGI_TRY(IGI_ALLOC(ctx, s->regions, &s->shares));
    IGI_TRY(IGI_ALLOC(ctx, s->regions, &s->sides));
    IGI_TRY(IGI_ALLOC(ctx, s->regions, &s->spread));
    IGI_TRY(IGI_ALLOC(ctx, s->regions, &s->matrix));
    IGI_TRY(IGI_ALLOC(ctx, s->regions, &s->sums));
    return IGI_ALLOC(ctx, s->regions, &s->right);
}

igi_status igi_light_shares_create(igi_context *ctx, const igi_problem *problem,
                                   const igi_field *field, const igi_materials *materials,
                                   const bool *diffuse, igi_light_shares **survey)
{
    igi_status status = IGI_OK;
    igi_light_shares *s = NULL;
    *survey = NULL;
    IGI_TRY(IGI_ALLOC(ctx, 1, &s));
    s->p = problem;
    s->materials = materials;
    s->diffuse = diffuse;
    s->regions = materials->count;
    choose_lights(s);
    if (s->light_count > IGI_SHARES_LIGHTS) goto cleanup;
    IGI_TRY_GOTO(allocate(ctx, s));
    look_at_sides(s, field);
    igi_count_rays(ctx, s->count * s->light_count * RAYS);
    centre(s);
    if (!fit(s)) goto cleanup;
    *survey = s;
    s = NULL;
cleanup:
    igi_light_shares_destroy(s);
    return status;
}

void igi_light_shares_destroy(igi_light_shares *s)
{
    if (!s) return;
    igi_free(s->looks);
    igi_free(s->scratch);
    igi_free(s->mean);
    igi_free(s->shares);
    igi_free(s->sides);
    igi_free(s->spread);
    igi_free(s->matrix);
    igi_free(s->right);
    igi_free(s->sums);
    igi_free(s);
}
