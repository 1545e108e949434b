/* SPDX-License-Identifier: Apache-2.0
 *
 * Photographs beside what the recovered materials predict for them.
 */
#ifndef IGI_SRC_MAPS_COMPARE_H
#define IGI_SRC_MAPS_COMPARE_H

#include "maps/maps.h"

/* A few of the photographs, spread over the set, into recovery->comparisons. The prediction is
 * albedo / pi times the field's irradiance: what the solution itself says, not a new rendering;
 * the albedo alone is the room without its light. */
IGI_MUST_USE igi_status igi_compare(igi_context *ctx, const igi_problem *problem,
                                    const igi_field *field, const igi_layout *layout,
                                    igi_recovery *recovery);

#endif
