/* SPDX-License-Identifier: Apache-2.0
 *
 * First the room is solved with the lights where the manifest puts them; what surfaces send each
 * other is measured with the photographs, and hardly asks where they stand. Then light from each
 * place and from half a patch beside it, six ways, is gathered anew (positions_cells.c) in every
 * step (positions_step.c). The whole twice, since what is unseen was solved under lights that stood
 * elsewhere.
 */
#include "diffuse/positions_private.h"

#include "diffuse/methods.h"

#include <stdio.h>
#include <string.h>

#define ROUNDS 2
#define RAYS 64
#define LIGHT_POINTS 12
#define EQUAL_STEPS 4 /* before regions weigh by their scatter: all lie far off */
#define MOST_STEPS 10
#define SETTLED 5e-4 /* metres */
#define OPEN 0.5     /* of what the manifest knew: the photographs add next to nothing */
#define FAR 3.0      /* of its standard deviations */

static bool asks(const igi_light *l)
{
    return l->position_std[0] > 0;
}

static igi_status list_columns(igi_context *ctx, igi_positions *p)
{
    const igi_problem *problem = p->problem;
    size_t n = problem->light_count;
    IGI_TRY(IGI_ALLOC(ctx, n, &p->light));
    IGI_TRY(IGI_ALLOC(ctx, n * p->bands, &p->powers));
    IGI_TRY(IGI_ALLOC(ctx, n, &p->prior));
    IGI_TRY(IGI_ALLOC(ctx, n, &p->prior_std));
    for (size_t l = 0; l < n; l++) {
        const igi_light *light = &problem->lights[l];
        bool tied = light->type == IGI_LIGHT_GONIOMETRIC;
        for (size_t b = 0; problem->solved[l] && b < (tied ? 1 : p->bands); b++)
            p->powers[p->power_count++] = (igi_place_power){l, tied ? -1 : (int)b};
        if (!asks(light)) continue;
        memcpy(p->prior[p->count], light->position, sizeof light->position);
        p->prior_std[p->count] = light->position_std[0];
        p->light[p->count++] = l;
    }
    p->columns = 3 * p->count + p->power_count;
    return IGI_OK;
}

static igi_status allocate(igi_context *ctx, igi_positions *p)
{
    size_t n = p->columns, k = p->regions * p->bands;
    IGI_TRY(IGI_ALLOC(ctx, p->regions, &p->scatter));
    IGI_TRY(IGI_ALLOC(ctx, k, &p->inverse));
    IGI_TRY(IGI_ALLOC(ctx, k * n, &p->share));
    IGI_TRY(IGI_ALLOC(ctx, k, &p->sums));
    IGI_TRY(IGI_ALLOC(ctx, n * n, &p->matrix));
    IGI_TRY(IGI_ALLOC(ctx, n * n, &p->factor));
    IGI_TRY(IGI_ALLOC(ctx, n * n, &p->covariance));
    IGI_TRY(IGI_ALLOC(ctx, n, &p->right));
    return IGI_ALLOC(ctx, n, &p->gains);
}

/* Takes a step, no longer than the manifest doubts; returns the farthest that a light moved. */
static double take(igi_positions *p, const double *steps)
{
    igi_light *lights = p->problem->lights;
    double most = 0;
    for (size_t k = 0; k < p->count; k++) {
        const double *s = steps + 3 * k;
        double length = sqrt(s[0] * s[0] + s[1] * s[1] + s[2] * s[2]);
        double share = fmin(1, p->prior_std[k] / fmax(length, 1e-12));
        for (int i = 0; i < 3; i++) igi_place_shift(&lights[p->light[k]], i, share * s[i]);
        most = fmax(most, length * share);
    }
    for (size_t n = 0; n < p->power_count; n++)
        for (size_t b = 0; b < p->bands; b++)
            if (p->powers[n].band < 0 || (size_t)p->powers[n].band == b)
                lights[p->powers[n].light].value[b] *= fmin(2,
                                                            fmax(0.5, 1 + steps[3 * p->count + n]));
    return most;
}

/* From diffuse->rows, solved, to where the lights stand. */
static igi_status settle(igi_context *ctx, igi_positions *p, const igi_diffuse *diffuse,
                         int equal_steps)
{
    igi_status status = IGI_OK;
    const igi_rows *rows = diffuse->rows;
    float *irradiance = NULL;
    double *steps = NULL;
    uint8_t *wanted = NULL;
    igi_places places = {0};
    IGI_TRY_GOTO(IGI_ALLOC(ctx, rows->seen_count * p->bands, &irradiance));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, p->columns, &steps));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 2 * p->problem->patches->count, &wanted));
    for (size_t i = 0; i < rows->seen_count; i++) {
        wanted[rows->side[i]] = 1;
        igi_row_indirect(rows, i, diffuse->radiance, (int)p->bands, irradiance + i * p->bands);
    }
    IGI_TRY_GOTO(igi_places_create(ctx, p->problem, rows, irradiance, &places));
    igi_places_weigh_by_pixels(p->problem, rows, &places);
    IGI_TRY_GOTO(igi_positions_fill_cells(ctx, p, diffuse, &places));
    for (int step = 0; step < MOST_STEPS; step++) {
        bool adapts = step >= equal_steps;
        IGI_TRY_GOTO(igi_positions_gather(ctx, p, &places, wanted));
        if (!igi_positions_step(p, adapts, steps))
            IGI_TRY_GOTO(
                igi_fail(ctx, IGI_E_INTERNAL, "lights: the system of their places is singular"));
        if (take(p, steps) < SETTLED && adapts) break;
    }
cleanup:
    igi_places_clear(&places);
    igi_free(irradiance);
    igi_free(steps);
    igi_free(wanted);
    return status;
}

static igi_status one_round(igi_context *ctx, igi_positions *p, igi_problem *problem,
                            int equal_steps)
{
    igi_status status = IGI_OK;
    igi_diffuse *diffuse = NULL;
    igi_gather_options options = {.rays = RAYS, .light_points = LIGHT_POINTS};
    igi_sites sites = igi_problem_sites(problem);
    IGI_TRY_GOTO(igi_diffuse_create(ctx, problem, &diffuse));
    IGI_TRY_GOTO(igi_rows_create(ctx, problem->scene, problem->patches, problem->tracer,
                                 problem->lighting, &sites, &options, &diffuse->rows));
    IGI_TRY_GOTO(igi_patches_solve(ctx, problem, NULL, diffuse));
    IGI_TRY_GOTO(settle(ctx, p, diffuse, equal_steps));
    igi_lighting_destroy(problem->lighting);
    problem->lighting = NULL;
    IGI_TRY_GOTO(igi_lighting_create(ctx, problem->scene, problem->lights, problem->light_count,
                                     &problem->lighting));
cleanup:
    igi_diffuse_destroy(diffuse);
    return status;
}

static void state_errors(igi_positions *p)
{
    for (size_t v = 0; v < 3 * p->count; v++)
        p->problem->lights[p->light[v / 3]].position_std[v % 3] = sqrt(
            fmax(0, p->covariance[v * (p->columns + 1)]));
}

/* A sentence where it is not what one hopes for. */
static igi_status explain(igi_context *ctx, const igi_positions *p, size_t k, char **sentence)
{
    const igi_light *light = &p->problem->lights[p->light[k]];
    size_t number = p->problem->light_of[p->light[k]];
    double moved = 0, prior = p->prior_std[k];
    int axis = 0;
    for (int i = 0; i < 3; i++) {
        double d = light->position[i] - p->prior[k][i];
        if (light->position_std[i] > light->position_std[axis]) axis = i;
        moved += d * d;
    }
    if (light->position_std[axis] > OPEN * prior)
        return igi_strprintf(ctx, sentence,
                             "lights[%zu]: the photographs do not determine its place along %c, to "
                             "%.2g m only; measure it, or add photographs of plain surfaces near "
                             "it and of shadows that it throws",
                             number, "xyz"[axis], light -> position_std[axis]);
    if (sqrt(moved) > FAR * prior)
        return igi_strprintf(ctx, sentence,
                             "lights[%zu]: the photographs put it %.2g m from where the manifest "
                             "does, which is more than \"position_std\" allows for; check its "
                             "position",
                             number, sqrt(moved));
    return IGI_OK;
}

igi_status igi_positions_explain(igi_context *ctx, const igi_positions *p, char ***warnings,
                                 size_t *warning_count)
{
    for (size_t k = 0; p && k < p->count; k++) {
        char *sentence = NULL;
        IGI_TRY(explain(ctx, p, k, &sentence));
        if (sentence) IGI_TRY(igi_add_sentence(ctx, warnings, warning_count, sentence));
    }
    return IGI_OK;
}

/* Powers are solved again with the albedos, from the start. */
static void forget_powers(igi_positions *p, const igi_light *before)
{
    for (size_t l = 0; l < p->problem->light_count; l++) {
        if (!p->problem->solved[l]) continue;
        p->problem->lights[l].known = before[l].known;
        memcpy(p->problem->lights[l].value, before[l].value, sizeof before[l].value);
    }
}

igi_status igi_positions_refine(igi_context *ctx, igi_problem *problem, igi_positions **positions)
{
    igi_status status = IGI_OK;
    igi_light *before = NULL;
    double(*stds)[IGI_MAX_BANDS] = NULL;
    size_t n = problem->light_count;
    bool any = false;
    *positions = NULL;
    for (size_t l = 0; l < n; l++) any |= asks(&problem->lights[l]);
    if (!any) return IGI_OK;
    igi_stage_begin(ctx, "positions");
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, positions));
    igi_positions *p = *positions;
    *p = (igi_positions){.problem = problem,
                         .bands = (size_t)problem->bands,
                         .regions = problem->scene->region_count};
    IGI_TRY_GOTO(list_columns(ctx, p));
    IGI_TRY_GOTO(allocate(ctx, p));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n, &before));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n, &stds));
    memcpy(before, problem->lights, n * sizeof *before);
    memcpy(stds, problem->light_std, n * sizeof *stds);
    for (int round = 0; round < ROUNDS; round++) {
        IGI_TRY_GOTO(one_round(ctx, p, problem, round == 0 ? EQUAL_STEPS : 0));
        if (round + 1 == ROUNDS && !igi_positions_covariance(p))
            IGI_TRY_GOTO(
                igi_fail(ctx, IGI_E_INTERNAL, "lights: the system of their places is singular"));
        forget_powers(p, before);
        memcpy(problem->light_std, stds, n * sizeof *stds);
    }
    state_errors(p);
    igi_positions_clear_cells(p);
cleanup:
    igi_free(before);
    igi_free(stds);
    if (status != IGI_OK) igi_positions_destroy(*positions);
    if (status != IGI_OK) *positions = NULL;
    return status;
}

void igi_positions_destroy(igi_positions *p)
{
    if (!p) return;
    igi_positions_clear_cells(p);
    double *arrays[] = {p->scatter, p->inverse, p->share,      p->sums,  p->prior_std,
                        p->matrix,  p->factor,  p->covariance, p->right, p->gains};
    for (size_t i = 0; i < sizeof arrays / sizeof *arrays; i++) igi_free(arrays[i]);
    igi_free(p->light);
    igi_free(p->powers);
    igi_free(p->prior);
    igi_free(p);
}
