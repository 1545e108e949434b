/* SPDX-License-Identifier: Apache-2.0
 *
 * Where does the brightness step lie that belongs to an edge between two regions? Across the edge,
 * six pixels of one region and six of the other: the outer three of each give the two levels a and
 * b, and the inner six say how many of them are a's,
 *     offset = sum (I - b) / (a - b) - 3,
 * whatever the shape of the pixel's filter. Noise averages out over edges, and so do shadows in
 * corners, which pull edges that face each other opposite ways. A content shifted by (dx, dy) moves
 * the crossing of an edge x = x0 + s (y - y0) along its row by dx - s dy: least squares, robustly,
 * over all edges.
 */
#include "observe/edges.h"

#include "base/order.h"

#include <math.h>
#include <stdlib.h>

#define OUTER 3 /* pixels a side whose level counts, */
#define INNER 3 /* and those between: the farthest offset that can be seen */
#define REACH (OUTER + INNER)
#define SLOPE_ROWS 3    /* rows up and down in which the same edge gives its slope */
#define STEEPEST 0.67   /* columns a row; of what is steeper the other direction tells more */
#define LEAST_STEP 0.25 /* of the brighter level */
#define STEP_SIGMAS 4.0
#define SHARP 0.12 /* of the step */
#define FEWEST_EDGES 30
#define HUBER_PX 0.5
#define HOLLOW_PX \
    30.0 /* surfaces that are nearer to each other than so many pixels may shade each
                          other */

typedef struct edge {
    double slope; /* of the content along the other axis */
    double offset;
    int axis; /* 0: crossed along a row, 1: along a column */
} edge;

typedef struct scan {
    const igi_scene *scene;
    const igi_image *image;
    const igi_visible *visible;
    double pixel_rad;
    edge *edges;
    size_t count, capacity;
} scan;

/* The region that a pixel shows, and its side; nothing: -1. */
static int64_t shown(const scan *s, int x, int y)
{
    const igi_visible *v = s->visible;
    if (x < 0 || y < 0 || x >= v->width || y >= v->height) return -1;
    const igi_hit *hit = &v->hits[(size_t)y * (size_t)v->width + (size_t)x];
    if (hit->triangle == IGI_NO_HIT) return -1;
    uint32_t region = s->scene->mesh.regions[hit->triangle];
    if (s->scene->regions[region].emitter) return -1;
    return (int64_t)region << 1 | (hit->back ? 1 : 0);
}

/* Where two surfaces meet in a hollow, light falls off toward the seam on both sides and the step of
 * brightness says nothing of where the seam lies. */
static bool is_hollow(const scan *s, const igi_hit *a, const igi_hit *b, double pixel_rad)
{
    const igi_mesh *mesh = &s->scene->mesh;
    igi_vec way = igi_sub(igi_triangle_point(mesh, b->triangle, b->u, b->v),
                          igi_triangle_point(mesh, a->triangle, a->u, a->v));
    igi_vec na = igi_triangle_normal(mesh, a->triangle),
            nb = igi_triangle_normal(mesh, b->triangle);
    double near = (double)igi_length(way) / (HOLLOW_PX * pixel_rad * (double)a->distance);
    double rise = (double)igi_dot(na, way) * (a->back ? -1 : 1),
           fall = (double)igi_dot(nb, way) * (b->back ? -1 : 1);
    return near < 1 &&
           (rise > 0.1 * (double)igi_length(way) || fall < -0.1 * (double)igi_length(way));
}

static double level(const scan *s, int x, int y)
{
    const igi_image *image = s->image;
    const float *p = image->samples +
                     ((size_t)y * (size_t)image->width + (size_t)x) * (size_t)image->channels;
    double sum = 0;
    for (int b = 0; b < s->scene->bands; b++) sum += (double)p[b];
    return sum;
}

/* The column (row) by which the edge between `left` and `right` moves in another row; false: it is
 * not there. */
static bool find_again(const scan *s, int x, int y, int axis, int rows, int *moved)
{
    int64_t left = shown(s, x, y), right = axis == 0 ? shown(s, x + 1, y) : shown(s, x, y + 1);
    for (int d = 0; d <= SLOPE_ROWS; d++)
        for (int sign = -1; sign <= 1; sign += 2) {
            int k = sign * d;
            int u = axis == 0 ? x + k : x + rows, v = axis == 0 ? y + rows : y + k;
            if (shown(s, u, v) != left) continue;
            if ((axis == 0 ? shown(s, u + 1, v) : shown(s, u, v + 1)) != right) continue;
            *moved = k;
            return true;
        }
    return false;
}

/* Up to the step and from it on, the inner pixels must have the outer ones' levels: what changes
 * slowly is shading, not an edge. */
static bool is_sharp(const double inner[2 * INNER], const double outer[2], double offset)
{
    double sum[2] = {0, 0}, n[2] = {0, 0}, step = outer[0] - outer[1];
    for (int k = 0; k < 2 * INNER; k++) {
        double from = k - INNER - offset; /* of the pixel's left end from the step */
        if (from > -1 && from < 0) continue;
        int side = from >= 0;
        sum[side] += inner[k];
        n[side]++;
    }
    for (int side = 0; side < 2; side++)
        if (n[side] > 0 && fabs(sum[side] / n[side] - outer[side]) > SHARP * fabs(step))
            return false;
    return true;
}

/* The levels of both sides and the offset between; false: no clear step. */
static bool measure(const scan *s, int x, int y, int axis, double *offset)
{
    double outer[2] = {0, 0}, squares[2] = {0, 0}, inner = 0, values[2 * INNER];
    int64_t sides[2] = {shown(s, x, y), axis == 0 ? shown(s, x + 1, y) : shown(s, x, y + 1)};
    if (sides[0] < 0 || sides[1] < 0 || sides[0] == sides[1]) return false;
    for (int k = 1 - REACH; k <= REACH; k++) {
        int u = axis == 0 ? x + k : x, v = axis == 0 ? y : y + k, side = k > 0;
        if (shown(s, u, v) != sides[side]) return false;
        double value = level(s, u, v);
        if (!isfinite(value)) return false;
        if (k > INNER || k <= -INNER) {
            outer[side] += value / OUTER;
            squares[side] += value * value / OUTER;
        } else inner += values[k + INNER - 1] = value;
    }
    double step = outer[0] - outer[1], high = fmax(outer[0], outer[1]);
    double scatter = fmax(0, squares[0] - outer[0] * outer[0]) +
                     fmax(0, squares[1] - outer[1] * outer[1]);
    if (fabs(step) < LEAST_STEP * high || step * step < STEP_SIGMAS * STEP_SIGMAS * scatter)
        return false;
    *offset = (inner - 2 * INNER * outer[1]) / step - INNER;
    return fabs(*offset) < INNER && is_sharp(values, outer, *offset);
}

static igi_status scan_pixel(igi_context *ctx, scan *s, int x, int y, int axis)
{
    edge e = {.axis = axis};
    int up, down;
    const igi_hit *a = &s->visible->hits[(size_t)y * (size_t)s->visible->width + (size_t)x];
    const igi_hit *b = a + (axis == 0 ? 1 : s->visible->width);
    if (a->triangle == IGI_NO_HIT || b->triangle == IGI_NO_HIT || is_hollow(s, a, b, s->pixel_rad))
        return IGI_OK;
    if (!measure(s, x, y, axis, &e.offset)) return IGI_OK;
    if (!find_again(s, x, y, axis, -SLOPE_ROWS, &up) ||
        !find_again(s, x, y, axis, SLOPE_ROWS, &down))
        return IGI_OK;
    e.slope = (double)(down - up) / (2 * SLOPE_ROWS);
    if (fabs(e.slope) > STEEPEST) return IGI_OK;
    edge *grown = igi_grow(ctx, s->edges, &s->capacity, s->count + 1, sizeof *grown);
    if (!grown) return IGI_E_SYSTEM;
    s->edges = grown;
    s->edges[s->count++] = e;
    return IGI_OK;
}

static double residual_of(const edge *e, const double shift[2])
{
    return e->offset - shift[e->axis] + e->slope * shift[1 - e->axis];
}

/* One step of reweighted least squares; the inverse of its matrix is the covariance of `shift` for
 * residuals of variance 1. */
static bool improve(const scan *s, double shift[2], double inverse[3])
{
    double m[3] = {0, 0, 0}, v[2] = {0, 0};
    for (size_t i = 0; i < s->count; i++) {
        const edge *e = &s->edges[i];
        double row[2], r = fabs(residual_of(e, shift)), w = r > HUBER_PX ? HUBER_PX / r : 1;
        row[e->axis] = 1;
        row[1 - e->axis] = -e->slope;
        m[0] += w * row[0] * row[0];
        m[1] += w * row[0] * row[1];
        m[2] += w * row[1] * row[1];
        for (int k = 0; k < 2; k++) v[k] += w * row[k] * e->offset;
    }
    double det = m[0] * m[2] - m[1] * m[1];
    if (!(det > 1e-3 * m[0] * m[2])) return false; /* all edges run one way */
    inverse[0] = m[2] / det, inverse[1] = -m[1] / det, inverse[2] = m[0] / det;
    for (int k = 0; k < 2; k++) shift[k] = inverse[k] * v[0] + inverse[k + 1] * v[1];
    return true;
}

static igi_status fit(igi_context *ctx, const scan *s, igi_registration *r)
{
    double inverse[3] = {0, 0, 0}, *distances;
    if (s->count < FEWEST_EDGES) return IGI_OK;
    for (int round = 0; round < 8; round++)
        if (!improve(s, r->offset, inverse)) {
            r->offset[0] = r->offset[1] = 0;
            return IGI_OK;
        }
    IGI_TRY(IGI_ALLOC(ctx, s->count, &distances));
    for (size_t i = 0; i < s->count; i++) distances[i] = fabs(residual_of(&s->edges[i], r->offset));
    r->residual = igi_median(distances, s->count);
    r->offset_error = 1.4826 * r->residual * sqrt(fmax(inverse[0], inverse[2]));
    r->edges = s->count;
    igi_free(distances);
    return IGI_OK;
}

igi_status igi_registration_measure(igi_context *ctx, const igi_scene *scene,
                                    const igi_image *image, const igi_visible *visible,
                                    double pixel_rad, igi_registration *registration)
{
    igi_status status = IGI_OK;
    scan s = {.scene = scene, .image = image, .visible = visible, .pixel_rad = pixel_rad};
    *registration = (igi_registration){0};
    for (int y = 0; y + 1 < visible->height; y++)
        for (int x = 0; x + 1 < visible->width; x++) {
            size_t i = (size_t)y * (size_t)visible->width + (size_t)x;
            if (visible->near_edge[i] < 2) continue;
            if (visible->near_edge[i + 1] >= 2) IGI_TRY_GOTO(scan_pixel(ctx, &s, x, y, 0));
            if (visible->near_edge[i + (size_t)visible->width] >= 2)
                IGI_TRY_GOTO(scan_pixel(ctx, &s, x, y, 1));
        }
    IGI_TRY_GOTO(fit(ctx, &s, registration));
cleanup:
    igi_free(s.edges);
    return status;
}
