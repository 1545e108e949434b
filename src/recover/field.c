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
#include "recover/field_private.h"

#include "base/parallel.h"

#include <string.h>

#define RADIUS_PATCHES 2.5f
/* A shadow's edge this near (patches) may cross the row itself between the rays that looked. */
#define EDGE_PATCHES 1.6f
#define THIN_PATCHES 0.02f
#define FACING_COS 0.9f
#define MAX_NEIGHBOURS 256
#define RIDGE 1e-3f
/* The visible share has an edge when it scatters more than this multiple of what its rays leave. */
#define SOFT_RATIO 1.5f
#define DEFAULT_RAYS 32
#define ROWS_A_TASK 256

typedef struct neighbour {
    uint32_t row;
    float x, y, weight; /* tangential, in radii */
} neighbour;

static uint64_t cell_hash(int32_t x, int32_t y, int32_t z)
{
    return igi_hash64(((uint64_t)(uint32_t)x << 32 | (uint32_t)y) ^ igi_hash64((uint32_t)z));
}

static int32_t cell_of(float x, float side)
{
    return (int32_t)floorf(x / side);
}

/* Of rows that photographs show: a hidden one, behind a picture or under a box, tells nothing of its
 * neighbours. Cells that share a slot share a list: rows far away fall out by their distance. */
static igi_status make_grid(igi_context *ctx, const igi_rows *rows, float side, row_grid *g)
{
    g->side = side;
    g->slots = 64;
    while (g->slots < rows->count) g->slots *= 2;
    IGI_TRY(IGI_ALLOC(ctx, g->slots, &g->first));
    IGI_TRY(IGI_ALLOC(ctx, rows->count, &g->next));
    for (size_t i = 0; i < g->slots; i++) g->first[i] = IGI_NO_ROW;
    for (size_t i = rows->seen_count; i-- > 0;) {
        const float *p = rows->point + 3 * i;
        uint64_t slot = cell_hash(cell_of(p[0], side), cell_of(p[1], side), cell_of(p[2], side)) &
                        (g->slots - 1);
        g->next[i] = g->first[slot];
        g->first[slot] = (uint32_t)i;
    }
    return IGI_OK;
}

/* The distinct slots of the 27 cells about a point. */
static int slots_about(const row_grid *g, igi_vec p, uint32_t slots[27])
{
    int n = 0;
    for (int k = 0; k < 27; k++) {
        uint64_t h = cell_hash(cell_of(p.x, g->side) + k % 3 - 1,
                               cell_of(p.y, g->side) + k / 3 % 3 - 1,
                               cell_of(p.z, g->side) + k / 9 - 1);
        uint32_t slot = (uint32_t)(h & (g->slots - 1));
        if (g->first[slot] == IGI_NO_ROW) continue;
        int known = 0;
        while (known < n && slots[known] != slot) known++;
        if (known == n) slots[n++] = slot;
    }
    return n;
}

static int find_neighbours(const igi_field *f, igi_vec point, igi_vec normal, neighbour *found)
{
    uint32_t slots[27];
    int n = 0, slot_count = slots_about(&f->grid, point, slots);
    float thin = THIN_PATCHES * f->problem->patches->size_m;
    igi_vec t, b;
    igi_frame_of(normal, &t, &b);
    for (int s = 0; s < slot_count; s++)
        for (uint32_t i = f->grid.first[slots[s]]; i != IGI_NO_ROW; i = f->grid.next[i]) {
            igi_vec d = igi_sub(igi_v_of(f->rows->point + 3 * (size_t)i), point);
            float share = igi_dot(d, d) / (f->radius * f->radius);
            float cosine = igi_dot(f->normals[i], normal);
            if (share >= 1 || cosine < FACING_COS || n == MAX_NEIGHBOURS) continue;
            /* off the plane no more than a curved surface would be: the next sheet is another one */
            float bend = sqrtf(fmaxf(0.0f, 1 - cosine * cosine) * igi_dot(d, d));
            if (fabsf(igi_dot(d, normal)) > thin + bend) continue;
            found[n++] = (neighbour){i, igi_dot(d, t) / f->radius, igi_dot(d, b) / f->radius,
                                     (1 - share) * (1 - share)};
        }
    return n;
}

/* Weighted moments about the neighbours' mean place. */
typedef struct moments {
    float w, x, y, xx, xy, yy, det;
} moments;

static moments moments_of(const neighbour *near, int n)
{
    moments m = {0};
    for (int k = 0; k < n; k++) {
        m.w += near[k].weight;
        m.x += near[k].weight * near[k].x;
        m.y += near[k].weight * near[k].y;
    }
    if (m.w > 0) {
        m.x /= m.w;
        m.y /= m.w;
    }
    for (int k = 0; k < n; k++) {
        float x = near[k].x - m.x, y = near[k].y - m.y;
        m.xx += near[k].weight * x * x;
        m.xy += near[k].weight * x * y;
        m.yy += near[k].weight * y * y;
    }
    m.xx += RIDGE * m.w;
    m.yy += RIDGE * m.w;
    m.det = m.xx * m.yy - m.xy * m.xy;
    return m;
}

/* value + slope . (x, y), slopes per radius; the variance of what it was fitted to about it, and of
 * its value. */
typedef struct plane {
    float value, slope[2], residual, variance;
} plane;

/* The plane through values[stride row] of the neighbours. */
static void fit(const neighbour *near, int n, const moments *m, const float *values, size_t stride,
                plane *p)
{
    float mean = 0, xe = 0, ye = 0, squares = 0, weights = 0;
    *p = (plane){0};
    if (!(m->w > 0) || !(m->det > 0)) return;
    for (int k = 0; k < n; k++) mean += near[k].weight * values[near[k].row * stride];
    mean /= m->w;
    for (int k = 0; k < n; k++) {
        float e = near[k].weight * (values[near[k].row * stride] - mean);
        xe += e * (near[k].x - m->x);
        ye += e * (near[k].y - m->y);
    }
    p->slope[0] = (xe * m->yy - ye * m->xy) / m->det;
    p->slope[1] = (ye * m->xx - xe * m->xy) / m->det;
    p->value = mean - p->slope[0] * m->x - p->slope[1] * m->y;
    for (int k = 0; k < n; k++) {
        float e = values[near[k].row * stride] - p->value - p->slope[0] * near[k].x -
                  p->slope[1] * near[k].y;
        squares += near[k].weight * e * e;
        weights += near[k].weight * near[k].weight;
    }
    /* of so many observations of equal weight, three are spent on the plane */
    float effective = m->w * m->w / weights;
    float lever = 1 + m->w * (m->x * m->x * m->yy - 2 * m->x * m->y * m->xy + m->y * m->y * m->xx) /
                          m->det;
    p->residual = squares / m->w * (effective > 4 ? effective / (effective - 3) : 4);
    p->variance = p->residual / effective * lever;
}

static linear to_linear(const plane *p, igi_vec normal, float radius)
{
    igi_vec t, b;
    igi_frame_of(normal, &t, &b);
    igi_vec gradient = igi_madd(igi_scale(t, p->slope[0] / radius), b, p->slope[1] / radius);
    return (linear){p->value, gradient};
}

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
    return to_linear(&p, f->normals[row], f->radius);
}

typedef enum shade { SHADE_DARK, SHADE_OPEN, SHADE_EDGE } shade;

static shade shade_of(const igi_field *f, size_t row, size_t light, const neighbour *near, int n)
{
    const igi_rows *r = f->rows;
    float reach = EDGE_PATCHES / RADIUS_PATCHES;
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
        fit(near, n, m, f->indirect + b, f->bands, &p);
        p.value = fmaxf(0.0f, p.value);
        f->smooth[row * f->bands + b] = to_linear(&p, f->normals[row], f->radius);
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
    fit(near, n, m, j->visible + l, f->rows->lights, &p);
    p.value = fminf(fmaxf(p.value, 0.0f), 1.0f);
    linear visible = to_linear(&p, f->normals[row], f->radius);
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
    int n = find_neighbours(f, igi_v_of(f->rows->point + 3 * row), f->normals[row], near);
    moments m = moments_of(near, n);
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

static igi_status fit_all(igi_context *ctx, igi_field *f)
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

static igi_vec mean_normal(const igi_problem *p, uint32_t side)
{
    const igi_patches *patches = p->patches;
    igi_vec sum = igi_v(0, 0, 0);
    for (uint32_t t = patches->triangle[side >> 1]; t != IGI_NO_HIT; t = patches->next[t])
        sum = igi_madd(sum, igi_tracer_normal(p->tracer, t), igi_triangle_area(patches->mesh, t));
    return igi_normalize(igi_scale(sum, side & 1 ? -1.0f : 1.0f));
}

static igi_status gather_now(igi_context *ctx, igi_field *f, const igi_diffuse *diffuse)
{
    const igi_problem *p = f->problem;
    igi_sites sites = igi_problem_sites(p);
    igi_gather_options options = {.rays = diffuse->ignores_indirect ? 0 : DEFAULT_RAYS,
                                  .light_points = DEFAULT_RAYS / 3};
    return igi_rows_create(ctx, p->scene, p->patches, p->tracer, p->lighting, &sites, &options,
                           &f->own_rows);
}

static igi_status prepare(igi_context *ctx, igi_field *f, const igi_diffuse *diffuse)
{
    const igi_rows *r = f->rows;
    IGI_TRY(IGI_ALLOC(ctx, r->count, &f->normals));
    IGI_TRY(IGI_ALLOC(ctx, r->count * f->bands, &f->indirect));
    IGI_TRY(IGI_ALLOC(ctx, r->count * f->bands, &f->smooth));
    IGI_TRY(IGI_ALLOC(ctx, r->count * f->bands, &f->side_irradiance));
    IGI_TRY(IGI_ALLOC(ctx, r->count, &f->std));
    IGI_TRY(IGI_ALLOC(ctx, r->count + 1, &f->edge_begin));
    for (size_t i = 0; i < r->count; i++) {
        f->normals[i] = mean_normal(f->problem, r->side[i]);
        if (!diffuse->ignores_indirect)
            igi_row_indirect(r, i, diffuse->radiance, (int)f->bands, f->indirect + i * f->bands);
    }
    return make_grid(ctx, r, f->radius, &f->grid);
}

igi_status igi_field_create(igi_context *ctx, const igi_problem *problem,
                            const igi_diffuse *diffuse, igi_field **field)
{
    igi_status status = IGI_OK;
    igi_field *f = NULL;
    *field = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &f));
    f->problem = problem;
    f->bands = (size_t)problem->bands;
    f->radius = RADIUS_PATCHES * problem->patches->size_m;
    f->rows = diffuse->rows;
    if (!f->rows) {
        IGI_TRY_GOTO(gather_now(ctx, f, diffuse));
        f->rows = f->own_rows;
    }
    IGI_TRY_GOTO(prepare(ctx, f, diffuse));
    IGI_TRY_GOTO(fit_all(ctx, f));
    *field = f;
    f = NULL;
cleanup:
    igi_field_destroy(f);
    return status;
}

void igi_field_destroy(igi_field *field)
{
    if (!field) return;
    igi_rows_destroy(field->own_rows);
    igi_free(field->normals);
    igi_free(field->indirect);
    igi_free(field->grid.first);
    igi_free(field->grid.next);
    igi_free(field->smooth);
    igi_free(field->side_irradiance);
    igi_free(field->std);
    igi_free(field->edge_begin);
    igi_free(field->edges);
    igi_free(field->nodes);
    igi_free(field);
}

/* A side that was not gathered: its lights are looked for, the rest is the neighbours'. */
static void irradiance_without_row(const igi_field *f, uint32_t surface, igi_vec point,
                                   float *irradiance)
{
    neighbour near[MAX_NEIGHBOURS];
    igi_vec normal = igi_tracer_normal(f->problem->tracer, igi_surface_triangle(surface));
    if (igi_surface_is_back(surface)) normal = igi_scale(normal, -1);
    int n = find_neighbours(f, point, normal, near);
    moments m = moments_of(near, n);
    for (size_t b = 0; b < f->bands; b++) {
        plane p;
        fit(near, n, &m, f->indirect + b, f->bands, &p);
        irradiance[b] = fmaxf(0.0f, p.value);
    }
    for (size_t l = 0; l < f->rows->lights; l++) {
        float direct = igi_light_irradiance(f->problem->lighting, f->problem->tracer, l, point,
                                            normal, 4, surface);
        for (size_t b = 0; b < f->bands; b++)
            irradiance[b] += direct * (float)f->problem->lights[l].value[b];
    }
}

void igi_field_irradiance(const igi_field *field, uint32_t surface, float u, float v,
                          float *irradiance)
{
    const igi_field *f = field;
    uint32_t triangle = igi_surface_triangle(surface);
    uint32_t patch = igi_patch_at(f->problem->patches, triangle, u, v);
    uint32_t row = f->rows->row_of[2 * patch + (igi_surface_is_back(surface) ? 1 : 0)];
    igi_vec point = igi_triangle_point(f->problem->patches->mesh, triangle, u, v);
    if (row == IGI_NO_ROW) {
        irradiance_without_row(f, surface, point, irradiance);
        return;
    }
    igi_vec offset = igi_sub(point, igi_v_of(f->rows->point + 3 * (size_t)row));
    for (size_t b = 0; b < f->bands; b++) {
        const linear *m = &f->smooth[row * f->bands + b];
        irradiance[b] = fminf(fmaxf(linear_at(m, offset), 0.5f * m->value), 2 * m->value);
    }
    for (size_t i = f->edge_begin[row]; i < f->edge_begin[row + 1]; i++) {
        const edge *e = &f->edges[i];
        float direct = fmaxf(0.0f, linear_at(&e->open, offset));
        if (direct > 0) direct *= igi_field_visible(f, e, triangle, u, v, point);
        for (size_t b = 0; b < f->bands; b++)
            irradiance[b] += direct * (float)f->problem->lights[e->light].value[b];
    }
}

bool igi_field_of_side(const igi_field *field, uint32_t side, float *irradiance)
{
    uint32_t row = field->rows->row_of[side];
    if (row == IGI_NO_ROW) return false;
    memcpy(irradiance, field->side_irradiance + row * field->bands,
           field->bands * sizeof *irradiance);
    return true;
}

float igi_field_std(const igi_field *field, uint32_t side)
{
    uint32_t row = field->rows->row_of[side];
    return row == IGI_NO_ROW ? 0 : field->std[row];
}

bool igi_field_has_edge(const igi_field *field, uint32_t side)
{
    uint32_t row = field->rows->row_of[side];
    return row != IGI_NO_ROW && field->edge_begin[row + 1] > field->edge_begin[row];
}

igi_vec igi_field_point(const igi_field *field, uint32_t side)
{
    return igi_v_of(field->rows->point + 3 * (size_t)field->rows->row_of[side]);
}
