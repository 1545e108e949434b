/* SPDX-License-Identifier: Apache-2.0
 *
 * Which roughness: the search of the lobe fit, over all that are looked for.
 */
#ifndef IGI_SRC_SPECULAR_LOBE_SEARCH_H
#define IGI_SRC_SPECULAR_LOBE_SEARCH_H

#include "specular/lobe_fit.h"
#include "specular/lobe_profile.h"

/* A table over all roughnesses that are looked for. */
IGI_MUST_USE igi_status igi_lobe_tabulate_coarsely(igi_context *ctx, const igi_profile *profile,
                                                   igi_model model, igi_lobe_table *table);

/* The best roughness of the table and the weights that it asks for, which the profile receives.
 * Of *estimate: residuals is read; specular, alpha, noise and deviance are written. */
size_t igi_lobe_settle(igi_profile *profile, const igi_lobe_table *table,
                       igi_lobe_estimate *estimate);

/* Settles in a fine table about estimate->alpha, which the caller clears; where residuals are few, in
 * finer ones until neighbours' ratio is below `finest`. */
IGI_MUST_USE igi_status igi_lobe_locate(igi_context *ctx, igi_profile *profile, igi_model model,
                                        double finest, igi_lobe_table *table,
                                        igi_lobe_estimate *estimate);

/* estimate->alpha, and the profile's weights from which it is found: those that it begins with, or
 * where residuals are few all alike. */
IGI_MUST_USE igi_status igi_lobe_search(igi_context *ctx, igi_profile *profile, igi_model model,
                                        igi_lobe_estimate *estimate);

#endif
