/* SPDX-License-Identifier: Apache-2.0 */
#include "hdr/sight.h"

#include "image/resample.h"

bool igi_sight_look_between(const accumulator *acc, const igi_motion *motion,
                            const igi_response *response, int x, int y, sight *s)
{
    const igi_photo *photo = motion->b;
    double place[2], wx[4], wy[4];
    igi_motion_place(motion, x, y, place);
    if (!(place[0] >= 0 && place[1] >= 0 && place[0] <= photo->width - 1 &&
          place[1] <= photo->height - 1))
        return false;
    int x0 = (int)place[0], y0 = (int)place[1];
    igi_cubic_weights(place[0] - x0, wx);
    igi_cubic_weights(place[1] - y0, wy);
    double sum[3] = {0};
    for (int c = 0; c < acc->channels; c++) s->fade[c] = 1, s->low[c] = HUGE_VALF, s->high[c] = 0;
    for (int k = 0; k < 16; k++) {
        int u = igi_clamp_index(x0 + k % 4 - 1, photo->width);
        int v = igi_clamp_index(y0 + k / 4 - 1, photo->height);
        bool inner = k % 4 % 3 && k / 4 % 3;
        const uint16_t *codes = photo->codes + ((size_t)v * (size_t)photo->width + (size_t)u) *
                                                   (size_t)acc->channels;
        const float *curve = response->exposure;
        for (int c = 0; c < acc->channels; c++, curve += response->levels) {
            float value = curve[codes[c]], fade = acc->fade[codes[c]];
            sum[c] += wx[k % 4] * wy[k / 4] * (double)value;
            if (inner && fade < s->fade[c]) s->fade[c] = fade;
            if (!inner) continue;
            s->low[c] = fminf(s->low[c], value);
            s->high[c] = fmaxf(s->high[c], value);
        }
    }
    for (int c = 0; c < acc->channels; c++)
        s->x[c] = fminf(s->high[c], fmaxf(s->low[c], (float)sum[c]));
    return true;
}
