/* SPDX-License-Identifier: Apache-2.0
 *
 * Specular coefficient and roughness of one region from its highlights.
 */
#ifndef IGI_SRC_SPECULAR_LOBE_FIT_H
#define IGI_SRC_SPECULAR_LOBE_FIT_H

#include "specular/lobe_table.h"

/* Roughnesses that are looked for: below, photographs of a few hundred pixels resolve nothing; above,
 * a lobe can hardly be told from a diffuse surface. */
#define IGI_FIT_ALPHA_LOW 0.004
#define IGI_FIT_ALPHA_HIGH 0.6

/* A coefficient of each band: specular times tint. */
typedef struct igi_lobe_colour {
    bool found;                 /* evidence asks for it; else all bands are alike */
    double tint[IGI_MAX_BANDS]; /* 1 on average */
    double std[IGI_MAX_BANDS];  /* of the coefficient, as that band alone would tell it */
    double gain;                /* in -2 ln likelihood; about so much where it was not tried */
} igi_lobe_colour;

typedef struct igi_lobe_estimate {
    igi_model model;
    igi_model rival; /* that fits better, though the user asked for `model`; IGI_LAMBERT: none */
    igi_model
        broader; /* that may fit as well, with an alpha beyond what is looked for; likewise, */
    double broader_specular, broader_alpha; /* of it, where it ran into the bound */
    igi_model alike;               /* that fits as well, though the user asked for `model`, */
    double alike_alpha;            /* with this alpha; likewise */
    double specular, specular_std; /* mean over bands */
    igi_lobe_colour colour;
    double alpha, alpha_std;
    double noise_std; /* of specular, were independent noise all that there is */
    double
        lamp_share; /* how much of what is known of specular comes from lamps' highlights, 0..1, */
    double alpha_lamp_share;      /* and of alpha */
    bool at_bound;                /* alpha ran into the upper end of what is looked for */
    double deviance;              /* -2 ln likelihood with the lobe, */
    double excused;               /* from which so much was taken off for the noise of S, */
    double plain_deviance;        /* and without: both with the noise that fits them */
    double residuals;             /* how many residuals there were */
    double noise;                 /* relative standard deviation of a residual with the lobe, */
    double plain_noise;           /* and without */
    double albedo[IGI_MAX_BANDS]; /* of the first group: the region's, where it is one group */
} igi_lobe_estimate;

/* rho_s of one band. */
static inline double igi_lobe_coefficient(const igi_lobe_estimate *e, int band)
{
    return e->specular * (e->colour.found ? e->colour.tint[band] : 1);
}

static inline double igi_lobe_coefficient_std(const igi_lobe_estimate *e, int band)
{
    return e->colour.found ? e->colour.std[band] : e->specular_std;
}

/* By how much in -2 ln likelihood an estimate must beat a simpler or earlier one: by more than the noise
 * of such differences, a share of all residuals. */
double igi_lobe_margin(const igi_lobe_estimate *estimate);

/* The same on a coarse grid of roughnesses alone: enough to see whether there is a lobe at all. */
IGI_MUST_USE igi_status igi_lobe_glance(igi_context *ctx, const igi_highlights *highlights,
                                        igi_model model, igi_lobe_estimate *estimate);

/* The best lobe of the given model. near_alpha: look about it only; 0: everywhere. */
IGI_MUST_USE igi_status igi_lobe_fit(igi_context *ctx, const igi_highlights *highlights,
                                     igi_model model, double near_alpha,
                                     igi_lobe_estimate *estimate);

#endif
