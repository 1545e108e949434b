/* SPDX-License-Identifier: Apache-2.0
 *
 * What a result says of the error that was asked for.
 */
#ifndef IGI_SRC_RECOVER_TARGET_H
#define IGI_SRC_RECOVER_TARGET_H

#include "base/context.h"

#include <igi/material.h>

/* Adds a warning where the materials' standard deviations are above the target: those of albedo, or of
 * rho_s and alpha where lobes were found; relative, means over regions. */
IGI_MUST_USE igi_status igi_target_judge(igi_context *ctx, double target, igi_materials *materials);

#endif
