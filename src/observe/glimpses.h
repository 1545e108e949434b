/* SPDX-License-Identifier: Apache-2.0
 *
 * What each photograph shows of each place: space is cut into cubes; a place is what lies of one
 * region's side, facing one way, in one cube.
 */
#ifndef IGI_SRC_OBSERVE_GLIMPSES_H
#define IGI_SRC_OBSERVE_GLIMPSES_H

#include "observe/observations.h"

typedef struct igi_glimpse {
    uint32_t place, frame;
    float value; /* ln of the mean brightness, */
    float error; /* and its standard error by the scatter of the pixels */
    float glow;  /* around it in that picture; 0: not measured */
} igi_glimpse;

typedef struct igi_glimpses {
    size_t place_count;
    uint32_t *region; /* [places] */
    size_t *begin;    /* [places + 1] its glimpses, of rising frames */
    size_t count;
    igi_glimpse *glimpses;
    size_t stride;      /* every so many observations were looked at */
    uint32_t *place_of; /* [(observations + stride - 1) / stride] */
} igi_glimpses;

/* Lamps are left out. */
IGI_MUST_USE igi_status igi_glimpses_create(igi_context *ctx, const igi_scene *scene,
                                            const igi_observations *observations,
                                            igi_glimpses *glimpses);
void igi_glimpses_clear(igi_glimpses *glimpses);

#endif
