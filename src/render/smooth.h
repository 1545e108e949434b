/* SPDX-License-Identifier: Apache-2.0
 *
 * Indirect light made smooth across a picture.
 */
#ifndef IGI_SRC_RENDER_SMOOTH_H
#define IGI_SRC_RENDER_SMOOTH_H

#include "render/render.h"

/* Smooths picture - direct where surfaces are diffuse or their lobes broad; albedos as in
 * igi_layers. */
IGI_MUST_USE igi_status igi_smooth_indirect(igi_context *ctx, const igi_renderer *renderer,
                                            const igi_camera *camera, igi_image *picture,
                                            const igi_image *direct, const igi_image *albedo);

#endif
