/* SPDX-License-Identifier: Apache-2.0
 *
 * The reflectance models of <igi/material.h>: evaluation, sampling and its density.
 * Directions are unit vectors in the local frame: z is the normal, both on the side z > 0.
 * The diffuse part rho_d/pi is the caller's; what is here is the specular lobe alone.
 */
#ifndef IGI_SRC_BRDF_BRDF_H
#define IGI_SRC_BRDF_BRDF_H

#include "base/vec.h"

#include <igi/material.h>

/* The lobe is affine in the specular coefficient: f_s = rho_s * scale + base, sr^-1; base is 0
 * but for ggx, whose Schlick term (1 - rho_s)(1 - cos)^5 does not vanish with rho_s. Both are 0
 * below the surface. alpha is clamped to [IGI_ALPHA_MIN, 1]. */
void igi_lobe_terms(igi_model model, float alpha, igi_vec in, igi_vec out, float *scale,
                    float *base);

/* A direction `in` for a given `out` from a point (u,v) of the unit square; its density per solid
 * angle is igi_lobe_pdf. May come out below the surface: then it carries nothing. */
igi_vec igi_lobe_sample(igi_model model, float alpha, igi_vec out, float u, float v);
float igi_lobe_pdf(igi_model model, float alpha, igi_vec in, igi_vec out);
/* Both terms of the lobe over that density: what a direction that it chose carries. No exponential is
 * needed. 0 of lambert, and below the surface. */
void igi_lobe_ratios(igi_model model, float alpha, igi_vec in, igi_vec out, float *scale,
                     float *base);
/* The density of Ward's, summed over roughnesses. */
float igi_ward_pdf_sum(const float *alphas, int count, igi_vec in, igi_vec out);

#define IGI_ALPHA_MIN 1e-3f

#endif
