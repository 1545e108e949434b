/* SPDX-License-Identifier: Apache-2.0
 *
 * A search over a grid of roughnesses finds the basins, wherever they are; a second grid about each
 * says which is likeliest, and Ceres finds its bottom. Weights depend on the lobe that is there, and
 * with weights of its own another basin may win: each is judged by its own likelihood, not by the
 * misfits of one choice of weights. Ceres works on a table of five roughnesses about the optimum,
 * interpolated in ln alpha by Lagrange's polynomials, whose derivative is exact; the albedos are
 * eliminated inside of each residual block (lobe_profile.c). One Newton step afterwards takes out the
 * bias that the noise of S leaves, which least squares cannot express.
 */
#include "specular/lobe_fit.h"

#include "bridge/least_squares.h"
#include "specular/jackknife.h"
#include "specular/lobe_profile.h"

#include <string.h>

#define GRID IGI_TABLE_ALPHAS
#define MOST_BASINS 8
#define MOST_SHIFTS 16
#define POLISHES 3
#define NOTHING 0.5 /* of -2 ln likelihood */
#define FINE 5
#define FEWEST_RESIDUALS 10
#define FEW_RESIDUALS 500
#define FINE_RATIO 1.13
#define ROUNDS 4

/* Errors that no residual shows, by scripts/random_rooms. What a surface mirrors is known by patches
 * alone: a lobe that no lamp lights is known about so well, relatively. The rest is common to all
 * pixels of a region. */
#define BLIND_SPECULAR 0.2
#define BLIND_ALPHA 0.7
#define COMMON 0.004
/* Of a pixel's angle: a roughness as small is not known, since its square is what pixels blur. */
#define UNRESOLVED 0.3
#define SHARP_SPECULAR 0.3 /* of what the sharpness leaves open of alpha */

static void spread_alphas(double low, double high, size_t count, double *alphas)
{
    for (size_t a = 0; a < count; a++)
        alphas[a] = low * pow(high / low, (double)a / (double)(count - 1));
}

/* The column of least misfit. */
static size_t best_column(igi_profile *f, const igi_lobe_table *t, igi_profile_outcome *best)
{
    size_t at = 0;
    for (size_t a = 0; a < t->alpha_count; a++) {
        igi_profile_column c = igi_profile_column_of(f, t, a);
        igi_profile_outcome o = igi_profile_evaluate(f, &c);
        if (a > 0 && o.misfit >= best->misfit) continue;
        *best = o;
        at = a;
    }
    return at;
}

/* Alternates between the best column and the weights that it asks for. Outliers are cut only once
 * the lobe is there: before, the highlight itself is one. */
static size_t settle(igi_profile *f, const igi_lobe_table *t, igi_lobe_estimate *e)
{
    size_t at = 0;
    igi_profile_outcome best = {0, 0, 0};
    for (int round = 0; round < ROUNDS; round++) {
        at = best_column(f, t, &best);
        igi_profile_column c = igi_profile_column_of(f, t, at);
        best = igi_profile_evaluate(f, &c);
        e->deviance = igi_profile_reweigh(f, &c, best.specular, round > 0, &e->noise);
        e->deviance -= best.specular * best.specular * igi_profile_noise(f, &c);
    }
    e->specular = best.specular;
    e->alpha = (double)t->alphas[at];
    return at;
}

typedef struct polish {
    const igi_profile *f;
    const igi_lobe_table *t;
    size_t *begin; /* [groups + 1] pixels of a group */
    double logs[FINE];
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
    for (size_t b = 0; b < f->bands; b++) {
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

/* The variance of S in all, sum w noise, and its derivative. */
static mixture noise_of(const polish *p, double log_alpha)
{
    double weights[FINE], slopes[FINE];
    mixture sum = {0, 0};
    lagrange(p, log_alpha, weights, slopes);
    for (size_t i = 0; i < p->f->n; i++)
        for (size_t b = 0; b < p->f->bands; b++) {
            mixture m = mix(p, p->t->noise, i, b, weights, slopes);
            double w = (double)p->f->weight[i * p->f->bands + b];
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

static igi_status polish_with_ceres(igi_context *ctx, const igi_profile *f, const igi_lobe_table *t,
                                    igi_lobe_estimate *e)
{
    igi_status status = IGI_OK;
    polish p = {.f = f, .t = t};
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
    e->specular = fmax(0, x[0]);
    e->alpha = exp(x[1]);
    e->noise_std = sqrt(covariance[0]);
    e->specular_std = sqrt(fmax(covariance[0], jackknife[0]));
    e->alpha_std = e->alpha * sqrt(fmax(covariance[3], jackknife[3]));
cleanup:
    igi_free(p.begin);
    igi_free(sizes);
    return status;
}

/* Phong's lobe of the same width has twice the alpha. */
static double highest_alpha(igi_model model)
{
    return model == IGI_PHONG ? fmin(1, 2 * IGI_FIT_ALPHA_HIGH) : IGI_FIT_ALPHA_HIGH;
}

/* How much of <S_perp, S_perp> lamps bring, at the table's only roughness. */
static double find_lamp_share(igi_profile *f, const igi_lobe_table *one)
{
    igi_profile_column column = igi_profile_column_of(f, one, 0);
    igi_profile_column alone = {one->lamps, NULL, NULL, f->bands};
    double all = igi_profile_evaluate(f, &column).information;
    double part = igi_profile_evaluate(f, &alone).information;
    return all > 0 ? fmin(1, fmax(0, part / all)) : 0;
}

/* What the residuals do not tell; least of all about a highlight that is sharper than the pixels. */
static void widen(const igi_highlights *h, igi_lobe_estimate *e)
{
    double blind = 1 - e->lamp_share,
           sharp = pow(UNRESOLVED * (double)h->pixel_angle / e->alpha, 2);
    double specular = hypot(hypot(BLIND_SPECULAR * blind, COMMON), SHARP_SPECULAR * sharp);
    double alpha = hypot(hypot(BLIND_ALPHA * blind, COMMON), sharp);
    e->specular_std = hypot(e->specular_std, specular * e->specular);
    e->alpha_std = hypot(e->alpha_std, alpha * e->alpha);
}

/* A fine table about e->alpha, shifted until the best lies inside of it. */
static igi_status locate(igi_context *ctx, igi_profile *f, igi_model model, igi_lobe_table *table,
                         igi_lobe_estimate *e)
{
    double alphas[FINE], reach = pow(FINE_RATIO, FINE / 2), high = highest_alpha(model);
    for (int attempt = 0; attempt < MOST_SHIFTS; attempt++) {
        igi_lobe_table_clear(table);
        double centre = fmax(IGI_FIT_ALPHA_LOW, fmin(high, e->alpha));
        spread_alphas(fmax(IGI_FIT_ALPHA_LOW, centre / reach), fmin(high, centre * reach), FINE,
                      alphas);
        IGI_TRY(igi_lobe_table_create(ctx, f->h, model, alphas, FINE, table));
        size_t at = settle(f, table, e);
        e->at_bound = e->alpha >= (double)(float)high;
        bool sharpest = e->alpha <= (double)(float)IGI_FIT_ALPHA_LOW;
        if (e->at_bound || sharpest || (at > 0 && at + 1 < FINE)) break;
    }
    return IGI_OK;
}

/* Takes the polished values as long as they are the likelier ones, judged by a table of their own,
 * with the weights that they ask for. *likelier: by how much. */
static igi_status take_polished(igi_context *ctx, igi_profile *f, igi_lobe_estimate *polished,
                                igi_lobe_estimate *e, double *likelier)
{
    igi_status status = IGI_OK;
    igi_lobe_table one = {.model = e->model};
    igi_lobe_estimate now = *polished;
    IGI_TRY_GOTO(igi_lobe_table_create(ctx, f->h, e->model, &polished->alpha, 1, &one));
    (void)settle(f, &one, &now);
    *likelier = e->deviance - now.deviance;
    if (*likelier < -NOTHING) { /* the table's polynomials led astray */
        polished->alpha = e->alpha;
        polished->specular = e->specular;
        igi_lobe_table_clear(&one);
        IGI_TRY_GOTO(igi_lobe_table_create(ctx, f->h, e->model, &e->alpha, 1, &one));
        (void)settle(f, &one, &now);
    }
    now.alpha = polished->alpha;
    now.specular = polished->specular;
    for (size_t b = 0; b < f->bands; b++) now.albedo[b] = f->albedo[b];
    now.lamp_share = find_lamp_share(f, &one);
    *e = now;
cleanup:
    igi_lobe_table_clear(&one);
    return status;
}

static igi_status fit_finely(igi_context *ctx, igi_profile *f, igi_model model,
                             igi_lobe_estimate *e)
{
    igi_status status = IGI_OK;
    igi_lobe_table table = {.model = model};
    double likelier = (double)INFINITY;
    IGI_TRY_GOTO(locate(ctx, f, model, &table, e));
    for (size_t b = 0; b < f->bands; b++) e->albedo[b] = f->albedo[b];
    for (int round = 0; round < POLISHES && likelier > NOTHING && e->specular > 0; round++) {
        igi_lobe_estimate polished = *e;
        IGI_TRY_GOTO(polish_with_ceres(ctx, f, &table, &polished));
        IGI_TRY_GOTO(take_polished(ctx, f, &polished, e, &likelier));
    }
    if (e->specular > 0) widen(f->h, e);
cleanup:
    igi_lobe_table_clear(&table);
    return status;
}

typedef struct basins {
    size_t count;
    double alpha[MOST_BASINS];
} basins;

/* The deepest minima of the misfit over the columns, with the present weights, join the others. */
static void add_basins(igi_profile *f, const igi_lobe_table *t, size_t most, basins *all)
{
    double misfit[IGI_TABLE_ALPHAS];
    bool taken[IGI_TABLE_ALPHAS] = {false};
    double step = log((double)t->alphas[1] / (double)t->alphas[0]);
    for (size_t a = 0; a < t->alpha_count; a++) {
        igi_profile_column c = igi_profile_column_of(f, t, a);
        misfit[a] = igi_profile_evaluate(f, &c).misfit;
    }
    for (size_t found = 0; found < most; found++) {
        size_t best = t->alpha_count;
        for (size_t a = 0; a < t->alpha_count; a++) {
            bool lowest = (a == 0 || misfit[a] < misfit[a - 1]) &&
                          (a + 1 == t->alpha_count || misfit[a] <= misfit[a + 1]);
            if (lowest && !taken[a] && (best == t->alpha_count || misfit[a] < misfit[best]))
                best = a;
        }
        if (best == t->alpha_count) return;
        taken[best] = true;
        bool known = false; /* by itself or by its neighbour, from which the way is as short */
        for (size_t k = 0; k < all->count; k++)
            known |= fabs(log(all->alpha[k] / (double)t->alphas[best])) < 1.1 * step;
        if (!known) all->alpha[all->count++] = (double)t->alphas[best];
    }
}

static igi_status tabulate_coarsely(igi_context *ctx, const igi_profile *f, igi_model model,
                                    igi_lobe_table *table)
{
    double alphas[GRID];
    spread_alphas(IGI_FIT_ALPHA_LOW, highest_alpha(model), GRID, alphas);
    return igi_lobe_table_create(ctx, f->h, model, alphas, GRID, table);
}

/* The likeliest of the basins that are found from these weights on; whether it is likelier than
 * *best, which it then becomes. */
static igi_status search_from(igi_context *ctx, igi_profile *f, const igi_lobe_table *coarse,
                              const float *weights, igi_lobe_estimate *best, bool *better)
{
    igi_status status = IGI_OK;
    basins all = {0};
    size_t size = f->n * f->bands * sizeof *f->weight;
    igi_lobe_table fine = {.model = coarse->model};
    igi_lobe_estimate first = *best;
    size_t most = best->residuals < FEW_RESIDUALS ? MOST_BASINS / 2 : 2;
    memcpy(f->weight, weights, size);
    add_basins(f, coarse, most, &all);
    (void)settle(f, coarse, &first);
    add_basins(f, coarse, most, &all);
    for (size_t k = 0; k < all.count; k++) {
        igi_lobe_estimate trial = first;
        memcpy(f->weight, weights, size);
        trial.alpha = all.alpha[k];
        IGI_TRY_GOTO(locate(ctx, f, coarse->model, &fine, &trial));
        if (!(trial.deviance < best->deviance)) continue;
        *best = trial;
        *better = true;
    }
cleanup:
    igi_lobe_table_clear(&fine);
    return status;
}

/* e->alpha, and the weights from which it is found: those of no lobe, or all alike, whichever leads
 * to the likelier one. */
static igi_status search(igi_context *ctx, igi_profile *f, igi_model model, igi_lobe_estimate *e)
{
    igi_status status = IGI_OK;
    size_t n = f->n * f->bands;
    igi_lobe_table coarse = {.model = model};
    float *plain = NULL;
    bool better = false;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 2 * n, &plain));
    float *alike = plain + n;
    memcpy(plain, f->weight, n * sizeof *plain);
    for (size_t k = 0; k < n; k++) alike[k] = 1;
    IGI_TRY_GOTO(tabulate_coarsely(ctx, f, model, &coarse));
    e->deviance = (double)INFINITY;
    IGI_TRY_GOTO(search_from(ctx, f, &coarse, plain, e, &better));
    better = false;
    if (e->residuals < FEW_RESIDUALS) /* more of them lead from anywhere to the same weights */
        IGI_TRY_GOTO(search_from(ctx, f, &coarse, alike, e, &better));
    memcpy(f->weight, better ? alike : plain, n * sizeof *plain);
cleanup:
    igi_lobe_table_clear(&coarse);
    igi_free(plain);
    return status;
}

/* What no lobe at all leaves; false: there is too little to judge by. */
static bool judge_plain(igi_profile *f, igi_model model, igi_lobe_estimate *estimate)
{
    size_t unknowns = f->h->groups * f->bands + 2;
    *estimate = (igi_lobe_estimate){.model = model, .at_bound = true};
    estimate->residuals = (double)(f->n * f->bands) - (double)unknowns;
    if (estimate->residuals < FEWEST_RESIDUALS) return false;
    igi_profile_column none = {NULL, NULL, NULL, 0};
    for (int round = 0; round < 2; round++) {
        (void)igi_profile_evaluate(f, &none);
        estimate->plain_deviance = igi_profile_reweigh(f, &none, 0, false, &estimate->noise);
    }
    estimate->plain_noise = estimate->noise;
    return true;
}

igi_status igi_lobe_glance(igi_context *ctx, const igi_highlights *highlights, igi_model model,
                           igi_lobe_estimate *estimate)
{
    igi_profile f;
    IGI_TRY(igi_profile_create(ctx, highlights, &f));
    igi_status status = IGI_OK;
    igi_lobe_table table = {.model = model};
    if (!judge_plain(&f, model, estimate)) goto cleanup;
    IGI_TRY_GOTO(tabulate_coarsely(ctx, &f, model, &table));
    (void)settle(&f, &table, estimate);
    if (estimate->deviance > estimate->plain_deviance) { /* hardly the best that there is */
        (void)judge_plain(&f, model, estimate);
        IGI_TRY_GOTO(search(ctx, &f, model, estimate));
    }
cleanup:
    igi_lobe_table_clear(&table);
    igi_profile_clear(&f);
    return status;
}

igi_status igi_lobe_fit(igi_context *ctx, const igi_highlights *highlights, igi_model model,
                        double near_alpha, igi_lobe_estimate *estimate)
{
    igi_status status = IGI_OK;
    igi_profile f;
    IGI_TRY(igi_profile_create(ctx, highlights, &f));
    if (!judge_plain(&f, model, estimate)) goto cleanup;
    estimate->alpha = near_alpha;
    if (!(near_alpha > 0)) IGI_TRY_GOTO(search(ctx, &f, model, estimate));
    IGI_TRY_GOTO(fit_finely(ctx, &f, model, estimate));
cleanup:
    igi_profile_clear(&f);
    return status;
}
