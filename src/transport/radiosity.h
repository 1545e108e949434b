/* SPDX-License-Identifier: Apache-2.0
 *
 * The classical radiosity system of one band: B_i = E_i + rho_i sum_j F_ij B_j.
 * B: radiosity, W m^-2 (pi times the radiance of a diffuse surface); E: what an element sends out
 * of its own, or sends on of light that no element sent: emission plus rho times direct irradiance.
 */
#ifndef IGI_SRC_TRANSPORT_RADIOSITY_H
#define IGI_SRC_TRANSPORT_RADIOSITY_H

#include "base/context.h"

typedef enum igi_radiosity_way {
    IGI_RADIOSITY_GAUSS_SEIDEL, /* gathering, element by element; the default */
    IGI_RADIOSITY_SHOOTING,     /* progressive refinement: the most unshot power first */
    IGI_RADIOSITY_LU            /* direct; its time grows as n^3 whatever rho is */
} igi_radiosity_way;

typedef struct igi_radiosity_system {
    size_t count;
    const double *factors; /* [count][count], row i: from i */
    const double *areas;   /* [count], > 0 */
    const double *albedo;  /* [count], rho_i */
    const double *sent;    /* [count], E_i */
    double tolerance;      /* of each B, relative to the largest; 0: 1e-9 */
} igi_radiosity_system;

/* Fills radiosity[count]. IGI_E_NO_ANSWER where light never dies out (albedo 1 in a closed room).
 * The same bytes for any number of threads: it uses one. */
IGI_MUST_USE igi_status igi_radiosity_solve(igi_context *ctx, const igi_radiosity_system *system,
                                            igi_radiosity_way way, double *radiosity);

#endif
