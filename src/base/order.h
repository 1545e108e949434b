/* SPDX-License-Identifier: Apache-2.0
 *
 * The order of numbers, for qsort; also of structures that begin with the number.
 */
#ifndef IGI_SRC_BASE_ORDER_H
#define IGI_SRC_BASE_ORDER_H

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

#endif
