/* SPDX-License-Identifier: Apache-2.0
 *
 * Parts of the 1999 algorithm: sample points in highlights, and the fit of one lobe to them.
 */
#ifndef IGI_SRC_SPECULAR_YU99_H
#define IGI_SRC_SPECULAR_YU99_H

#include "specular/specular.h"

/* A direction from which light reaches a sample point, in the frame of its normal. */
typedef struct igi_yu99_link {
    igi_vec in;
    float weight; /* cos(in) over the density of the directions; 0: carries nothing */
    float incident[IGI_MAX_BANDS]; /* radiance; of a light without extent its irradiance */
} igi_yu99_link;

typedef struct igi_yu99_samples {
    size_t count;
    size_t links; /* of each point */
    int bands;
    igi_vec *out;        /* [count] toward the camera, in the frame of the normal */
    float *radiance;     /* [count][bands] as photographed */
    float *irradiance;   /* [count][bands] */
    igi_yu99_link *link; /* [count][links] */
} igi_yu99_samples;

/* Up to so many points of the region that photographs show, spread evenly; or, predicted: one half
 * where a lamp or a bright surface is predicted to be mirrored most, one half over the rest. */
IGI_MUST_USE igi_status igi_yu99_samples_create(igi_context *ctx, const igi_radiance_field *field,
                                                uint32_t region, size_t points, bool predicted,
                                                igi_yu99_samples **samples);
void igi_yu99_samples_destroy(igi_yu99_samples *samples);

/* Ward's lobe: L = rho_d/pi E + rho_s S(alpha), least squares over all points and bands, robust. The
 * model is IGI_LAMBERT when no highlight tells of a lobe. */
IGI_MUST_USE igi_status igi_yu99_fit_lobe(igi_context *ctx, const igi_yu99_samples *samples,
                                          igi_lobe_estimate *estimate);

/* Albedo and its deviation from points, their lobe being known: the ratio of what is sent on to what
 * is received. false when nothing is received. */
bool igi_yu99_albedo(const igi_yu99_samples *samples, const igi_lobe *lobe,
                     double albedo[IGI_MAX_BANDS], double albedo_std[IGI_MAX_BANDS]);

/* The whole algorithm: albedos into `diffuse`, lobes into `specular`. */
IGI_MUST_USE igi_status igi_yu99_create(igi_context *ctx, const igi_problem *problem,
                                        igi_diffuse *diffuse, igi_specular **specular);

#endif
