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
    const igi_correction *correction;
} igi_lobe_view;

/* Adds the lobe's radiance at a point as a photograph shows it. */
void igi_lobe_view_radiance(const igi_lobe_view *view, const igi_problem *problem, size_t frame,
                            const igi_hit *hit, float *radiance);

/* The same in parts: from lamps by a few samples and the share of the lamps that the side sees, from
 * surfaces as it is on average over the side in that photograph, by one half of the rays. How bright
 * either is, the other half tells: a weight that knew the chance errors of what it weighs would favour
 * what came out low. */
typedef struct igi_lobe_parts {
    float radiance[IGI_MAX_BANDS];
    float lit, mirrored; /* brightness of the parts, mean over bands */
} igi_lobe_parts;

void igi_lobe_view_parts(const igi_lobe_view *view, const igi_problem *problem, size_t frame,
                         const igi_hit *hit, int half, igi_lobe_parts *parts);

#endif
