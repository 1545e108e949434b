/* SPDX-License-Identifier: Apache-2.0
 *
 * The part of the lobe fit that is linear: albedos and the specular coefficient for a given alpha.
 */
#ifndef IGI_SRC_SPECULAR_LOBE_PROFILE_H
#define IGI_SRC_SPECULAR_LOBE_PROFILE_H

#include "specular/lobe_table.h"

typedef struct igi_profile {
    const igi_highlights *h;
    size_t bands, n;
    float *weight; /* [count][bands] one over the variance of a residual */
    float *start;  /* [count][bands] the weights that a search begins with: the caller's */
    float *bias; /* [count][bands] how much of the noise of S biases rho_s: 1 where the weight does
                     * not know S */
    float *scratch; /* [2][count][bands] */
    double *sums;   /* [groups][bands][3]: <E,E>, <y,E>, <S,E> */
    double *albedo; /* [groups][bands] of the last evaluation */
} igi_profile;

/* Pixel 0's terms at one alpha; scale NULL: no lobe. */
typedef struct igi_profile_column {
    const float *scale, *base, *noise;
    size_t stride; /* to the next pixel */
} igi_profile_column;

typedef struct igi_profile_outcome {
    double specular, misfit;
    double information; /* <S_perp, S_perp>: one over the variance of specular, were noise all */
} igi_profile_outcome;

IGI_MUST_USE igi_status igi_profile_create(igi_context *ctx, const igi_highlights *highlights,
                                           igi_profile *profile);
void igi_profile_clear(igi_profile *profile);

igi_profile_column igi_profile_column_of(const igi_profile *profile, const igi_lobe_table *table,
                                         size_t alpha);

/* Best specular coefficient (>= 0), albedos and weighted squared misfit. */
igi_profile_outcome igi_profile_evaluate(igi_profile *profile, const igi_profile_column *column);

/* sum w noise: what the choice of directions adds to the misfit for a specular coefficient of 1. */
double igi_profile_noise(const igi_profile *profile, const igi_profile_column *column);

/* Weights from the predictions of the last evaluation; robust: outliers weigh less. *noise is the
 * spread of relative residuals. Returns -2 ln likelihood. */
double igi_profile_reweigh(igi_profile *profile, const igi_profile_column *column, double specular,
                           bool robust, double *noise);

#endif
