/* SPDX-License-Identifier: Apache-2.0
 *
 * With x_c = pi L_c, E_c(p) the irradiance of cell c and u_c = 1 / variance, the misfits
 *     f_c = x_c t_r / E_c - 1,        t_r = sum u / sum u x/E over the region,
 * are made small by Gauss and Newton: f falls by (G_cl / E_c - its mean over the region) dp_l. Being
 * relative, they do not care for a scale common to all p where nothing known shines: that direction
 * is left to the guesses, which join as observations. Pixels enter only through x, which is no
 * coefficient, so that their noise biases nothing. Values stay within a factor of BOLDEST of the
 * last ones; one that would leave the range is held at its end, and the rest solved again.
 */
#include "diffuse/powers_private.h"

#include "base/solve.h"

#include <string.h>

#define FIRST_ALBEDO 0.5
#define BOLDEST 4.0
#define LEAST_VALUE 1e-3 /* in units; what is less may as well be nothing */
/* Before regions weigh by their scatter: of a guess, those that an unknown light reaches fit worst, and
 * would never be listened to. */
#define EQUAL_STEPS 30
#define NEARLY 0.01       /* steps so small may as well be weighed at once */
#define ADAPTING_STEPS 20 /* then weights stay, so that the steps settle */

/* What arrives at the cells but for the unknown lights. */
static void fill_received(igi_powers *p, const igi_places *places)
{
    const igi_light *lights = p->problem->lights;
    double patch = (double)p->problem->patches->size_m * (double)p->problem->patches->size_m;
    memset(p->received, 0, p->cells.count * p->bands * sizeof *p->received);
    for (size_t i = 0; i < places->count; i++) {
        uint32_t cell = p->cells.of_place[i];
        if (cell == IGI_NO_CELL) continue;
        for (size_t b = 0; b < p->bands; b++)
            p->received[cell * p->bands + b] += (double)places->weight[i] *
                                                (double)places->irradiance[i * p->bands + b];
    }
    for (size_t cell = 0; cell < p->cells.count; cell++)
        for (size_t b = 0; b < p->bands; b++) {
            double *e = &p->received[cell * p->bands + b];
            *e /= p->size[cell] * patch;
            for (size_t v = 0; v < p->count; v++)
                if (v == 0 || p->variables[v - 1].column != p->variables[v].column)
                    *e -= lights[p->variables[v].light].value[b] *
                          p->gain[(cell * p->columns + p->variables[v].column) * p->bands + b];
            *e = fmax(0, *e);
        }
}

/* The value with which a light alone would make the surfaces' albedos about a half. */
static void guess_units(igi_powers *p)
{
    for (size_t v = 0; v < p->count; v++) {
        igi_power_variable *var = &p->variables[v];
        double squares = 0, missing = 0, all = 0;
        if (var->unit > 0) continue;
        for (size_t cell = 0; cell < p->cells.count; cell++)
            for (size_t b = 0; b < p->bands; b++) {
                if (var->band != IGI_ALL_BANDS && (size_t)var->band != b) continue;
                double g = p->gain[(cell * p->columns + var->column) * p->bands + b];
                double e = p->reflected[cell * p->bands + b] / FIRST_ALBEDO;
                squares += p->size[cell] * g * g;
                all += p->size[cell] * g * e;
                missing += p->size[cell] * g * (e - p->received[cell * p->bands + b]);
            }
        if (squares > 0 && all > 0)
            var->unit = fmax(missing, 0.1 * all) / (squares * (double)p->columns);
    }
}

/* A guess that the photographs have left far behind was wrong by its albedo: it must not hold the
 * value back. */
static void guess_again(igi_powers *p)
{
    for (size_t v = 0; v < p->count; v++) {
        igi_power_variable *var = &p->variables[v];
        if (var->guess_std < IGI_GUESS_STD || !(var->value > IGI_GUESS_STD)) continue;
        var->unit *= var->value;
        var->value = 1;
    }
}

/* 1 / albedo of the regions, and the mean over each of what the lights' shares of the light are. */
static void average_regions(igi_powers *p)
{
    size_t n = p->count, k = p->regions * p->bands;
    memset(p->inverse, 0, k * sizeof *p->inverse);
    memset(p->weight, 0, k * sizeof *p->weight);
    memset(p->mean_gain, 0, k * n * sizeof *p->mean_gain);
    for (size_t cell = 0; cell < p->cells.count; cell++)
        for (size_t b = 0; b < p->bands; b++) {
            size_t at = p->cells.region[cell] * p->bands + b;
            double w = igi_power_weight(p, cell, b), e = igi_power_irradiance(p, cell, b);
            if (!(e > 0)) continue;
            p->weight[at] += w;
            p->inverse[at] += w * p->reflected[cell * p->bands + b] / e;
            for (size_t v = 0; v < n; v++)
                p->mean_gain[at * n + v] += w * igi_power_gain(p, cell, v, b) / e;
        }
    for (size_t at = 0; at < k; at++) {
        p->inverse[at] = p->inverse[at] > 0 ? p->weight[at] / p->inverse[at] : 0;
        for (size_t v = 0; v < n && p->weight[at] > 0; v++)
            p->mean_gain[at * n + v] /= p->weight[at];
    }
}

/* The normal equations, for the values themselves. */
static void assemble(igi_powers *p)
{
    size_t n = p->count;
    memset(p->matrix, 0, n * n * sizeof *p->matrix);
    for (size_t v = 0; v < n; v++)
        p->right[v] = p->matrix[v * n + v] = igi_guess_precision(&p->variables[v]);
    for (size_t cell = 0; cell < p->cells.count; cell++)
        for (size_t b = 0; b < p->bands; b++) {
            if (!(p->inverse[p->cells.region[cell] * p->bands + b] > 0)) continue;
            double w = igi_power_weight(p, cell, b), f = igi_power_misfit(p, cell, b);
            igi_power_gains(p, cell, b, p->own);
            for (size_t v = 0; v < n; v++) f += p->own[v] * p->variables[v].value;
            for (size_t v = 0; v < n; v++) {
                if (p->own[v] == 0) continue;
                p->right[v] += w * p->own[v] * f;
                for (size_t m = 0; m < n; m++) p->matrix[v * n + m] += w * p->own[v] * p->own[m];
            }
        }
}

/* Solves for the variables that are not held. */
static bool solve_free(igi_powers *p)
{
    size_t n = p->count;
    memcpy(p->factor, p->matrix, n * n * sizeof *p->matrix);
    for (size_t v = 0; v < n; v++) {
        if (p->is_held[v]) continue;
        p->next[v] = p->right[v];
        for (size_t m = 0; m < n; m++)
            if (p->is_held[m]) p->next[v] -= p->matrix[v * n + m] * p->own[m];
    }
    for (size_t v = 0; v < n; v++) {
        if (p->is_held[v]) p->next[v] = p->own[v];
        for (size_t m = 0; m < n; m++)
            if (p->is_held[v] || p->is_held[m]) p->factor[v * n + m] = v == m;
    }
    return igi_solve_cholesky(p->factor, n, p->next, 1);
}

/* The variable that leaves its range by the largest factor is held at the end of it, until none
 * does. `own` holds the values of those that are held. */
static void solve_within(igi_powers *p)
{
    size_t n = p->count;
    for (size_t v = 0; v < n; v++) {
        p->is_held[v] = !(p->variables[v].unit > 0);
        p->own[v] = 0;
    }
    for (;;) {
        size_t worst = n;
        double most = 0;
        if (!solve_free(p)) return;
        for (size_t v = 0; v < n; v++) {
            double now = p->variables[v].value, low = now < LEAST_VALUE ? 0 : now / BOLDEST;
            double high = fmax(now, LEAST_VALUE) * BOLDEST;
            double beyond = fmax(low - p->next[v], p->next[v] - high) / fmax(now, LEAST_VALUE);
            if (p->is_held[v] || !(beyond > most)) continue;
            most = beyond;
            worst = v;
            p->own[v] = p->next[v] < low ? low : high;
        }
        if (worst == n) return;
        p->is_held[worst] = true;
    }
}

double igi_powers_step(igi_powers *p, const igi_places *places)
{
    double change = 0;
    bool adapts = p->adapted < ADAPTING_STEPS && (p->adapted > 0 || p->steps >= EQUAL_STEPS ||
                                                  (p->steps > 0 && p->change < NEARLY));
    fill_received(p, places);
    if (p->steps == 0) guess_units(p);
    guess_again(p);
    average_regions(p);
    assemble(p);
    solve_within(p);
    for (size_t v = 0; v < p->count; v++) {
        igi_power_variable *var = &p->variables[v];
        double move = p->next[v] - var->value;
        change = fmax(change, fabs(move) / fmax(LEAST_VALUE, p->next[v]));
        var->value += p->boldness * move;
        for (size_t b = 0; b < p->bands; b++)
            if (igi_power_in_band(var, b))
                p->problem->lights[var->light].value[b] = var->value * var->unit;
    }
    /* Unseen surfaces answer with what they reflect, one sweep later: that may overshoot. */
    if (p->steps > 0 && !adapts && change > 0.9 * p->change)
        p->boldness = fmax(0.5 * p->boldness, 1.0 / 64);
    p->change = change;
    average_regions(p);
    if (adapts) igi_powers_weigh(p);
    p->adapted += adapts;
    p->steps++;
    if (p->adapted < ADAPTING_STEPS) return fmax(change, 1); /* not done yet */
    return change;
}
