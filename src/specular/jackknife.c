/* SPDX-License-Identifier: Apache-2.0 */
#include "specular/jackknife.h"

#include "base/context.h"

#include <math.h>
#include <stdlib.h>

/* A piece's share of the Hessian (00, 01, 11) and of the gradient. */
typedef struct part {
    uint32_t piece;
    double h[3], g[2];
} part;

static int compare_parts(const void *a, const void *b)
{
    uint32_t x = ((const part *)a)->piece, y = ((const part *)b)->piece;
    return (x > y) - (x < y);
}

static void add(part *to, const part *from)
{
    for (int k = 0; k < 3; k++) to->h[k] += from->h[k];
    for (int k = 0; k < 2; k++) to->g[k] += from->g[k];
}

/* One part for each run of `stride` residuals of all blocks. */
static igi_status collect(igi_context *ctx, const igi_least_squares *problem, const double x[2],
                          const uint32_t *pieces, size_t stride, part *parts)
{
    igi_status status = IGI_OK;
    double *residuals = NULL;
    int largest = 1;
    for (size_t b = 0; b < problem->block_count; b++)
        if (problem->block_sizes[b] > largest) largest = problem->block_sizes[b];
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 3 * (size_t)largest, &residuals));
    double *jacobian = residuals + largest;
    for (size_t b = 0, at = 0; b < problem->block_count; b++) {
        if (!problem->residuals(problem->user, b, x, residuals, jacobian)) continue;
        for (int i = 0; i < problem->block_sizes[b]; i++, at++) {
            const double *j = jacobian + 2 * i, r = residuals[i];
            part one = {0, {j[0] * j[0], j[0] * j[1], j[1] * j[1]}, {j[0] * r, j[1] * r}};
            parts[at / stride].piece = pieces[at / stride];
            add(&parts[at / stride], &one);
        }
    }
cleanup:
    igi_free(residuals);
    return status;
}

/* Sorted by piece; equal ones become one. */
static size_t merge(part *parts, size_t count)
{
    size_t n = 0;
    qsort(parts, count, sizeof *parts, compare_parts);
    for (size_t i = 0; i < count; i++) {
        if (n > 0 && parts[n - 1].piece == parts[i].piece) add(&parts[n - 1], &parts[i]);
        else parts[n++] = parts[i];
    }
    return n;
}

static void leave_out(const part *all, const part *c, double covariance[4])
{
    double a = all->h[0] - c->h[0], b = all->h[1] - c->h[1], d = all->h[2] - c->h[2];
    double det = a * d - b * b;
    if (!(det > 1e-9 * all->h[0] * all->h[2])) det = 0;
    double x = (d * c->g[0] - b * c->g[1]) / det, y = (a * c->g[1] - b * c->g[0]) / det;
    covariance[0] += det > 0 ? x * x : (double)INFINITY;
    covariance[1] += det > 0 ? x * y : 0;
    covariance[3] += det > 0 ? y * y : (double)INFINITY;
}

/* Student's 97.5 % point over the normal one, about, for so many pieces' worth of information: few
 * pieces tell their own scatter badly, and 1.96 standard deviations must hold 95 % all the same. */
static double student(double pieces)
{
    return pieces > 0 ? 1 + 1.5 / pieces + 0.8 / (pieces * pieces) : 1;
}

igi_status igi_jackknife(igi_context *ctx, const igi_least_squares *problem, const double x[2],
                         const uint32_t *pieces, size_t stride, double covariance[4])
{
    igi_status status = IGI_OK;
    part *parts = NULL, all = {0, {0, 0, 0}, {0, 0}};
    size_t count = 0;
    for (int k = 0; k < 4; k++) covariance[k] = k == 1 || k == 2 ? 0 : (double)INFINITY;
    for (size_t b = 0; b < problem->block_count; b++) count += (size_t)problem->block_sizes[b];
    count /= stride;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, count + 1, &parts));
    IGI_TRY_GOTO(collect(ctx, problem, x, pieces, stride, parts));
    size_t n = merge(parts, count);
    if (n < 2) goto cleanup;
    for (size_t i = 0; i < n; i++) add(&all, &parts[i]);
    covariance[0] = covariance[3] = 0;
    double squares[3] = {0};
    for (size_t i = 0; i < n; i++) {
        leave_out(&all, &parts[i], covariance);
        for (int k = 0; k < 3; k += 2) squares[k] += parts[i].h[k] * parts[i].h[k];
    }
    double factor = (double)(n - 1) / (double)n;
    double first = student(all.h[0] * all.h[0] / squares[0]);
    double second = student(all.h[2] * all.h[2] / squares[2]);
    covariance[0] *= factor * first * first;
    covariance[3] *= factor * second * second;
    covariance[1] *= factor * first * second;
    covariance[2] = covariance[1];
cleanup:
    igi_free(parts);
    return status;
}
