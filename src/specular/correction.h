/* SPDX-License-Identifier: Apache-2.0
 *
 * What the present lobes do to the diffuse half.
 */
#ifndef IGI_SRC_SPECULAR_CORRECTION_H
#define IGI_SRC_SPECULAR_CORRECTION_H

#include "specular/incident.h"

IGI_MUST_USE igi_status igi_correction_create(igi_context *ctx, const igi_problem *problem,
                                              const igi_rows *rows, igi_correction *correction);
void igi_correction_clear(igi_correction *correction);

/* Finds the part of the lobes of `field` in what was seen of each side, and in what each row
 * receives. Rounds have random streams of their own. */
IGI_MUST_USE igi_status igi_correction_find(igi_context *ctx, const igi_radiance_field *field,
                                            const igi_diffuse *diffuse, uint64_t round,
                                            igi_correction *correction);

#endif
