/* SPDX-License-Identifier: Apache-2.0
 *
 * Pixels from which those of a highlight are chosen.
 */
#ifndef IGI_SRC_SPECULAR_CANDIDATES_H
#define IGI_SRC_SPECULAR_CANDIDATES_H

#include "specular/incident.h"

/* Pixels of each region to choose from, thinned evenly: observation[begin[region]...]. */
typedef struct igi_candidates {
    size_t *begin; /* [regions + 1] */
    uint32_t *observation;
    bool *curved; /* [regions] facets of many directions: a pixel may show several */
} igi_candidates;

IGI_MUST_USE igi_status igi_candidates_create(igi_context *ctx, const igi_problem *problem,
                                              igi_candidates *candidates);
void igi_candidates_clear(igi_candidates *candidates);

/* What a pixel shows. */
typedef struct igi_pixel_view {
    igi_vec point, normal, out; /* world; out: unit, toward the camera */
    const igi_camera *camera;
    uint32_t pixel;
} igi_pixel_view;

igi_pixel_view igi_pixel_view_of(const igi_problem *problem, size_t observation);
uint32_t igi_observation_region(const igi_problem *problem, size_t observation);

#endif
