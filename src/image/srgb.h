/* SPDX-License-Identifier: Apache-2.0
 *
 * Linear pictures to 8 bits.
 */
#ifndef IGI_SRC_IMAGE_SRGB_H
#define IGI_SRC_IMAGE_SRGB_H

#include "base/context.h"

#include <igi/image.h>

enum { IGI_SRGB_STEPS = 4096 };

/* Linear [0,1] to sRGB bytes (IEC 61966-2-1). */
typedef struct igi_srgb {
    uint8_t byte[IGI_SRGB_STEPS];
} igi_srgb;

void igi_srgb_make(igi_srgb *table);

static inline uint8_t igi_srgb_byte(const igi_srgb *table, float linear)
{
    if (!(linear > 0)) return 0;
    if (linear >= 1) return 255;
    return table->byte[(int)(linear * (float)(IGI_SRGB_STEPS - 1) + .5f)];
}

/* The image's first three bands times `exposure` as PNG in sRGB; to be freed with
 * igi_image_free_bytes. */
IGI_MUST_USE igi_status igi_srgb_png(igi_context *ctx, const igi_image *image, int bands,
                                     float exposure, uint8_t **png, size_t *size);

/* Three mantissas and the exponent they share: x = (byte + .5) 2^(exponent - 136), half a per cent;
 * all 0: black (Ward, "Real pixels", 1991). */
void igi_rgbe(const float rgb[3], uint8_t rgbe[4]);

#endif
