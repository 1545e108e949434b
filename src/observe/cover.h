/* SPDX-License-Identifier: Apache-2.0
 *
 * Whether a pixel shows one thing alone. That no neighbouring pixel shows another is the cheap sign
 * (igi_visible); where it leaves a region with hardly a pixel, or thin things before it may pass
 * between the pixels' rays, rays all over the pixel tell.
 */
#ifndef IGI_SRC_OBSERVE_COVER_H
#define IGI_SRC_OBSERVE_COVER_H

#include "scene/camera.h"
#include "trace/trace.h"

typedef enum igi_cover {
    IGI_COVER_WIDE, /* one smooth piece of one region fills the pixel and what surrounds it closely */
    IGI_COVER_WHOLE, /* it fills the pixel */
    IGI_COVER_PART   /* something else shows as well */
} igi_cover;

/* pixel: row * width + column. Adds the rays it cost to *rays. */
igi_cover igi_cover_of(const igi_scene *scene, const igi_tracer *tracer, const igi_camera *camera,
                       uint32_t pixel, size_t *rays);

#endif
