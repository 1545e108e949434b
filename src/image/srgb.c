/* SPDX-License-Identifier: Apache-2.0 */
#include "image/srgb.h"

#include <math.h>

void igi_srgb_make(igi_srgb *table)
{
    for (int i = 0; i < IGI_SRGB_STEPS; i++) {
        double x = (double)i / (IGI_SRGB_STEPS - 1);
        double y = x <= 0.0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - 0.055;
        table->byte[i] = (uint8_t)(255 * y + .5);
    }
}

igi_status igi_srgb_png(igi_context *ctx, const igi_image *image, int bands, float exposure,
                        uint8_t **png, size_t *size)
{
    size_t values = 3 * (size_t)image->width * (size_t)image->height;
    uint8_t *pixels;
    igi_srgb table;
    igi_srgb_make(&table);
    IGI_TRY(IGI_ALLOC(ctx, values, &pixels));
    for (size_t i = 0; i < values; i++) {
        int band = (int)(i % 3) < bands ? (int)(i % 3) : bands - 1;
        float x = image->samples[i / 3 * (size_t)image->channels + (size_t)band];
        pixels[i] = igi_srgb_byte(&table, x * exposure);
    }
    igi_status status = igi_image_encode_png(ctx, pixels, image->width, image->height, 3, png,
                                             size);
    igi_free(pixels);
    return status;
}

void igi_rgbe(const float rgb[3], uint8_t rgbe[4])
{
    double largest = (double)fmaxf(rgb[0], fmaxf(rgb[1], rgb[2]));
    int exponent = 0;
    for (int k = 0; k < 4; k++) rgbe[k] = 0;
    if (!(largest > 1e-32)) return;
    double scale = frexp(largest, &exponent) * 256 / largest;
    for (int k = 0; k < 3; k++) rgbe[k] = (uint8_t)fmax(0, (double)rgb[k] * scale);
    rgbe[3] = (uint8_t)(exponent + 128);
}
