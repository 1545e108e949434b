/* SPDX-License-Identifier: Apache-2.0
 *
 * Maps that repeat without a seam: checks, stripes, and fractal noise between two colours.
 */
#include "synth/synth.h"

#include "base/rng.h"

#include <math.h>

static double lattice(uint64_t seed, int x, int y, int period)
{
    uint64_t cell = (uint64_t)((y % period) * period + x % period);
    return (double)igi_u32_to_float((uint32_t)igi_hash64(seed ^ igi_hash64(cell)));
}

/* Value noise of this many cells along a side, 0..1. */
static double noise(uint64_t seed, double u, double v, int cells)
{
    double x = u * cells, y = v * cells, fx = x - floor(x), fy = y - floor(y);
    int i = (int)x, j = (int)y;
    fx = fx * fx * (3 - 2 * fx);
    fy = fy * fy * (3 - 2 * fy);
    double low = lattice(seed, i, j, cells) * (1 - fx) + lattice(seed, i + 1, j, cells) * fx;
    double high = lattice(seed, i, j + 1, cells) * (1 - fx) +
                  lattice(seed, i + 1, j + 1, cells) * fx;
    return low * (1 - fy) + high * fy;
}

/* How much of the second colour there is at (u,v). */
static double mixture(const texture *t, double u, double v)
{
    int x = (int)(u * t->cells), y = (int)(v * t->cells);
    if (t->kind == TEXTURE_CHECKER) return (x + y) % 2;
    if (t->kind == TEXTURE_STRIPES) return x % 2;
    double sum = 0, weight = 0.5;
    for (int octave = 0; octave < 4; octave++, weight /= 2)
        sum += weight * noise(t->seed + (uint64_t)octave, u, v, t->cells << octave);
    return sum / (2 * (0.5 - weight));
}

igi_status texture_make(igi_context *ctx, const texture *t, int bands, igi_image **image)
{
    IGI_TRY(igi_image_create(ctx, t->size, t->size, bands, image));
    float *texel = (*image)->samples;
    for (int y = 0; y < t->size; y++)
        for (int x = 0; x < t->size; x++, texel += bands) {
            double m = mixture(t, (x + .5) / t->size, 1 - (y + .5) / t->size);
            for (int b = 0; b < bands; b++)
                texel[b] = (float)(t->colours[0][b] * (1 - m) + t->colours[1][b] * m);
        }
    return IGI_OK;
}
