/* SPDX-License-Identifier: Apache-2.0
 *
 * Numbers to colours, and pictures to bytes for a page.
 */
#ifndef IGI_SRC_REPORT_COLOUR_H
#define IGI_SRC_REPORT_COLOUR_H

#include "image/srgb.h"

#include <igi/image.h>

enum { IGI_RAMP_STOPS = 9 };

/* Which band stands for red, green (1) or blue (2). */
static inline int igi_band_of(int colour, int bands)
{
    return colour < bands ? colour : bands > 1 ? bands - 1 : 0;
}

/* Colour ramps with the same stops as the page's legends: `spread` from -1 to 1 (blue, white,
 * red), `heat` from 0 to 1 (viridis). */
extern const uint8_t igi_ramp_spread[IGI_RAMP_STOPS][3];
extern const uint8_t igi_ramp_heat[IGI_RAMP_STOPS][3];
/* t in [0,1] along the ramp. */
void igi_ramp_colour(const uint8_t ramp[IGI_RAMP_STOPS][3], float t, uint8_t rgb[3]);

#endif
