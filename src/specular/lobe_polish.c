/* SPDX-License-Identifier: Apache-2.0
 *
 * Ceres works on a table of five roughnesses about the optimum, interpolated in ln alpha by
 * Lagrange's polynomials, whose derivative is exact; the albedos are eliminated inside of each
 * residual block (lobe_profile.c). One Newton step afterwards takes out the bias that the noise of S
 * leaves, which least squares cannot express.
 */
#include "specular/lobe_polish.h"

#include "bridge/least_squares.h"
#include "specular/jackknife.h"

#include <string.h>

#define FINE IGI_POLISH_ALPHAS

typedef struct polish {
    const igi_profile *f;
    const igi_lobe_table *t;
    size_t *begin; /* [groups + 1] pixels of a group */
    double logs[FINE];
    size_t first_band, last_band; /* the others tell nothing */
} polish;

/* Lagrange's weights at x = ln alpha, and their derivatives. */
static void lagrange(const polish *p, double x, double weights[FINE], double slopes[FINE])
{
    for (int i = 0; i < FINE; i++) {
        double value = 1, slope = 0, below = 1;
        for (int j = 0; j < FINE; j++) {
            if (j == i) continue;
            slope = slope * (x - p->logs[j]) + value;
            value *= x - p->logs[j];
            below *= p->logs[i] - p->logs[j];
        }
        weights[i] = value / below;
        slopes[i] = slope / below;
    }
}

typedef struct mixture {
    double value, slope;
} mixture;

static mixture mix(const polish *p, const float *table, size_t i, size_t b, const double *weights,
                   const double *slopes)
{
    mixture m = {0, 0};
    if (!table) return m;
    const float *at = table + i * p->t->alpha_count * p->f->bands + b;
    for (int a = 0; a < FINE; a++) {
        m.value += weights[a] * (double)at[(size_t)a * p->f->bands];
        m.slope += slopes[a] * (double)at[(size_t)a * p->f->bands];
    }
    return m;
}

/* Residuals of one group: sqrt(w) (y - rho_s S)_perp over its pixels and bands; parameters rho_s and
 * ln alpha. */
static bool group_residuals(void *user, size_t group, const double *parameters, double *residuals,
                            double *jacobian)
{
    const polish *p = user;
    const igi_profile *f = p->f;
    double weights[FINE], slopes[FINE], rho = parameters[0];
    lagrange(p, parameters[1], weights, slopes);
    size_t first = p->begin[group], last = p->begin[group + 1];
    if (p->last_band - p->first_band < f->bands) {
        size_t size = (last - first) * f->bands;
        memset(residuals, 0, size * sizeof *residuals);
        if (jacobian) memset(jacobian, 0, 2 * size * sizeof *jacobian);
    }
    for (size_t b = p->first_band; b < p->last_band; b++) {
        double ee = 0, re = 0, se = 0, de = 0;
        for (size_t i = first; i < last; i++) {
            size_t k = i * f->bands + b, at = (i - first) * f->bands + b;
            double w = sqrt((double)f->weight[k]), e = w * (double)f->h->irradiance[k] / IGI_PI;
            mixture s = mix(p, p->t->scale, i, b, weights, slopes);
            mixture base = mix(p, p->t->base, i, b, weights, slopes);
            double r = w * ((double)f->h->radiance[k] - base.value - rho * s.value);
            double d = -w * (rho * s.slope + base.slope);
            residuals[at] = r;
            ee += e * e;
            re += r * e;
            se -= w * s.value * e;
            de += d * e;
            if (!jacobian) continue;
            jacobian[2 * at] = -w * s.value;
            jacobian[2 * at + 1] = d;
        }
        for (size_t i = first; i < last && ee > 0; i++) {
            size_t k = i * f->bands + b, at = (i - first) * f->bands + b;
            double e = sqrt((double)f->weight[k]) * (double)f->h->irradiance[k] / IGI_PI / ee;
            residuals[at] -= e * re;
            if (!jacobian) continue;
            jacobian[2 * at] -= e * se;
            jacobian[2 * at + 1] -= e * de;
        }
    }
    return true;
}

/* The variance of S in all as far as it biases rho_s, sum w bias noise, and its derivative. */
static mixture noise_of(const polish *p, double log_alpha)
{
    double weights[FINE], slopes[FINE];
    mixture sum = {0, 0};
    lagrange(p, log_alpha, weights, slopes);
    for (size_t i = 0; i < p->f->n; i++)
        for (size_t b = 0; b < p->f->bands; b++) {
            mixture m = mix(p, p->t->noise, i, b, weights, slopes);
            double w = (double)p->f->weight[i * p->f->bands + b] *
                       (double)p->f->bias[i * p->f->bands + b];
            sum.value += w * m.value;
            sum.slope += w * m.slope;
        }
    return sum;
}

/* One Newton step from the minimum of chi^2/2 to that of chi^2/2 - rho^2 V(alpha)/2. */
static void take_out_bias(const polish *p, const double *covariance, double variance, double x[2])
{
    mixture v = noise_of(p, x[1]);
    double det = covariance[0] * covariance[3] - covariance[1] * covariance[1];
    if (!(det > 0) || !isfinite(det) || !(variance > 0)) return;
    double h00 = variance * covariance[3] / det - v.value;
    double h01 = -variance * covariance[1] / det - x[0] * v.slope;
    double h11 = variance * covariance[0] / det;
    double g0 = x[0] * v.value, g1 = 0.5 * x[0] * x[0] * v.slope;
    det = h00 * h11 - h01 * h01;
    if (!(h00 > 0) || !(det > 0)) return;
    x[0] += (h11 * g0 - h01 * g1) / det;
    x[1] += fmax(-0.2, fmin(0.2, (h00 * g1 - h01 * g0) / det));
}

/* Products of dS/d ln alpha after elimination of the albedos: of lamps alone, over the whole. */
static double lamp_share_of_alpha(const polish *p, double log_alpha)
{
    const igi_profile *f = p->f;
    const float *tables[2] = {p->t->lamps, p->t->scale};
    double weights[FINE], slopes[FINE], products[2] = {0, 0};
    lagrange(p, log_alpha, weights, slopes);
    for (size_t g = 0; g < f->h->groups; g++)
        for (size_t b = 0; b < 2 * f->bands; b++) {
            double ee = 0, de = 0, dd = 0;
            for (size_t i = p->begin[g]; i < p->begin[g + 1]; i++) {
                size_t k = i * f->bands + b / 2;
                double d = mix(p, tables[b & 1], i, b / 2, weights, slopes).slope;
                double w = (double)f->weight[k], e = (double)f->h->irradiance[k];
                ee += w * e * e;
                de += w * d * e;
                dd += w * d * d;
            }
            products[b & 1] += dd - (ee > 0 ? de * de / ee : 0);
        }
    return products[1] > 0 ? fmin(1, fmax(0, products[0] / products[1])) : 0;
}

static igi_status find_groups(igi_context *ctx, const igi_highlights *h, size_t bands,
                              size_t **begin, int **sizes)
{
    IGI_TRY(IGI_ALLOC(ctx, h->groups + 1, begin));
    IGI_TRY(IGI_ALLOC(ctx, h->groups + 1, sizes));
    for (size_t i = 0; i < h->count; i++) (*begin)[h->group[i] + 1] = i + 1;
    for (size_t g = 0; g < h->groups; g++)
        (*sizes)[g] = (int)(((*begin)[g + 1] - (*begin)[g]) * bands);
    return IGI_OK;
}

igi_status igi_lobe_polish(igi_context *ctx, const igi_profile *f, const igi_lobe_table *t,
                           igi_lobe_estimate *e)
{
    igi_status status = IGI_OK;
    polish p = {.f = f, .t = t, .last_band = f->bands};
    int *sizes = NULL;
    double x[2] = {e->specular, log(e->alpha)}, covariance[4], jackknife[4];
    igi_least_squares_result result;
    for (int a = 0; a < FINE; a++) p.logs[a] = log((double)t->alphas[a]);
    IGI_TRY_GOTO(find_groups(ctx, f->h, f->bands, &p.begin, &sizes));
    double lower[2] = {0, p.logs[0]}, upper[2] = {1e3, p.logs[FINE - 1]};
    igi_least_squares problem = {.parameter_count = 2,
                                 .block_count = f->h->groups,
                                 .block_sizes = sizes,
                                 .residuals = group_residuals,
                                 .user = &p,
                                 .lower = lower,
                                 .upper = upper,
                                 .max_iterations = 30};
    IGI_TRY_GOTO(igi_least_squares_solve(ctx, &problem, x, covariance, &result));
    IGI_TRY_GOTO(igi_jackknife(ctx, &problem, x, f->h->piece, f->bands, jackknife));
    if (result.rank == 2 && x[0] > 0) take_out_bias(&p, covariance, result.residual_variance, x);
    e->alpha_lamp_share = lamp_share_of_alpha(&p, x[1]);
    e->specular = fmax(0, x[0]);
    e->alpha = exp(x[1]);
    e->noise_std = sqrt(covariance[0]);
    e->specular_std = sqrt(fmax(covariance[0], jackknife[0]));
    e->alpha_std = e->alpha * sqrt(fmax(covariance[3], jackknife[3]));
    for (size_t b = 0; b < f->bands && f->h->tint; b++) {
        p.first_band = b;
        p.last_band = b + 1;
        IGI_TRY_GOTO(igi_jackknife(ctx, &problem, x, f->h->piece, f->bands, jackknife));
        e->colour.std[b] = f->h->tint[b] * sqrt(fmax(covariance[0], jackknife[0]));
    }
cleanup:
    igi_free(p.begin);
    igi_free(sizes);
    return status;
}
