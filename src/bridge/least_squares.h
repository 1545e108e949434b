/* SPDX-License-Identifier: Apache-2.0
 *
 * Small dense non-linear least squares: a robust loss, bounds, and a covariance that says what the
 * data do not determine. Ceres underneath; no C++ type and no exception passes.
 *
 *     minimise over x:  1/2 sum over blocks b of rho(|r_b(x)|^2),   lower <= x <= upper
 *
 * rho is Huber's loss: rho(s) = s up to s = a^2, 2 a sqrt(s) - a^2 beyond, a = loss_scale. It is
 * convex, and leaves residuals shorter than a as they are: a scale well above the noise does not
 * bend the answer.
 *
 * One thread a solve; solves may run side by side. The same input gives the same bytes.
 */
#ifndef IGI_SRC_BRIDGE_LEAST_SQUARES_H
#define IGI_SRC_BRIDGE_LEAST_SQUARES_H

#include <igi/base.h>

#ifdef __cplusplus
extern "C" {
#endif

#define IGI_LEAST_SQUARES_MAX_PARAMETERS 32

/* Writes residuals[block_size] and, when jacobian is not NULL, their derivatives
 * jacobian[block_size][parameter_count]. false, or a number that is not finite or beyond 1e100:
 * the parameters are outside of the domain; a step that led there is taken back and shortened.
 * Must not longjmp. */
typedef bool (*igi_residuals_fn)(void *user, size_t block, const double *parameters,
                                 double *residuals, double *jacobian);

typedef struct igi_least_squares {
    size_t parameter_count; /* 1..IGI_LEAST_SQUARES_MAX_PARAMETERS */
    size_t block_count;
    const int *block_sizes; /* [block_count], each >= 1; NULL: each is 1 */
    igi_residuals_fn residuals;
    void *user;
    const double *lower;      /* [parameter_count], -INFINITY: none; NULL: none at all */
    const double *upper;      /* equal to lower: the parameter is held at that value */
    double loss_scale;        /* a, of the norm of a block; 0: no loss, rho(s) = s */
    double residual_variance; /* of one residual, where known; 0: estimated from the residuals */
    int max_iterations;       /* 0: 100 */
    double tolerance;         /* of the parameters, relative; 0: 1e-8 */
} igi_least_squares;

typedef struct igi_least_squares_result {
    double cost; /* the sum above, with its 1/2 */
    int iterations;
    bool converged;           /* at a minimum within the tolerance, judged with the bounds; false:
                                 the iterations ran out first; the parameters are the best found */
    int rank;                 /* directions of the parameters' space that the data determine */
    double residual_variance; /* as given, or the estimate; INFINITY: too few residuals for one */
    signed char at_bound[IGI_LEAST_SQUARES_MAX_PARAMETERS]; /* -1 lower, +1 upper, 0 between */
} igi_least_squares_result;

/* `parameters` holds the start (moved inside of the bounds) and receives the solution; after a
 * failure it is as it was. Finds the minimum whose valley the start lies in.
 *
 * covariance: [parameter_count][parameter_count] or NULL. residual_variance x the inverse of
 *     H = sum over blocks of J^T (rho' 1 + 2 rho'' r r^T) J,
 * what is left of J^T J after the loss: a scalar outlier tells nothing. Scaled to a diagonal of
 * ones, an eigenvalue of H below 1e-12 of the largest counts as zero: its direction is not
 * determined, and every parameter that takes part in it has variance INFINITY and no covariances
 * (0). The bounds are disregarded (at_bound tells): a parameter at its bound has the variance it
 * would have without. Only a parameter that is held (lower == upper) has variance 0, and does not
 * count in rank. An estimated variance is that of Huber (Robust Statistics, 1981, 7.6):
 *     sum of |rho' r|^2 / (residuals - rank) / mean of the diagonal of (rho' 1 + 2 rho'' r r^T),
 * which without a loss is the sum of squares over the degrees of freedom.
 *
 * IGI_E_NO_ANSWER: the residuals are not finite at the start. IGI_E_USAGE: the problem is wrong.
 * No blocks: the start is the answer, of rank 0. */
IGI_MUST_USE igi_status igi_least_squares_solve(igi_context *ctx, const igi_least_squares *problem,
                                                double *parameters, double *covariance,
                                                igi_least_squares_result *result);

#ifdef __cplusplus
}
#endif
#endif
