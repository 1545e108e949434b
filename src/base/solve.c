/* SPDX-License-Identifier: Apache-2.0
 *
 * Cholesky's factorisation, forward and backward substitution.
 */
#include "base/solve.h"

#include <math.h>
#include <string.h>

bool igi_solve_cholesky(double *a, size_t n, double *b, size_t count)
{
    for (size_t j = 0; j < n; j++) {
        double *row = a + j * n, d = row[j];
        for (size_t k = 0; k < j; k++) d -= row[k] * row[k];
        if (!(d > 0)) return false;
        row[j] = sqrt(d);
        for (size_t i = j + 1; i < n; i++) {
            double *lower = a + i * n, sum = lower[j];
            for (size_t k = 0; k < j; k++) sum -= lower[k] * row[k];
            lower[j] = sum / row[j];
        }
    }
    for (size_t r = 0; r < count; r++) {
        double *x = b + r * n;
        for (size_t i = 0; i < n; i++) {
            for (size_t k = 0; k < i; k++) x[i] -= a[i * n + k] * x[k];
            x[i] /= a[i * n + i];
        }
        for (size_t i = n; i-- > 0;) {
            for (size_t k = i + 1; k < n; k++) x[i] -= a[k * n + i] * x[k];
            x[i] /= a[i * n + i];
        }
    }
    return true;
}

bool igi_solve_sandwich(const double *a, double *scratch, size_t n, double *s)
{
    for (int side = 0; side < 2; side++) {
        memcpy(scratch, a, n * n * sizeof *a);
        if (!igi_solve_cholesky(scratch, n, s, n)) return false;
        for (size_t i = 0; i < n; i++)
            for (size_t j = 0; j < i; j++) {
                double swap = s[i * n + j];
                s[i * n + j] = s[j * n + i];
                s[j * n + i] = swap;
            }
    }
    return true;
}
