/* SPDX-License-Identifier: Apache-2.0
 *
 * Charts grow from one triangle over shared edges as long as triangles face within 26 degrees of
 * the first, so that flattening them onto its plane neither folds nor shrinks them much. They are
 * packed by shelves, highest first (Coffman et al. 1980), and the scale is found by bisection.
 */
#include "scene/atlas.h"

#include "base/rng.h"
#include "base/vec.h"

#include <stdlib.h>
#include <string.h>

#define FACING_COS 0.9f
#define BISECTIONS 24
/* Room between charts, of the unit square: a texel of a small map, or less where charts are many. */
#define GUTTER (1.0f / 64)
#define GUTTER_SHARE (1.0f / 16) /* of a mean chart's side */
#define NONE UINT32_MAX

typedef struct chart {
    uint32_t first;        /* member of the chart's chain */
    float low[2], size[2]; /* its box in its own plane, metres */
    float at[2];           /* packed place of the box, unit square */
    igi_vec axis[2];
    bool turned; /* lies on its side */
} chart;

typedef struct work {
    const igi_mesh *mesh;
    igi_atlas *atlas;
    uint32_t *neighbours; /* [count][3] member across each edge, or NONE */
    uint32_t *next;       /* [count] the next member of the same chart */
    bool *taken;          /* [count] */
    uint32_t *queue;      /* [count] */
    chart *charts;
    size_t chart_count;
    uint32_t *order; /* [charts] highest first */
} work;

static igi_vec corner(const work *w, uint32_t member, int k)
{
    size_t t = w->atlas->triangles[member];
    return igi_v_of(w->mesh->positions + 3 * (size_t)w->mesh->triangles[3 * t + (size_t)(k % 3)]);
}

static igi_vec normal_of(const work *w, uint32_t member)
{
    igi_vec a = corner(w, member, 0);
    return igi_normalize(
        igi_cross(igi_sub(corner(w, member, 1), a), igi_sub(corner(w, member, 2), a)));
}

/* Open addressing: the first triangle at an edge waits for the second. */
static igi_status link_neighbours(igi_context *ctx, work *w)
{
    size_t edges = 3 * w->atlas->count, slots = 64;
    while (slots < 2 * edges) slots *= 2;
    uint32_t *table; /* edge + 1, or 0 */
    IGI_TRY(IGI_ALLOC(ctx, slots, &table));
    for (uint32_t e = 0; e < edges; e++) {
        const uint32_t *v = w->mesh->triangles + 3 * (size_t)w->atlas->triangles[e / 3];
        uint32_t a = v[e % 3], b = v[(e + 1) % 3];
        uint64_t key = a < b ? (uint64_t)a << 32 | b : (uint64_t)b << 32 | a;
        w->neighbours[e] = NONE;
        for (size_t i = igi_hash64(key) & (slots - 1);; i = (i + 1) & (slots - 1)) {
            if (table[i] == 0) {
                table[i] = e + 1;
                break;
            }
            uint32_t other = table[i] - 1;
            const uint32_t *o = w->mesh->triangles + 3 * (size_t)w->atlas->triangles[other / 3];
            uint32_t c = o[other % 3], d = o[(other + 1) % 3];
            if (!((a == c && b == d) || (a == d && b == c))) continue;
            /* A neighbour runs along the edge the other way; else it lies on the same side of it.
             * A third triangle at an edge is none's neighbour. */
            if (w->neighbours[other] == NONE && a == d) {
                w->neighbours[e] = other / 3;
                w->neighbours[other] = e / 3;
            }
            break;
        }
    }
    igi_free(table);
    return IGI_OK;
}

static void extend_box(const work *w, uint32_t member, const igi_vec axis[2], float low[2],
                       float high[2])
{
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 2; i++) {
            float x = igi_dot(corner(w, member, k), axis[i]);
            low[i] = fminf(low[i], x);
            high[i] = fmaxf(high[i], x);
        }
}

/* The box along the edge of the first triangle that makes it smallest. */
static void find_box(const work *w, chart *c)
{
    igi_vec normal = normal_of(w, c->first);
    float best = INFINITY;
    for (int k = 0; k < 3; k++) {
        igi_vec along = igi_normalize(igi_sub(corner(w, c->first, k + 1), corner(w, c->first, k)));
        igi_vec axis[2] = {along, igi_cross(normal, along)};
        float low[2] = {INFINITY, INFINITY}, high[2] = {-INFINITY, -INFINITY};
        for (uint32_t m = c->first; m != NONE; m = w->next[m]) extend_box(w, m, axis, low, high);
        float area = (high[0] - low[0]) * (high[1] - low[1]);
        if (!(area < best)) continue;
        best = area;
        for (int i = 0; i < 2; i++) {
            c->axis[i] = axis[i];
            c->low[i] = low[i];
            c->size[i] = high[i] - low[i];
        }
    }
    c->turned = c->size[1] > c->size[0];
}

static void grow_chart(work *w, uint32_t first)
{
    chart *c = &w->charts[w->chart_count++];
    igi_vec normal = normal_of(w, first);
    size_t head = 0, tail = 0;
    c->first = first;
    w->queue[tail++] = first;
    w->taken[first] = true;
    while (head < tail) {
        uint32_t m = w->queue[head++];
        w->next[m] = NONE;
        for (int k = 0; k < 3; k++) {
            uint32_t n = w->neighbours[3 * m + (uint32_t)k];
            if (n == NONE || w->taken[n] || igi_dot(normal, normal_of(w, n)) < FACING_COS) continue;
            w->taken[n] = true;
            w->queue[tail++] = n;
        }
        if (head < tail) w->next[m] = w->queue[head];
    }
    find_box(w, c);
}

typedef struct rank {
    float height;
    uint32_t chart;
} rank;

static int compare_ranks(const void *pa, const void *pb)
{
    const rank *a = pa, *b = pb;
    if (a->height != b->height) return a->height > b->height ? -1 : 1;
    return a->chart < b->chart ? -1 : 1;
}

static igi_status order_charts(igi_context *ctx, work *w)
{
    rank *ranks;
    IGI_TRY(IGI_ALLOC(ctx, w->chart_count, &ranks));
    for (size_t i = 0; i < w->chart_count; i++)
        ranks[i] = (rank){fminf(w->charts[i].size[0], w->charts[i].size[1]), (uint32_t)i};
    qsort(ranks, w->chart_count, sizeof *ranks, compare_ranks);
    for (size_t i = 0; i < w->chart_count; i++) w->order[i] = ranks[i].chart;
    igi_free(ranks);
    return IGI_OK;
}

/* Sets every chart on a shelf; false when they do not fit at this scale. */
static bool pack(work *w, float scale, float gutter)
{
    float x = 0, y = 0, shelf = 0;
    for (size_t i = 0; i < w->chart_count; i++) {
        chart *c = &w->charts[w->order[i]];
        float width = c->size[c->turned] * scale, height = c->size[!c->turned] * scale;
        if (x > 0 && x + width > 1) {
            y += shelf + gutter;
            x = shelf = 0;
        }
        shelf = fmaxf(shelf, height);
        if (x + width > 1 || y + shelf > 1) return false;
        c->at[0] = x;
        c->at[1] = y;
        x += width + gutter;
    }
    return true;
}

static void find_scale(work *w)
{
    float longest = 0, gutter = fminf(GUTTER, GUTTER_SHARE / sqrtf((float)w->chart_count));
    for (size_t i = 0; i < w->chart_count; i++)
        longest = fmaxf(longest, w->charts[i].size[w->charts[i].turned]);
    float fits = 0, fails = longest > 0 ? 1 / longest : 1;
    if (pack(w, fails, gutter)) fits = fails;
    for (int i = 0; i < BISECTIONS && fits < fails; i++) {
        float middle = 0.5f * (fits + fails);
        if (pack(w, middle, gutter)) fits = middle;
        else fails = middle;
    }
    (void)pack(w, fits, gutter);
    w->atlas->uv_per_m = fits;
}

static void set_uvs(const work *w)
{
    float scale = w->atlas->uv_per_m;
    for (size_t i = 0; i < w->chart_count; i++) {
        const chart *c = &w->charts[i];
        for (uint32_t m = c->first; m != NONE; m = w->next[m])
            for (int k = 0; k < 3; k++) {
                float *uv = w->atlas->uvs + 6 * (size_t)m + 2 * k;
                for (int a = 0; a < 2; a++) {
                    float x = igi_dot(corner(w, m, k), c->axis[a]) - c->low[a];
                    int to = c->turned ? 1 - a : a;
                    uv[to] = fminf(fmaxf(c->at[to] + x * scale, 0.0f), 1.0f);
                }
            }
    }
}

static igi_status list_triangles(igi_context *ctx, igi_atlas *a, const igi_mesh *mesh,
                                 uint32_t region)
{
    for (size_t t = 0; t < mesh->triangle_count; t++) a->count += mesh->regions[t] == region;
    IGI_TRY(IGI_ALLOC(ctx, a->count, &a->triangles));
    IGI_TRY(IGI_ALLOC(ctx, 6 * a->count, &a->uvs));
    size_t n = 0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++)
        if (mesh->regions[t] == region) a->triangles[n++] = t;
    return IGI_OK;
}

igi_status igi_atlas_create(igi_context *ctx, const igi_mesh *mesh, uint32_t region,
                            igi_atlas **atlas)
{
    igi_status status = IGI_OK;
    work w = {.mesh = mesh};
    *atlas = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &w.atlas));
    IGI_TRY_GOTO(list_triangles(ctx, w.atlas, mesh, region));
    size_t n = w.atlas->count;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 3 * n, &w.neighbours));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n, &w.next));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n, &w.taken));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n, &w.queue));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n, &w.charts));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n, &w.order));
    IGI_TRY_GOTO(link_neighbours(ctx, &w));
    for (uint32_t m = 0; m < n; m++)
        if (!w.taken[m]) grow_chart(&w, m);
    if (n > 0) {
        IGI_TRY_GOTO(order_charts(ctx, &w));
        find_scale(&w);
        set_uvs(&w);
    }
    *atlas = w.atlas;
    w.atlas = NULL;
cleanup:
    igi_atlas_destroy(w.atlas);
    igi_free(w.neighbours);
    igi_free(w.next);
    igi_free(w.taken);
    igi_free(w.queue);
    igi_free(w.charts);
    igi_free(w.order);
    return status;
}

void igi_atlas_destroy(igi_atlas *atlas)
{
    if (!atlas) return;
    igi_free(atlas->triangles);
    igi_free(atlas->uvs);
    igi_free(atlas);
}

igi_status igi_atlas_fill(igi_context *ctx, const igi_mesh *mesh, uint32_t region, float *uvs)
{
    igi_atlas *atlas;
    IGI_TRY(igi_atlas_create(ctx, mesh, region, &atlas));
    for (size_t i = 0; i < atlas->count; i++)
        memcpy(uvs + 6 * (size_t)atlas->triangles[i], atlas->uvs + 6 * i, 6 * sizeof *uvs);
    igi_atlas_destroy(atlas);
    return IGI_OK;
}
