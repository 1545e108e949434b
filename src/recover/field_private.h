/* SPDX-License-Identifier: Apache-2.0
 *
 * The field's parts, for field*.c alone.
 */
#ifndef IGI_SRC_RECOVER_FIELD_PRIVATE_H
#define IGI_SRC_RECOVER_FIELD_PRIVATE_H

#include "recover/field.h"

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

/* Share of the edge's light that reaches a point of its row's cell. */
float igi_field_visible(const igi_field *field, const edge *e, uint32_t triangle, float u, float v,
                        igi_vec point);

#endif
