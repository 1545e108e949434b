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

/* Adds the lobe's radiance at a point as a photograph shows it: to `lamps` by a few samples and the
 * share of the lamps that the side sees, to `surfaces` as it is on average over the side in that
 * photograph. They may be the same. */
void igi_lobe_view_radiance(const igi_lobe_view *view, const igi_problem *problem, size_t frame,
                            const igi_hit *hit, float *lamps, float *surfaces);

#endif
