/* SPDX-License-Identifier: Apache-2.0
 *
 * Edges of the mesh as a camera sees them, and where the photograph has them.
 *
 * Two neighbouring pixels that show different surfaces have an edge between them; bisecting with
 * rays finds it to a hundredth of a pixel, on this row and two rows away, which gives its slope. No
 * edge of the mesh is looked at as such: outlines of round things count like creases, and of what is
 * hidden nothing is known. A site is used where the block of pixels around shows these two surfaces
 * alone, each on its side, so that nothing else can be mistaken for it.
 */
#include "observe/edge_sites.h"

#include "base/context.h"
#include "scene/camera.h"

#include <math.h>
#include <stdlib.h>

/* Pixels beyond the reach that tell the level of a side. */
#define LEVEL_PIXELS 4
#define MOST_REACH 12
#define MOST_PIXELS (2 * (MOST_REACH + LEVEL_PIXELS) + 2)
#define SLOPE_ROWS 2
#define STEEPEST 1.05
#define BISECTIONS 7
/* How far the three crossings may be off a line, pixels. */
#define STRAIGHT .12
/* A lens scatters lamps' light about them, and saturated pixels are cut: pixels. */
#define LAMP_SIGMA .2
/* Rows (columns) that are looked along: each, but of large photographs so many; of those, at first
 * one of so many. */
#define MOST_ROWS 400
#define SPARSE 8

typedef struct finder {
    const igi_edge_search *search;
    igi_vec centre;
    float pixel_rad;
    uint32_t *labels; /* [height][width] of connected surfaces */
    int axis;         /* 0: along rows, 1: along columns */
    uint64_t rays;
} finder;

/* ---- surfaces: pixels joined where no edge lies between ---- */

static bool is_edge(const finder *f, int i, int k)
{
    const igi_visible *v = f->search->visible;
    if (v->near_edge[i] < 2 || v->near_edge[k] < 2) return false; /* an edge marks both its sides */
    return igi_visible_is_edge(f->search->scene, f->search->tracer, &v->hits[i], &v->hits[k],
                               f->pixel_rad);
}

static uint32_t root_of(uint32_t *parents, uint32_t i)
{
    while (parents[i] != i) i = parents[i] = parents[parents[i]];
    return i;
}

static void join(uint32_t *parents, uint32_t a, uint32_t b)
{
    a = root_of(parents, a);
    b = root_of(parents, b);
    if (a < b) parents[b] = a;
    else parents[a] = b;
}

static void label_surfaces(finder *f)
{
    int w = f->search->visible->width, h = f->search->visible->height;
    for (int i = 0; i < w * h; i++) f->labels[i] = (uint32_t)i;
    for (int y = 0; y < h; y++)
        for (int x = 0; x < w; x++) {
            int i = y * w + x;
            if (x + 1 < w && !is_edge(f, i, i + 1)) join(f->labels, (uint32_t)i, (uint32_t)i + 1);
            if (y + 1 < h && !is_edge(f, i, i + w)) join(f->labels, (uint32_t)i, (uint32_t)(i + w));
        }
    for (int i = 0; i < w * h; i++) f->labels[i] = root_of(f->labels, (uint32_t)i);
}

/* ---- one site ---- */

/* The index of a pixel, `along` the axis and `across` it; SIZE_MAX outside. */
static size_t pixel_at(const finder *f, int along, int across)
{
    int x = f->axis == 0 ? along : across, y = f->axis == 0 ? across : along;
    if (x < 0 || y < 0 || x >= f->search->visible->width || y >= f->search->visible->height)
        return SIZE_MAX;
    return (size_t)y * (size_t)f->search->visible->width + (size_t)x;
}

static igi_hit look(finder *f, double along, double across)
{
    double x = f->axis == 0 ? along : across, y = f->axis == 0 ? across : along;
    f->rays++;
    return igi_trace(f->search->tracer, f->centre, igi_camera_direction(f->search->camera, x, y));
}

static bool is_lamp(const finder *f, const igi_hit *hit)
{
    return hit->triangle != IGI_NO_HIT &&
           f->search->scene->regions[f->search->scene->mesh.regions[hit->triangle]].emitter;
}

typedef struct crossing {
    double place;
    igi_hit before, after; /* of rays a hundredth of a pixel to either side */
} crossing;

/* The edge between two pixels' centres. */
static crossing bisect(finder *f, int along, int across)
{
    double low = along + .5, high = along + 1.5;
    igi_hit a = f->search->visible->hits[pixel_at(f, along, across)];
    igi_hit b = f->search->visible->hits[pixel_at(f, along + 1, across)];
    for (int i = 0; i < BISECTIONS; i++) {
        double middle = (low + high) / 2;
        igi_hit hit = look(f, middle, across + .5);
        if (igi_visible_is_edge(f->search->scene, f->search->tracer, &a, &hit, f->pixel_rad)) {
            high = middle;
            if (!igi_visible_is_edge(f->search->scene, f->search->tracer, &hit, &b, f->pixel_rad))
                b = hit;
        } else {
            low = middle;
            a = hit;
        }
    }
    return (crossing){(low + high) / 2, a, b};
}

static const igi_hit *nearer_of(const crossing *c)
{
    bool before = c->after.triangle == IGI_NO_HIT ||
                  (c->before.triangle != IGI_NO_HIT && c->before.distance < c->after.distance);
    return before ? &c->before : &c->after;
}

static igi_vec point_of(const finder *f, const igi_hit *hit)
{
    return igi_triangle_point(&f->search->scene->mesh, hit->triangle, hit->u, hit->v);
}

/* The surfaces touch, and each lies before the other. */
static bool is_corner(const finder *f, const crossing *c)
{
    if (c->before.triangle == IGI_NO_HIT || c->after.triangle == IGI_NO_HIT) return false;
    igi_vec way = igi_sub(point_of(f, &c->after), point_of(f, &c->before));
    igi_vec normal = igi_tracer_normal(f->search->tracer, c->before.triangle);
    float before = igi_dot(normal, way) * (c->before.back ? -1.0f : 1.0f);
    return before > 0 && igi_length(way) < f->pixel_rad * c->before.distance;
}

/* The same edge some rows away: the pixel before it, or INT_MIN. */
static bool find_again(const finder *f, int along, int across, const uint32_t sides[2], int *found)
{
    for (int d = 0; d <= 2 * SLOPE_ROWS + 1; d++)
        for (int sign = -1; sign <= 1; sign += 2) {
            size_t a = pixel_at(f, along + sign * d, across);
            size_t b = pixel_at(f, along + sign * d + 1, across);
            if (a == SIZE_MAX || b == SIZE_MAX) continue;
            if (f->labels[a] != sides[0] || f->labels[b] != sides[1]) continue;
            *found = along + sign * d;
            return true;
        }
    return false;
}

/* The edge on this row, and its slope. */
static bool trace_edge(finder *f, int along, int across, const uint32_t sides[2], crossing *here,
                       double *slope)
{
    int there[2];
    double place[2];
    for (int k = 0; k < 2; k++)
        if (!find_again(f, along, across + (k ? SLOPE_ROWS : -SLOPE_ROWS), sides, &there[k]))
            return false;
    if (abs(there[1] - there[0]) > 2 * SLOPE_ROWS * STEEPEST + 1) return false;
    *here = bisect(f, along, across);
    for (int k = 0; k < 2; k++)
        place[k] = bisect(f, there[k], across + (k ? SLOPE_ROWS : -SLOPE_ROWS)).place;
    *slope = (place[1] - place[0]) / (2 * SLOPE_ROWS);
    return fabs(*slope) <= STEEPEST && fabs((place[0] + place[1]) / 2 - here->place) < STRAIGHT;
}

/* The row of pixels that a site is measured on. */
typedef struct strip {
    int across, first, count;
    double place, slope; /* of the edge on this row, and as it leans */
    double reach;
    const uint32_t *sides;
} strip;

/* Around the site there are these two surfaces alone, each on its side of the line. */
static bool is_alone(const finder *f, const strip *s)
{
    int rows = (int)ceil(s->reach);
    for (int r = -rows; r <= rows; r++)
        for (int k = s->first; k < s->first + s->count; k++) {
            size_t at = pixel_at(f, k, s->across + r);
            double off = k + .5 - (s->place + s->slope * r);
            if (at == SIZE_MAX) return false;
            if (fabs(off) < 1) {
                if (f->labels[at] != s->sides[0] && f->labels[at] != s->sides[1]) return false;
            } else if (f->labels[at] != s->sides[off > 0]) {
                return false;
            }
        }
    return true;
}

/* As wide as what is searched, or else half as wide: in small pictures few edges are alone. */
static bool lay_strip(const finder *f, strip *s)
{
    s->reach = fmin(f->search->reach, MOST_REACH - 1);
    for (int attempt = 0; attempt < 2; attempt++, s->reach /= 2) {
        int wide = (int)ceil(s->reach + fabs(s->slope) / 2) + LEVEL_PIXELS;
        s->first = (int)floor(s->place) - wide;
        s->count = 2 * wide + 1;
        if (s->count <= MOST_PIXELS && is_alone(f, s)) return true;
    }
    return false;
}

/* One number a pixel: how far its colour lies on the way from the one side's to the other's. */
static bool project_colours(const finder *f, const strip *s, double *y)
{
    const igi_image *image = f->search->photo;
    int bands = f->search->scene->bands, count = s->count;
    double way[IGI_MAX_BANDS] = {0}, length = 0;
    const float *pixels[MOST_PIXELS];
    for (int i = 0; i < count; i++)
        pixels[i] = image->samples + pixel_at(f, s->first + i, s->across) * (size_t)image->channels;
    for (int b = 0; b < bands; b++) {
        for (int i = 0; i < LEVEL_PIXELS; i++)
            way[b] += (double)pixels[count - 1 - i][b] - (double)pixels[i][b];
        length += way[b] * way[b];
    }
    if (!(length > 0 && isfinite(length))) return false;
    for (int i = 0; i < count; i++) {
        y[i] = 0;
        for (int b = 0; b < bands; b++) y[i] += (double)pixels[i][b] * way[b] / sqrt(length);
    }
    return true;
}

static igi_status add_site(igi_context *ctx, finder *f, int along, int across,
                           igi_edge_sites *sites)
{
    size_t here = pixel_at(f, along, across), next = pixel_at(f, along + 1, across);
    const uint32_t sides[2] = {f->labels[here], f->labels[next]};
    strip s = {.across = across, .sides = sides};
    double y[MOST_PIXELS], seen, sigma;
    crossing edge;
    bool lit = is_lamp(f, &f->search->visible->hits[here]) ||
               is_lamp(f, &f->search->visible->hits[next]);
    if (sides[0] == sides[1] || !trace_edge(f, along, across, sides, &edge, &s.slope))
        return IGI_OK;
    s.place = edge.place;
    if (!lay_strip(f, &s) || !project_colours(f, &s, y) ||
        !igi_edge_profile_measure(y, s.count, s.place - s.first, s.reach, s.slope, &seen, &sigma))
        return IGI_OK;
    igi_edge_site *grown = igi_grow(ctx, sites->sites, &sites->capacity, sites->count + 1,
                                    sizeof *grown);
    if (!grown) return IGI_E_SYSTEM;
    sites->sites = grown;
    double norm = 1 / sqrt(1 + s.slope * s.slope);
    igi_edge_site *site = &grown[sites->count++];
    int a = f->axis, b = 1 - f->axis;
    const igi_hit *nearer = nearer_of(&edge);
    site->point = point_of(f, nearer);
    site->region = f->search->scene->mesh.regions[nearer->triangle];
    site->seen[a] = seen + s.first;
    site->seen[b] = across + .5;
    site->normal[a] = norm;
    site->normal[b] = -s.slope * norm;
    site->offset = (seen + s.first - s.place) * norm;
    site->sigma = hypot(sigma, lit ? LAMP_SIGMA : 0) * norm;
    site->corner = is_corner(f, &edge);
    return IGI_OK;
}

static igi_status scan(igi_context *ctx, finder *f, int first, int step, igi_edge_sites *sites)
{
    for (f->axis = 0; f->axis < 2; f->axis++) {
        int length = f->axis == 0 ? f->search->visible->width : f->search->visible->height;
        int rows = f->axis == 0 ? f->search->visible->height : f->search->visible->width;
        for (int across = first; across < rows; across += step)
            for (int along = 0; along + 1 < length; along++)
                IGI_TRY(add_site(ctx, f, along, across, sites));
    }
    return IGI_OK;
}

/* Every eighth row first, then those halfway between, until that is enough. */
static igi_status scan_all(igi_context *ctx, finder *f, igi_edge_sites *sites)
{
    int least = (f->search->visible->height + MOST_ROWS - 1) / MOST_ROWS;
    sites->step = SPARSE * least;
    IGI_TRY(scan(ctx, f, 0, sites->step, sites));
    for (; sites->step > least && sites->count < f->search->enough; sites->step /= 2)
        IGI_TRY(scan(ctx, f, sites->step / 2, sites->step, sites));
    return IGI_OK;
}

igi_status igi_edge_sites_find(igi_context *ctx, const igi_edge_search *search,
                               igi_edge_sites *sites)
{
    igi_status status = IGI_OK;
    finder f = {.search = search,
                .centre = igi_camera_centre(search->camera),
                .pixel_rad = (float)(1 / search->camera->fl_x)};
    size_t pixels = (size_t)search->visible->width * (size_t)search->visible->height;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, pixels, &f.labels));
    label_surfaces(&f);
    sites->count = 0;
    IGI_TRY_GOTO(scan_all(ctx, &f, sites));
cleanup:
    igi_count_rays(ctx, f.rays);
    igi_free(f.labels);
    return status;
}
