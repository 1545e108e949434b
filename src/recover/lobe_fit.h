/* SPDX-License-Identifier: Apache-2.0
 *
 * Specular coefficient and roughness of one region from its highlights.
 */
#ifndef IGI_SRC_RECOVER_LOBE_FIT_H
#define IGI_SRC_RECOVER_LOBE_FIT_H

#include "recover/lobe_table.h"

typedef struct igi_lobe_estimate {
    igi_model model;
    double specular, specular_std;
    double alpha, alpha_std;
    double misfit;        /* weighted sum of squared residuals over their number's share: chi^2 */
    double plain_misfit;  /* the same with no lobe */
    double residuals;     /* how many residuals there were, after what the groups' albedos took */
    double noise;         /* relative standard deviation of a residual */
} igi_lobe_estimate;

/* The best lobe of the given model: a search over all roughnesses, then a polish. */
IGI_MUST_USE igi_status igi_lobe_fit(igi_context *ctx, const igi_highlights *highlights,
                                     igi_model model, igi_lobe_estimate *estimate);

#endif
