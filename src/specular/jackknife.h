/* SPDX-License-Identifier: Apache-2.0
 *
 * How far a fit would move if pieces of the data were left out: errors that neighbours share do not
 * average out as independent ones do, and residuals alone cannot tell.
 */
#ifndef IGI_SRC_SPECULAR_JACKKNIFE_H
#define IGI_SRC_SPECULAR_JACKKNIFE_H

#include "bridge/least_squares.h"

/* The delete-a-piece jackknife of two parameters x about their optimum (Quenouille 1956; CR3 of
 * Bell & McCaffrey 2002), by one Newton step a piece:
 *     cov = (n-1)/n sum_c d_c d_c^T,   d_c = (H - H_c)^-1 g_c,
 * g_c and H_c the parts of gradient and Hessian that the residuals of piece c have, n pieces;
 * widened as Student's distribution is where few pieces carry the information, so that 1.96
 * standard deviations are a 95 % interval.
 * pieces: of every `stride` residuals, in their order, the piece that they belong to. Where one
 * piece alone determines something, the variances are INFINITY. */
IGI_MUST_USE igi_status igi_jackknife(igi_context *ctx, const igi_least_squares *problem,
                                      const double x[2], const uint32_t *pieces, size_t stride,
                                      double covariance[4]);

#endif
