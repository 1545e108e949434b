/* SPDX-License-Identifier: Apache-2.0
 *
 * Shared among the four texels about it, each pixel blurs the map by a texel. But the map must
 * predict the pixels: pi L = E sum_t b_t rho_t, b the same bilinear weights. What is left over goes
 * back to the texels in proportion (iterative back-projection, Irani & Peleg 1991),
 *     rho_t += sum w b_t (pi L - E rho(x)) / sum w b_t E
 * with as few rounds as sharpen texture and not yet noise.
 */
#include "maps/maps_private.h"

#include <string.h>

#define ROUNDS 2

static int wrap_index(int i, int size, bool wraps)
{
    if (wraps) return i < 0 ? i + size : i >= size ? i - size : i;
    return i < 0 ? 0 : i >= size ? size - 1 : i;
}

void igi_taps_at(const igi_texels *t, float x, float y, igi_taps *taps)
{
    x -= 0.5f;
    y -= 0.5f;
    int i = (int)floorf(x), j = (int)floorf(y);
    float fx = x - (float)i, fy = y - (float)j;
    for (int k = 0; k < 4; k++) {
        int column = wrap_index(i + k % 2, t->size, t->wraps);
        int line = wrap_index(j + k / 2, t->size, t->wraps);
        taps->weight[k] = (k % 2 ? fx : 1 - fx) * (k / 2 ? fy : 1 - fy);
        taps->texel[k] = (size_t)(line * t->size + column);
    }
}

/* Residuals of all pixels, sent back to the texels. */
static void project_back(const igi_texels *t, const float *albedo, float *change)
{
    size_t bands = (size_t)t->bands, stride = 3 + 2 * bands;
    memset(change, 0, (size_t)t->size * (size_t)t->size * bands * sizeof *change);
    for (size_t i = 0; i < t->pixel_count; i++) {
        const float *pixel = t->pixels + i * stride;
        igi_taps taps;
        igi_taps_at(t, pixel[0], pixel[1], &taps);
        for (size_t b = 0; b < bands; b++) {
            float here = 0;
            for (int k = 0; k < 4; k++) here += taps.weight[k] * albedo[taps.texel[k] * bands + b];
            float left = pixel[2] * (pixel[3 + b] - pixel[3 + bands + b] * here);
            for (int k = 0; k < 4; k++) change[taps.texel[k] * bands + b] += taps.weight[k] * left;
        }
    }
}

igi_status igi_texels_sharpen(igi_context *ctx, igi_texels *texels)
{
    igi_status status = IGI_OK;
    float *albedo = NULL, *change = NULL;
    size_t values = (size_t)texels->size * (size_t)texels->size * (size_t)texels->bands;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, values, &albedo));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, values, &change));
    for (size_t i = 0; i < values; i++)
        if (texels->received[i] > 0) albedo[i] = texels->reflected[i] / texels->received[i];
    for (int round = 0; round < ROUNDS && texels->pixel_count > 0; round++) {
        project_back(texels, albedo, change);
        for (size_t i = 0; i < values; i++)
            if (texels->received[i] > 0)
                albedo[i] = fmaxf(0.0f, albedo[i] + change[i] / texels->received[i]);
    }
    for (size_t i = 0; i < values; i++) texels->reflected[i] = albedo[i] * texels->received[i];
cleanup:
    igi_free(albedo);
    igi_free(change);
    return status;
}
