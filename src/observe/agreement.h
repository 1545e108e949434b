/* SPDX-License-Identifier: Apache-2.0
 *
 * Do the photographs agree with each other? Of a place that several of them show, each has its say
 * about its radiance: from that the gain of each photograph against the others, and the share of
 * places at which it contradicts them.
 */
#ifndef IGI_SRC_OBSERVE_AGREEMENT_H
#define IGI_SRC_OBSERVE_AGREEMENT_H

#include "observe/glimpses.h"

typedef struct igi_frame_agreement {
    size_t places;      /* that two other photographs show too */
    double gain;        /* against the others, median over places; 1 without places */
    double gain_error;  /* one standard deviation */
    double contradicts; /* share of those places at which it is alone with what it shows, where that
                           is less without the region that may just mirror a lamp; */
    double contradictions; /* how many these are */
    double darker;         /* share of all places at which it shows less light than the others, */
    double dark;           /* or less than a third, and not in one region alone */
    double uneven; /* standard error of what it shows of a place, by its pixels: the median */
} igi_frame_agreement;

typedef struct igi_agreement {
    size_t frame_count;
    igi_frame_agreement *frames;
    double gain_spread; /* robust standard deviation of ln gain over the photographs */
    double typical_share, typical_darker, typical_dark; /* medians of these three */
    double typical_uneven;
} igi_agreement;

IGI_MUST_USE igi_status igi_agreement_create(igi_context *ctx, const igi_scene *scene,
                                             const igi_glimpses *glimpses,
                                             igi_agreement **agreement);
void igi_agreement_destroy(igi_agreement *agreement);

#endif
