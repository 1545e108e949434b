/* SPDX-License-Identifier: Apache-2.0
 *
 * For a roughness alpha the photographed radiance is linear in the rest: for pixel i of group g,
 *     L_i = rho_g E_i/pi + rho_s S_i(alpha) + B_i(alpha)          per band, B = 0 but for ggx.
 * The albedos rho_g are eliminated: with weighted sums <.,.> over a group and band, and
 * x_perp = x - E <x,E>/<E,E>,
 *     rho_s(alpha) = sum <y_perp, S_perp> / sum <S_perp, S_perp>,     y = L - B,
 *     chi^2(alpha) = sum <y_perp, y_perp> - rho_s sum <y_perp, S_perp>
 * (variable projection; Golub & Pereyra 1973). chi^2 over a grid of alphas finds the basin.
 *
 * S carries noise of its own from the choice of directions. Left alone it would draw rho_s toward
 * zero (errors in variables); its variance, known from halves, is taken out of <S_perp, S_perp>.
 *
 * Noise is taken as proportional to the *predicted* radiance: weights from the noisy radiance itself
 * would favour what came out dark by chance. Residuals beyond OUTLIER_SIGMAS lose weight (Huber),
 * generously, or the highlight itself would be cut.
 */
#include "recover/lobe_fit.h"

#include <stdlib.h>
#include <string.h>

#define ALPHA_LOW 0.01
#define ALPHA_HIGH 0.5
#define GRID 20
#define OUTLIER_SIGMAS 4.0
#define ROUNDS 5

typedef struct fit {
    const igi_highlights *h;
    size_t bands, n;
    float *weight;   /* [count][bands] */
    double *sums;    /* [groups][bands][3]: <E,E>, <y,E>, <S,E> */
    double *albedo;  /* [groups][bands] of the last evaluation */
} fit;

typedef struct outcome {
    double specular, misfit;
} outcome;

typedef struct column {
    const float *scale, *base, *noise; /* of pixel 0 at this alpha; NULL: no lobe */
    size_t stride;             /* to the next pixel */
} column;

static column column_of(const fit *f, const igi_lobe_table *t, size_t a)
{
    return (column){t->scale + a * f->bands, t->base ? t->base + a * f->bands : NULL,
                    t->noise + a * f->bands, t->alpha_count * f->bands};
}

static double light_of(const fit *f, size_t k)
{
    return (double)f->h->irradiance[k] / IGI_PI;
}

/* y = L - B and S of pixel i, band b. */
static void terms(const fit *f, const column *c, size_t i, size_t b, double *y, double *s)
{
    *y = (double)f->h->radiance[i * f->bands + b];
    *s = c->scale ? (double)c->scale[i * c->stride + b] : 0;
    if (c->base) *y -= (double)c->base[i * c->stride + b];
}

static outcome evaluate(fit *f, const column *c)
{
    size_t bands = f->bands;
    double yy = 0, ys = 0, ss = 0;
    memset(f->sums, 0, f->h->groups * bands * 3 * sizeof *f->sums);
    for (size_t i = 0; i < f->n; i++)
        for (size_t b = 0; b < bands; b++) {
            double y, s, w = (double)f->weight[i * bands + b], e = light_of(f, i * bands + b);
            double *g = f->sums + (f->h->group[i] * bands + b) * 3;
            terms(f, c, i, b, &y, &s);
            yy += w * y * y;
            ys += w * y * s;
            ss += w * s * s;
            if (c->noise) ss -= w * (double)c->noise[i * c->stride + b];
            g[0] += w * e * e;
            g[1] += w * y * e;
            g[2] += w * s * e;
        }
    for (size_t k = 0; k < f->h->groups * bands; k++) {
        const double *g = f->sums + 3 * k;
        if (!(g[0] > 0)) continue;
        yy -= g[1] * g[1] / g[0];
        ys -= g[1] * g[2] / g[0];
        ss -= g[2] * g[2] / g[0];
    }
    outcome o = {ss > 0 ? fmax(0, ys / ss) : 0, 0};
    o.misfit = fmax(0, yy - 2 * o.specular * ys + o.specular * o.specular * ss);
    for (size_t k = 0; k < f->h->groups * bands; k++) {
        const double *g = f->sums + 3 * k;
        f->albedo[k] = g[0] > 0 ? fmax(0, (g[1] - o.specular * g[2]) / g[0]) : 0;
    }
    return o;
}

static double prediction(const fit *f, const column *c, double specular, size_t i, size_t b)
{
    double y, s, e = light_of(f, i * f->bands + b);
    terms(f, c, i, b, &y, &s);
    double base = (double)f->h->radiance[i * f->bands + b] - y;
    return f->albedo[f->h->group[i] * f->bands + b] * e + specular * s + base;
}

static int compare_floats(const void *a, const void *b)
{
    float x = *(const float *)a, y = *(const float *)b;
    return (x > y) - (x < y);
}

static double median_of(float *x, size_t n)
{
    if (n == 0) return 0;
    qsort(x, n, sizeof *x, compare_floats);
    return (double)x[n / 2];
}

/* Weights 1/(c prediction)^2, c the spread of relative residuals, and less for outliers. Returns c. */
static double reweigh(fit *f, const column *c, double specular, bool robust, float *scratch)
{
    size_t n = f->n * f->bands;
    double floor = 0;
    for (size_t k = 0; k < n; k++) floor += (double)f->h->radiance[k] / (double)n;
    floor *= 0.02; /* what is nearly black tells nothing more */
    for (size_t i = 0; i < f->n; i++)
        for (size_t b = 0; b < f->bands; b++) {
            double p = prediction(f, c, specular, i, b);
            double r = (double)f->h->radiance[i * f->bands + b] - p;
            scratch[i * f->bands + b] = (float)fabs(r / (fabs(p) + floor));
        }
    memcpy(scratch + n, scratch, n * sizeof *scratch);
    double noise = fmax(1e-4, 1.4826 * median_of(scratch + n, n));
    for (size_t i = 0; i < f->n; i++)
        for (size_t b = 0; b < f->bands; b++) {
            size_t k = i * f->bands + b;
            double p = fabs(prediction(f, c, specular, i, b)) + floor;
            double sigmas = (double)scratch[k] / noise;
            double huber = robust && sigmas > OUTLIER_SIGMAS ? OUTLIER_SIGMAS / sigmas : 1;
            f->weight[k] = (float)(huber / (noise * noise * p * p));
        }
    return noise;
}

/* The alpha of least misfit on the table, and where a parabola through it and its neighbours has
 * its vertex. */
static size_t best_column(fit *f, const igi_lobe_table *t, double *alpha, outcome *best)
{
    double misfit[GRID];
    size_t at = 0;
    for (size_t a = 0; a < t->alpha_count; a++) {
        column c = column_of(f, t, a);
        outcome o = evaluate(f, &c);
        misfit[a] = o.misfit;
        if (a == 0 || o.misfit < best->misfit) {
            *best = o;
            at = a;
        }
    }
    *alpha = t->alphas[at];
    if (at == 0 || at + 1 == t->alpha_count) return at;
    double left = misfit[at - 1] - misfit[at], right = misfit[at + 1] - misfit[at];
    double step = log(t->alphas[at + 1] / t->alphas[at]);
    if (left + right > 0) *alpha *= exp(0.5 * step * (left - right) / (left + right));
    return at;
}

static void spread_alphas(double low, double high, size_t count, double *alphas)
{
    for (size_t a = 0; a < count; a++)
        alphas[a] = low * pow(high / low, (double)a / (double)(count - 1));
}

/* Profile on one table: alternates weights and search. */
static igi_status search(igi_context *ctx, fit *f, igi_model model, const double *alphas,
                         size_t count, igi_lobe_estimate *e)
{
    igi_status status = IGI_OK;
    igi_lobe_table table = {.model = model};
    float *scratch = NULL;
    outcome best = {0, 0};
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 2 * f->n * f->bands, &scratch));
    IGI_TRY_GOTO(igi_lobe_table_create(ctx, f->h, model, alphas, count, &table));
    for (int round = 0; round < ROUNDS; round++) {
        size_t at = best_column(f, &table, &e->alpha, &best);
        column c = column_of(f, &table, at);
        best = evaluate(f, &c);
        e->specular = best.specular;
        e->noise = reweigh(f, &c, best.specular, round > 1, scratch);
    }
    /* with the weights of the best model, so that both are judged by one measure */
    size_t at = best_column(f, &table, &e->alpha, &best);
    column none = {NULL, NULL, NULL, 0}, c = column_of(f, &table, at);
    e->plain_misfit = evaluate(f, &none).misfit;
    e->misfit = evaluate(f, &c).misfit;
    e->specular = best.specular;
cleanup:
    igi_free(scratch);
    igi_lobe_table_clear(&table);
    return status;
}

igi_status igi_lobe_fit(igi_context *ctx, const igi_highlights *highlights, igi_model model,
                        igi_lobe_estimate *estimate)
{
    igi_status status = IGI_OK;
    double alphas[GRID];
    size_t bands = (size_t)highlights->bands, n = highlights->count;
    fit f = {.h = highlights, .bands = bands, .n = n};
    *estimate = (igi_lobe_estimate){.model = model};
    estimate->residuals = (double)(n * bands) - (double)(highlights->groups * bands) - 2;
    if (estimate->residuals < 10) return IGI_OK;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n * bands, &f.weight));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, highlights->groups * bands * 3, &f.sums));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, highlights->groups * bands, &f.albedo));
    for (size_t k = 0; k < n * bands; k++) f.weight[k] = 1;
    column none = {NULL, NULL, NULL, 0};
    (void)evaluate(&f, &none);
    float *scratch;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 2 * n * bands, &scratch));
    (void)reweigh(&f, &none, 0, false, scratch);
    igi_free(scratch);
    spread_alphas(ALPHA_LOW, ALPHA_HIGH, GRID, alphas);
    IGI_TRY_GOTO(search(ctx, &f, model, alphas, GRID, estimate));
    double width = pow(ALPHA_HIGH / ALPHA_LOW, 1.0 / (GRID - 1));
    spread_alphas(estimate->alpha / width, estimate->alpha * width, 9, alphas);
    IGI_TRY_GOTO(search(ctx, &f, model, alphas, 9, estimate));
cleanup:
    igi_free(f.weight);
    igi_free(f.sums);
    igi_free(f.albedo);
    return status;
}
