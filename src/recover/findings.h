/* SPDX-License-Identifier: Apache-2.0
 *
 * What the solutions say of each region, in words that a user reads: igi_materials.
 */
#ifndef IGI_SRC_RECOVER_FINDINGS_H
#define IGI_SRC_RECOVER_FINDINGS_H

#include "specular/specular.h"

#include <igi/material.h>

/* Materials without maps, and the lights with what was solved; with the warnings of observing and of the
 * diffuse solution. `specular` may be NULL: nobody looked for lobes. */
IGI_MUST_USE igi_status igi_materials_of(igi_context *ctx, const igi_problem *problem,
                                         const igi_diffuse *diffuse, const igi_specular *specular,
                                         igi_materials **materials);

/* Of a textured region, `albedo` is a mean over its map: its standard deviation holds the pattern only as
 * far as the region is not observed. */
void igi_pattern_settle(const igi_diffuse *diffuse, igi_materials *materials);

/* A metal's diffuse part must be asked for: where its standard deviation allows for none, there is none,
 * and a warning says so. Albedo and standard deviation are the final ones. */
IGI_MUST_USE igi_status igi_metal_settle(igi_context *ctx, int bands, igi_material *material);

#endif
