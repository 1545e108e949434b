/* SPDX-License-Identifier: Apache-2.0
 *
 * What cannot be excluded where no lobe was found.
 */
#ifndef IGI_SRC_SPECULAR_LOBE_DOUBT_H
#define IGI_SRC_SPECULAR_LOBE_DOUBT_H

#include "specular/highlights.h"

/* rho_s + so many sigmas is the bound: 95 of 100 do not exceed it. Stated for lobes up to a roughness:
 * broader ones hide in the albedo. */
#define IGI_BOUND_SIGMAS 1.645
#define IGI_BOUND_ALPHA 0.3f

typedef struct igi_lobe_doubt {
    double bound;                /* of rho_s, for the roughness that is seen least; 1: any */
    double share[IGI_MAX_BANDS]; /* of the albedo that such a lobe may account for: one sigma */
} igi_lobe_doubt;

/* Ward's lobe of several roughnesses on highlights of a region that is taken as lambert. */
IGI_MUST_USE igi_status igi_lobe_doubt_create(igi_context *ctx, const igi_highlights *highlights,
                                              igi_lobe_doubt *doubt);

#endif
