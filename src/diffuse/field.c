/* SPDX-License-Identifier: Apache-2.0
 *
 * The field is made in three steps: rows, as gathered; planes fitted through them (field_fit.c);
 * and, where a region asks for it, shadows' edges (field_edges.c).
 */
#include "diffuse/field_parts.h"

#include <string.h>

#define DEFAULT_RAYS 32

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
        for (size_t b = 0; diffuse->received && b < f->bands; b++)
            f->indirect[i * f->bands + b] += diffuse->received[i * f->bands + b];
    }
    return igi_row_grid_create(ctx, r, f->radius, &f->grid);
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
    f->radius = IGI_FIELD_RADIUS_PATCHES * problem->patches->size_m;
    f->rows = diffuse->rows;
    if (!f->rows) {
        IGI_TRY_GOTO(gather_now(ctx, f, diffuse));
        f->rows = f->own_rows;
    }
    IGI_TRY_GOTO(prepare(ctx, f, diffuse));
    IGI_TRY_GOTO(igi_field_fit(ctx, f));
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
    int n = igi_field_neighbours(f, point, normal, near);
    moments m = igi_moments_of(near, n);
    for (size_t b = 0; b < f->bands; b++) {
        plane p;
        igi_plane_fit(near, n, &m, f->indirect + b, f->bands, &p);
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
    bool back = igi_surface_is_back(surface);
    uint32_t row = f->rows->row_of[igi_side_at(f->problem->patches, triangle, u, v, back)];
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
