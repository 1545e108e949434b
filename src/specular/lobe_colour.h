/* SPDX-License-Identifier: Apache-2.0
 *
 * Coloured lobes, as metals have them: a specular coefficient of each band.
 */
#ifndef IGI_SRC_SPECULAR_LOBE_COLOUR_H
#define IGI_SRC_SPECULAR_LOBE_COLOUR_H

#include "specular/lobe_fit.h"
#include "specular/lobe_profile.h"

/* The coefficients of each band at a column's roughness, over those that the column has already, and
 * what they gain: with the profile's weights, about the sums of its last evaluation, which must be the
 * column's. */
void igi_lobe_colour_look(const igi_profile *profile, const igi_profile_column *column,
                          igi_lobe_colour *colour);

/* By how much a colour must gain, of so many bands. */
double igi_lobe_colour_margin(const igi_lobe_estimate *estimate, int bands);

#endif
