/* SPDX-License-Identifier: Apache-2.0
 *
 * Many pictures of one lit scene: what igi_render and igi synth share.
 */
#ifndef IGI_SRC_RENDER_RENDER_H
#define IGI_SRC_RENDER_RENDER_H

#include "base/context.h"

#include <igi/render.h>

typedef struct igi_renderer igi_renderer;

/* Scene, materials and lights must outlive it. Materials are found by the regions' names. */
IGI_MUST_USE igi_status igi_renderer_create(igi_context *ctx, const igi_scene *scene,
                                            const igi_materials *materials, const igi_light *lights,
                                            size_t light_count, igi_renderer **renderer);
void igi_renderer_destroy(igi_renderer *renderer);
/* The same scene under lights of other values, as many and of the same kinds, with finishes of its
 * own. The base must outlive it. */
IGI_MUST_USE igi_status igi_renderer_vary(igi_context *ctx, const igi_renderer *base,
                                          const igi_light *lights, igi_renderer **renderer);

/* Solves the radiosity of the scene; from then on paths end with it where they meet the second
 * surface, and pictures are quick: their light is exact up to one bounce. */
IGI_MUST_USE igi_status igi_renderer_add_cache(igi_context *ctx, igi_renderer *renderer);

/* Solves a rough radiosity, from which paths know about what they will find: they end early and
 * lose nothing by it, whatever its error. Does nothing when `paths`, about as many as will be traced,
 * are too few to pay for it. */
IGI_MUST_USE igi_status igi_renderer_expect(igi_context *ctx, igi_renderer *renderer, double paths);

/* From now on pictures are made that way; *max_depth is cut to what it needs. */
IGI_MUST_USE igi_status igi_renderer_set_method(igi_context *ctx, igi_renderer *renderer,
                                                igi_render_method method, int *max_depth);

/* Images [count] of the cameras' size and the scene's bands; all but the pictures may be NULL. */
typedef struct igi_layers {
    igi_image **pictures;
    igi_image **variances; /* of each pixel's mean */
    igi_image **direct;    /* of the pictures: light that has met one surface at most */
    igi_image **albedos;   /* rho_d of what is seen; lamps and the sky: 0 */
} igi_layers;

/* Fills the layers. Streams are keyed by the context's seed, `key`, frame, pixel and sample. */
IGI_MUST_USE igi_status igi_renderer_frames(igi_context *ctx, const igi_renderer *renderer,
                                            const igi_camera *cameras, size_t count,
                                            const igi_render_options *options, uint64_t key,
                                            const igi_layers *layers);

/* Reads sensors from the file `path` and writes what they measure into the file `table`: irradiance
 * and illuminance of the side that each faces. Each takes IGI_SENSOR_PATHS times options->samples
 * paths, doubled until its relative standard deviation is `target` (0: not doubled). *noise receives
 * the largest relative standard deviation. */
#define IGI_SENSOR_PATHS 64
IGI_MUST_USE igi_status igi_sensors_measure(igi_context *ctx, const igi_renderer *renderer,
                                            const char *path, const igi_render_options *options,
                                            double target, const char *table, double *noise);

#endif
