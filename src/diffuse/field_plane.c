/* SPDX-License-Identifier: Apache-2.0
 *
 * Rows about a point, and the plane through their values: what moving least squares is made of.
 */
#include "diffuse/field_parts.h"

#define THIN_PATCHES 0.02f
#define FACING_COS 0.9f

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
igi_status igi_row_grid_create(igi_context *ctx, const igi_rows *rows, float side, row_grid *g)
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

int igi_field_neighbours(const igi_field *f, igi_vec point, igi_vec normal, neighbour *found)
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

moments igi_moments_of(const neighbour *near, int n)
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

void igi_plane_fit(const neighbour *near, int n, const moments *m, const float *values,
                   size_t stride, plane *p)
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

linear igi_plane_linear(const plane *p, igi_vec normal, float radius)
{
    igi_vec t, b;
    igi_frame_of(normal, &t, &b);
    igi_vec gradient = igi_madd(igi_scale(t, p->slope[0] / radius), b, p->slope[1] / radius);
    return (linear){p->value, gradient};
}
