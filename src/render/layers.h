/* SPDX-License-Identifier: Apache-2.0
 *
 * One frame with all its layers, in as many passes as its noise asks for, and its files.
 */
#ifndef IGI_SRC_RENDER_LAYERS_H
#define IGI_SRC_RENDER_LAYERS_H

#include "render/render.h"

/* [0] picture, [1] variance, [2] direct, [3] albedo; the last two NULL unless asked for. */
enum { LAYER_PICTURE, LAYER_VARIANCE, LAYER_DIRECT, LAYER_ALBEDO, LAYERS };
typedef struct layered_frame {
    int bands;
    igi_image *layers[LAYERS];
    int samples;  /* paths a pixel so far */
    double noise; /* mean standard deviation of a pixel over the mean pixel; 0: not known */
} layered_frame;

/* Renders passes of options->samples paths until the noise is at most `target` (0: one pass). */
IGI_MUST_USE igi_status layered_frame_render(igi_context *ctx, const igi_renderer *renderer,
                                             const igi_camera *camera, uint64_t key,
                                             const igi_render_options *options, double target,
                                             bool apart, int bands, layered_frame *frame);
void layered_frame_clear(layered_frame *frame);

/* One picture with the layers as OpenEXR has them: "direct.R" .. "variance.B". */
IGI_MUST_USE igi_status layered_frame_join(igi_context *ctx, const layered_frame *frame,
                                           igi_image **joined);
/* What takes the 95th percentile of the picture's pixels to .8. */
IGI_MUST_USE igi_status layered_frame_exposure(igi_context *ctx, const layered_frame *frame,
                                               float *exposure);

#endif
