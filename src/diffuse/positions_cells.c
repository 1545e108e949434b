/* SPDX-License-Identifier: Apache-2.0
 *
 * What light reaches each cell, from where the lights stand and from beside it.
 */
#include "diffuse/positions_private.h"

#include <string.h>

#define STEP_POINTS 4
#define FIRST_SCATTER 1e-4 /* a cell of a tenth of a square metre three per cent off */

void igi_positions_clear_cells(igi_positions *p)
{
    double **arrays[] = {&p->size,   &p->reflected, &p->received, &p->noise,
                         &p->direct, &p->moved,     &p->trust};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) {
        igi_free(*arrays[i]);
        *arrays[i] = NULL;
    }
    igi_cells_clear(&p->cells);
}

/* Adds means over each cell of what[places][values] to sums[cells][values]. */
static void add_means(const igi_positions *p, const igi_places *places, const float *what,
                      size_t values, double scale, double *sums)
{
    for (size_t i = 0; i < places->count; i++) {
        uint32_t cell = p->cells.of_place[i];
        if (cell == IGI_NO_CELL) continue;
        double share = scale * (double)places->weight[i] / p->size[cell];
        for (size_t v = 0; v < values; v++)
            sums[cell * values + v] += share * (double)what[i * values + v];
    }
}

/* What of the cells does not change while the lights are moved. */
igi_status igi_positions_fill_cells(igi_context *ctx, igi_positions *p, const igi_diffuse *diffuse,
                                    const igi_places *places)
{
    const igi_rows *rows = diffuse->rows;
    igi_positions_clear_cells(p);
    IGI_TRY(igi_cells_create(ctx, p->problem, places, &p->cells));
    size_t cells = p->cells.count, bands = p->bands, lights = p->problem->light_count;
    IGI_TRY(IGI_ALLOC(ctx, cells, &p->size));
    IGI_TRY(IGI_ALLOC(ctx, cells * bands, &p->reflected));
    IGI_TRY(IGI_ALLOC(ctx, cells * bands, &p->received));
    IGI_TRY(IGI_ALLOC(ctx, cells * bands, &p->noise));
    IGI_TRY(IGI_ALLOC(ctx, cells * lights, &p->direct));
    IGI_TRY(IGI_ALLOC(ctx, cells * p->count * IGI_PLACE_STEPS, &p->moved));
    IGI_TRY(IGI_ALLOC(ctx, cells * bands, &p->trust));
    for (size_t i = 0; i < places->count; i++)
        if (p->cells.of_place[i] != IGI_NO_CELL)
            p->size[p->cells.of_place[i]] += (double)places->weight[i];
    add_means(p, places, places->radiance, bands, IGI_PI, p->reflected);
    add_means(p, places, places->irradiance, bands, 1, p->received);
    add_means(p, places, rows->direct, lights, 1, p->direct);
    for (size_t i = 0; i < places->count; i++) {
        uint32_t cell = p->cells.of_place[i];
        if (cell == IGI_NO_CELL) continue;
        double share = (double)places->weight[i] / p->size[cell];
        for (size_t b = 0; b < bands; b++)
            p->noise[cell * bands + b] += share * share *
                                          igi_row_variance(rows, i, diffuse->radiance, (int)bands,
                                                           (int)b);
    }
    for (size_t i = 0; i < cells * bands; i++) p->trust[i] = 1;
    for (size_t r = 0; r < p->regions; r++) p->scatter[r] = FIRST_SCATTER;
    return IGI_OK;
}

void igi_place_shift(igi_light *light, int axis, double metres)
{
    light->position[axis] += metres;
    if (light->type == IGI_LIGHT_LINE) light->end[axis] += metres;
}

/* The light from where the lights stand, and from beside it. */
igi_status igi_positions_gather(igi_context *ctx, igi_positions *p, const igi_places *places,
                                const uint8_t *wanted)
{
    const igi_problem *problem = p->problem;
    igi_status status = IGI_OK;
    igi_light *lights = NULL;
    igi_lighting *lighting = NULL;
    igi_rows *rows = NULL;
    size_t n = p->count * IGI_PLACE_STEPS, cells = p->cells.count, all = problem->light_count;
    igi_sites sites = igi_problem_sites(problem);
    igi_gather_options options = {.light_points = STEP_POINTS, .wanted = wanted};
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n, &lights));
    for (size_t i = 0; i < n; i++) {
        int step = (int)(i % IGI_PLACE_STEPS);
        lights[i] = problem->lights[p->light[i / IGI_PLACE_STEPS]];
        if (step > 0)
            igi_place_shift(&lights[i], (step - 1) / 2,
                            (step % 2 ? 0.5 : -0.5) * (double)problem->patches->size_m);
    }
    IGI_TRY_GOTO(igi_lighting_create(ctx, problem->scene, lights, n, &lighting));
    IGI_TRY_GOTO(igi_rows_create(ctx, problem->scene, problem->patches, problem->tracer, lighting,
                                 &sites, &options, &rows));
    memset(p->moved, 0, cells * n * sizeof *p->moved);
    add_means(p, places, rows->direct, n, 1, p->moved);
    for (size_t cell = 0; cell < cells; cell++)
        for (size_t k = 0; k < p->count; k++)
            p->direct[cell * all + p->light[k]] = p->moved[cell * n + k * IGI_PLACE_STEPS];
cleanup:
    igi_rows_destroy(rows);
    igi_lighting_destroy(lighting);
    igi_free(lights);
    return status;
}
