/* SPDX-License-Identifier: Apache-2.0
 *
 * How much each candidate pixel might tell about a lobe: the predicted lobe of the lamps over the
 * diffuse radiance, for each of four roughnesses.
 */
#ifndef IGI_SRC_SPECULAR_HIGHLIGHT_SCORES_H
#define IGI_SRC_SPECULAR_HIGHLIGHT_SCORES_H

#include "specular/candidates.h"

/* Irradiance at an observation, per band. */
typedef void (*igi_irradiance_fn)(const void *user, size_t observation, float *irradiance);

/* What highlights are made from. */
typedef struct igi_highlight_source {
    const igi_radiance_field *field;
    const igi_rows *rows; /* of the patches method, for the lamps' share of irradiance */
    const igi_candidates *candidates;
    igi_irradiance_fn irradiance;
    const void *user; /* of irradiance */
} igi_highlight_source;

typedef struct igi_highlight_scores {
    size_t region, count;
    uint32_t *observation; /* [count] */
    float (*score)[4];     /* [count] */
    double sums[4];        /* over all */
} igi_highlight_scores;

/* Of at most so many of the region's candidates. */
IGI_MUST_USE igi_status igi_highlight_scores_create(igi_context *ctx,
                                                    const igi_highlight_source *source,
                                                    size_t region, size_t at_most,
                                                    const float alphas[4],
                                                    igi_highlight_scores *scores);
void igi_highlight_scores_clear(igi_highlight_scores *scores);

#endif
