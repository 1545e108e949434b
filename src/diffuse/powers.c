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
#define FIRST_SCATTER 1e-4
#define LEAST_SCATTER 1e-8
#define SHRINKING 4.0    /* so many cells' worth of the other regions' scatter */
#define OUTLIER_SIGMAS 4 /* beyond that a cell counts less (Huber) */
/* Before regions weigh by their scatter: of a guess, those that an unknown light reaches fit worst, and
 * would never be listened to. */
#define EQUAL_STEPS 30
#define NEARLY 0.01       /* steps so small may as well be weighed at once */
#define ADAPTING_STEPS 20 /* then weights stay, so that the steps settle */

static bool bands_are_tied(igi_light_type type)
{
    return type == IGI_LIGHT_GONIOMETRIC;
}

/* What photographs show of a lamp among other things is a guess with an error of its own. */
static igi_power_variable make_variable(const igi_powers *p, size_t light, int band)
{
    igi_power_variable v = {
        .light = light, .column = p->columns, .band = band, .value = 1, .guess_std = IGI_GUESS_STD};
    const igi_light *l = &p->problem->lights[light];
    if (!l->known || band == IGI_ALL_BANDS) return v;
    v.unit = l->value[band];
    v.guess_std = p->problem->light_std[light][band] / v.unit;
    return v;
}

static igi_status list_variables(igi_context *ctx, igi_powers *p)
{
    const igi_problem *problem = p->problem;
    IGI_TRY(IGI_ALLOC(ctx, problem->light_count * p->bands, &p->variables));
    for (size_t l = 0; l < problem->light_count; l++) {
        if (!problem->solved[l]) continue;
        bool tied = bands_are_tied(problem->lights[l].type);
        for (size_t b = 0; b < (tied ? 1 : p->bands); b++)
            p->variables[p->count++] = make_variable(p, l, tied ? IGI_ALL_BANDS : (int)b);
        p->columns++;
    }
    return IGI_OK;
}

static igi_status allocate(igi_context *ctx, igi_powers *p)
{
    size_t cells = p->cells.count, b = p->bands, n = p->count;
    IGI_TRY(IGI_ALLOC(ctx, cells, &p->size));
    IGI_TRY(IGI_ALLOC(ctx, cells * b, &p->reflected));
    IGI_TRY(IGI_ALLOC(ctx, cells * b, &p->received));
    IGI_TRY(IGI_ALLOC(ctx, cells * b * p->columns, &p->gain));
    IGI_TRY(IGI_ALLOC(ctx, cells * b, &p->trust));
    IGI_TRY(IGI_ALLOC(ctx, p->regions * b, &p->scatter));
    IGI_TRY(IGI_ALLOC(ctx, p->regions * b, &p->inverse));
    IGI_TRY(IGI_ALLOC(ctx, p->regions * b, &p->weight));
    IGI_TRY(IGI_ALLOC(ctx, p->regions * b * n, &p->mean_gain));
    IGI_TRY(IGI_ALLOC(ctx, n, &p->own));
    IGI_TRY(IGI_ALLOC(ctx, n * n, &p->matrix));
    IGI_TRY(IGI_ALLOC(ctx, n * n, &p->factor));
    IGI_TRY(IGI_ALLOC(ctx, p->regions * b, &p->misfits));
    IGI_TRY(IGI_ALLOC(ctx, n, &p->next));
    IGI_TRY(IGI_ALLOC(ctx, n, &p->is_held));
    return IGI_ALLOC(ctx, n, &p->right);
}

/* What of a cell does not change from step to step. */
static void fill_cells(igi_powers *p, const igi_places *places)
{
    double patch = (double)p->problem->patches->size_m * (double)p->problem->patches->size_m;
    for (size_t i = 0; i < places->count; i++) {
        uint32_t cell = p->cells.of_place[i];
        if (cell == IGI_NO_CELL) continue;
        double w = (double)places->weight[i];
        p->size[cell] += w;
        for (size_t b = 0; b < p->bands; b++) {
            p->reflected[cell * p->bands + b] += w * IGI_PI *
                                                 (double)places->radiance[i * p->bands + b];
            for (size_t v = 0; v < p->count; v++) {
                const igi_power_variable *var = &p->variables[v];
                if (v && var[-1].column == var->column) continue;
                p->gain[(cell * p->columns + var->column) * p->bands + b] +=
                    w * (double)p->rows->direct[i * p->rows->lights + var->light];
            }
        }
    }
    for (size_t cell = 0; cell < p->cells.count; cell++) {
        for (size_t b = 0; b < p->bands; b++) p->reflected[cell * p->bands + b] /= p->size[cell];
        for (size_t k = 0; k < p->bands * p->columns; k++)
            p->gain[cell * p->bands * p->columns + k] /= p->size[cell];
        p->size[cell] /= patch;
    }
    for (size_t i = 0; i < p->cells.count * p->bands; i++) p->trust[i] = 1;
    for (size_t i = 0; i < p->regions * p->bands; i++) p->scatter[i] = FIRST_SCATTER;
}

igi_status igi_powers_create(igi_context *ctx, const igi_problem *problem, const igi_rows *rows,
                             const igi_places *places, igi_powers **powers)
{
    igi_status status = IGI_OK;
    igi_powers *p = NULL;
    *powers = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &p));
    *p = (igi_powers){.problem = problem,
                      .rows = rows,
                      .bands = (size_t)problem->bands,
                      .regions = problem->scene->region_count,
                      .boldness = 1};
    IGI_TRY_GOTO(list_variables(ctx, p));
    if (p->count == 0) goto cleanup;
    IGI_TRY_GOTO(igi_cells_create(ctx, problem, places, &p->cells));
    IGI_TRY_GOTO(allocate(ctx, p));
    fill_cells(p, places);
    *powers = p;
    p = NULL;
cleanup:
    igi_powers_destroy(p);
    return status;
}

void igi_powers_destroy(igi_powers *p)
{
    if (!p) return;
    igi_cells_clear(&p->cells);
    double *arrays[] = {p->size,    p->reflected, p->received, p->gain,      p->trust,
                        p->scatter, p->inverse,   p->weight,   p->mean_gain, p->own,
                        p->matrix,  p->right,     p->factor,   p->misfits,   p->next};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) igi_free(arrays[i]);
    igi_free(p->variables);
    igi_free(p->is_held);
    igi_free(p);
}

static double of_unknown(const igi_powers *p, size_t cell, size_t b)
{
    double sum = 0;
    for (size_t v = 0; v < p->count; v++)
        sum += p->variables[v].value * igi_power_gain(p, cell, v, b);
    return sum;
}

double igi_power_irradiance(const igi_powers *p, size_t cell, size_t b)
{
    double least = 1e-6 * p->reflected[cell * p->bands + b];
    return fmax(least, p->received[cell * p->bands + b] + of_unknown(p, cell, b));
}

double igi_power_weight(const igi_powers *p, size_t cell, size_t b)
{
    return p->size[cell] * p->trust[cell * p->bands + b] /
           p->scatter[p->cells.region[cell] * p->bands + b];
}

double igi_power_misfit(const igi_powers *p, size_t cell, size_t b)
{
    double e = igi_power_irradiance(p, cell, b);
    double t = p->inverse[p->cells.region[cell] * p->bands + b];
    return e > 0 ? p->reflected[cell * p->bands + b] * t / e - 1 : 0;
}

void igi_power_gains(const igi_powers *p, size_t cell, size_t b, double *gains)
{
    size_t at = p->cells.region[cell] * p->bands + b;
    double e = igi_power_irradiance(p, cell, b);
    for (size_t v = 0; v < p->count; v++)
        gains[v] = e > 0 ? igi_power_gain(p, cell, v, b) / e - p->mean_gain[at * p->count + v] : 0;
}

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

/* How far the cells of each region lie from the equation, and which lie too far. Few cells say
 * little, and lean on the other regions: on their harmonic mean, lest a textured region speak for
 * a plain one. */
static void weigh_again(igi_powers *p)
{
    double pooled = 0, pooled_cells = 0;
    memset(p->misfits, 0, p->regions * p->bands * sizeof *p->misfits);
    for (size_t cell = 0; cell < p->cells.count; cell++)
        for (size_t b = 0; b < p->bands; b++) {
            double d = igi_power_misfit(p, cell, b);
            p->misfits[p->cells.region[cell] * p->bands + b] += p->size[cell] * d * d *
                                                                p->trust[cell * p->bands + b];
        }
    for (size_t at = 0; at < p->regions * p->bands; at++) {
        double cells = (double)p->cells.of_region[at / p->bands];
        if (cells < 2) continue;
        pooled += cells * cells / fmax(p->misfits[at], LEAST_SCATTER * cells);
        pooled_cells += cells;
    }
    double common = pooled > 0 ? pooled_cells / pooled : FIRST_SCATTER;
    for (size_t at = 0; at < p->regions * p->bands; at++) {
        double cells = (double)p->cells.of_region[at / p->bands];
        p->scatter[at] = fmax(LEAST_SCATTER, (p->misfits[at] + SHRINKING * common) /
                                                 (fmax(cells - 1, 0) + SHRINKING));
    }
    for (size_t k = 0; k < p->cells.count * p->bands; k++) {
        size_t cell = k / p->bands, at = p->cells.region[cell] * p->bands + k % p->bands;
        double sigmas = fabs(igi_power_misfit(p, cell, k % p->bands)) *
                        sqrt(p->size[cell] / p->scatter[at]);
        p->trust[k] = sigmas > OUTLIER_SIGMAS ? OUTLIER_SIGMAS / sigmas : 1;
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
    if (adapts) weigh_again(p);
    p->adapted += adapts;
    p->steps++;
    if (p->adapted < ADAPTING_STEPS) return fmax(change, 1); /* not done yet */
    return change;
}
