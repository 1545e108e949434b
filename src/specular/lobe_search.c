/* SPDX-License-Identifier: Apache-2.0
 *
 * A grid of roughnesses finds the basins, wherever they are; a second, finer grid about each says
 * which is likeliest. Weights depend on the lobe that is there, and with weights of its own another
 * basin may win: each is judged by its own likelihood, not by the misfits of one choice of weights.
 *
 * With few residuals this holds for the roughnesses within a basin too: weights that suit one cut
 * just those residuals off that tell of its neighbours, and the likelihood may have dips that are
 * narrower than any grid. There each roughness gets weights of its own, and grids are refined until
 * neighbours differ by little.
 */
#include "specular/lobe_search.h"

#include "specular/lobe_polish.h"

#include <string.h>

#define GRID IGI_TABLE_ALPHAS
#define FINE IGI_POLISH_ALPHAS
#define MOST_BASINS 8
#define MOST_SHIFTS 16
#define FEW_RESIDUALS 500
#define FINE_RATIO 1.13
#define FINER_RATIO 1.02 /* to tell basins apart */
#define FINER 0.35       /* of what a ratio is above 1 */
#define ROUNDS 4
#define SETTLED 0.01 /* of -2 ln likelihood */

static void spread_alphas(double low, double high, size_t count, double *alphas)
{
    for (size_t a = 0; a < count; a++)
        alphas[a] = low * pow(high / low, (double)a / (double)(count - 1));
}

static bool is_small(const igi_lobe_estimate *e)
{
    return e->residuals < FEW_RESIDUALS;
}

/* The column of least misfit. */
static size_t best_column(igi_profile *f, const igi_lobe_table *t)
{
    size_t at = 0;
    double best = (double)INFINITY;
    for (size_t a = 0; a < t->alpha_count; a++) {
        igi_profile_column c = igi_profile_column_of(f, t, a);
        double misfit = igi_profile_evaluate(f, &c).misfit;
        if (a > 0 && misfit >= best) continue;
        best = misfit;
        at = a;
    }
    return at;
}

/* The weights that a column asks for. Outliers are cut only once the lobe is there: before, the
 * highlight itself is one. */
static void reweigh(igi_profile *f, const igi_lobe_table *t, size_t at, int round,
                    igi_lobe_estimate *e)
{
    igi_profile_column c = igi_profile_column_of(f, t, at);
    e->specular = igi_profile_evaluate(f, &c).specular;
    e->alpha = (double)t->alphas[at];
    e->deviance = igi_profile_reweigh(f, &c, e->specular, round > 0, &e->noise);
    e->excused = e->specular * e->specular * igi_profile_noise(f, &c);
    e->deviance -= e->excused;
}

static void begin_anew(igi_profile *f)
{
    memcpy(f->weight, f->start, f->n * f->bands * sizeof *f->weight);
    for (size_t k = 0; k < f->n * f->bands; k++) f->bias[k] = 1;
}

/* One column alone, from the profile's first weights on. */
static void settle_at(igi_profile *f, const igi_lobe_table *t, size_t at, igi_lobe_estimate *e)
{
    begin_anew(f);
    double before = (double)INFINITY;
    for (int round = 0; round < ROUNDS; round++) {
        reweigh(f, t, at, round, e);
        if (round > 1 && fabs(before - e->deviance) < SETTLED) break;
        before = e->deviance;
    }
}

/* The likeliest column, each with weights of its own. */
static size_t settle_each(igi_profile *f, const igi_lobe_table *t, double *deviance,
                          igi_lobe_estimate *e)
{
    size_t best = 0;
    for (size_t a = 0; a < t->alpha_count; a++) {
        settle_at(f, t, a, e);
        deviance[a] = e->deviance;
        if (deviance[a] < deviance[best]) best = a;
    }
    settle_at(f, t, best, e);
    return best;
}

size_t igi_lobe_settle(igi_profile *f, const igi_lobe_table *t, igi_lobe_estimate *e)
{
    size_t at = 0;
    double deviance[IGI_TABLE_ALPHAS];
    if (is_small(e)) return settle_each(f, t, deviance, e);
    for (int round = 0; round < ROUNDS; round++) {
        at = best_column(f, t);
        reweigh(f, t, at, round, e);
    }
    return at;
}

/* Phong's lobe of the same width has twice the alpha. */
static double highest_alpha(igi_model model)
{
    return model == IGI_PHONG ? fmin(1, 2 * IGI_FIT_ALPHA_HIGH) : IGI_FIT_ALPHA_HIGH;
}

igi_status igi_lobe_locate(igi_context *ctx, igi_profile *f, igi_model model, double finest,
                           igi_lobe_table *table, igi_lobe_estimate *e)
{
    double alphas[FINE], ratio = FINE_RATIO, high = highest_alpha(model);
    for (int attempt = 0; attempt < MOST_SHIFTS; attempt++) {
        double centre = fmax(IGI_FIT_ALPHA_LOW, fmin(high, e->alpha)), reach = pow(ratio, FINE / 2);
        igi_lobe_table_clear(table);
        spread_alphas(fmax(IGI_FIT_ALPHA_LOW, centre / reach), fmin(high, centre * reach), FINE,
                      alphas);
        IGI_TRY(igi_lobe_table_create(ctx, f->h, model, alphas, FINE, table));
        size_t at = igi_lobe_settle(f, table, e);
        e->at_bound = e->alpha >= (double)(float)high;
        bool sharpest = e->alpha <= (double)(float)IGI_FIT_ALPHA_LOW;
        bool inside = at > 0 && at + 1 < FINE;
        if (!e->at_bound && !sharpest && !inside) continue;
        if (!is_small(e) || ratio < finest) break;
        ratio = 1 + FINER * (ratio - 1);
    }
    return IGI_OK;
}

typedef struct basins {
    size_t count;
    double alpha[MOST_BASINS];
} basins;

/* The deepest minima over the columns join the others. */
static void add_basins(const igi_lobe_table *t, const double *depth, size_t most, basins *all)
{
    bool taken[IGI_TABLE_ALPHAS] = {false};
    double step = log((double)t->alphas[1] / (double)t->alphas[0]);
    for (size_t found = 0; found < most; found++) {
        size_t best = t->alpha_count;
        for (size_t a = 0; a < t->alpha_count; a++) {
            bool lowest = (a == 0 || depth[a] < depth[a - 1]) &&
                          (a + 1 == t->alpha_count || depth[a] <= depth[a + 1]);
            if (lowest && !taken[a] && (best == t->alpha_count || depth[a] < depth[best])) best = a;
        }
        if (best == t->alpha_count) return;
        taken[best] = true;
        bool known = false; /* by itself or by its neighbour, from which the way is as short */
        for (size_t k = 0; k < all->count; k++)
            known |= fabs(log(all->alpha[k] / (double)t->alphas[best])) < 1.1 * step;
        if (!known) all->alpha[all->count++] = (double)t->alphas[best];
    }
}

static void find_misfits(igi_profile *f, const igi_lobe_table *t, double *misfit)
{
    for (size_t a = 0; a < t->alpha_count; a++) {
        igi_profile_column c = igi_profile_column_of(f, t, a);
        misfit[a] = igi_profile_evaluate(f, &c).misfit;
    }
}

/* Basins that are found from the present weights on. */
static void find_basins(igi_profile *f, const igi_lobe_table *t, igi_lobe_estimate *e, basins *all)
{
    double depth[IGI_TABLE_ALPHAS];
    if (is_small(e)) {
        (void)settle_each(f, t, depth, e);
        add_basins(t, depth, MOST_BASINS, all);
        return;
    }
    find_misfits(f, t, depth);
    add_basins(t, depth, 2, all);
    (void)igi_lobe_settle(f, t, e);
    find_misfits(f, t, depth);
    add_basins(t, depth, 2, all);
}

igi_status igi_lobe_tabulate_coarsely(igi_context *ctx, const igi_profile *f, igi_model model,
                                      igi_lobe_table *table)
{
    double alphas[GRID];
    spread_alphas(IGI_FIT_ALPHA_LOW, highest_alpha(model), GRID, alphas);
    return igi_lobe_table_create(ctx, f->h, model, alphas, GRID, table);
}

/* The likeliest of the basins, each from the first weights on. */
static igi_status find_deepest(igi_context *ctx, igi_profile *f, igi_model model, const basins *all,
                               const igi_lobe_estimate *first, igi_lobe_estimate *best)
{
    igi_status status = IGI_OK;
    igi_lobe_table fine = {.model = model};
    best->deviance = (double)INFINITY;
    for (size_t k = 0; k < all->count; k++) {
        igi_lobe_estimate trial = *first;
        begin_anew(f);
        trial.alpha = all->alpha[k];
        IGI_TRY_GOTO(igi_lobe_locate(ctx, f, model, FINER_RATIO, &fine, &trial));
        if (trial.deviance < best->deviance) *best = trial;
    }
cleanup:
    igi_lobe_table_clear(&fine);
    return status;
}

igi_status igi_lobe_search(igi_context *ctx, igi_profile *f, igi_model model, igi_lobe_estimate *e)
{
    igi_status status = IGI_OK;
    igi_lobe_table coarse = {.model = model};
    igi_lobe_estimate first = *e;
    basins all = {0};
    IGI_TRY_GOTO(igi_lobe_tabulate_coarsely(ctx, f, model, &coarse));
    if (is_small(e)) /* more of them lead from anywhere to the same weights */
        for (size_t k = 0; k < f->n * f->bands; k++) f->start[k] = 1;
    begin_anew(f);
    find_basins(f, &coarse, &first, &all);
    IGI_TRY_GOTO(find_deepest(ctx, f, model, &all, &first, e));
    begin_anew(f);
cleanup:
    igi_lobe_table_clear(&coarse);
    return status;
}
