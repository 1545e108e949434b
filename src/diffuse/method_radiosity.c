/* SPDX-License-Identifier: Apache-2.0
 *
 * The classical way, as the first step of the 1999 paper: coarse elements, dense form factors.
 *
 *     B_i = rho_r(i) H_i,    H_i = direct_i + sum_j F_ij B_j        per band, B = pi L
 *
 * B of a seen element is the mean of what the photographs show of it; rho of a region is the ratio
 * of the sums of B and H over its seen elements. Lamps count in direct_i, where their shape is
 * integrated in closed form, and are black in B: through F, a small lamp would be met by a handful
 * of rays.
 *
 * What is wrong with it, and why it is not the default: one value an element. Light that changes
 * within an element (a shadow edge, a corner) is lost, and an element of which photographs show a
 * part is taken to be like that part.
 */
#include "diffuse/coarse.h"
#include "diffuse/methods.h"

igi_status igi_method_radiosity(igi_context *ctx, const igi_problem *problem, igi_diffuse *diffuse)
{
    igi_status status = IGI_OK;
    igi_coarse *coarse = NULL;
    igi_stage_begin(ctx, "form factors");
    IGI_TRY_GOTO(igi_coarse_create(ctx, problem, &coarse));
    igi_stage_begin(ctx, "solve");
    IGI_TRY_GOTO(igi_coarse_solve(ctx, coarse, NULL, NULL, diffuse));
    igi_coarse_hand_on(coarse, diffuse);
cleanup:
    igi_coarse_destroy(coarse);
    return status;
}
