/* SPDX-License-Identifier: Apache-2.0
 *
 * Sums over the seen sides of each region: its albedo as a ratio, and how far to believe it.
 */
#ifndef IGI_SRC_DIFFUSE_REGION_SUMS_H
#define IGI_SRC_DIFFUSE_REGION_SUMS_H

#include "diffuse/problem.h"

/* Seen sides with their region, weight (area, m^2), radiance[count][bands] that leaves them and
 * irradiance[count][bands] that reaches them; point[count][3] is where they lie, metres. */
typedef struct igi_places {
    size_t count;
    uint32_t *region;
    float *weight;
    float *radiance;
    const float *irradiance; /* the caller's */
    const float *point;      /* the rows' */
} igi_places;

/* The places of the seen rows. */
IGI_MUST_USE igi_status igi_places_create(igi_context *ctx, const igi_problem *problem,
                                          const igi_rows *rows, const float *irradiance,
                                          igi_places *places);
/* Places of few pixels count less. What is fitted to differences between places (powers and places of
 * lights) is as sure as they are; an area's mean, which a texture's albedo is, needs their areas. */
void igi_places_weigh_by_pixels(const igi_problem *problem, const igi_rows *rows,
                                igi_places *places);
void igi_places_clear(igi_places *places);

typedef struct igi_region_sums igi_region_sums;

IGI_MUST_USE igi_status igi_region_sums_create(igi_context *ctx, const igi_problem *problem,
                                               igi_region_sums **sums);
void igi_region_sums_destroy(igi_region_sums *sums);

/* rho = pi sum w L / sum w E of each region and band; a region without places gets the mean of the
 * others. Returns the largest change from what albedo[regions] held. */
double igi_region_sums_albedo(igi_region_sums *sums, const igi_places *places,
                              double (*albedo)[IGI_MAX_BANDS]);

/* Standard deviations of diffuse->albedo from the residuals, and which regions are determined. */
IGI_MUST_USE igi_status igi_region_sums_std(igi_context *ctx, igi_region_sums *sums,
                                            const igi_places *places, igi_diffuse *diffuse);

/* Adds to them what places of one region may share, beside its pattern. */
void igi_region_sums_share(const igi_problem *problem, igi_diffuse *diffuse);

/* All of it for methods that know the irradiance[rows][bands] of every seen row. */
IGI_MUST_USE igi_status igi_albedo_of_rows(igi_context *ctx, const igi_problem *problem,
                                           const igi_rows *rows, const float *irradiance,
                                           igi_diffuse *diffuse);

#endif
