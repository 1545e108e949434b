/* SPDX-License-Identifier: Apache-2.0
 *
 * Which surface each pixel of a camera shows, and which pixels show an edge.
 */
#ifndef IGI_SRC_OBSERVE_VISIBLE_H
#define IGI_SRC_OBSERVE_VISIBLE_H

#include "trace/trace.h"

/* hits[height][width]: what the ray through each pixel's centre meets, and whether the pixel lies
 * within two pixels of an edge: where the region, the side, the depth or the normal jumps. Such
 * pixels mix two radiances, or would with a camera half a pixel off; those of grade 3 mix two
 * materials. */
typedef struct igi_visible {
    int width, height;
    igi_hit *hits;
    uint8_t *
        near_edge; /* 0: clean; 1: within 2 pixels of an edge, or on the picture's border; 2: beside one; 3: beside one
                           where the region changes or ends */
} igi_visible;

IGI_MUST_USE igi_status igi_visible_create(igi_context *ctx, const igi_scene *scene,
                                           const igi_tracer *tracer, const igi_camera *camera,
                                           igi_visible *visible);
/* Does an edge lie between what two neighbouring rays of a camera meet? pixel_rad: the angle between
 * them. */
bool igi_visible_is_edge(const igi_scene *scene, const igi_tracer *tracer, const igi_hit *a,
                         const igi_hit *b, float pixel_rad);
void igi_visible_clear(igi_visible *visible);

#endif
