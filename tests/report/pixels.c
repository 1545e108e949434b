/* SPDX-License-Identifier: Apache-2.0
 *
 * pixels FILE.exr EXPOSURE BLOCK: the picture as a page shows it, the means of sRGB bytes over blocks
 * of so many pixels a side, red green blue, row after row, one number a line.
 */
#include <igi/igi.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

static double byte_of(double x)
{
    if (!(x > 0)) return 0;
    if (x >= 1) return 255;
    return floor(255 * (x <= .0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - .055) + .5);
}

static double block_mean(const igi_image *image, double exposure, int x0, int y0, int side, int c)
{
    double sum = 0;
    for (int y = y0; y < y0 + side; y++)
        for (int x = x0; x < x0 + side; x++)
            sum += byte_of(exposure *
                           (double)image->samples[((size_t)y * (size_t)image->width + (size_t)x) *
                                                      (size_t)image->channels +
                                                  (size_t)c]);
    return sum / side / side;
}

int main(int argc, char **argv)
{
    igi_context *ctx = NULL;
    igi_image *image = NULL;
    if (argc != 4 || igi_context_create(NULL, &ctx) != IGI_OK) return 2;
    if (igi_image_load_exr(ctx, argv[1], &image) != IGI_OK) {
        fprintf(stderr, "%s\n", igi_context_message(ctx));
        return 1;
    }
    int side = atoi(argv[3]);
    for (int y = 0; y + side <= image->height; y += side)
        for (int x = 0; x + side <= image->width; x += side)
            for (int c = 0; c < 3; c++)
                printf("%.3f\n", block_mean(image, atof(argv[2]), x, y, side, c));
    igi_image_destroy(image);
    igi_context_destroy(ctx);
    return 0;
}
