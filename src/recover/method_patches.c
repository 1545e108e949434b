/* SPDX-License-Identifier: Apache-2.0
 *
 * Every patch gathers from every other; unseen ones are solved.
 *
 * For row i (a side of a patch) with rays k = 1..K, per band,
 *     E_i = sum_l G_il value_l + (pi / K) sum_k L(hit_ik)
 * where L of a seen side is what the photographs show. The albedo of region r is the ratio
 *     rho_r = pi sum_i a_i L_i / sum_i a_i E_i        over the seen sides i of r, a_i their areas:
 * a ratio of sums, not a mean of ratios, because E_i is noisy and its reciprocal would be biased;
 * and not least squares, because noise in the regressor E_i biases those low (errors in variables).
 * L of an unseen side is rho_r E_i / pi. Sweeps over both until they settle: the fixed point of
 * (I - rho F) b = e restricted to the unseen, which contracts by rho times the unseen share.
 *
 * Uncertainty: the residuals d_i = pi L_i - rho E_i hold the noise of photographs and of sampling
 * alike. Neighbours share errors (a shadow edge, a bright hit), so residuals are summed over cells
 * of a coarse grid before they are squared (a cluster-robust sandwich; White 1980, Liang & Zeger
 * 1986).
 */
#include "recover/methods.h"

#include "recover/region_sums.h"

#include <string.h>

#define MAX_SWEEPS 200
#define SETTLED 1e-7

typedef struct solver {
    const igi_problem *problem;
    const igi_rows *rows;
    int bands;
    float *radiance;   /* [rows][bands] */
    float *direct;     /* [rows][bands] irradiance by the lights */
    float *irradiance; /* [rows][bands] */
    uint32_t *region;  /* [rows] */
    float *weight;     /* [rows] area of seen sides, 0 for the others */
    double (*albedo)[IGI_MAX_BANDS];
} solver;

static void light_rows(solver *s)
{
    const igi_rows *r = s->rows;
    for (size_t i = 0; i < r->count; i++)
        for (int b = 0; b < s->bands; b++) {
            double sum = 0;
            for (size_t l = 0; l < r->lights; l++)
                sum += (double)r->direct[i * r->lights + l] * s->problem->lights[l].value[b];
            s->direct[i * (size_t)s->bands + (size_t)b] = (float)sum;
        }
}

static void gather_row(const solver *s, size_t row)
{
    const igi_rows *r = s->rows;
    size_t bands = (size_t)s->bands;
    float sum[IGI_MAX_BANDS] = {0};
    for (int k = 0; k < r->rays; k++) {
        uint32_t met = r->hits[row * (size_t)r->rays + (size_t)k];
        if (met == IGI_NO_ROW) continue;
        for (size_t b = 0; b < bands; b++) sum[b] += s->radiance[met * bands + b];
    }
    for (size_t b = 0; b < bands; b++)
        s->irradiance[row * bands + b] =
            s->direct[row * bands + b] + IGI_PIF / (float)r->rays * sum[b];
}

static igi_places places_of(const solver *s)
{
    return (igi_places){s->rows->seen_count, s->region, s->weight, s->radiance, s->irradiance,
                        s->rows->point};
}

/* One sweep; the largest change of an albedo, or relative change of an unseen radiance. */
static double sweep(solver *s, igi_region_sums *sums)
{
    const igi_rows *r = s->rows;
    size_t bands = (size_t)s->bands;
    igi_places places = places_of(s);
    for (size_t i = 0; i < r->count; i++) gather_row(s, i);
    double change = igi_region_sums_albedo(sums, &places, s->albedo);
    for (size_t i = r->seen_count; i < r->count; i++)
        for (size_t b = 0; b < bands; b++) {
            float updated = (float)(s->albedo[s->region[i]][b] / IGI_PI) * s->irradiance[i * bands + b];
            double step = fabs((double)(updated - s->radiance[i * bands + b]));
            change = fmax(change, step / (1e-3 + fabs((double)updated)));
            s->radiance[i * bands + b] = updated;
        }
    return change;
}

static igi_status prepare(igi_context *ctx, solver *s)
{
    const igi_rows *r = s->rows;
    size_t bands = (size_t)s->bands;
    IGI_TRY(IGI_ALLOC(ctx, r->count * bands, &s->radiance));
    IGI_TRY(IGI_ALLOC(ctx, r->count * bands, &s->direct));
    IGI_TRY(IGI_ALLOC(ctx, r->count * bands, &s->irradiance));
    IGI_TRY(IGI_ALLOC(ctx, r->count, &s->region));
    IGI_TRY(IGI_ALLOC(ctx, r->count, &s->weight));
    for (size_t i = 0; i < r->count; i++) {
        s->region[i] = igi_patch_region(s->problem->patches, r->side[i] >> 1);
        if (i >= r->seen_count) continue;
        s->weight[i] = s->problem->patches->area[r->side[i] >> 1];
        memcpy(s->radiance + i * bands, s->problem->seen + r->side[i] * bands, bands * sizeof(float));
    }
    light_rows(s);
    return IGI_OK;
}

static void hand_on_radiance(const solver *s, igi_diffuse *diffuse)
{
    size_t bands = (size_t)s->bands;
    for (size_t i = 0; i < s->rows->count; i++)
        memcpy(diffuse->radiance + s->rows->side[i] * bands, s->radiance + i * bands,
               bands * sizeof(float));
}

igi_status igi_method_patches(igi_context *ctx, const igi_problem *problem, igi_diffuse *diffuse)
{
    igi_status status = IGI_OK;
    igi_rows *rows = NULL;
    igi_region_sums *sums = NULL;
    solver s = {.problem = problem, .bands = problem->bands, .albedo = diffuse->albedo};
    int rays = problem->options->rays ? problem->options->rays : 16;
    igi_gather_options options = {.rays = rays, .light_points = rays > 3 ? rays / 4 : 1};
    igi_sites sites = igi_problem_sites(problem);
    igi_stage_begin(ctx, "gather");
    IGI_TRY_GOTO(igi_rows_create(ctx, problem->scene, problem->patches, problem->tracer,
                                 problem->lighting, &sites, &options, &rows));
    igi_stage_begin(ctx, "solve");
    s.rows = rows;
    IGI_TRY_GOTO(prepare(ctx, &s));
    IGI_TRY_GOTO(igi_region_sums_create(ctx, problem, &sums));
    for (int i = 0; i < MAX_SWEEPS; i++)
        if (sweep(&s, sums) < SETTLED) break;
    igi_places places = places_of(&s);
    IGI_TRY_GOTO(igi_region_sums_std(ctx, sums, &places, diffuse));
    hand_on_radiance(&s, diffuse);
    diffuse->indirect = true;
cleanup:
    igi_free(s.radiance);
    igi_free(s.direct);
    igi_free(s.irradiance);
    igi_free(s.region);
    igi_free(s.weight);
    igi_region_sums_destroy(sums);
    igi_rows_destroy(rows);
    return status;
}
