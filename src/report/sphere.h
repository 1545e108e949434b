/* SPDX-License-Identifier: Apache-2.0
 *
 * A ball of a material under light that is always the same: a soft box above on the left, and a
 * room that is bright above and dark below.
 */
#ifndef IGI_SRC_REPORT_SPHERE_H
#define IGI_SRC_REPORT_SPHERE_H

#include "base/context.h"

#include <igi/material.h>

/* side x side pixels, `bands` channels and the ball's coverage, 0..1, as the last. A white diffuse
 * ball has radiance 1 where it is brightest. */
IGI_MUST_USE igi_status igi_sphere_draw(igi_context *ctx, const igi_material *material, int bands,
                                        int side, igi_image **picture);

#endif
