/* SPDX-License-Identifier: Apache-2.0
 *
 * The ways to diffuse albedo, behind one interface; see igi_method.
 */
#ifndef IGI_SRC_DIFFUSE_METHODS_H
#define IGI_SRC_DIFFUSE_METHODS_H

#include "diffuse/problem.h"

/* Fills `diffuse`, which igi_diffuse_create made. IGI_E_NO_ANSWER when nothing is determined. */
typedef igi_status (*igi_method_fn)(igi_context *ctx, const igi_problem *problem,
                                    igi_diffuse *diffuse);

IGI_MUST_USE igi_status igi_method_patches(igi_context *ctx, const igi_problem *problem,
                                           igi_diffuse *diffuse);
IGI_MUST_USE igi_status igi_method_gather(igi_context *ctx, const igi_problem *problem,
                                          igi_diffuse *diffuse);
IGI_MUST_USE igi_status igi_method_radiosity(igi_context *ctx, const igi_problem *problem,
                                             igi_diffuse *diffuse);
IGI_MUST_USE igi_status igi_method_direct(igi_context *ctx, const igi_problem *problem,
                                          igi_diffuse *diffuse);

/* The second half of the patches method: solves for albedos and unseen sides with diffuse->rows,
 * which the first half made. correction may be NULL. */
IGI_MUST_USE igi_status igi_patches_solve(igi_context *ctx, const igi_problem *problem,
                                          const igi_correction *correction, igi_diffuse *diffuse);

/* The rays at which the patches method stops doubling for a target when they do not lower the stated
 * error. */
int igi_patches_rays(double target_error);

/* Mean over the determined regions of the albedo's relative standard deviation, as it stands. */
double igi_stated_error(const igi_problem *problem, const igi_diffuse *diffuse);

#endif
