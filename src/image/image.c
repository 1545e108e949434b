/* SPDX-License-Identifier: Apache-2.0
 *
 * The image itself: memory and the names of its channels.
 */
#include "base/context.h"
#include "image/image_private.h"

#include <stdio.h>
#include <string.h>

igi_status igi_image_create(igi_context *ctx, int width, int height, int channels,
                            igi_image **image)
{
    igi_status status = IGI_OK;
    igi_image *made = NULL;
    *image = NULL;
    if (width < 1 || height < 1 || channels < 1 || channels > IGI_MAX_BANDS + 1)
        return igi_fail(ctx, IGI_E_USAGE,
                        "image: %d x %d pixels with %d channels; sizes start at 1, and channels "
                        "end at %d",
                        width, height, channels, IGI_MAX_BANDS + 1);
    size_t pixels = (size_t)width * (size_t)height;
    if (pixels > IGI_IMAGE_MAX_SAMPLES / (size_t)channels)
        return igi_fail(ctx, IGI_E_SYSTEM,
                        "image: %d x %d pixels with %d channels are more than igi keeps in memory "
                        "(%zu samples); use a smaller image",
                        width, height, channels, IGI_IMAGE_MAX_SAMPLES);
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &made));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, pixels * (size_t)channels, &made->samples));
    made->width = width;
    made->height = height;
    made->channels = channels;
    for (int c = 0; c < channels; c++) {
        if (channels == 1) snprintf(made->names[c], IGI_CHANNEL_NAME_SIZE, "Y");
        else if (channels == 3 || channels == 4)
            snprintf(made->names[c], IGI_CHANNEL_NAME_SIZE, "%c", "RGBA"[c]);
        else snprintf(made->names[c], IGI_CHANNEL_NAME_SIZE, "band%02d", c);
    }
    *image = made;
    made = NULL;
cleanup:
    igi_image_destroy(made);
    return status;
}

void igi_image_destroy(igi_image *image)
{
    if (!image) return;
    igi_free(image->samples);
    igi_free(image);
}

void igi_image_free_bytes(uint8_t *bytes)
{
    igi_free(bytes);
}
