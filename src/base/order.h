/* SPDX-License-Identifier: Apache-2.0
 *
 * The order of numbers, for qsort; also of structures that begin with the number. Medians and means.
 */
#ifndef IGI_SRC_BASE_ORDER_H
#define IGI_SRC_BASE_ORDER_H

#include <math.h>
#include <stdlib.h>

static inline int igi_compare_doubles(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static inline int igi_compare_floats(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static inline double igi_mean(const float *values, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++) sum += (double)values[i];
    return sum / (double)count;
}

/* Sorts them. The mean of the middle two when their count is even; NaN of nothing. */
static inline double igi_median(double *values, size_t count)
{
    if (count == 0) return (double)NAN;
    qsort(values, count, sizeof *values, igi_compare_doubles);
    return (values[(count - 1) / 2] + values[count / 2]) / 2;
}

/* Of pairs of a value and its weight, which it sorts; count > 0. */
static inline double igi_weighted_median(double (*pairs)[2], size_t count)
{
    double all = 0, below = 0;
    qsort(pairs, count, sizeof *pairs, igi_compare_doubles);
    for (size_t i = 0; i < count; i++) all += pairs[i][1];
    for (size_t i = 0; i + 1 < count; i++) {
        below += pairs[i][1];
        if (2 * below >= all) return pairs[i][0];
    }
    return pairs[count - 1][0];
}

#endif
