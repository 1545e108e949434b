/* SPDX-License-Identifier: Apache-2.0
 *
 * Irradiance of every side of every patch under the renderer's lights: the radiosity solution.
 */
#ifndef IGI_SRC_RENDER_CACHE_H
#define IGI_SRC_RENDER_CACHE_H

#include "render/path.h"

typedef struct igi_cache_options {
    int rays;          /* of each side */
    int light_points;  /* of each side */
    float patch_share; /* patches' size over the scene's diagonal */
    bool shoot;        /* by shooting rather than gathering */
    size_t most_sides; /* with more, none is made; 0: however many */
} igi_cache_options;

/* Surfaces reflect diffusely, what their lobes reflect included. */
IGI_MUST_USE igi_status igi_cache_create(igi_context *ctx, const igi_renderer *renderer,
                                         const igi_cache_options *options, igi_cache **cache);
void igi_cache_destroy(igi_cache *cache);

/* Adds what the surface at the hit sends back, times throughput[bands]. */
void igi_cache_add(const igi_cache *cache, const surface *s, const igi_hit *hit,
                   const float *throughput, float *radiance);

#endif
