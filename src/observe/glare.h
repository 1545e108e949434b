/* SPDX-License-Identifier: Apache-2.0
 *
 * Light that shines into a lens lays a veil over the photograph: it shows where the scene is dark.
 */
#ifndef IGI_SRC_OBSERVE_GLARE_H
#define IGI_SRC_OBSERVE_GLARE_H

#include "observe/observations.h"

/* A veil that all photographs share cannot be told from light of the scene; this is what one has
 * more than the others. */
typedef struct igi_glare {
    double share; /* of the photograph's mean brightness, added everywhere */
    double sigma; /* of it; INFINITY: too few dark places of too few regions */
} igi_glare;

/* glares[frame_count]. */
IGI_MUST_USE igi_status igi_glare_estimate(igi_context *ctx, const igi_scene *scene,
                                           const igi_observations *observations, igi_glare *glares);
/* Adds a warning for each photograph with a clear veil. */
IGI_MUST_USE igi_status igi_observations_warn_of_glare(igi_context *ctx, const igi_scene *scene,
                                                       igi_observations *observations);

#endif
