/* SPDX-License-Identifier: Apache-2.0
 *
 * With residuals d_i = pi L_i - rho E_i, summed over cells c of neighbouring places,
 *     var(rho) = 1 / (1 - sum_c h_c^2) sum_c (sum_{i in c} w_i d_i)^2 / (sum_i w_i E_i)^2,
 * h_c the share of a cell in the light that the region receives: the sandwich of a ratio estimator
 * that allows errors to be alike within a cell. Of a few cells it says next to nothing: their
 * residuals add up to zero, and two may both be near it. Then the places by themselves are believed,
 * whose variance is that of many, times how far neighbours' errors are alike in the other regions
 * (the design effect of surveys; Kish 1965).
 */
#include "diffuse/region_sums.h"

#include "base/order.h"
#include "diffuse/cells.h"

#include <string.h>

/* What is said of a region that nothing determines: anything in 0..1 may be true. */
#define UNKNOWN_STD 0.3
/* So many pixels of a place are as noisy as it is unlike its neighbours. */
#define ENOUGH_PIXELS 8
/* What the other regions say of neighbours, in cells of a region's own. */
#define OTHERS_CELLS 8.0
/* What all of a region shares (a bright patch that all its rays meet) no cell tells: errors over what the
 * cells say, of diffuse regions, by likelihood (rooms 1 to 40 of scripts/random_rooms). */
#define SHARED 1.5

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

void igi_places_weigh_by_pixels(const igi_problem *problem, const igi_rows *rows,
                                igi_places *places)
{
    for (size_t i = 0; i < places->count; i++) {
        float pixels = (float)igi_problem_seen_count(problem, rows->side[i]);
        places->weight[i] *= pixels / (pixels + ENOUGH_PIXELS);
    }
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

/* How residuals scatter over a region, in a band: sums of their squares, and of the squares of what
 * was received. */
typedef struct scatter {
    double of_cells, of_places, cells_received, places_received;
} scatter;

/* Residuals of each cell and what it received: sums[cells][bands][2]. */
static void add_residuals(const igi_region_sums *s, const igi_places *places,
                          const igi_cells *cells, double (*albedo)[IGI_MAX_BANDS],
                          double (*sums)[2], scatter *scatters)
{
    size_t bands = (size_t)s->problem->bands;
    for (size_t i = 0; i < places->count; i++) {
        uint32_t cell = cells->of_place[i];
        if (cell == IGI_NO_CELL) continue;
        for (size_t b = 0; b < bands; b++) {
            uint32_t r = cells->region[cell];
            double received = (double)places->weight[i] * (double)places->irradiance[i * bands + b];
            double d = (double)places->weight[i] * IGI_PI *
                           (double)places->radiance[i * bands + b] -
                       albedo[r][b] * received;
            scatter *region = &scatters[r * bands + b];
            region->of_places += d * d;
            region->places_received += received * received;
            sums[cell * bands + b][0] += d;
            sums[cell * bands + b][1] += received;
        }
    }
    for (size_t k = 0; k < cells->count * bands; k++) {
        scatter *region = &scatters[cells->region[k / bands] * bands + k % bands];
        region->of_cells += sums[k][0] * sums[k][0];
        region->cells_received += sums[k][1] * sums[k][1];
    }
}

/* 1 - sum h^2, times as many as there seem to be: what is free of n alike is n - 1. */
static double freedom(double squares, double received)
{
    return received > 0 ? fmax(0, 1 - squares / (received * received)) : 0;
}

static double alone(const scatter *s, double received)
{
    double free = freedom(s->places_received, received);
    return free > 0 ? s->of_places / free : 0;
}

/* By how much neighbours' likeness raises the variance. Returns the cells that say so, less one. */
static double likeness(const scatter *s, double received, double *times)
{
    double free = freedom(s->cells_received, received), single = alone(s, received);
    if (!(free > 0) || !(single > 0)) return 0;
    *times = s->of_cells / free / single;
    return free * received * received / s->cells_received;
}

/* The median over the regions' cells: a texture, or a lobe that was missed, is alike in neighbours
 * as no other region's errors are. `pairs` is scratch. */
static double usual_likeness(const igi_region_sums *s, const scatter *scatters, double (*pairs)[2])
{
    size_t bands = (size_t)s->problem->bands, n = 0;
    for (size_t k = 0; k < s->problem->scene->region_count * bands; k++) {
        pairs[n][1] = likeness(&scatters[k], s->received[k / bands][k % bands], &pairs[n][0]);
        n += pairs[n][1] > 0;
    }
    return n > 0 ? igi_weighted_median(pairs, n) : 1;
}

static double std_of(const scatter *s, double received, double usual)
{
    double times = 0, cells = likeness(s, received, &times), single = alone(s, received);
    if (!(received > 0) || !(single > 0)) return UNKNOWN_STD;
    times = (cells * times + OTHERS_CELLS * usual) / (cells + OTHERS_CELLS);
    return sqrt(single * times) / received;
}

/* Relative variance of a place by itself. */
static double place_variance(const scatter *s, double received, double albedo)
{
    double square = albedo * albedo * s->places_received;
    return square > 0 ? alone(s, received) / square : 0;
}

/* The median over the places: patterns are on fewer than half of them. `pairs` is scratch. */
static double usual_variance(const igi_region_sums *s, const scatter *scatters,
                             double (*albedo)[IGI_MAX_BANDS], double (*pairs)[2])
{
    size_t bands = (size_t)s->problem->bands, n = 0;
    for (size_t k = 0; k < s->problem->scene->region_count * bands; k++) {
        double received = s->received[k / bands][k % bands];
        pairs[n][0] = place_variance(&scatters[k], received, albedo[k / bands][k % bands]);
        if (!(pairs[n][0] > 0)) continue;
        pairs[n++][1] = received * received / scatters[k].places_received;
    }
    return n > 0 ? igi_weighted_median(pairs, n) : HUGE_VAL;
}

/* What scatters beyond the usual, of a standard deviation. */
static double pattern_of(const scatter *s, double received, double albedo, double usual,
                         double times, double std)
{
    if (!(received > 0) || place_variance(s, received, albedo) <= usual) return 0;
    double even = albedo / received * sqrt(usual * s->places_received * times);
    return sqrt(fmax(0, std * std - even * even));
}

igi_status igi_region_sums_std(igi_context *ctx, igi_region_sums *sums, const igi_places *places,
                               igi_diffuse *diffuse)
{
    igi_cells cells = {0};
    scatter *scatters = NULL;
    double(*of_cells)[2] = NULL, (*pairs)[2] = NULL;
    size_t regions = sums->problem->scene->region_count, bands = (size_t)sums->problem->bands;
    igi_status status = IGI_OK;
    add_up(sums, places);
    IGI_TRY_GOTO(igi_cells_create(ctx, sums->problem, places, &cells));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, cells.count * bands, &of_cells));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions * bands, &scatters));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions * bands + 1, &pairs));
    add_residuals(sums, places, &cells, diffuse->albedo, of_cells, scatters);
    double usual = usual_likeness(sums, scatters, pairs);
    double variance = usual_variance(sums, scatters, diffuse->albedo, pairs);
    for (size_t r = 0; r < regions; r++) {
        bool lamp = sums->problem->scene->regions[r].emitter;
        diffuse->determined[r] = is_determined(sums, r);
        for (size_t b = 0; b < bands; b++) {
            const scatter *one = &scatters[r * bands + b];
            double received = sums->received[r][b], *std = &diffuse->albedo_std[r][b];
            *std = lamp ? 0 : std_of(one, received, usual);
            if (!diffuse->pattern_std || lamp) continue;
            diffuse->pattern_std[r][b] = pattern_of(one, received, diffuse->albedo[r][b], variance,
                                                    usual, *std);
        }
    }
cleanup:
    igi_cells_clear(&cells);
    igi_free(scatters);
    igi_free(of_cells);
    igi_free(pairs);
    return status;
}

void igi_region_sums_share(const igi_problem *problem, igi_diffuse *diffuse)
{
    for (size_t r = 0; r < problem->scene->region_count; r++)
        for (int b = 0; b < problem->bands && diffuse->determined[r]; b++) {
            double *std = &diffuse->albedo_std[r][b];
            double pattern = diffuse->pattern_std ? diffuse->pattern_std[r][b] : 0;
            double even = sqrt(fmax(0, *std * *std - pattern * pattern));
            *std = fmin(fmax(*std, UNKNOWN_STD), hypot(SHARED * even, pattern));
        }
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
    igi_region_sums_share(problem, diffuse);
cleanup:
    igi_places_clear(&places);
    igi_region_sums_destroy(sums);
    return status;
}
