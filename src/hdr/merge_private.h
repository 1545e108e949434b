/* SPDX-License-Identifier: Apache-2.0
 *
 * The sums of a merge in progress; merge.c fills them, bracket.c decides from what.
 */
#ifndef IGI_SRC_HDR_MERGE_PRIVATE_H
#define IGI_SRC_HDR_MERGE_PRIVATE_H

#include "hdr/hdr_private.h"

#define NOISE_OCTAVES 30 /* below full scale */
#define NOISE_SIZE (64 * (NOISE_OCTAVES + 1))
#define RESIDUAL_BINS 512

typedef struct noise_model {
    double full_well_e, read_noise; /* as in igi_merge_options, both > 0 */
    bool fitted;                    /* the response was recovered from the bracket */
} noise_model;

typedef struct accumulator {
    igi_image *image; /* the result, whose channels hold the sums meanwhile */
    int channels;
    float *fade;                 /* [levels] weight towards saturation */
    float noise[3][NOISE_SIZE];  /* variance of an exposure */
    float weight[3][NOISE_SIZE]; /* of a sample: h^2 / noise, of the photograph added last */
    float floor[3];              /* exposure below which a sample is not worth its bias */
    bool fitted;                 /* the response was, to the same photographs */
    uint64_t residuals[RESIDUAL_BINS];
    uint64_t samples, saturated, moved; /* of the photograph added last */
} accumulator;

IGI_MUST_USE igi_status igi_accumulator_prepare(igi_context *ctx, const igi_photo *shape,
                                                const igi_response *response,
                                                const noise_model *model, accumulator *acc);
void igi_accumulator_free(accumulator *acc);
/* Photographs in the order of falling exposure. */
void igi_accumulator_add(accumulator *acc, const igi_photo *photo, const igi_response *response,
                         double h, const igi_shift *shift);
/* Turns sums into radiance and variance; returns the measured scatter. */
double igi_accumulator_finish(accumulator *acc, double shortest_h, bool noise_is_known);

#endif
