/* SPDX-License-Identifier: Apache-2.0
 *
 * Push and pull (Gortler et al. 1996): means of what is known go up a pyramid, and come down again
 * to where nothing is known.
 */
#include "maps/maps_private.h"

/* The mean of the known among the 2 x 2 below. */
static void push(const float *image, const float *weight, int size, int channels, float *coarse,
                 float *coarse_weight)
{
    int half = size / 2;
    for (int y = 0; y < half; y++)
        for (int x = 0; x < half; x++) {
            float *to = coarse + (size_t)(y * half + x) * (size_t)channels, sum = 0;
            for (int c = 0; c < channels; c++) to[c] = 0;
            for (int k = 0; k < 4; k++) {
                size_t from = (size_t)((2 * y + k / 2) * size + 2 * x + k % 2);
                if (!(weight[from] > 0)) continue;
                sum += 1;
                for (int c = 0; c < channels; c++)
                    to[c] += image[from * (size_t)channels + (size_t)c];
            }
            coarse_weight[y * half + x] = sum;
            for (int c = 0; c < channels && sum > 0; c++) to[c] /= sum;
        }
}

static int clamp_index(int i, int size)
{
    return i < 0 ? 0 : i >= size ? size - 1 : i;
}

/* Bilinear: 9/16, 3/16, 3/16 and 1/16 of the four coarse pixels about the fine one. */
static void pull(float *image, const float *weight, int size, int channels, const float *coarse)
{
    int half = size / 2;
    for (int y = 0; y < size; y++)
        for (int x = 0; x < size; x++) {
            size_t to = (size_t)(y * size + x);
            if (weight[to] > 0) continue;
            for (int c = 0; c < channels; c++) {
                float sum = 0;
                for (int k = 0; k < 4; k++) {
                    int i = clamp_index(x / 2 + (k % 2) * (x % 2 ? 1 : -1), half);
                    int j = clamp_index(y / 2 + (k / 2) * (y % 2 ? 1 : -1), half);
                    float w = (k % 2 ? 0.25f : 0.75f) * (k / 2 ? 0.25f : 0.75f);
                    sum += w * coarse[(size_t)(j * half + i) * (size_t)channels + (size_t)c];
                }
                image[to * (size_t)channels + (size_t)c] = sum;
            }
        }
}

igi_status igi_fill_holes(igi_context *ctx, float *image, const float *weight, int size,
                          int channels, const float *fallback)
{
    igi_status status = IGI_OK;
    float *coarse = NULL, *coarse_weight = NULL;
    if (size < 2 || size % 2) {
        for (int i = 0; i < size * size; i++)
            for (int c = 0; c < channels && !(weight[i] > 0); c++)
                image[(size_t)i * (size_t)channels + (size_t)c] = fallback[c];
        return IGI_OK;
    }
    size_t quarter = (size_t)(size / 2) * (size_t)(size / 2);
    IGI_TRY_GOTO(IGI_ALLOC(ctx, quarter * (size_t)channels, &coarse));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, quarter, &coarse_weight));
    push(image, weight, size, channels, coarse, coarse_weight);
    IGI_TRY_GOTO(igi_fill_holes(ctx, coarse, coarse_weight, size / 2, channels, fallback));
    pull(image, weight, size, channels, coarse);
cleanup:
    igi_free(coarse);
    igi_free(coarse_weight);
    return status;
}
