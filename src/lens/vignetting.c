/* SPDX-License-Identifier: Apache-2.0
 *
 * The polynomial V = 1 + k1 r^2 + k2 r^4 + k3 r^6 with a free centre.
 *
 * For a given centre, a V is linear in (a, a k1, a k2, a k3); so only the centre is searched, by a
 * compass search that halves its step: the misfit is smooth and has one minimum. Places that
 * disagree strongly (dust, a shadow of the photographer) lose weight (Tukey's biweight).
 */
#include "base/context.h"
#include "base/order.h"
#include "base/solve.h"
#include "lens/lens_private.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct samples {
    const double (*places)[2];
    const double (*partners)[2]; /* NULL: values are a V; else values are ln V - ln V there */
    const double *values;
    double *weights;
    size_t count;
    double half_diagonal;
} samples;

static double squared_radius(const samples *s, const double place[2], double cx, double cy)
{
    double x = (place[0] - cx) / s->half_diagonal;
    double y = (place[1] - cy) / s->half_diagonal;
    return x * x + y * y;
}

/* What the four unknowns are multiplied with. A pair knows no scale: its first is tied to 0. */
static void fill_basis(const samples *s, size_t i, double cx, double cy, double basis[4])
{
    double a = squared_radius(s, s->places[i], cx, cy), b = 0;
    if (s->partners) b = squared_radius(s, s->partners[i], cx, cy);
    basis[0] = s->partners ? 0 : 1;
    basis[1] = a - b;
    basis[2] = a * a - b * b;
    basis[3] = a * a * a - b * b * b;
}

static double residual(const samples *s, size_t i, double cx, double cy, const double p[4])
{
    double basis[4], off = s->values[i];
    fill_basis(s, i, cx, cy, basis);
    for (int k = 0; k < 4; k++) off -= p[k] * basis[k];
    return off;
}

/* Weighted least squares of the four linear unknowns; the misfit, or HUGE_VAL. */
static double fit_linear(const samples *s, double cx, double cy, double p[4])
{
    double a[16] = {0}, sum = 0, weight = 0;
    for (int k = 0; k < 4; k++) p[k] = 0;
    for (size_t i = 0; i < s->count; i++) {
        double basis[4], w = s->weights[i];
        fill_basis(s, i, cx, cy, basis);
        for (int j = 0; j < 4; j++) {
            for (int k = 0; k < 4; k++) a[4 * j + k] += w * basis[j] * basis[k];
            p[j] += w * basis[j] * s->values[i];
        }
    }
    if (s->partners) a[0] = 1;
    for (int k = 0; k < 4; k++) a[5 * k] *= 1 + 1e-12;
    if (!igi_solve_cholesky(a, 4, p, 1)) return HUGE_VAL;
    for (size_t i = 0; i < s->count; i++) {
        double off = residual(s, i, cx, cy, p);
        sum += s->weights[i] * off * off;
        weight += s->weights[i];
    }
    return weight > 0 ? sum / weight : HUGE_VAL;
}

/* The best centre near *cx, *cy and its polynomial. */
static double search_centre(const samples *s, double *cx, double *cy, double p[4])
{
    static const int compass[4][2] = {{1, 0}, {-1, 0}, {0, 1}, {0, -1}};
    double best = fit_linear(s, *cx, *cy, p), step = s->half_diagonal / 8;
    double x0 = *cx, y0 = *cy;
    while (step > s->half_diagonal * 1e-4) {
        bool moved = false;
        for (int i = 0; i < 4; i++) {
            double x = *cx + compass[i][0] * step, y = *cy + compass[i][1] * step, tried[4];
            if (hypot(x - x0, y - y0) > s->half_diagonal / 2) continue;
            double misfit = fit_linear(s, x, y, tried);
            if (!(misfit < best)) continue;
            best = misfit, *cx = x, *cy = y, moved = true;
            memcpy(p, tried, 4 * sizeof *p);
        }
        if (!moved) step /= 2;
    }
    return best;
}

/* Biweights from the residuals; `scratch` has room for them. */
static void reweight(const samples *s, double cx, double cy, const double p[4], double *scratch)
{
    double *residuals = scratch, *sorted = scratch + s->count;
    for (size_t i = 0; i < s->count; i++) residuals[i] = fabs(residual(s, i, cx, cy, p));
    memcpy(sorted, residuals, s->count * sizeof *sorted);
    double width = 6 * igi_median(sorted, s->count) / .6745 + 1e-9 * fabs(p[0]);
    for (size_t i = 0; i < s->count; i++) {
        double u = residuals[i] / width;
        s->weights[i] = u < 1 ? (1 - u * u) * (1 - u * u) : 0;
    }
}

/* The robust fit: centre and unknowns. IGI_E_NO_ANSWER is left to the caller: *misfit HUGE_VAL. */
static igi_status fit_robustly(igi_context *ctx, samples *s, double centre[2], double p[4],
                               double *misfit)
{
    igi_status status = IGI_OK;
    double *scratch = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, s->count, &s->weights));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 2 * s->count, &scratch));
    for (size_t i = 0; i < s->count; i++) s->weights[i] = 1;
    for (int round = 0; round < 4; round++) {
        *misfit = search_centre(s, &centre[0], &centre[1], p);
        reweight(s, centre[0], centre[1], p, scratch);
    }
cleanup:
    igi_free(s->weights);
    igi_free(scratch);
    s->weights = NULL;
    return status;
}

static igi_status fail_undetermined(igi_context *ctx)
{
    return igi_fail(ctx, IGI_E_NO_ANSWER,
                    "vignetting: the measurements do not determine it; photograph an evenly lit "
                    "surface that fills the frame");
}

igi_status igi_vignetting_fit(igi_context *ctx, const double (*places)[2],
                              const double *transmissions, size_t count, const int size[2],
                              igi_vignetting *vignetting)
{
    samples s = {places, NULL, transmissions, NULL, count, hypot(size[0], size[1]) / 2};
    double p[4] = {0}, centre[2] = {size[0] / 2., size[1] / 2.}, misfit = 0, sum = 0;
    memset(vignetting, 0, sizeof *vignetting);
    if (count < 12) return fail_undetermined(ctx);
    IGI_TRY(fit_robustly(ctx, &s, centre, p, &misfit));
    if (!(misfit < HUGE_VAL) || !(p[0] > 0)) return fail_undetermined(ctx);
    vignetting->known = true;
    vignetting->centre_x = centre[0];
    vignetting->centre_y = centre[1];
    for (int k = 0; k < 3; k++) vignetting->k[k] = p[k + 1] / p[0];
    for (size_t i = 0; i < count; i++) {
        double off = transmissions[i] / p[0] -
                     igi_vignetting_at(vignetting, places[i][0], places[i][1], size);
        sum += off * off;
    }
    vignetting->rms = sqrt(sum / (double)count);
    return IGI_OK;
}

/* V as a polynomial, from ln V as one: least squares over the disk. */
static bool from_logarithm(const double p[4], double k[3])
{
    double a[9] = {0};
    for (int j = 0; j < 3; j++) k[j] = 0;
    for (int i = 1; i <= 100; i++) {
        double r2 = i / 100., v = exp(r2 * (p[1] + r2 * (p[2] + r2 * p[3]))) - 1;
        const double basis[3] = {r2, r2 * r2, r2 * r2 * r2};
        for (int x = 0; x < 3; x++) {
            for (int y = 0; y < 3; y++) a[3 * x + y] += basis[x] * basis[y];
            k[x] += basis[x] * v;
        }
    }
    return igi_solve_cholesky(a, 3, k, 1);
}

igi_status igi_vignetting_fit_pairs(igi_context *ctx, const igi_vignetting_pairs *pairs,
                                    const int size[2], igi_vignetting *vignetting)
{
    samples s = {(const double(*)[2])pairs->a,
                 (const double(*)[2])pairs->b,
                 pairs->log_ratios,
                 NULL,
                 pairs->count,
                 hypot(size[0], size[1]) / 2};
    double p[4] = {0}, centre[2] = {size[0] / 2., size[1] / 2.}, misfit = 0;
    memset(vignetting, 0, sizeof *vignetting);
    if (pairs->count < 100) return fail_undetermined(ctx);
    IGI_TRY(fit_robustly(ctx, &s, centre, p, &misfit));
    if (!(misfit < HUGE_VAL) || !from_logarithm(p, vignetting->k)) return fail_undetermined(ctx);
    vignetting->known = true;
    vignetting->centre_x = centre[0];
    vignetting->centre_y = centre[1];
    vignetting->rms = sqrt(misfit);
    return IGI_OK;
}

double igi_vignetting_at(const igi_vignetting *vignetting, double x, double y, const int size[2])
{
    if (!vignetting->known) return 1;
    double dx = x - vignetting->centre_x, dy = y - vignetting->centre_y;
    double r2 = 4 * (dx * dx + dy * dy) / ((double)size[0] * size[0] + (double)size[1] * size[1]);
    double v = 1 + r2 * (vignetting->k[0] + r2 * (vignetting->k[1] + r2 * vignetting->k[2]));
    return v > .01 ? v : .01;
}
