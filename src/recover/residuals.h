/* SPDX-License-Identifier: Apache-2.0
 *
 * What a solution leaves unexplained: over each region, between photographs, and within them.
 */
#ifndef IGI_SRC_RECOVER_RESIDUALS_H
#define IGI_SRC_RECOVER_RESIDUALS_H

#include "diffuse/field.h"

#include <igi/material.h>

/* All relative: of 1. */
typedef struct igi_region_residual {
    double sides;      /* how many of its patches' sides tell */
    bool calm;         /* diffuse, and photographs of it differ no more than usual */
    double trend;      /* standard deviation of a plane fitted to the albedos of its sides */
    double differ;     /* standard deviation between the photographs of it, beyond their noise, */
    double by_chance;  /* what noise alone may feign of it, */
    double mean_error; /* and what it does to the mean over them */
} igi_region_residual;

typedef struct igi_residuals {
    size_t region_count;
    igi_region_residual *regions;
    double vignetting, vignetting_error; /* loss of light in the corners, and one deviation */
    double glare, glare_error;           /* share of all light that strays over the picture */
    double usual_differ; /* `differ` of the calmest quarter of the diffuse surface */
    double drift;        /* standard deviation of the photographs' gains */
} igi_residuals;

/* `materials` are those of the scene's regions, in order; diffuse[regions]: those that count for
 * vignetting, glare and drift. */
IGI_MUST_USE igi_status igi_residuals_create(igi_context *ctx, const igi_problem *problem,
                                             const igi_field *field, const igi_materials *materials,
                                             const bool *diffuse, igi_residuals **residuals);
/* A side's own albedo, mean over bands; negative: it has none. */
double igi_residual_albedo(const igi_problem *problem, const igi_field *field,
                           const igi_materials *materials, uint32_t side);
/* The two halves of igi_residuals_create: over each region, and between and within photographs. */
IGI_MUST_USE igi_status igi_residuals_find_trends(igi_context *ctx, const igi_problem *problem,
                                                  const igi_field *field,
                                                  const igi_materials *materials,
                                                  igi_residuals *residuals);
IGI_MUST_USE igi_status igi_residuals_compare_views(igi_context *ctx, const igi_problem *problem,
                                                    const bool *diffuse, igi_residuals *residuals);
void igi_residuals_destroy(igi_residuals *residuals);

#endif
