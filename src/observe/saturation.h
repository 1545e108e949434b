/* SPDX-License-Identifier: Apache-2.0
 *
 * Saturated pixels that nothing marks.
 */
#ifndef IGI_SRC_OBSERVE_SATURATION_H
#define IGI_SRC_OBSERVE_SATURATION_H

#include "observe/observations.h"

/* When several pixels of surfaces share the very largest value, photographs are clipped there: those
 * pixels are left out, with a warning that also names lamps as bright as that. */
IGI_MUST_USE igi_status igi_observations_unclip(igi_context *ctx, const igi_scene *scene,
                                                igi_observations *observations);
/* Takes the warning back (number `warning`) where the photographs that it is about were left out since;
 * true: it did. */
bool igi_observations_retract_clipped(igi_observations *observations, size_t warning);

#endif
