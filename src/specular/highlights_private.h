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

/* Fills the rest of what each pixel has. fewer: as for igi_highlights_create. */
IGI_MUST_USE igi_status igi_highlights_light(igi_context *ctx, const igi_highlight_source *source,
                                             size_t region, const igi_highlight_options *options,
                                             const igi_highlights *fewer, igi_highlights *out);

#endif
