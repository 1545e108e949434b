/* SPDX-License-Identifier: Apache-2.0
 *
 * Triangles with the same three corners lie on each other. Two triangles of one surface run through
 * their common edge in opposite directions; where they run the same way, one of them is turned
 * around. Edges of more than two triangles (where walls meet boxes) say nothing.
 */
#include "check/mesh_faults.h"

#include "base/rng.h"

#include <math.h>
#include <stdlib.h>

typedef struct record {
    uint64_t key;
    uint32_t triangle;
    int8_t sense; /* of an edge: +1, -1; of a triangle: 0 */
} record;

static int compare_records(const void *a, const void *b)
{
    const record *x = a, *y = b;
    if (x->key != y->key) return x->key < y->key ? -1 : 1;
    return (x->triangle > y->triangle) - (x->triangle < y->triangle);
}

/* A corner's place on a grid, hashed. */
static uint64_t corner_key(const igi_mesh *mesh, uint32_t vertex, double cell)
{
    uint64_t key = 0;
    for (int k = 0; k < 3; k++)
        key = igi_hash64(key ^ (uint64_t)(int64_t)llround(
                                   (double)mesh->positions[3 * vertex + (uint32_t)k] / cell));
    return key;
}

static double extent(const igi_mesh *mesh)
{
    double low = HUGE_VAL, high = -HUGE_VAL;
    for (size_t i = 0; i < 3 * mesh->vertex_count; i++) {
        low = fmin(low, (double)mesh->positions[i]);
        high = fmax(high, (double)mesh->positions[i]);
    }
    return high > low ? high - low : 1;
}

static void describe(const igi_mesh *mesh, uint32_t triangle, const uint64_t *corners, record *face,
                     record edges[3])
{
    uint64_t c[3];
    for (int k = 0; k < 3; k++) c[k] = corners[mesh->triangles[3 * triangle + (uint32_t)k]];
    /* the same for any order of the corners */
    *face = (record){igi_hash64(c[0]) + igi_hash64(c[1]) + igi_hash64(c[2]), triangle, 0};
    for (int k = 0; k < 3; k++) {
        uint64_t a = c[k], b = c[(k + 1) % 3];
        uint64_t both = igi_hash64(a) + igi_hash64(b) + igi_hash64(mesh->regions[triangle]);
        edges[k] = (record){both, triangle, a < b ? 1 : -1};
    }
}

static void count_runs(const record *faces, size_t n, igi_mesh_faults *out)
{
    for (size_t i = 1; i < n; i++) {
        if (faces[i].key != faces[i - 1].key) continue;
        if (out->doubled++ == 0) out->first_doubled = faces[i].triangle;
    }
}

static void count_flips(const record *edges, size_t n, igi_mesh_faults *out)
{
    for (size_t i = 0, next; i < n; i = next) {
        for (next = i + 1; next < n && edges[next].key == edges[i].key;) next++;
        if (next - i != 2 || edges[i].sense != edges[i + 1].sense) continue;
        if (out->flipped++ == 0) out->first_flipped = edges[i + 1].triangle;
    }
}

igi_status igi_mesh_faults_find(igi_context *ctx, const igi_mesh *mesh, igi_mesh_faults *faults)
{
    igi_status status = IGI_OK;
    size_t n = mesh->triangle_count;
    uint64_t *corners = NULL;
    record *faces = NULL, *edges = NULL;
    *faults = (igi_mesh_faults){0, 0, SIZE_MAX, SIZE_MAX};
    IGI_TRY_GOTO(IGI_ALLOC(ctx, mesh->vertex_count, &corners));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n, &faces));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 3 * n, &edges));
    double cell = 1e-6 * extent(mesh);
    for (size_t v = 0; v < mesh->vertex_count; v++)
        corners[v] = corner_key(mesh, (uint32_t)v, cell);
    for (size_t t = 0; t < n; t++) describe(mesh, (uint32_t)t, corners, &faces[t], &edges[3 * t]);
    qsort(faces, n, sizeof *faces, compare_records);
    qsort(edges, 3 * n, sizeof *edges, compare_records);
    count_runs(faces, n, faults);
    count_flips(edges, 3 * n, faults);
cleanup:
    igi_free(corners);
    igi_free(faces);
    igi_free(edges);
    return status;
}
