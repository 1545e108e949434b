/* SPDX-License-Identifier: Apache-2.0
 *
 * The indirect irradiance of a row is a mean over a few dozen rays: right on average, noisy by
 * itself. Moving least squares (Lancaster & Salkauskas 1981) takes the noise out: at each row a
 * plane a + g . (x - x_i) is fitted to the rows about it that lie in the same plane and face alike,
 * weighted by (1 - d^2/R^2)^2. It follows gradients, which a mean would bias at walls, and what is
 * left of the residual says how far to believe it.
 *
 * The lights' part is known without noise as long as nothing is in between: value of the row itself,
 * gradient from the neighbours. A light is left out of this where a shadow's edge crosses the row or
 * its neighbours; there the open light and the visible share are kept apart (field_edges.c).
 */
#include "diffuse/field_parts.h"

#include "base/parallel.h"

#include <string.h>

/* A shadow's edge this near (patches) may cross the row itself between the rays that looked. */
#define EDGE_PATCHES 1.6f
/* The visible share has an edge when it scatters more than this multiple of what its rays leave. */
#define SOFT_RATIO 1.5f
#define ROWS_A_TASK 256

/* The plane through the row's own value. */
static linear fit_through(const igi_field *f, size_t row, const neighbour *near, int n,
                          const float *values, size_t stride)
{
    float own = values[row * stride], xe = 0, ye = 0, xx = RIDGE, xy = 0, yy = RIDGE;
    for (int k = 0; k < n; k++) {
        float w = near[k].weight, e = w * (values[near[k].row * stride] - own);
        xe += e * near[k].x;
        ye += e * near[k].y;
        xx += w * near[k].x * near[k].x;
        xy += w * near[k].x * near[k].y;
        yy += w * near[k].y * near[k].y;
    }
    float det = xx * yy - xy * xy;
    plane p = {.value = own, .slope = {(xe * yy - ye * xy) / det, (ye * xx - xe * xy) / det}};
    return igi_plane_linear(&p, f->normals[row], f->radius);
}

typedef enum shade { SHADE_DARK, SHADE_OPEN, SHADE_EDGE } shade;

static shade shade_of(const igi_field *f, size_t row, size_t light, const neighbour *near, int n)
{
    const igi_rows *r = f->rows;
    float reach = EDGE_PATCHES / IGI_FIELD_RADIUS_PATCHES;
    size_t own = row * r->lights + light;
    bool lit = r->direct[own] > 0, dark = r->open[own] > r->direct[own];
    for (int k = 0; k < n; k++) {
        size_t i = near[k].row * r->lights + light;
        if (near[k].x * near[k].x + near[k].y * near[k].y > reach * reach) continue;
        lit |= r->direct[i] > 0;
        dark |= r->open[i] > r->direct[i];
    }
    return !lit ? SHADE_DARK : dark ? SHADE_EDGE : SHADE_OPEN;
}

typedef struct edge_list {
    size_t count, capacity;
    edge *edges;
} edge_list;

typedef struct job {
    igi_field *field;
    const float *visible; /* [rows][lights] share of the open light */
    edge_list *lists;     /* [tasks] */
} job;

static void add_light(const igi_field *f, size_t row, size_t light, const linear *irradiance)
{
    for (size_t b = 0; b < f->bands; b++) {
        float value = (float)f->problem->lights[light].value[b];
        linear *m = &f->smooth[row * f->bands + b];
        m->value += value * irradiance->value;
        m->gradient = igi_madd(m->gradient, irradiance->gradient, value);
    }
}

static void fit_indirect(igi_field *f, size_t row, const neighbour *near, int n, const moments *m,
                         float *variance)
{
    for (size_t b = 0; b < f->bands; b++) {
        plane p;
        igi_plane_fit(near, n, m, f->indirect + b, f->bands, &p);
        p.value = fmaxf(0.0f, p.value);
        f->smooth[row * f->bands + b] = igi_plane_linear(&p, f->normals[row], f->radius);
        variance[b] += p.variance;
    }
}

static igi_status add_edge(igi_context *ctx, edge_list *list, edge e)
{
    void *grown = igi_grow(ctx, list->edges, &list->capacity, list->count + 1, sizeof e);
    if (!grown) return IGI_E_SYSTEM;
    list->edges = grown;
    list->edges[list->count++] = e;
    return IGI_OK;
}

/* What no photograph shows is taken as gathered: it is asked for beside edges at most. */
static void take_row(const igi_field *f, size_t row)
{
    float *e = f->side_irradiance + row * f->bands;
    igi_row_direct(f->rows, row, f->problem->lights, (int)f->bands, e);
    for (size_t b = 0; b < f->bands; b++) {
        e[b] += f->indirect[row * f->bands + b];
        f->smooth[row * f->bands + b] = (linear){.value = e[b]};
    }
}

/* A soft edge: the visible share scatters about the plane no more than its shadow rays do. */
static bool is_soft(const igi_rows *r, size_t light, const neighbour *near, int n,
                    const plane *visible)
{
    float variance = 0, weight = 0;
    for (int k = 0; k < n; k++) {
        variance += near[k].weight * r->visible_var[near[k].row * r->lights + light];
        weight += near[k].weight;
    }
    return visible->residual * weight < SOFT_RATIO * variance;
}

/* Adds a light whose edge is sharp to the list, any other to the smooth part of the row. */
static igi_status fit_light(igi_context *ctx, const job *j, size_t row, size_t l,
                            const neighbour *near, int n, const moments *m, float *variance,
                            edge_list *list)
{
    igi_field *f = j->field;
    shade s = shade_of(f, row, l, near, n);
    if (s == SHADE_DARK) return IGI_OK;
    linear open = fit_through(f, row, near, n, f->rows->open + l, f->rows->lights);
    if (s == SHADE_OPEN) {
        add_light(f, row, l, &open);
        return IGI_OK;
    }
    plane p;
    igi_plane_fit(near, n, m, j->visible + l, f->rows->lights, &p);
    p.value = fminf(fmaxf(p.value, 0.0f), 1.0f);
    linear visible = igi_plane_linear(&p, f->normals[row], f->radius);
    for (size_t b = 0; b < f->bands; b++) {
        float value = open.value * (float)f->problem->lights[l].value[b];
        variance[b] += value * value * p.variance;
    }
    if (!is_soft(f->rows, l, near, n, &p)) {
        f->edge_begin[row + 1]++;
        return add_edge(ctx, list, (edge){(uint32_t)row, (uint32_t)l, open, visible, NO_NODES});
    }
    linear seen = {open.value * visible.value,
                   igi_madd(igi_scale(open.gradient, visible.value), visible.gradient, open.value)};
    add_light(f, row, l, &seen);
    return IGI_OK;
}

/* Mean over the row's places: where an edge is sharp, as the row's own rays saw it. */
static void sum_up_row(const igi_field *f, size_t row, const float *variance, const edge_list *list)
{
    float *e = f->side_irradiance + row * f->bands, total = 0, sum = 0;
    for (size_t b = 0; b < f->bands; b++) {
        e[b] = fmaxf(0.0f, f->smooth[row * f->bands + b].value);
        for (size_t k = list->count - f->edge_begin[row + 1]; k < list->count; k++)
            e[b] += f->rows->direct[row * f->rows->lights + list->edges[k].light] *
                    (float)f->problem->lights[list->edges[k].light].value[b];
        total += e[b];
        sum += variance[b];
    }
    f->std[row] = total > 0 ? sqrtf(sum * (float)f->bands) / total : 0;
}

static igi_status fit_row(igi_context *ctx, const job *j, size_t row, edge_list *list)
{
    igi_field *f = j->field;
    if (row >= f->rows->seen_count) {
        take_row(f, row);
        return IGI_OK;
    }
    neighbour near[MAX_NEIGHBOURS];
    float variance[IGI_MAX_BANDS] = {0};
    int n = igi_field_neighbours(f, igi_v_of(f->rows->point + 3 * row), f->normals[row], near);
    moments m = igi_moments_of(near, n);
    fit_indirect(f, row, near, n, &m, variance);
    for (size_t l = 0; l < f->rows->lights; l++)
        IGI_TRY(fit_light(ctx, j, row, l, near, n, &m, variance, list));
    sum_up_row(f, row, variance, list);
    return IGI_OK;
}

static igi_status fit_rows(igi_context *ctx, void *user, size_t task, int worker)
{
    (void)worker;
    const job *j = user;
    size_t begin = task * ROWS_A_TASK, end = begin + ROWS_A_TASK;
    if (end > j->field->rows->count) end = j->field->rows->count;
    for (size_t row = begin; row < end; row++) IGI_TRY(fit_row(ctx, j, row, &j->lists[task]));
    return IGI_OK;
}

static igi_status join_edges(igi_context *ctx, igi_field *f, const edge_list *lists, size_t tasks)
{
    for (size_t row = 0; row < f->rows->count; row++) f->edge_begin[row + 1] += f->edge_begin[row];
    IGI_TRY(IGI_ALLOC(ctx, f->edge_begin[f->rows->count], &f->edges));
    edge *at = f->edges;
    for (size_t i = 0; i < tasks; i++) {
        if (lists[i].count) memcpy(at, lists[i].edges, lists[i].count * sizeof *at);
        at += lists[i].count;
    }
    return IGI_OK;
}

igi_status igi_field_fit(igi_context *ctx, igi_field *f)
{
    igi_status status = IGI_OK;
    size_t pairs = f->rows->count * f->rows->lights;
    size_t tasks = (f->rows->count + ROWS_A_TASK - 1) / ROWS_A_TASK;
    edge_list *lists = NULL;
    float *visible = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, tasks, &lists));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, pairs, &visible));
    for (size_t i = 0; i < pairs; i++)
        visible[i] = f->rows->open[i] > 0 ? f->rows->direct[i] / f->rows->open[i] : 0;
    job j = {.field = f, .visible = visible, .lists = lists};
    IGI_TRY_GOTO(igi_parallel_for(ctx, tasks, fit_rows, &j));
    IGI_TRY_GOTO(join_edges(ctx, f, lists, tasks));
cleanup:
    for (size_t i = 0; lists && i < tasks; i++) igi_free(lists[i].edges);
    igi_free(lists);
    igi_free(visible);
    return status;
}
