/* SPDX-License-Identifier: Apache-2.0
 *
 * The field's parts, for field*.c alone.
 */
#ifndef IGI_SRC_DIFFUSE_FIELD_PRIVATE_H
#define IGI_SRC_DIFFUSE_FIELD_PRIVATE_H

#include "diffuse/field.h"

/* Radius of a neighbourhood. */
#define IGI_FIELD_RADIUS_PATCHES 2.5f
#define MAX_NEIGHBOURS 256
#define RIDGE 1e-3f /* of the normal equations, keeps narrow strips solvable */

/* value + gradient . (x - the row's point) */
typedef struct linear {
    float value;
    igi_vec gradient;
} linear;

static inline float linear_at(const linear *m, igi_vec offset)
{
    return m->value + igi_dot(m->gradient, offset);
}

#define NO_NODES SIZE_MAX
#define NODES_ALONG 5 /* of a cell */

/* A light whose shadow has a sharp edge in a row or beside it. */
typedef struct edge {
    uint32_t row, light;
    linear open, visible;
    size_t nodes; /* visible share at NODES_ALONG^2 points of the cell, from here in `nodes` */
} edge;

/* Rows by the cell of a grid that their point lies in. */
typedef struct row_grid {
    float side;
    size_t slots;
    uint32_t *first; /* [slots] a row of the cell, or IGI_NO_ROW */
    uint32_t *next;  /* [rows] the next of the same cell */
} row_grid;

struct igi_field {
    const igi_problem *problem;
    const igi_rows *rows;
    igi_rows *own_rows;
    size_t bands;
    float radius;     /* metres, of the neighbourhood */
    igi_vec *normals; /* [rows] */
    float *indirect;  /* [rows][bands] as gathered */
    row_grid grid;
    linear *smooth;         /* [rows][bands] indirect light, and lights without a sharp edge here */
    float *side_irradiance; /* [rows][bands] */
    float *std;             /* [rows] relative */
    size_t *edge_begin;     /* [rows + 1] */
    edge *edges;
    size_t node_count;
    size_t node_capacity;
    float *nodes;
};

typedef struct neighbour {
    uint32_t row;
    float x, y, weight; /* tangential, in radii */
} neighbour;

/* Weighted moments about the neighbours' mean place. */
typedef struct moments {
    float w, x, y, xx, xy, yy, det;
} moments;

/* value + slope . (x, y), slopes per radius; the variance of what it was fitted to about it, and of
 * its value. */
typedef struct plane {
    float value, slope[2], residual, variance;
} plane;

IGI_MUST_USE igi_status igi_row_grid_create(igi_context *ctx, const igi_rows *rows, float side,
                                            row_grid *grid);
/* Seen rows within the field's radius that lie in the plane and face alike; their number, at most
 * MAX_NEIGHBOURS. */
int igi_field_neighbours(const igi_field *field, igi_vec point, igi_vec normal, neighbour *found);
moments igi_moments_of(const neighbour *near, int count);
/* The plane through values[stride row] of the neighbours. */
void igi_plane_fit(const neighbour *near, int count, const moments *m, const float *values,
                   size_t stride, plane *p);
/* The same in world coordinates. */
linear igi_plane_linear(const plane *p, igi_vec normal, float radius);

/* Fits every seen row: smooth, side_irradiance, std and edges. */
IGI_MUST_USE igi_status igi_field_fit(igi_context *ctx, igi_field *field);

/* Share of the edge's light that reaches a point of its row's cell. */
float igi_field_visible(const igi_field *field, const edge *e, uint32_t triangle, float u, float v,
                        igi_vec point);

#endif
