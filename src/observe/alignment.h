/* SPDX-License-Identifier: Apache-2.0
 *
 * All photographs together: are cameras off, and do they share what is off?
 */
#ifndef IGI_SRC_OBSERVE_ALIGNMENT_H
#define IGI_SRC_OBSERVE_ALIGNMENT_H

#include "observe/edges.h"

typedef struct igi_alignment {
    size_t known;         /* photographs whose shift edges tell */
    double typical_px;    /* shift of a photograph beyond what measuring it explains, */
    double typical_ratio; /* and the shifts' mean square over what measuring explains */
    double shift[2];      /* that all share, as of a wrong principal point, */
    double magnified;     /* and as of a wrong focal length, pixels at the corner */
    bool all_off, shift_is_shared, magnified_is_shared;
} igi_alignment;

IGI_MUST_USE igi_status igi_alignment_judge(igi_context *ctx, const igi_registration *registrations,
                                            size_t count, igi_alignment *alignment);
/* This photograph by itself. */
bool igi_registration_is_off(const igi_registration *registration);

#endif
