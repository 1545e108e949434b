/* SPDX-License-Identifier: Apache-2.0
 *
 * What each chosen pixel would show of a lobe, tabulated over roughness.
 */
#ifndef IGI_SRC_SPECULAR_LOBE_TABLE_H
#define IGI_SRC_SPECULAR_LOBE_TABLE_H

#include "specular/highlights.h"

#define IGI_TABLE_ALPHAS 28 /* at most */

/* The specular radiance of pixel i at roughness alphas[a] is rho_s scale[i][a] + base[i][a], per
 * band, with the highlights' tint in the scale: scale[count][alpha_count][bands]; base is NULL but for
 * ggx. noise is the variance of scale
 * that the choice of directions leaves: (A - B)^2 for halves A + B = scale. */
typedef struct igi_lobe_table {
    igi_model model;
    size_t alpha_count;
    float alphas[IGI_TABLE_ALPHAS]; /* rising */
    float *scale, *base, *noise;
    float *lamps; /* the part of scale that comes straight from lamps */
} igi_lobe_table;

IGI_MUST_USE igi_status igi_lobe_table_create(igi_context *ctx, const igi_highlights *highlights,
                                              igi_model model, const double *alphas,
                                              size_t alpha_count, igi_lobe_table *table);
void igi_lobe_table_clear(igi_lobe_table *table);

#endif
