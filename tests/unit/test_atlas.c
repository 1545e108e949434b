/* SPDX-License-Identifier: Apache-2.0 */
#include "test.h"

#include "rooms.h"
#include "scene/atlas.h"

#include <string.h>

#define GRID 256

static double area_of(const float *uv)
{
    return 0.5 *
           fabs((double)((uv[2] - uv[0]) * (uv[5] - uv[1]) - (uv[3] - uv[1]) * (uv[4] - uv[0])));
}

/* Is (x,y) within the triangle, its rim excluded? */
static bool is_inside(const float *uv, double x, double y)
{
    int positive = 0, negative = 0;
    for (int k = 0; k < 3; k++) {
        const float *a = uv + 2 * k, *b = uv + 2 * ((k + 1) % 3);
        double side = ((double)b[0] - (double)a[0]) * (y - (double)a[1]) -
                      ((double)b[1] - (double)a[1]) * (x - (double)a[0]);
        positive += side > 1e-6;
        negative += side < -1e-6;
    }
    return positive == 3 || negative == 3;
}

/* Points of a grid that lie in two triangles at least. */
static int overlaps(const igi_atlas *a)
{
    static uint8_t hits[GRID][GRID];
    int count = 0;
    memset(hits, 0, sizeof hits);
    for (size_t t = 0; t < a->count; t++) {
        const float *uv = a->uvs + 6 * t;
        double low[2] = {1, 1}, high[2] = {0, 0};
        for (int k = 0; k < 6; k++) {
            low[k % 2] = fmin(low[k % 2], (double)uv[k]);
            high[k % 2] = fmax(high[k % 2], (double)uv[k]);
        }
        for (int j = (int)(low[1] * GRID); j < GRID && j <= (int)(high[1] * GRID); j++)
            for (int i = (int)(low[0] * GRID); i < GRID && i <= (int)(high[0] * GRID); i++)
                if (is_inside(uv, (i + 0.37) / GRID, (j + 0.41) / GRID)) count += hits[j][i]++ > 0;
    }
    return count;
}

static bool in_square(const igi_atlas *a)
{
    for (size_t i = 0; i < 6 * a->count; i++)
        if (!(a->uvs[i] >= 0 && a->uvs[i] <= 1)) return false;
    return true;
}

static void square_fills_the_square(void)
{
    igi_context *ctx = test_context(1);
    room *r = room_new();
    igi_atlas *a = NULL;
    room_cube(r, 2, 3);
    CHECK_OK(ctx, igi_atlas_create(ctx, &r->mesh, 4, &a));
    CHECK(a->count == 18);
    double sum = 0;
    for (size_t t = 0; t < a->count; t++) {
        CHECK(r->mesh.regions[a->triangles[t]] == 4);
        sum += area_of(a->uvs + 6 * t);
    }
    CHECK_NEAR(sum, 1, 1e-5);
    CHECK_NEAR((double)a->uv_per_m, 0.5, 1e-6);
    CHECK(in_square(a) && overlaps(a) == 0);
    igi_atlas_destroy(a);
    free(r);
    igi_context_destroy(ctx);
}

/* All faces of a box in one region: six charts at one scale. */
static void box_in_one_region(void)
{
    igi_context *ctx = test_context(1);
    room *r = room_new();
    igi_atlas *a = NULL, *again = NULL;
    room_cube(r, 3, 4);
    for (size_t t = 0; t < r->mesh.triangle_count; t++) r->mesh.regions[t] = 0;
    CHECK_OK(ctx, igi_atlas_create(ctx, &r->mesh, 0, &a));
    CHECK_OK(ctx, igi_atlas_create(ctx, &r->mesh, 0, &again));
    CHECK(a->count == r->mesh.triangle_count && in_square(a) && overlaps(a) == 0);
    double sum = 0, scale = (double)a->uv_per_m;
    for (size_t t = 0; t < a->count; t++) {
        double area = area_of(a->uvs + 6 * t);
        sum += area;
        CHECK_NEAR(area, 9.0 / 32 * scale * scale, 1e-5 * area);
    }
    CHECK(sum > 0.5);
    CHECK(memcmp(a->uvs, again->uvs, 6 * a->count * sizeof(float)) == 0);
    igi_atlas_destroy(a);
    igi_atlas_destroy(again);
    free(r);
    igi_context_destroy(ctx);
}

static void sphere_of_many_charts(void)
{
    igi_context *ctx = test_context(1);
    room *r = room_new();
    igi_atlas *a = NULL;
    room_sphere(r, 16, false);
    CHECK_OK(ctx, igi_atlas_create(ctx, &r->mesh, 0, &a));
    CHECK(a->count == 8 * 16 * 16 && in_square(a) && overlaps(a) == 0);
    double sum = 0, scale = (double)a->uv_per_m;
    for (size_t t = 0; t < a->count; t++) sum += area_of(a->uvs + 6 * t);
    double share = sum / (4 * 3.14159265 * scale * scale); /* flattening shrinks by 10 % at most */
    CHECK(share > 0.88 && share < 1 && sum > 0.25);
    igi_atlas_destroy(a);
    free(r);
    igi_context_destroy(ctx);
}

/* Slivers, triangles that share no corner, many at one edge, a region without any. */
static void awkward_meshes(void)
{
    igi_context *ctx = test_context(1);
    room *r = room_new();
    igi_atlas *a = NULL;
    uint32_t p = room_vertex(r, 0, 0, 0), q = room_vertex(r, 1, 0, 0);
    for (int i = 0; i < 500; i++)
        room_triangle(r, p, q, room_vertex(r, 0.3, cos(i * 0.1), sin(i * 0.1)), 0);
    room_triangle(r, p, q, q, 0);
    room_triangle(r, p, q, room_vertex(r, 0.5, 1e-7, 0), 0);
    CHECK_OK(ctx, igi_atlas_create(ctx, &r->mesh, 0, &a));
    CHECK(a->count == 502 && in_square(a) && overlaps(a) == 0);
    igi_atlas_destroy(a);
    CHECK_OK(ctx, igi_atlas_create(ctx, &r->mesh, 7, &a));
    CHECK(a->count == 0);
    igi_atlas_destroy(a);
    free(r);
    igi_context_destroy(ctx);
}

TEST_MAIN({"square_fills_the_square", square_fills_the_square},
          {"box_in_one_region", box_in_one_region},
          {"sphere_of_many_charts", sphere_of_many_charts}, {"awkward_meshes", awkward_meshes})
