/* SPDX-License-Identifier: Apache-2.0
 *
 * For a roughness alpha the specular coefficient and its variance are
 *     rho = <y_perp, S_perp> / <S_perp, S_perp>,    var = sum_c g_c^2 / <S_perp, S_perp>^2,
 * g_c the part of <y_perp, S_perp> that comes from piece c of the surface: errors of the irradiance
 * are alike within a piece. rho + 1.645 sigma is an upper bound; the largest over alpha is stated.
 * A lobe of rho would take rho <S,E>/<y,E> off the albedo: the root of its mean square, a share of the
 * albedo that may not be albedo. The mean is over what may be there: no lobe, or one of these alpha
 * with a coefficient from a half-normal distribution, each weighed by how well it explains the pixels.
 */
#include "specular/lobe_doubt.h"

#include "specular/lobe_profile.h"

#include <stdlib.h>
#include <string.h>

#define ALPHAS 6
#define FEWEST 10
#define SHINING 0.5 /* share of surfaces that have a lobe, before one has looked */
#define USUAL 0.1   /* and the width of their coefficients' distribution */
#define SURE 300.0  /* logarithm of odds that nothing can weigh up */
#define FLAT 1e3    /* a coefficient's standard deviation where nothing tells of it */

typedef struct term {
    uint32_t piece;
    double gradient;
} term;

static int compare_terms(const void *a, const void *b)
{
    uint32_t x = ((const term *)a)->piece, y = ((const term *)b)->piece;
    return (x > y) - (x < y);
}

/* sum_c g_c^2 of the last evaluation, about `specular`. */
static double scatter(const igi_profile *f, const igi_profile_column *c, double specular,
                      term *terms)
{
    for (size_t i = 0; i < f->n; i++) {
        terms[i] = (term){f->h->piece[i], 0};
        for (size_t b = 0; b < f->bands; b++) {
            size_t k = i * f->bands + b, group = f->h->group[i] * f->bands + b;
            const double *g = f->sums + 3 * group;
            if (!(g[0] > 0)) continue;
            double e = (double)f->h->irradiance[k] / IGI_PI;
            double s = (double)c->scale[i * c->stride + b] - e * g[2] / g[0];
            double y = (double)f->h->radiance[k] - e * g[1] / g[0];
            terms[i].gradient += (double)f->weight[k] * s * (y - specular * s);
        }
    }
    qsort(terms, f->n, sizeof *terms, compare_terms);
    double sum = 0, piece = 0;
    for (size_t i = 0; i < f->n; i++) {
        piece += terms[i].gradient;
        if (i + 1 < f->n && terms[i + 1].piece == terms[i].piece) continue;
        sum += piece * piece;
        piece = 0;
    }
    return sum;
}

/* <S,E>/<y,E> of a band over all groups: what a coefficient of 1 takes off the albedo, as a share. */
static double taken(const igi_profile *f, size_t band)
{
    double s = 0, y = 0;
    for (size_t g = 0; g < f->h->groups; g++) {
        const double *sums = f->sums + (g * f->bands + band) * 3;
        s += sums[2];
        y += sums[1];
    }
    return y > 0 ? s / y : 0;
}

/* What the pixels and the prior say of lobes of one roughness. */
typedef struct posterior {
    double odds;   /* that there is one, before it is asked how many surfaces have one */
    double square; /* mean square of its coefficient if there is */
} posterior;

/* Of N(mean, sigma^2) and a half-normal prior of width USUAL. */
static posterior weigh(double mean, double sigma)
{
    double narrow = 1 / sqrt(1 / (sigma * sigma) + 1 / (USUAL * USUAL));
    double m = narrow * narrow * mean / (sigma * sigma), z = m / narrow;
    double inside = erfc(-z / sqrt(2)) / 2, density = exp(-z * z / 2) / sqrt(2 * IGI_PI);
    return (posterior){.odds = 2 * narrow / USUAL * inside * exp(fmin(z * z / 2, SURE)),
                       .square = m * m + narrow * narrow + m * narrow * density / inside};
}

static void judge(igi_profile *f, const igi_lobe_table *t, term *terms, igi_lobe_doubt *doubt)
{
    double all = 0;
    memset(doubt, 0, sizeof *doubt);
    for (size_t a = 0; a < ALPHAS; a++) {
        igi_profile_column c = igi_profile_column_of(f, t, a);
        igi_profile_outcome o = igi_profile_evaluate(f, &c);
        double sum = scatter(f, &c, o.specular, terms), sigma = FLAT;
        if (o.information > 0) sigma = fmin(FLAT, sqrt(fmax(o.information, sum)) / o.information);
        posterior p = weigh(o.specular, sigma);
        all += p.odds / ALPHAS;
        for (size_t b = 0; b < f->bands; b++)
            doubt->share[b] += p.odds / ALPHAS * p.square * pow(taken(f, b), 2);
        if (t->alphas[a] <= IGI_BOUND_ALPHA)
            doubt->bound = fmax(doubt->bound, fmin(1, o.specular + IGI_BOUND_SIGMAS * sigma));
    }
    for (size_t b = 0; b < f->bands; b++)
        doubt->share[b] = fmin(1, sqrt(doubt->share[b] * SHINING / (1 - SHINING + SHINING * all)));
}

igi_status igi_lobe_doubt_create(igi_context *ctx, const igi_highlights *highlights,
                                 igi_lobe_doubt *doubt)
{
    static const double alphas[ALPHAS] = {0.03, 0.06, 0.1, 0.18, 0.3, 0.5};
    igi_status status = IGI_OK;
    igi_profile f;
    igi_lobe_table table = {.model = IGI_WARD};
    term *terms = NULL;
    *doubt = (igi_lobe_doubt){.bound = 1};
    IGI_TRY(igi_profile_create(ctx, highlights, &f));
    if (f.n < FEWEST) goto cleanup;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, f.n, &terms));
    igi_profile_column none = {NULL, NULL, NULL, 0};
    double noise;
    for (int round = 0; round < 2; round++) {
        (void)igi_profile_evaluate(&f, &none);
        (void)igi_profile_reweigh(&f, &none, 0, false, &noise);
    }
    IGI_TRY_GOTO(igi_lobe_table_create(ctx, highlights, IGI_WARD, alphas, ALPHAS, &table));
    judge(&f, &table, terms, doubt);
cleanup:
    igi_lobe_table_clear(&table);
    igi_free(terms);
    igi_profile_clear(&f);
    return status;
}
