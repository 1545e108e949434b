/* SPDX-License-Identifier: Apache-2.0
 *
 * Small meshes for tests: quads joined to rooms, spheres.
 */
#ifndef IGI_TESTS_ROOMS_H
#define IGI_TESTS_ROOMS_H

#include <igi/scene.h>

#include <math.h>
#include <stdlib.h>

#define ROOM_MAX 8192

typedef struct room {
    float positions[ROOM_MAX][3];
    uint32_t triangles[ROOM_MAX][3], regions[ROOM_MAX];
    igi_mesh mesh;
} room;

/* Every room here is on the heap: it is large. */
static inline room *room_new(void)
{
    room *r = calloc(1, sizeof *r);
    if (!r) abort();
    r->mesh.positions = r->positions[0];
    r->mesh.triangles = r->triangles[0];
    r->mesh.regions = r->regions;
    return r;
}

static inline uint32_t room_vertex(room *r, double x, double y, double z)
{
    float *p = r->positions[r->mesh.vertex_count];
    p[0] = (float)x;
    p[1] = (float)y;
    p[2] = (float)z;
    return (uint32_t)r->mesh.vertex_count++;
}

static inline void room_triangle(room *r, uint32_t a, uint32_t b, uint32_t c, uint32_t region)
{
    size_t t = r->mesh.triangle_count++;
    r->triangles[t][0] = a;
    r->triangles[t][1] = b;
    r->triangles[t][2] = c;
    r->regions[t] = region;
}

/* A parallelogram, its front toward u x v, as n x n x 2 triangles. */
static inline void room_quad(room *r, const double p[3], const double u[3], const double v[3],
                             int n, uint32_t region)
{
    uint32_t first = (uint32_t)r->mesh.vertex_count, w = (uint32_t)n + 1;
    for (int j = 0; j <= n; j++)
        for (int i = 0; i <= n; i++) {
            double a = (double)i / n, b = (double)j / n;
            room_vertex(r, p[0] + a * u[0] + b * v[0], p[1] + a * u[1] + b * v[1],
                        p[2] + a * u[2] + b * v[2]);
        }
    for (uint32_t j = 0; j < (uint32_t)n; j++)
        for (uint32_t i = 0; i < (uint32_t)n; i++) {
            uint32_t a = first + j * w + i;
            room_triangle(r, a, a + 1, a + w + 1, region);
            room_triangle(r, a, a + w + 1, a + w, region);
        }
}

/* A cube from 0 to side, fronts inward; regions: floor 0, ceiling 1, walls 2..5. */
static inline void room_cube(room *r, double side, int n)
{
    const double o[3] = {0, 0, 0}, x[3] = {side, 0, 0}, y[3] = {0, side, 0}, z[3] = {0, 0, side};
    room_quad(r, o, x, y, n, 0);
    room_quad(r, z, y, x, n, 1);
    room_quad(r, o, y, z, n, 2);
    room_quad(r, x, z, y, n, 3);
    room_quad(r, o, z, x, n, 4);
    room_quad(r, y, x, z, n, 5);
}

static inline uint32_t room_on_sphere(room *r, const double p[3])
{
    double l = sqrt(p[0] * p[0] + p[1] * p[1] + p[2] * p[2]);
    return room_vertex(r, p[0] / l, p[1] / l, p[2] / l);
}

/* The unit sphere, fronts inward, as an octahedron of 8 n^2 triangles blown up; triangle i is
 * region i when `apart`, else all are region 0. */
static inline void room_sphere(room *r, int n, bool apart)
{
    for (int o = 0; o < 8; o++) {
        double s[3] = {o & 1 ? -1 : 1, o & 2 ? -1 : 1, o & 4 ? -1 : 1};
        bool odd = s[0] * s[1] * s[2] > 0; /* fronts inward */
        for (int j = 0; j < n; j++)
            for (int i = 0; i < 2 * (n - j) - 1; i++) {
                int a = i / 2, c[2][3][2] = {{{a, j}, {a + 1, j}, {a, j + 1}},
                                             {{a + 1, j + 1}, {a, j + 1}, {a + 1, j}}};
                uint32_t id[3];
                for (int k = 0; k < 3; k++) {
                    int u = c[i % 2][k][0], v = c[i % 2][k][1];
                    const double p[3] = {s[0] * (n - u - v), s[1] * u, s[2] * v};
                    id[k] = room_on_sphere(r, p);
                }
                uint32_t region = apart ? (uint32_t)r->mesh.triangle_count : 0;
                room_triangle(r, id[0], id[odd ? 2 : 1], id[odd ? 1 : 2], region);
            }
    }
}

#endif
