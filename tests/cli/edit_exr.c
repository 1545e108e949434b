/* SPDX-License-Identifier: Apache-2.0
 *
 * edit_exr FILE fill VALUE COUNT: the first COUNT pixels of the middle row and below become VALUE
 * edit_exr FILE crop: one column less
 * edit_exr FILE bands N: another number of channels
 */
#include <igi/igi.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static igi_status remake(igi_context *ctx, igi_image **image, int width, int channels)
{
    igi_image *old = *image;
    igi_status status = igi_image_create(ctx, width, old->height, channels, image);
    if (status != IGI_OK) return status;
    for (int y = 0; y < old->height; y++)
        for (int x = 0; x < width; x++)
            for (int c = 0; c < channels; c++)
                (*image)->samples[(y * width + x) * channels + c] =
                    old->samples[(y * old->width + x) * old->channels + c % old->channels];
    igi_image_destroy(old);
    return IGI_OK;
}

int main(int argc, char **argv)
{
    igi_context *ctx = NULL;
    igi_image *image = NULL;
    if (argc < 3 || igi_context_create(NULL, &ctx) != IGI_OK) return 2;
    igi_status status = igi_image_load_exr(ctx, argv[1], &image);
    if (status == IGI_OK && strcmp(argv[2], "fill") == 0 && argc == 5) {
        int start = image->width * (image->height / 2) * image->channels;
        for (int i = 0; i < atoi(argv[4]) * image->channels; i++)
            image->samples[start + i] = (float)strtod(argv[3], NULL);
    } else if (status == IGI_OK && strcmp(argv[2], "crop") == 0) {
        status = remake(ctx, &image, image->width - 1, image->channels);
    } else if (status == IGI_OK && strcmp(argv[2], "bands") == 0 && argc == 4) {
        status = remake(ctx, &image, image->width, atoi(argv[3]));
    }
    if (status == IGI_OK) status = igi_image_save_exr(ctx, image, IGI_EXR_FLOAT, argv[1]);
    if (status != IGI_OK) fprintf(stderr, "%s\n", igi_context_message(ctx));
    igi_image_destroy(image);
    igi_context_destroy(ctx);
    return (int)status;
}
