/* SPDX-License-Identifier: Apache-2.0
 *
 * What the recovered lobes add to a pixel, quickly: to be taken out of photographs before albedo is
 * mapped, and to be put into predictions.
 */
#ifndef IGI_SRC_SPECULAR_LOBE_VIEW_H
#define IGI_SRC_SPECULAR_LOBE_VIEW_H

#include "specular/incident.h"

typedef struct igi_lobe_view {
    const igi_rows *rows;
    const igi_lobe *lobes; /* [regions] */
    const float *seen;     /* [2 patches][bands] the lobe's part of what was seen of a side, */
    const float *surfaces; /* [2 patches][bands] and of that the part that came from no lamp */
} igi_lobe_view;

/* Adds the lobe's radiance at a point toward `eye`: lamps by a few samples and the share of them
 * that the side sees, surfaces as they were seen of that side on average. */
void igi_lobe_view_radiance(const igi_lobe_view *view, const igi_problem *problem, uint32_t surface,
                            float u, float v, igi_vec eye, float *radiance);

#endif
