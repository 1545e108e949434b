/* SPDX-License-Identifier: Apache-2.0
 *
 * Where lights stand, refined by the light that they throw: shading and shadows.
 */
#ifndef IGI_SRC_DIFFUSE_POSITIONS_H
#define IGI_SRC_DIFFUSE_POSITIONS_H

#include "diffuse/problem.h"

typedef struct igi_positions igi_positions;

/* Moves the problem's lights whose manifest states a "position_std" to where the photographs put
 * them, with new position_std, and prepares its lighting again. *positions: NULL when there is
 * none. */
IGI_MUST_USE igi_status igi_positions_refine(igi_context *ctx, igi_problem *problem,
                                             igi_positions **positions);
void igi_positions_destroy(igi_positions *positions);

/* What the places leave open, powers that were solved and albedos inherit: their standard
 * deviations must be there already. Does nothing with NULL. */
void igi_positions_widen(const igi_positions *positions, const igi_problem *problem,
                         igi_diffuse *diffuse);

/* Adds sentences about what the photographs do not determine. Does nothing with NULL. */
IGI_MUST_USE igi_status igi_positions_explain(igi_context *ctx, const igi_positions *positions,
                                              char ***warnings, size_t *warning_count);

#endif
