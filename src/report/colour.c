/* SPDX-License-Identifier: Apache-2.0 */
#include "report/colour.h"

#include <math.h>

const uint8_t igi_ramp_spread[IGI_RAMP_STOPS][3] = {
    {33, 102, 172},  {67, 147, 195},  {146, 197, 222}, {209, 229, 240}, {247, 247, 247},
    {253, 219, 199}, {244, 165, 130}, {214, 96, 77},   {178, 24, 43}};

const uint8_t igi_ramp_heat[IGI_RAMP_STOPS][3] = {{68, 1, 84},    {71, 44, 122},  {59, 81, 139},
                                                  {44, 113, 142}, {33, 144, 141}, {39, 173, 129},
                                                  {92, 200, 99},  {170, 220, 50}, {253, 231, 37}};

void igi_ramp_colour(const uint8_t ramp[IGI_RAMP_STOPS][3], float t, uint8_t rgb[3])
{
    float at = fminf(fmaxf(t, 0), 1) * (IGI_RAMP_STOPS - 1);
    int i = (int)at < IGI_RAMP_STOPS - 1 ? (int)at : IGI_RAMP_STOPS - 2;
    for (int k = 0; k < 3; k++) {
        float low = (float)ramp[i][k], high = (float)ramp[i + 1][k];
        rgb[k] = (uint8_t)(low + (at - (float)i) * (high - low) + .5f);
    }
}
