/* SPDX-License-Identifier: Apache-2.0
 *
 * The irradiance that reaches the surfaces, as a field: gathered once at every patch, smoothed, and
 * then a few nanoseconds a point.
 */
#ifndef IGI_SRC_DIFFUSE_FIELD_H
#define IGI_SRC_DIFFUSE_FIELD_H

#include "diffuse/problem.h"

typedef struct igi_field igi_field;

/* From the rows that the method gathered with; where it left none, they are gathered now. Problem
 * and diffuse must outlive the field. */
IGI_MUST_USE igi_status igi_field_create(igi_context *ctx, const igi_problem *problem,
                                         const igi_diffuse *diffuse, igi_field **field);
void igi_field_destroy(igi_field *field);

/* Looks closer at the patches of the region that a shadow's edge crosses: shadow rays from a grid of
 * points in each. Without it the edge is as sharp as the patches. */
IGI_MUST_USE igi_status igi_field_refine(igi_context *ctx, igi_field *field, uint32_t region);

/* Irradiance per band at a point of a surface (triangle << 1 | back). */
void igi_field_irradiance(const igi_field *field, uint32_t surface, float u, float v,
                          float *irradiance);

/* Mean irradiance per band over the places of a side of a patch (2 patch + back) that photographs
 * show. false: it was not gathered there. */
bool igi_field_of_side(const igi_field *field, uint32_t side, float *irradiance);

/* One standard deviation of the irradiance there, relative, from the sampling; 0 where unknown. */
float igi_field_std(const igi_field *field, uint32_t side);
/* Does a shadow's edge cross the side, or run beside it? */
bool igi_field_has_edge(const igi_field *field, uint32_t side);
/* Mean place of what was gathered from for the side; the side must have been gathered. */
igi_vec igi_field_point(const igi_field *field, uint32_t side);

#endif
