/* SPDX-License-Identifier: Apache-2.0 */
#include "observe/glow.h"

#include <math.h>

#define BELL 2.0 /* cells */

void igi_glow_measure(const igi_image *image, int bands, float glow[IGI_GLOW_CELLS])
{
    enum { W = IGI_GLOW_COLUMNS, H = IGI_GLOW_ROWS };
    double sum[IGI_GLOW_CELLS] = {0}, count[IGI_GLOW_CELLS] = {0}, across[IGI_GLOW_CELLS] = {0};
    double bell[W];
    for (int i = 0; i < W; i++)
        bell[i] = exp(-.5 * i * i / (BELL * BELL)) / (BELL * sqrt(2 * 3.14159265358979));
    const float *p = image->samples;
    for (int y = 0; y < image->height; y++)
        for (int x = 0; x < image->width; x++, p += image->channels) {
            int cell = y * H / image->height * W + x * W / image->width;
            double all = 0;
            for (int b = 0; b < bands; b++) all += (double)p[b];
            if (!isfinite(all)) continue;
            sum[cell] += all;
            count[cell]++;
        }
    for (int i = 0; i < IGI_GLOW_CELLS; i++)
        for (int x = 0; x < W; x++) {
            int from = i / W * W + x, off = x > i % W ? x - i % W : i % W - x;
            if (count[from] > 0) across[i] += bell[off] * sum[from] / count[from];
        }
    for (int i = 0; i < IGI_GLOW_CELLS; i++) {
        double all = 0;
        for (int y = 0; y < H; y++)
            all += bell[y > i / W ? y - i / W : i / W - y] * across[y * W + i % W];
        glow[i] = (float)all;
    }
}

float igi_glow_at(const float glow[IGI_GLOW_CELLS], const int size[2], uint32_t pixel)
{
    float x = ((float)(pixel % (uint32_t)size[0]) + .5f) * IGI_GLOW_COLUMNS / (float)size[0] - .5f;
    float y = ((float)(pixel / (uint32_t)size[0]) + .5f) * IGI_GLOW_ROWS / (float)size[1] - .5f;
    x = fmaxf(0, fminf(IGI_GLOW_COLUMNS - 1.001f, x));
    y = fmaxf(0, fminf(IGI_GLOW_ROWS - 1.001f, y));
    int column = (int)x, row = (int)y;
    float u = x - (float)column, v = y - (float)row;
    const float *g = glow + row * IGI_GLOW_COLUMNS + column;
    return (1 - v) * ((1 - u) * g[0] + u * g[1]) +
           v * ((1 - u) * g[IGI_GLOW_COLUMNS] + u * g[IGI_GLOW_COLUMNS + 1]);
}
