/* SPDX-License-Identifier: Apache-2.0
 *
 * What "random" in a spec says: within which ranges a room is drawn, and from which materials.
 */
#ifndef IGI_SRC_SYNTH_RANDOM_RANGES_H
#define IGI_SRC_SYNTH_RANDOM_RANGES_H

#include "synth/synth.h"

#define RANDOM_MOST 8 /* lamps, and pieces of furniture */

typedef struct random_ranges {
    double low[3], high[3]; /* of the room's size, metres */
    double furniture[2], lamps[2], lamp_size[2], radiance[2];
    double glossy, textured; /* shares of the surfaces */
    double albedo[2], specular[2], alpha[2];
    double (*table)[7]; /* [rows] rho_d and rho_s for R, G, B, then alpha; NULL: the ranges above */
    size_t rows;
} random_ranges;

/* Fills what is not said with what rooms are like. The table is the caller's to free, also after a
 * failure. */
IGI_MUST_USE igi_status random_ranges_read(igi_context *ctx, const igi_json *at,
                                           random_ranges *ranges);

#endif
