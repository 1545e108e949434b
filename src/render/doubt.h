/* SPDX-License-Identifier: Apache-2.0
 *
 * How uncertain a picture is, because what it is rendered from is.
 */
#ifndef IGI_SRC_RENDER_DOUBT_H
#define IGI_SRC_RENDER_DOUBT_H

#include "render/render.h"

typedef struct igi_doubt igi_doubt;

/* `base` renders the materials, whose lights have standard deviations light_std (NULL: none). Both
 * must outlive it. */
IGI_MUST_USE igi_status igi_doubt_create(igi_context *ctx, const igi_renderer *base,
                                         const igi_materials *materials,
                                         double (*light_std)[IGI_MAX_BANDS], igi_doubt **doubt);
void igi_doubt_destroy(igi_doubt *doubt);

typedef struct igi_picture_doubt {
    double pixel;   /* mean standard deviation of a pixel over the mean pixel */
    double picture; /* standard deviation of the mean pixel over it */
} igi_picture_doubt;

/* One standard deviation of each pixel of a picture, in its units: *sigma is the caller's. */
IGI_MUST_USE igi_status igi_doubt_picture(igi_context *ctx, const igi_doubt *doubt,
                                          const igi_camera *camera, uint64_t key,
                                          const igi_image *picture, igi_image **sigma,
                                          igi_picture_doubt *summary);

#endif
