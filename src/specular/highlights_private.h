/* SPDX-License-Identifier: Apache-2.0
 *
 * The steps of igi_highlights_create.
 */
#ifndef IGI_SRC_SPECULAR_HIGHLIGHTS_PRIVATE_H
#define IGI_SRC_SPECULAR_HIGHLIGHTS_PRIVATE_H

#include "specular/highlights.h"

/* Fills group and observation. */
IGI_MUST_USE igi_status igi_highlights_choose(igi_context *ctx, const igi_problem *problem,
                                              const igi_highlight_scores *scores,
                                              const igi_highlight_options *options,
                                              igi_highlights *out);

/* What the directions of a region's pixels are made for. */
typedef struct igi_highlight_task {
    const igi_problem *problem;
    const igi_highlight_source *source;
    const igi_highlight_options *options;
    size_t region;
} igi_highlight_task;

/* The directions of one pixel, all of nothing before, and what arrives along them. Returns the rays
 * it cost. */
uint64_t igi_highlight_directions(const igi_highlight_task *task, const igi_pixel_view *view,
                                  igi_rng *rng, igi_direction_sample *directions, float *incident);

/* Fills the rest of what each pixel has. fewer: as for igi_highlights_create. */
IGI_MUST_USE igi_status igi_highlights_light(igi_context *ctx, const igi_highlight_source *source,
                                             size_t region, const igi_highlight_options *options,
                                             const igi_highlights *fewer, igi_highlights *out);

#endif
