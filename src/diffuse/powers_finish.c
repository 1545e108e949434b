/* SPDX-License-Identifier: Apache-2.0
 *
 * How far to believe the solved values. With f_c the misfits and g_cl what they fall by, the
 * covariance is N^-1 (sum_c s_c s_c^T + P) N^-1, s_cl = u_c g_cl f_c (a sandwich, White 1980), N
 * the matrix of the system and P the precision of the guesses. A misfit counts as no smaller than
 * it is expected to be: few cells may fit by luck.
 *
 * Noise n of the gathered light K is in f and in g alike, and where K hardly varies it is all that g
 * varies by: the values are drawn toward where it matters less. By how much, is N^-1 r with
 * r_l = sum_c u_c (G_cl / E_c) var(n_c) / E_c^2; that counts as an error, too.
 *
 * What the values leave open, albedo inherits: d rho_r / rho_r = - sum_l <G_l / E>_r dp_l.
 */
#include "diffuse/powers_private.h"

#include "base/solve.h"

#include <string.h>

static void add_scores(igi_powers *p, double *score, double *sum)
{
    size_t n = p->count;
    for (size_t cell = 0; cell < p->cells.count; cell++) {
        memset(score, 0, n * sizeof *score);
        for (size_t b = 0; b < p->bands; b++) {
            double w = igi_power_weight(p, cell, b), f = igi_power_misfit(p, cell, b);
            if (!(p->inverse[p->cells.region[cell] * p->bands + b] > 0)) continue;
            f = copysign(fmax(fabs(f), 1 / sqrt(w)), f);
            igi_power_gains(p, cell, b, p->own);
            for (size_t v = 0; v < n; v++) score[v] += w * f * p->own[v];
        }
        for (size_t v = 0; v < n; v++)
            for (size_t m = 0; m < n; m++) sum[v * n + m] += score[v] * score[m];
    }
}

static void add_pull(igi_powers *p, const igi_places *places, const igi_diffuse *diffuse,
                     double *pull)
{
    double patch = (double)p->problem->patches->size_m * (double)p->problem->patches->size_m;
    for (size_t i = 0; i < places->count; i++) {
        uint32_t cell = p->cells.of_place[i];
        if (cell == IGI_NO_CELL) continue;
        double share = (double)places->weight[i] / (p->size[cell] * patch);
        for (size_t b = 0; b < p->bands; b++) {
            double e = igi_power_irradiance(p, cell, b), w = igi_power_weight(p, cell, b);
            double noise = share * share *
                           igi_row_variance(p->rows, i, diffuse->radiance, (int)p->bands, (int)b);
            for (size_t v = 0; v < p->count && e > 0; v++)
                pull[v] += w * igi_power_gain(p, cell, v, b) / e * noise / (e * e);
        }
    }
}

static igi_status fill_covariance(igi_context *ctx, igi_powers *p, const igi_places *places,
                                  const igi_diffuse *diffuse, igi_power_outcome *o)
{
    size_t n = p->count;
    double *score;
    IGI_TRY(IGI_ALLOC(ctx, n, &score));
    for (size_t v = 0; v < n; v++) o->covariance[v * n + v] = igi_guess_precision(&p->variables[v]);
    add_scores(p, score, o->covariance);
    memset(score, 0, n * sizeof *score);
    add_pull(p, places, diffuse, score);
    for (size_t v = 0; v < n; v++)
        for (size_t m = 0; m < n; m++) o->covariance[v * n + m] += score[v] * score[m];
    igi_free(score);
    if (igi_solve_sandwich(p->matrix, p->factor, n, o->covariance)) return IGI_OK;
    return igi_fail(ctx, IGI_E_INTERNAL, "lights: the system of their powers is singular");
}

static void hand_on(const igi_power_outcome *o, igi_diffuse *diffuse)
{
    const igi_powers *p = o->p;
    size_t n = p->count;
    for (size_t v = 0; v < n; v++) {
        const igi_power_variable *var = &p->variables[v];
        for (size_t b = 0; b < p->bands; b++) {
            if (!igi_power_in_band(var, b)) continue;
            p->problem->lights[var->light].known = true;
            p->problem->light_std[var->light][b] = igi_power_std(o, v) * var->unit;
        }
    }
    for (size_t at = 0; at < p->regions * p->bands; at++) {
        size_t region = at / p->bands, b = at % p->bands;
        double variance = 0;
        for (size_t v = 0; v < n; v++)
            for (size_t m = 0; m < n; m++)
                variance += p->mean_gain[at * n + v] * p->mean_gain[at * n + m] *
                            o->covariance[v * n + m];
        if (!diffuse->determined[region]) continue;
        diffuse->albedo_std[region][b] = hypot(
            diffuse->albedo_std[region][b], diffuse->albedo[region][b] * sqrt(fmax(0, variance)));
    }
}

igi_status igi_powers_finish(igi_context *ctx, igi_powers *p, const igi_places *places,
                             igi_diffuse *diffuse)
{
    if (!p) return IGI_OK;
    igi_status status = IGI_OK;
    igi_power_outcome o = {.p = p};
    IGI_TRY_GOTO(IGI_ALLOC(ctx, p->count * p->count, &o.covariance));
    IGI_TRY_GOTO(fill_covariance(ctx, p, places, diffuse, &o));
    hand_on(&o, diffuse);
    igi_diffuse_forget_warnings(diffuse);
    for (size_t v = 0; v < p->count; v++)
        if (v == 0 || p->variables[v - 1].light != p->variables[v].light)
            IGI_TRY_GOTO(igi_power_explain(ctx, &o, v, diffuse));
cleanup:
    igi_free(o.covariance);
    return status;
}
