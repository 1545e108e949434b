/* SPDX-License-Identifier: Apache-2.0
 *
 * The polynomial V = 1 + k1 r^2 + k2 r^4 + k3 r^6 with a free centre.
 *
 * For a given centre, a V is linear in (a, a k1, a k2, a k3); so only the centre is searched, by a
 * compass search that halves its step: the misfit is smooth and has one minimum. Places that
 * disagree strongly (dust, a shadow of the photographer) lose weight (Tukey's biweight).
 */
#include "base/context.h"
#include "base/solve.h"
#include "lens/lens_private.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef struct samples {
    const double (*places)[2];
    const double *values;
    double *weights;
    size_t count;
    double half_diagonal;
} samples;

static double squared_radius(const samples *s, size_t i, double cx, double cy)
{
    double x = (s->places[i][0] - cx) / s->half_diagonal;
    double y = (s->places[i][1] - cy) / s->half_diagonal;
    return x * x + y * y;
}

/* Weighted least squares of the four linear unknowns; the misfit, or HUGE_VAL. */
static double fit_linear(const samples *s, double cx, double cy, double p[4])
{
    double a[16] = {0}, sum = 0, weight = 0;
    for (int k = 0; k < 4; k++) p[k] = 0;
    for (size_t i = 0; i < s->count; i++) {
        double r2 = squared_radius(s, i, cx, cy), w = s->weights[i];
        const double basis[4] = {1, r2, r2 * r2, r2 * r2 * r2};
        for (int j = 0; j < 4; j++) {
            for (int k = 0; k < 4; k++) a[4 * j + k] += w * basis[j] * basis[k];
            p[j] += w * basis[j] * s->values[i];
        }
    }
    for (int k = 0; k < 4; k++) a[5 * k] *= 1 + 1e-12;
    if (!igi_solve_cholesky(a, 4, p, 1)) return HUGE_VAL;
    for (size_t i = 0; i < s->count; i++) {
        double r2 = squared_radius(s, i, cx, cy);
        double off = s->values[i] - (p[0] + r2 * (p[1] + r2 * (p[2] + r2 * p[3])));
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

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Biweights from the residuals; `scratch` has room for them. */
static void reweight(const samples *s, double cx, double cy, const double p[4], double *scratch)
{
    double *residuals = scratch, *sorted = scratch + s->count;
    for (size_t i = 0; i < s->count; i++) {
        double r2 = squared_radius(s, i, cx, cy);
        residuals[i] = fabs(s->values[i] - (p[0] + r2 * (p[1] + r2 * (p[2] + r2 * p[3]))));
    }
    memcpy(sorted, residuals, s->count * sizeof *sorted);
    qsort(sorted, s->count, sizeof *sorted, by_value);
    double width = 6 * sorted[s->count / 2] / .6745 + 1e-9 * fabs(p[0]);
    for (size_t i = 0; i < s->count; i++) {
        double u = residuals[i] / width;
        s->weights[i] = u < 1 ? (1 - u * u) * (1 - u * u) : 0;
    }
}

igi_status igi_vignetting_fit(igi_context *ctx, const double (*places)[2],
                              const double *transmissions, size_t count, const int size[2],
                              igi_vignetting *vignetting)
{
    igi_status status = IGI_OK;
    samples s = {places, transmissions, NULL, count, hypot(size[0], size[1]) / 2};
    double *scratch = NULL, p[4] = {0}, cx = size[0] / 2., cy = size[1] / 2., misfit = 0;
    memset(vignetting, 0, sizeof *vignetting);
    if (count < 12)
        return igi_fail(ctx, IGI_E_NO_ANSWER,
                        "vignetting: %zu places do not determine it; use a whole photograph",
                        count);
    IGI_TRY_GOTO(IGI_ALLOC(ctx, count, &s.weights));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 2 * count, &scratch));
    for (size_t i = 0; i < count; i++) s.weights[i] = 1;
    for (int round = 0; round < 4; round++) {
        misfit = search_centre(&s, &cx, &cy, p);
        reweight(&s, cx, cy, p, scratch);
    }
    if (!isfinite(misfit) || !(p[0] > 0)) {
        status = igi_fail(ctx, IGI_E_NO_ANSWER,
                          "vignetting: the measurements do not determine it; "
                          "photograph an evenly lit surface that fills the frame");
        goto cleanup;
    }
    vignetting->known = true;
    vignetting->centre_x = cx;
    vignetting->centre_y = cy;
    for (int k = 0; k < 3; k++) vignetting->k[k] = p[k + 1] / p[0];
    double sum = 0;
    for (size_t i = 0; i < count; i++) {
        double off = transmissions[i] / p[0] -
                     igi_vignetting_at(vignetting, places[i][0], places[i][1], size);
        sum += off * off;
    }
    vignetting->rms = sqrt(sum / (double)count);
cleanup:
    igi_free(s.weights);
    igi_free(scratch);
    return status;
}

double igi_vignetting_at(const igi_vignetting *vignetting, double x, double y, const int size[2])
{
    if (!vignetting->known) return 1;
    double dx = x - vignetting->centre_x, dy = y - vignetting->centre_y;
    double r2 = 4 * (dx * dx + dy * dy) / ((double)size[0] * size[0] + (double)size[1] * size[1]);
    double v = 1 + r2 * (vignetting->k[0] + r2 * (vignetting->k[1] + r2 * vignetting->k[2]));
    return v > .01 ? v : .01;
}
