/* SPDX-License-Identifier: Apache-2.0
 *
 * What a solution says against the assumptions it rests on: as warnings.
 */
#ifndef IGI_SRC_RECOVER_DOUBTS_H
#define IGI_SRC_RECOVER_DOUBTS_H

#include "diffuse/field.h"

#include <igi/recover.h>

/* Widens the standard deviations of albedo by what photographs of one place disagree about, and adds
 * to the materials' warnings: lamps that the photographs show otherwise than stated; surfaces
 * that reflect more than they receive; light that the solution does not explain; surfaces whose
 * look changes with the viewpoint although they were found to be diffuse; what too few photographs
 * show. */
IGI_MUST_USE igi_status igi_doubts_add(igi_context *ctx, const igi_problem *problem,
                                       const igi_field *field, igi_materials *materials);

#endif
