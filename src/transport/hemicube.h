/* SPDX-License-Identifier: Apache-2.0
 *
 * The hemicube (Cohen & Greenberg 1985): what a point sees, drawn on the upper half of a cube about
 * it, each pixel weighing as much as the form factor from the point to it.
 */
#ifndef IGI_SRC_TRANSPORT_HEMICUBE_H
#define IGI_SRC_TRANSPORT_HEMICUBE_H

#include "transport/mesh_elements.h"

/* Weights of the pixels; shared by all threads. */
typedef struct igi_hemicube igi_hemicube;
/* The pictures; one for each thread. */
typedef struct igi_hemicube_buffer igi_hemicube_buffer;

/* resolution: pixels along the top face, even, 2..4096; the sides are half as high. */
IGI_MUST_USE igi_status igi_hemicube_create(igi_context *ctx, int resolution,
                                            igi_hemicube **hemicube);
void igi_hemicube_destroy(igi_hemicube *hemicube);
IGI_MUST_USE igi_status igi_hemicube_buffer_create(igi_context *ctx, const igi_hemicube *hemicube,
                                                   igi_hemicube_buffer **buffer);
void igi_hemicube_buffer_destroy(igi_hemicube_buffer *buffer);

/* Adds `weight` times the form factor from the point to each element to row[]. `turn`: by what
 * angle about the normal the cube is turned, radians. */
void igi_hemicube_add(const igi_elements *elements, const igi_hemicube *hemicube,
                      igi_hemicube_buffer *buffer, const double point[3], const double normal[3],
                      double turn, double weight, double *row);

/* A row from `points` points spread over element e, each cube turned at random; `key` is that of
 * the random pattern. `row` is zeroed [n]. */
void igi_form_factor_row_by_hemicube(const igi_elements *elements, const igi_hemicube *hemicube,
                                     igi_hemicube_buffer *buffer, uint32_t e, int points,
                                     uint64_t key, double *row);

#endif
