/* SPDX-License-Identifier: Apache-2.0
 *
 * Form factors: F_ij is the fraction of the light that leaves element i, diffusely, which arrives
 * at element j. Three ways to the same numbers:
 *   closed    exact, between convex polygons with nothing in between
 *   rays      cosine-distributed rays from points spread over the element; with occlusion
 *   hemicube  Cohen & Greenberg 1985: five depth-buffered pictures from points of the element
 * Rows sum to 1 in a closed room; A_i F_ij = A_j F_ji.
 */
#ifndef IGI_SRC_TRANSPORT_FORM_FACTOR_H
#define IGI_SRC_TRANSPORT_FORM_FACTOR_H

#include "transport/mesh_elements.h"

/* From a differential element at `point` facing `normal` (unit) to a planar polygon, of which the
 * counter-clockwise side counts; the part below the horizon does not. Lambert's formula. The
 * polygon must be convex where the horizon cuts it. */
double igi_form_factor_from_point(const double point[3], const double normal[3],
                                  const double (*polygon)[3], size_t count);

/* From one convex planar polygon to another, front to front, unoccluded: the double contour
 * integral. Polygons may share edges or vertices. At most IGI_MAX_POLYGON corners each. 0 where a
 * polygon has no area or they do not face each other. */
#define IGI_MAX_POLYGON 512
double igi_form_factor_between(const double (*from)[3], size_t from_count, const double (*to)[3],
                               size_t to_count);

typedef enum igi_factor_way {
    IGI_FACTOR_CLOSED,
    IGI_FACTOR_RAYS,
    IGI_FACTOR_HEMICUBE
} igi_factor_way;

typedef struct igi_factor_options {
    igi_factor_way way;
    int rays;       /* rays an element; default 1024 */
    int points;     /* hemicubes an element; default 4 */
    int resolution; /* pixels along the top face of a hemicube, even; default 64 */
    uint64_t seed;
} igi_factor_options;

void igi_factor_options_init(igi_factor_options *options, igi_factor_way way);

/* Fills factors[n][n], n = elements->count. The tracer is of the elements' mesh; only rays need it.
 * What leaves the scene, or meets the side of a surface that is no element, is in no column. */
IGI_MUST_USE igi_status igi_form_factors(igi_context *ctx, const igi_elements *elements,
                                         const igi_tracer *tracer,
                                         const igi_factor_options *options, double *factors);

/* One row; `row` is zeroed [n]. `key` is that of the random pattern. */
void igi_form_factor_row_by_rays(const igi_elements *elements, const igi_tracer *tracer, uint32_t e,
                                 int rays, uint64_t key, double *row);

#endif
