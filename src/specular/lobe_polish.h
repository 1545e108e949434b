/* SPDX-License-Identifier: Apache-2.0
 *
 * The bottom of a basin of the lobe fit, and how sure it is.
 */
#ifndef IGI_SRC_SPECULAR_LOBE_POLISH_H
#define IGI_SRC_SPECULAR_LOBE_POLISH_H

#include "specular/lobe_fit.h"
#include "specular/lobe_profile.h"

#define IGI_POLISH_ALPHAS 5 /* of the table */

/* Least misfit over specular and alpha, within the table and with the profile's weights; from *e on,
 * which receives them and their standard deviations. */
IGI_MUST_USE igi_status igi_lobe_polish(igi_context *ctx, const igi_profile *profile,
                                        const igi_lobe_table *table, igi_lobe_estimate *estimate);

#endif
