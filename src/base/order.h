/* SPDX-License-Identifier: Apache-2.0
 *
 * The order of numbers, for qsort; also of structures that begin with the number. Medians.
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

/* Sorts them. The mean of the middle two when their count is even; NaN of nothing. */
static inline double igi_median(double *values, size_t count)
{
    if (count == 0) return (double)NAN;
    qsort(values, count, sizeof *values, igi_compare_doubles);
    return (values[(count - 1) / 2] + values[count / 2]) / 2;
}

#endif
