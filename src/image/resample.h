/* SPDX-License-Identifier: Apache-2.0
 *
 * Images of another size.
 */
#ifndef IGI_SRC_IMAGE_RESAMPLE_H
#define IGI_SRC_IMAGE_RESAMPLE_H

#include "base/context.h"

#include <igi/image.h>

/* An axis that shrinks is averaged over the area of a pixel, one that grows is interpolated
 * linearly between pixel centres. */
IGI_MUST_USE igi_status igi_image_resample(igi_context *ctx, const igi_image *image, int width,
                                           int height, igi_image **result);

/* The image at most `side` pixels wide and high: *small is a copy. */
IGI_MUST_USE igi_status igi_image_reduce(igi_context *ctx, const igi_image *image, int side,
                                         igi_image **small);

/* Of the finite samples, channel by channel: mean[bands], which are zero before; returns their mean. */
double igi_image_mean(const igi_image *image, int bands, double *mean);

/* Catmull-Rom weights of the four samples around t in [0,1), which lies between the middle two. */
static inline void igi_cubic_weights(double t, double w[4])
{
    w[0] = t * (-.5 + t * (1 - .5 * t));
    w[1] = 1 + t * t * (-2.5 + 1.5 * t);
    w[2] = t * (.5 + t * (2 - 1.5 * t));
    w[3] = t * t * (-.5 + .5 * t);
}

static inline int igi_clamp_index(int x, int size)
{
    return x < 0 ? 0 : x < size ? x : size - 1;
}

#endif
