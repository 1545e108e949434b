/* SPDX-License-Identifier: Apache-2.0
 *
 * Which lobe, if any: by how much more likely it makes the photographs.
 */
#ifndef IGI_SRC_SPECULAR_LOBE_CHOICE_H
#define IGI_SRC_SPECULAR_LOBE_CHOICE_H

#include "specular/incident.h"
#include "specular/lobe_fit.h"

/* Is what a first look found worth a closer one? */
bool igi_lobe_is_hinted(const igi_lobe_estimate *estimate);

/* The best of the families found, and which others the photographs leave open. */
void igi_lobe_choose(const igi_lobe_estimate *found, size_t count, igi_lobe_estimate *best);

/* A family that fits as well in `first` leaves open what it says otherwise. */
void igi_lobe_allow_for_broader(igi_lobe_estimate *estimate, const igi_lobe_estimate *first);

/* The lobe, if it is asked for; else the region is lambert, in the estimate too. */
void igi_lobe_take(igi_lobe_estimate *estimate, int bands, igi_lobe *lobe);

#endif
