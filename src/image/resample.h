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

#endif
