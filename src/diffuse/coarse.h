/* SPDX-License-Identifier: Apache-2.0
 *
 * The room in coarse elements: the classical inverse radiosity, which two methods share.
 */
#ifndef IGI_SRC_DIFFUSE_COARSE_H
#define IGI_SRC_DIFFUSE_COARSE_H

#include "diffuse/problem.h"
#include "transport/mesh_elements.h"

/* Lamps are black here: their light is in `direct`. */
typedef struct igi_coarse {
    const igi_problem *problem;
    igi_elements *elements; /* those that photographs show or that matter to these */
    size_t n, bands, lights;
    double *factors;   /* [n][n] */
    float *direct;     /* [n][lights] irradiance per unit of the light's value */
    float *radiance;   /* [n][bands] as photographed; of unseen elements as solved */
    float *irradiance; /* [n][bands] as solved */
    float *weight;     /* [n] area seen, less where it is a part; 0: unseen, or a lamp */
    float *point;      /* [n][3] */
    uint32_t *region;  /* [n] */
} igi_coarse;

IGI_MUST_USE igi_status igi_coarse_create(igi_context *ctx, const igi_problem *problem,
                                          igi_coarse **coarse);
void igi_coarse_destroy(igi_coarse *coarse);

/* Albedos of the regions, their deviations, and the unseen elements' radiances. Of what is seen of
 * an element, gloss[n][bands] is not diffuse, and extra[n][bands] is irradiance that the elements'
 * mean radiances do not tell of; both may be NULL. */
IGI_MUST_USE igi_status igi_coarse_solve(igi_context *ctx, igi_coarse *coarse, const float *gloss,
                                         const float *extra, igi_diffuse *diffuse);

/* Sides of patches that no photograph shows get the radiance of their element. */
void igi_coarse_hand_on(const igi_coarse *coarse, igi_diffuse *diffuse);

#endif
