/* SPDX-License-Identifier: Apache-2.0
 *
 * What a photograph shows of a pixel of the merged image.
 */
#ifndef IGI_SRC_HDR_SIGHT_H
#define IGI_SRC_HDR_SIGHT_H

#include "hdr/merge_private.h"

/* One pixel of a photograph: its exposures, and those that the longer photographs predict. */
typedef struct sight {
    float x[3], fade[3], predicted[3]; /* predicted: x where nothing is known yet */
    bool between;
    float low[3], high[3]; /* if so, of the pixels that x was read between */
    bool known[3];
} sight;

/* By the nearest pixel; false outside of the photograph. */
static inline bool igi_sight_look(const accumulator *acc, const igi_motion *motion,
                                  const igi_response *response, int x, int y, sight *s)
{
    const igi_photo *photo = motion->b;
    size_t at = igi_motion_pixel(motion, x, y);
    if (at == SIZE_MAX) return false;
    const uint16_t *codes = photo->codes + at * (size_t)acc->channels;
    const float *curve = response->exposure;
    for (int c = 0; c < acc->channels; c++, curve += response->levels) {
        s->x[c] = curve[codes[c]];
        s->fade[c] = acc->fade[codes[c]];
    }
    return true;
}

/* The same between pixels: Catmull and Rom's bicubic over exposures, held within the four around. One
 * saturated pixel among those spoils it. */
bool igi_sight_look_between(const accumulator *acc, const igi_motion *motion,
                            const igi_response *response, int x, int y, sight *s);

#endif
