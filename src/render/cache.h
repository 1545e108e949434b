/* SPDX-License-Identifier: Apache-2.0
 *
 * Irradiance of every side of every patch under the renderer's lights: the radiosity solution.
 */
#ifndef IGI_SRC_RENDER_CACHE_H
#define IGI_SRC_RENDER_CACHE_H

#include "render/path.h"

/* Rays of each side: 64 or so. `shoot`: by shooting rather than gathering. Surfaces reflect diffusely, what their lobes reflect included. */
IGI_MUST_USE igi_status igi_cache_create(igi_context *ctx, const igi_renderer *renderer, int rays,
                                         bool shoot, igi_cache **cache);
void igi_cache_destroy(igi_cache *cache);

/* Adds what the surface at the hit sends back, times throughput[bands]. */
void igi_cache_add(const igi_cache *cache, const surface *s, const igi_hit *hit,
                   const float *throughput, float *radiance);

#endif
