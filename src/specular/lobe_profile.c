/* SPDX-License-Identifier: Apache-2.0
 *
 * For a roughness alpha the photographed radiance is linear in the rest: for pixel i of group g,
 *     L_i = rho_g E_i/pi + rho_s S_i(alpha) + B_i(alpha)          per band, B = 0 but for ggx.
 * The albedos rho_g are eliminated: with weighted sums <.,.> over a group and band, and
 * x_perp = x - E <x,E>/<E,E>,
 *     rho_s(alpha) = sum <y_perp, S_perp> / sum <S_perp, S_perp>,     y = L - B,
 *     chi^2(alpha) = sum <y_perp, y_perp> - rho_s sum <y_perp, S_perp>
 * (variable projection; Golub & Pereyra 1973).
 *
 * S carries noise of its own from the choice of directions. Left alone it would draw rho_s toward
 * zero (errors in variables), or up where weights follow S (bias_of); its variance, known from halves, is
 * taken out of <S_perp, S_perp>.
 *
 * Noise is taken as proportional to the *predicted* radiance: weights from the noisy radiance itself
 * would favour what came out dark by chance. Residuals beyond OUTLIER_SIGMAS lose weight (Huber),
 * generously, or the highlight itself would be cut.
 */
#include "specular/lobe_profile.h"

#include <stddef.h>
#include <string.h>

#define OUTLIER_SIGMAS 4.0
/* Added to every prediction, as a share of the mean: what is nearly black tells nothing more. */
#define DARK_SHARE 0.02

igi_status igi_profile_create(igi_context *ctx, const igi_highlights *highlights,
                              igi_profile *profile)
{
    size_t bands = (size_t)highlights->bands, n = highlights->count;
    igi_status status = IGI_OK;
    *profile = (igi_profile){.h = highlights, .bands = bands, .n = n};
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n * bands, &profile->weight));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n * bands, &profile->start));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n * bands, &profile->bias));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 2 * n * bands, &profile->scratch));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, highlights->groups * bands * 3, &profile->sums));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, highlights->groups * bands, &profile->albedo));
    for (size_t k = 0; k < n * bands; k++) profile->weight[k] = profile->bias[k] = 1;
cleanup:
    if (status != IGI_OK) igi_profile_clear(profile);
    return status;
}

void igi_profile_clear(igi_profile *profile)
{
    igi_free(profile->weight);
    igi_free(profile->start);
    igi_free(profile->bias);
    igi_free(profile->scratch);
    igi_free(profile->sums);
    igi_free(profile->albedo);
    *profile = (igi_profile){0};
}

igi_profile_column igi_profile_column_of(const igi_profile *profile, const igi_lobe_table *table,
                                         size_t alpha)
{
    size_t at = alpha * profile->bands;
    return (igi_profile_column){table->scale + at, table->base ? table->base + at : NULL,
                                table->noise + at, table->alpha_count * profile->bands};
}

static double diffuse_unit(const igi_profile *f, size_t k)
{
    return (double)f->h->irradiance[k] / IGI_PI;
}

/* y = L - B and S of pixel i, band b. */
static void terms(const igi_profile *f, const igi_profile_column *c, size_t i, size_t b, double *y,
                  double *s)
{
    *y = (double)f->h->radiance[i * f->bands + b];
    *s = c->scale ? (double)c->scale[i * c->stride + b] : 0;
    if (c->base) *y -= (double)c->base[i * c->stride + b];
}

igi_profile_outcome igi_profile_evaluate(igi_profile *profile, const igi_profile_column *column)
{
    const igi_profile *f = profile;
    const igi_profile_column *c = column;
    size_t bands = f->bands, sums = f->h->groups * bands;
    double yy = 0, ys = 0, ss = 0, noise = 0, bias = 0;
    memset(f->sums, 0, sums * 3 * sizeof *f->sums);
    for (size_t i = 0; i < f->n; i++)
        for (size_t b = 0; b < bands; b++) {
            double y, s, w = (double)f->weight[i * bands + b], e = diffuse_unit(f, i * bands + b);
            double *g = f->sums + (f->h->group[i] * bands + b) * 3;
            terms(f, c, i, b, &y, &s);
            yy += w * y * y;
            ys += w * y * s;
            ss += w * s * s;
            double variance = c->noise ? w * (double)c->noise[i * c->stride + b] : 0;
            noise += variance;
            bias += variance * (double)f->bias[i * bands + b];
            g[0] += w * e * e;
            g[1] += w * y * e;
            g[2] += w * s * e;
        }
    for (size_t k = 0; k < sums; k++) {
        const double *g = f->sums + 3 * k;
        if (!(g[0] > 0)) continue;
        yy -= g[1] * g[1] / g[0];
        ys -= g[1] * g[2] / g[0];
        ss -= g[2] * g[2] / g[0];
    }
    igi_profile_outcome o = {ss > bias ? fmax(0, ys / (ss - bias)) : 0, 0, ss - noise};
    o.misfit = fmax(0, yy - 2 * o.specular * ys + o.specular * o.specular * (ss - noise));
    for (size_t k = 0; k < sums; k++) {
        const double *g = f->sums + 3 * k;
        f->albedo[k] = g[0] > 0 ? fmax(0, (g[1] - o.specular * g[2]) / g[0]) : 0;
    }
    return o;
}

double igi_profile_noise(const igi_profile *profile, const igi_profile_column *column)
{
    double sum = 0;
    for (size_t i = 0; column->noise && i < profile->n; i++)
        for (size_t b = 0; b < profile->bands; b++)
            sum += (double)profile->weight[i * profile->bands + b] *
                   (double)column->noise[i * column->stride + b];
    return sum;
}

static double prediction(const igi_profile *f, const igi_profile_column *c, double specular,
                         size_t i, size_t b)
{
    double y, s;
    terms(f, c, i, b, &y, &s);
    double base = (double)f->h->radiance[i * f->bands + b] - y;
    return f->albedo[f->h->group[i] * f->bands + b] * diffuse_unit(f, i * f->bands + b) +
           specular * s + base;
}

/* A weight 1/p^2 that knows S by its prediction p is low where S came out high by chance: of the noise's
 * effect on rho_s, -<w noise>, that takes back 2 rho_s S_perp/p. */
static float bias_of(const igi_profile *f, const igi_profile_column *c, double specular, size_t k)
{
    if (!c->noise) return 1;
    size_t i = k / f->bands, b = k % f->bands;
    const double *g = f->sums + 3 * (f->h->group[i] * f->bands + b);
    double s = (double)c->scale[i * c->stride + b];
    if (g[0] > 0) s -= diffuse_unit(f, k) * g[2] / g[0];
    return (float)(1 - 2 * specular * s / (double)f->weight[k]);
}

/* The upper median, by Hoare's FIND in Wirth's form (1976): the rest need not be sorted. */
static double median_of(float *x, size_t n)
{
    ptrdiff_t low = 0, high = (ptrdiff_t)n - 1, middle = (ptrdiff_t)(n / 2);
    while (low < high) {
        float pivot = x[middle];
        ptrdiff_t i = low, j = high;
        do {
            while (x[i] < pivot) i++;
            while (pivot < x[j]) j--;
            if (i > j) break;
            float kept = x[i];
            x[i++] = x[j];
            x[j--] = kept;
        } while (i <= j);
        if (j < middle) low = i;
        if (middle < i) high = j;
    }
    return n > 0 ? (double)x[middle] : 0;
}

static double loss_of(double sigmas)
{
    return sigmas > OUTLIER_SIGMAS ? OUTLIER_SIGMAS * sigmas : sigmas * sigmas;
}

/* The scale of residuals that makes them likeliest, from the median's on. Two explanations compare
 * fairly only at their own best: judged by its median, one that is good but for a tenth of the pixels
 * (a mirror of things known coarsely) comes out behind one that is bad everywhere. */
static double likeliest_scale(const float *residuals, size_t n, double scale)
{
    for (int round = 0; round < 6 && n > 0; round++) {
        double sum = 0;
        for (size_t k = 0; k < n; k++) sum += loss_of((double)residuals[k] / scale);
        scale *= sqrt(fmin(16, fmax(1.0 / 16, sum / (double)n)));
    }
    return fmax(1e-4, scale);
}

double igi_profile_reweigh(igi_profile *profile, const igi_profile_column *column, double specular,
                           bool robust, double *noise)
{
    const igi_profile *f = profile;
    size_t n = f->n * f->bands;
    double floor = 0, deviance = 0;
    for (size_t k = 0; k < n; k++) floor += DARK_SHARE * (double)f->h->radiance[k] / (double)n;
    for (size_t k = 0; k < n; k++) {
        double p = prediction(f, column, specular, k / f->bands, k % f->bands);
        f->weight[k] = (float)(fabs(p) + floor); /* for a moment: the predicted noise's unit */
        f->scratch[k] = (float)(fabs((double)f->h->radiance[k] - p) / (double)f->weight[k]);
        f->bias[k] = bias_of(f, column, specular, k);
    }
    memcpy(f->scratch + n, f->scratch, n * sizeof *f->scratch);
    *noise = fmax(1e-4, 1.4826 * median_of(f->scratch + n, n));
    double scale = likeliest_scale(f->scratch, n, *noise);
    for (size_t k = 0; k < n; k++) {
        double sigmas = (double)f->scratch[k] / *noise, sigma = *noise * (double)f->weight[k];
        double huber = sigmas > OUTLIER_SIGMAS ? OUTLIER_SIGMAS / sigmas : 1;
        deviance += loss_of((double)f->scratch[k] / scale) + 2 * log(scale * (double)f->weight[k]);
        f->weight[k] = (float)((robust ? huber : 1) / (sigma * sigma));
    }
    return deviance;
}
