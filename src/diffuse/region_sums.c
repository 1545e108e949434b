/* SPDX-License-Identifier: Apache-2.0
 *
 * With residuals d_i = pi L_i - rho E_i, summed over cells c of neighbouring places,
 *     var(rho) = n/(n-1) sum_c (sum_{i in c} w_i d_i)^2 / (sum_i w_i E_i)^2,   n cells,
 * the sandwich of a ratio estimator that allows errors to be alike within a cell.
 */
#include "diffuse/region_sums.h"

#include "diffuse/cells.h"

#include <string.h>

/* What is said of a region that nothing determines: anything in 0..1 may be true. */
#define UNKNOWN_STD 0.3

struct igi_region_sums {
    const igi_problem *problem;
    double (*reflected)[IGI_MAX_BANDS]; /* [regions] pi sum w L */
    double (*received)[IGI_MAX_BANDS];  /* [regions] sum w E */
};

igi_status igi_places_create(igi_context *ctx, const igi_problem *problem, const igi_rows *rows,
                             const float *irradiance, igi_places *places)
{
    size_t n = rows->seen_count, bands = (size_t)problem->bands;
    *places = (igi_places){.irradiance = irradiance, .point = rows->point};
    igi_status status = IGI_OK;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n, &places->region));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n, &places->weight));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n * bands, &places->radiance));
    for (size_t i = 0; i < n; i++) {
        uint32_t side = rows->side[i];
        places->region[i] = igi_patch_region(problem->patches, side >> 1);
        if (igi_problem_seen_count(problem, side) == 0) continue;
        places->weight[i] = problem->patches->area[side >> 1];
        memcpy(places->radiance + i * bands, problem->seen + side * bands, bands * sizeof(float));
    }
    places->count = n;
cleanup:
    if (status != IGI_OK) igi_places_clear(places);
    return status;
}

void igi_places_clear(igi_places *places)
{
    igi_free(places->region);
    igi_free(places->weight);
    igi_free(places->radiance);
    *places = (igi_places){0};
}

igi_status igi_region_sums_create(igi_context *ctx, const igi_problem *problem,
                                  igi_region_sums **sums)
{
    igi_region_sums *s = NULL;
    igi_status status = IGI_OK;
    *sums = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &s));
    s->problem = problem;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, problem->scene->region_count, &s->reflected));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, problem->scene->region_count, &s->received));
    *sums = s;
    s = NULL;
cleanup:
    igi_region_sums_destroy(s);
    return status;
}

void igi_region_sums_destroy(igi_region_sums *sums)
{
    if (!sums) return;
    igi_free(sums->reflected);
    igi_free(sums->received);
    igi_free(sums);
}

static void add_up(igi_region_sums *s, const igi_places *places)
{
    size_t bands = (size_t)s->problem->bands;
    for (size_t r = 0; r < s->problem->scene->region_count; r++)
        for (size_t b = 0; b < bands; b++) s->reflected[r][b] = s->received[r][b] = 0;
    for (size_t i = 0; i < places->count; i++) {
        double w = (double)places->weight[i];
        if (w <= 0) continue;
        uint32_t r = places->region[i];
        for (size_t b = 0; b < bands; b++) {
            s->reflected[r][b] += w * IGI_PI * (double)places->radiance[i * bands + b];
            s->received[r][b] += w * (double)places->irradiance[i * bands + b];
        }
    }
}

static bool is_determined(const igi_region_sums *s, size_t region)
{
    if (s->problem->scene->regions[region].emitter) return false;
    for (int b = 0; b < s->problem->bands; b++)
        if (s->received[region][b] > 0) return true;
    return false;
}

/* The mean over determined regions: the guess for what nothing shows. */
static double common_albedo(const igi_region_sums *s, int band)
{
    double sum = 0, n = 0;
    for (size_t r = 0; r < s->problem->scene->region_count; r++)
        if (is_determined(s, r) && s->received[r][band] > 0) {
            sum += s->reflected[r][band] / s->received[r][band];
            n++;
        }
    return n > 0 ? fmin(sum / n, 1) : 0.5;
}

double igi_region_sums_albedo(igi_region_sums *sums, const igi_places *places,
                              double (*albedo)[IGI_MAX_BANDS])
{
    double change = 0;
    add_up(sums, places);
    for (int b = 0; b < sums->problem->bands; b++) {
        double common = common_albedo(sums, b);
        for (size_t r = 0; r < sums->problem->scene->region_count; r++) {
            if (sums->problem->scene->regions[r].emitter) continue;
            double received = sums->received[r][b];
            double updated = received > 0 ? sums->reflected[r][b] / received : common;
            updated = fmax(0, updated);
            change = fmax(change, fabs(updated - albedo[r][b]));
            albedo[r][b] = updated;
        }
    }
    return change;
}

/* Residuals of each cell: [cells][bands]. */
static void add_residuals(const igi_region_sums *s, const igi_places *places,
                          const igi_cells *cells, double (*albedo)[IGI_MAX_BANDS], double *residual)
{
    size_t bands = (size_t)s->problem->bands;
    for (size_t i = 0; i < places->count; i++) {
        uint32_t cell = cells->of_place[i];
        if (cell == IGI_NO_CELL) continue;
        for (size_t b = 0; b < bands; b++)
            residual[cell * bands + b] += (double)places->weight[i] *
                                          (IGI_PI * (double)places->radiance[i * bands + b] -
                                           albedo[cells->region[cell]][b] *
                                               (double)places->irradiance[i * bands + b]);
    }
}

igi_status igi_region_sums_std(igi_context *ctx, igi_region_sums *sums, const igi_places *places,
                               igi_diffuse *diffuse)
{
    igi_cells cells = {0};
    double *residual = NULL;
    size_t regions = sums->problem->scene->region_count, bands = (size_t)sums->problem->bands;
    igi_status status = IGI_OK;
    add_up(sums, places);
    IGI_TRY_GOTO(igi_cells_create(ctx, sums->problem, places, &cells));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, cells.count * bands, &residual));
    add_residuals(sums, places, &cells, diffuse->albedo, residual);
    for (size_t r = 0; r < regions; r++)
        for (size_t b = 0; b < bands; b++) diffuse->albedo_std[r][b] = 0;
    for (size_t i = 0; i < cells.count; i++)
        for (size_t b = 0; b < bands; b++)
            diffuse->albedo_std[cells.region[i]][b] += residual[i * bands + b] *
                                                       residual[i * bands + b];
    for (size_t r = 0; r < regions; r++) {
        diffuse->determined[r] = is_determined(sums, r);
        double n = (double)cells.of_region[r];
        for (size_t b = 0; b < bands; b++) {
            double received = sums->received[r][b], *std = &diffuse->albedo_std[r][b];
            *std = received > 0 && n > 1 ? sqrt(n / (n - 1) * *std) / received : UNKNOWN_STD;
            if (sums->problem->scene->regions[r].emitter) *std = 0;
        }
    }
cleanup:
    igi_cells_clear(&cells);
    igi_free(residual);
    return status;
}

igi_status igi_albedo_of_rows(igi_context *ctx, const igi_problem *problem, const igi_rows *rows,
                              const float *irradiance, igi_diffuse *diffuse)
{
    igi_status status = IGI_OK;
    igi_region_sums *sums = NULL;
    igi_places places = {0};
    IGI_TRY_GOTO(igi_places_create(ctx, problem, rows, irradiance, &places));
    IGI_TRY_GOTO(igi_region_sums_create(ctx, problem, &sums));
    (void)igi_region_sums_albedo(sums, &places, diffuse->albedo);
    IGI_TRY_GOTO(igi_region_sums_std(ctx, sums, &places, diffuse));
cleanup:
    igi_places_clear(&places);
    igi_region_sums_destroy(sums);
    return status;
}
