/* SPDX-License-Identifier: Apache-2.0
 *
 * Light between surfaces is measured with the photographs, and light from lamps is stated: of a region
 * of one albedo rho, lit by lights l to the shares d_il of all that reaches its side i,
 *     a_i = rho (1 + sum s_l d_il),
 * where s_l is what the stated power of light l lacks. Least squares, robustly, about each region's
 * means; how well the s_l are known, regions left out in turn say (the jackknife), since what else
 * is wrong with a side (a lobe that was missed, light badly gathered) is alike over a region.
 */
#ifndef IGI_SRC_RECOVER_LIGHT_SHARES_H
#define IGI_SRC_RECOVER_LIGHT_SHARES_H

#include "diffuse/field.h"

#include <igi/material.h>

enum { IGI_SHARES_LIGHTS = 6 };

/* A side of a patch. */
typedef struct igi_look {
    uint32_t region;
    double off;                      /* its albedo over the region's mean, less 1 */
    double share[IGI_SHARES_LIGHTS]; /* d_il, less the region's mean */
    double received;                 /* mean over bands */
    double weight;                   /* 0: its region has no voice */
    igi_vec point, normal;
} igi_look;

typedef struct igi_light_shares {
    const igi_problem *p;
    const igi_materials *materials;
    const bool *diffuse;              /* [regions] those that have a voice */
    size_t light_count;               /* more than there is room for: all are left out */
    size_t lights[IGI_SHARES_LIGHTS]; /* of the problem's */
    double scales[IGI_SHARES_LIGHTS]; /* s_l */
    double errors[IGI_SHARES_LIGHTS]; /* and one standard deviation */
    size_t regions, count;
    igi_look *looks;                     /* [count] */
    double *mean;                        /* [regions] albedo */
    double (*shares)[IGI_SHARES_LIGHTS]; /* [regions] mean d */
    double *sides;                       /* [regions] looked at */
    double *spread;                      /* [regions] of the residuals, robust */
    double (*matrix)[IGI_SHARES_LIGHTS * IGI_SHARES_LIGHTS]; /* [regions] normal equations, */
    double (*right)[IGI_SHARES_LIGHTS];                      /* and their right sides */
    double (*sums)[IGI_SHARES_LIGHTS + 2]; /* [regions] weights, with off, shares */
    double *scratch;                       /* [count] */
} igi_light_shares;

/* *survey stays NULL where too few regions tell, or the lights are too many to be told apart. `field`,
 * `materials` and diffuse[regions] must outlive it. */
IGI_MUST_USE igi_status igi_light_shares_create(igi_context *ctx, const igi_problem *problem,
                                                const igi_field *field,
                                                const igi_materials *materials, const bool *diffuse,
                                                igi_light_shares **survey);
void igi_light_shares_destroy(igi_light_shares *survey);

/* Mean over bands of what a light of the problem's is said to have. */
double igi_light_shares_value(const igi_problem *problem, size_t light);

/* Lights that photographs show are compared with those. Here they stand for what else is wrong with
 * direct and gathered light: without them, a bulb takes the blame. */
bool igi_light_shares_shows(igi_light_type type);

#endif
