/* SPDX-License-Identifier: Apache-2.0
 *
 * The diffuse part of one side of a patch, from all photographs that show it.
 */
#ifndef IGI_SRC_SPECULAR_SIDE_VIEWS_H
#define IGI_SRC_SPECULAR_SIDE_VIEWS_H

#include "specular/incident.h"

#define IGI_SIDE_VIEWS 64 /* photographs of one side that are told apart */

/* What is known of the side's region, mean radiance over its seen sides. */
typedef struct igi_side_level {
    double seen, diffuse;
} igi_side_level;

/* Rays of the lobe: of the side, about, and of each view at least; an even number. */
typedef struct igi_side_effort {
    int samples, of_view;
} igi_side_effort;

/* d, the diffuse radiance; `views` of the correction get the lobe's part from surfaces. *trust: the
 * side's weight in its region's albedo. Returns the rays it cost. */
uint64_t igi_side_views_part(const igi_radiance_field *field, uint32_t side, igi_side_effort effort,
                             const float *before, igi_side_level level, igi_rng *rng,
                             igi_correction *correction);

#endif
