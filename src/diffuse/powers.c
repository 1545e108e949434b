/* SPDX-License-Identifier: Apache-2.0
 *
 * What is unknown of the lights, what the cells say of it, and the cells' equation: see powers_step.c.
 */
#include "diffuse/powers_private.h"

bool igi_powers_are_wanted(const igi_problem *problem)
{
    for (size_t l = 0; l < problem->light_count; l++)
        if (problem->solved[l]) return true;
    return false;
}

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
    for (size_t i = 0; i < p->regions * p->bands; i++) p->scatter[i] = IGI_FIRST_SCATTER;
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
