/* SPDX-License-Identifier: Apache-2.0
 *
 * Small dense linear systems.
 */
#ifndef IGI_SRC_BASE_SOLVE_H
#define IGI_SRC_BASE_SOLVE_H

#include <stdbool.h>
#include <stddef.h>

/* Solves A x = b in place for `count` right-hand sides b[count][n] by Cholesky. A is row-major,
 * symmetric and positive; only its lower triangle is read, and overwritten. False when it is not
 * positive. */
bool igi_solve_cholesky(double *a, size_t n, double *b, size_t count);

/* Overwrites s[n][n], symmetric, with A^-1 s A^-1, A as above but kept; `scratch` [n][n]. */
bool igi_solve_sandwich(const double *a, double *scratch, size_t n, double *s);

#endif
