/* SPDX-License-Identifier: Apache-2.0
 *
 * One lobe for all points of a region: minimise over rho_d (per band), rho_s and alpha
 *     sum_p sum_b w_pb (L_pb - rho_d,b E_pb/pi - rho_s S_pb(alpha))^2
 * For a given alpha the model is linear and solved at once; alpha is searched for on a grid of its
 * logarithm, then by golden section. Weights are one over the square of the prediction, cut down for
 * residuals beyond three of their medians (Huber), and found anew a few times.
 */
#include "specular/yu99.h"

#include "base/order.h"
#include "brdf/brdf.h"

#include <stdlib.h>

#define GRID 20
#define GOLDEN_STEPS 8
#define REWEIGHTINGS 4
#define LOW_ALPHA 0.01
#define HIGH_ALPHA 0.6
/* Below this many standard deviations, or without this share of the squares explained, the region
 * is left without a lobe. */
#define CERTAIN_SIGMAS 4.0
#define EXPLAINED 0.1

typedef struct fitter {
    const igi_yu99_samples *samples;
    size_t values;  /* count * bands */
    double *table;  /* [GRID + 1][values] S on the grid; the last row for any alpha */
    double *weight; /* [values] */
    double *scaled; /* [2][values] scratch */
} fitter;

typedef struct trial {
    double albedo[IGI_MAX_BANDS], specular, squares, log_alpha;
} trial;

static double grid_alpha(int k)
{
    return log(LOW_ALPHA) + k * log(HIGH_ALPHA / LOW_ALPHA) / (GRID - 1);
}

/* S of one point, per band. */
static void add_links(const igi_yu99_samples *s, size_t point, float alpha, double *sum)
{
    float scale, base;
    for (int b = 0; b < s->bands; b++) sum[b] = 0;
    for (size_t k = 0; k < s->links; k++) {
        const igi_yu99_link *link = &s->link[point * s->links + k];
        if (!(link->weight > 0)) continue;
        igi_lobe_terms(IGI_WARD, alpha, link->in, s->out[point], &scale, &base);
        for (int b = 0; b < s->bands; b++)
            sum[b] += (double)(link->weight * scale * link->incident[b]);
    }
}

/* S of all points into `lobe`. */
static void fill_lobe(const fitter *f, double log_alpha, double *lobe)
{
    const igi_yu99_samples *s = f->samples;
    for (size_t i = 0; i < s->count; i++)
        add_links(s, i, (float)exp(log_alpha), lobe + i * (size_t)s->bands);
}

/* The linear part, rho_s >= 0, with S as in `lobe`; NULL: rho_s = 0. */
static trial solve(const fitter *f, double log_alpha, const double *lobe)
{
    const igi_yu99_samples *s = f->samples;
    size_t bands = (size_t)s->bands;
    double ee[IGI_MAX_BANDS] = {0}, es[IGI_MAX_BANDS] = {0}, el[IGI_MAX_BANDS] = {0};
    double ss = 0, sl = 0;
    trial t = {.log_alpha = log_alpha};
    for (size_t i = 0; i < f->values; i++) {
        double e = (double)s->irradiance[i] / IGI_PI, l = (double)s->radiance[i];
        double w = f->weight[i], gloss = lobe ? lobe[i] : 0;
        ee[i % bands] += w * e * e;
        es[i % bands] += w * e * gloss;
        el[i % bands] += w * e * l;
        ss += w * gloss * gloss;
        sl += w * gloss * l;
    }
    for (size_t b = 0; b < bands; b++) {
        if (!(ee[b] > 0)) continue;
        ss -= es[b] * es[b] / ee[b];
        sl -= es[b] * el[b] / ee[b];
    }
    if (ss > 0) t.specular = fmax(0, sl / ss);
    for (size_t b = 0; b < bands; b++)
        if (ee[b] > 0) t.albedo[b] = fmax(0, (el[b] - t.specular * es[b]) / ee[b]);
    for (size_t i = 0; i < f->values; i++) {
        double diffuse = t.albedo[i % bands] * (double)s->irradiance[i] / IGI_PI;
        double r = (double)s->radiance[i] - diffuse - (lobe ? t.specular * lobe[i] : 0);
        t.squares += f->weight[i] * r * r;
    }
    return t;
}

static trial solve_at(const fitter *f, double log_alpha)
{
    double *lobe = f->table + GRID * f->values;
    fill_lobe(f, log_alpha, lobe);
    return solve(f, log_alpha, lobe);
}

static trial search_grid(const fitter *f)
{
    trial best = {.squares = HUGE_VAL};
    for (int k = 0; k < GRID; k++) {
        trial t = solve(f, grid_alpha(k), f->table + (size_t)k * f->values);
        if (t.squares < best.squares) best = t;
    }
    return best;
}

static trial polish(const fitter *f, trial best)
{
    const double golden = 0.6180339887498949;
    double step = grid_alpha(1) - grid_alpha(0);
    double low = fmax(best.log_alpha - step, grid_alpha(0));
    double high = fmin(best.log_alpha + step, grid_alpha(GRID - 1));
    for (int k = 0; k < GOLDEN_STEPS; k++) {
        trial a = solve_at(f, high - golden * (high - low));
        trial b = solve_at(f, low + golden * (high - low));
        if (a.squares < b.squares) high = b.log_alpha;
        else low = a.log_alpha;
        if (a.squares < best.squares) best = a;
        if (b.squares < best.squares) best = b;
    }
    return best;
}

/* New weights from the residuals of `t`. */
static void reweight(const fitter *f, const trial *t)
{
    const igi_yu99_samples *s = f->samples;
    size_t bands = (size_t)s->bands;
    double mean = 0, *lobe = f->table + GRID * f->values, *residual = f->scaled + f->values;
    fill_lobe(f, t->log_alpha, lobe);
    for (size_t i = 0; i < f->values; i++) mean += (double)s->radiance[i] / (double)f->values;
    for (size_t i = 0; i < f->values; i++) {
        double predicted = t->albedo[i % bands] * (double)s->irradiance[i] / IGI_PI +
                           t->specular * lobe[i];
        double scale = fmax(predicted, 0.05 * mean);
        f->weight[i] = 1 / (scale * scale);
        f->scaled[i] = residual[i] = fabs((double)s->radiance[i] - predicted) / scale;
    }
    double limit = 3 * 1.4826 * igi_median(f->scaled, f->values);
    for (size_t i = 0; i < f->values && limit > 0; i++)
        if (residual[i] > limit) f->weight[i] *= limit / residual[i];
}

/* Curvature of the sum of squares about the best trial, by differences in rho_s and log alpha. */
static void find_deviations(const fitter *f, const trial *best, igi_lobe_estimate *fit)
{
    double freedom = (double)f->values - (double)f->samples->bands - 2, h = 0.05;
    if (freedom < 1) return;
    trial low = solve_at(f, best->log_alpha - h), high = solve_at(f, best->log_alpha + h);
    double noise = best->squares / freedom;
    double bend = (low.squares - 2 * best->squares + high.squares) / (h * h) / 2;
    double slope = (high.specular - low.specular) / (2 * h); /* of rho_s along the valley */
    double log_alpha_std = bend > 0 ? sqrt(noise / bend) : 1;
    trial plain = solve(f, best->log_alpha, NULL);
    double gain = plain.squares - best->squares; /* rho_s^2 ss, ss being its curvature */
    double across = gain > 0 ? best->specular * sqrt(noise / gain) : best->specular;
    fit->alpha_std = fit->alpha * fmin(log_alpha_std, 1);
    fit->specular_std = hypot(across, slope * fmin(log_alpha_std, 1));
    if (gain < EXPLAINED * plain.squares || best->specular < CERTAIN_SIGMAS * across)
        fit->model = IGI_LAMBERT;
}

igi_status igi_yu99_fit_lobe(igi_context *ctx, const igi_yu99_samples *samples,
                             igi_lobe_estimate *fit)
{
    igi_status status = IGI_OK;
    fitter f = {.samples = samples, .values = samples->count * (size_t)samples->bands};
    *fit = (igi_lobe_estimate){.model = IGI_LAMBERT};
    if (samples->count < 8) return IGI_OK;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, (GRID + 1) * f.values, &f.table));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, f.values, &f.weight));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 2 * f.values, &f.scaled));
    for (int k = 0; k < GRID; k++) fill_lobe(&f, grid_alpha(k), f.table + (size_t)k * f.values);
    for (size_t i = 0; i < f.values; i++) f.weight[i] = 1;
    trial best = solve(&f, log(0.1), NULL);
    for (int k = 0; k < REWEIGHTINGS; k++) {
        reweight(&f, &best);
        best = search_grid(&f);
    }
    best = polish(&f, best);
    fit->specular = best.specular;
    fit->alpha = exp(best.log_alpha);
    fit->model = IGI_WARD;
    find_deviations(&f, &best, fit);
cleanup:
    igi_free(f.table);
    igi_free(f.weight);
    igi_free(f.scaled);
    return status;
}

bool igi_yu99_albedo(const igi_yu99_samples *samples, const igi_lobe *lobe,
                     double albedo[IGI_MAX_BANDS], double albedo_std[IGI_MAX_BANDS])
{
    const igi_yu99_samples *s = samples;
    size_t bands = (size_t)s->bands;
    double gloss[IGI_MAX_BANDS] = {0}, sent[IGI_MAX_BANDS] = {0}, received[IGI_MAX_BANDS] = {0};
    double ss[IGI_MAX_BANDS] = {0}, sr[IGI_MAX_BANDS] = {0}, rr[IGI_MAX_BANDS] = {0};
    for (size_t i = 0; i < s->count; i++) {
        if (lobe->model != IGI_LAMBERT) add_links(s, i, lobe->alpha, gloss);
        for (size_t b = 0; b < bands; b++) {
            double e = (double)s->irradiance[i * bands + b];
            double m = IGI_PI *
                       ((double)s->radiance[i * bands + b] - (double)lobe->specular[b] * gloss[b]);
            sent[b] += m;
            received[b] += e;
            ss[b] += m * m;
            sr[b] += m * e;
            rr[b] += e * e;
        }
    }
    for (size_t b = 0; b < bands; b++) {
        if (!(received[b] > 0)) return false;
        albedo[b] = fmax(0, sent[b] / received[b]);
        /* sum of (m - rho e)^2, the spread of a ratio estimator */
        double squares = ss[b] - 2 * albedo[b] * sr[b] + albedo[b] * albedo[b] * rr[b];
        albedo_std[b] = sqrt(fmax(0, squares)) / received[b];
    }
    return true;
}
