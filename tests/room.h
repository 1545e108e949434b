/* SPDX-License-Identifier: Apache-2.0
 *
 * Scenes that tests build by hand: triangles without shared corners, a few regions and their
 * materials, one band unless the test says otherwise.
 */
#ifndef IGI_TESTS_ROOM_H
#define IGI_TESTS_ROOM_H

#include "test.h"

#include "light/light.h"

enum { ROOM_TRIANGLES = 20000, ROOM_REGIONS = 8, ROOM_LIGHTS = 4 };

typedef struct room {
    float positions[ROOM_TRIANGLES * 9], uvs[ROOM_TRIANGLES * 6];
    uint32_t triangles[ROOM_TRIANGLES * 3], regions_of[ROOM_TRIANGLES];
    char names[ROOM_REGIONS][16];
    igi_region regions[ROOM_REGIONS];
    igi_material list[ROOM_REGIONS];
    igi_light lights[ROOM_LIGHTS];
    igi_scene scene;
    igi_materials materials;
    igi_context *ctx;
} room;

static inline room *room_new(int threads)
{
    room *r = calloc(1, sizeof *r);
    if (!r) abort();
    r->ctx = test_context(threads);
    r->scene.bands = r->materials.bands = 1;
    r->scene.regions = r->regions;
    r->scene.lights = r->lights;
    r->materials.materials = r->list;
    igi_mesh *mesh = &r->scene.mesh;
    mesh->positions = r->positions;
    mesh->triangles = r->triangles;
    mesh->regions = r->regions_of;
    mesh->uvs = r->uvs;
    return r;
}

static inline void room_free(room *r)
{
    igi_context_destroy(r->ctx);
    free(r);
}

/* A lambert region of this albedo in every band; returns its number. */
static inline uint32_t room_region(room *r, const char *name, double albedo)
{
    size_t i = r->scene.region_count++;
    if (i >= ROOM_REGIONS) abort();
    r->materials.count = r->scene.region_count;
    snprintf(r->names[i], sizeof r->names[i], "%s", name);
    r->regions[i] = (igi_region){.name = r->names[i], .has_uvs = true};
    r->list[i] = (igi_material){.region = r->names[i], .model = IGI_LAMBERT};
    for (int b = 0; b < IGI_MAX_BANDS; b++) r->list[i].albedo[b] = albedo;
    return (uint32_t)i;
}

static inline igi_light *room_light(room *r, igi_light light)
{
    if (r->scene.light_count >= ROOM_LIGHTS) abort();
    igi_light *l = &r->lights[r->scene.light_count++];
    *l = light;
    l->known = true;
    return l;
}

/* An emitter region with its light of this radiance in every band. */
static inline uint32_t room_lamp(room *r, const char *name, double radiance)
{
    uint32_t region = room_region(r, name, 0);
    r->regions[region].emitter = r->list[region].emitter = true;
    igi_light *l = room_light(r, (igi_light){.type = IGI_LIGHT_AREA, .region = (int)region});
    for (int b = 0; b < IGI_MAX_BANDS; b++) l->value[b] = radiance;
    return region;
}

static inline void room_triangle(room *r, uint32_t region, igi_vec a, igi_vec b, igi_vec c,
                                 const float *uvs)
{
    size_t t = r->scene.mesh.triangle_count++;
    igi_vec corners[3] = {a, b, c};
    if (t >= ROOM_TRIANGLES) abort();
    memcpy(r->positions + 9 * t, corners, sizeof corners);
    if (uvs) memcpy(r->uvs + 6 * t, uvs, 6 * sizeof *uvs);
    for (uint32_t k = 0; k < 3; k++) r->triangles[3 * t + k] = (uint32_t)(3 * t) + k;
    r->regions_of[t] = region;
    r->scene.mesh.vertex_count += 3;
}

/* A parallelogram, u along x, v along y; its front is where they look counter-clockwise. */
static inline void room_quad(room *r, uint32_t region, igi_vec corner, igi_vec x, igi_vec y)
{
    static const float lower[6] = {0, 0, 1, 0, 1, 1}, upper[6] = {0, 0, 1, 1, 0, 1};
    igi_vec b = igi_add(corner, x), c = igi_add(b, y), d = igi_add(corner, y);
    room_triangle(r, region, corner, b, c, lower);
    room_triangle(r, region, corner, c, d, upper);
}

/* The box [0,size]^3 seen from inside: floor, ceiling, then the walls y=0, y=s, x=0, x=s. */
static inline void room_box(room *r, const uint32_t regions[6], float s)
{
    igi_vec x = {s, 0, 0}, y = {0, s, 0}, z = {0, 0, s}, o = {0, 0, 0};
    room_quad(r, regions[0], o, x, y);
    room_quad(r, regions[1], z, y, x);
    room_quad(r, regions[2], o, z, x);
    room_quad(r, regions[3], y, x, z);
    room_quad(r, regions[4], o, y, z);
    room_quad(r, regions[5], x, z, y);
}

/* A sphere of 2 n (m - 1) triangles, front outside; `inward` turns it. */
static inline void room_sphere(room *r, uint32_t region, igi_vec centre, float radius, int n, int m,
                               bool inward)
{
    for (int j = 0; j < m; j++)
        for (int i = 0; i < n; i++) {
            igi_vec q[4];
            for (int k = 0; k < 4; k++) {
                float theta = IGI_PIF * (float)(j + (k == 1 || k == 2)) / (float)m;
                float phi = 2 * IGI_PIF * (float)((i + (k >= 2)) % n) / (float)n;
                igi_vec d = {sinf(theta) * cosf(phi), sinf(theta) * sinf(phi), cosf(theta)};
                q[inward ? 3 - k : k] = igi_madd(centre, d, radius);
            }
            if (j < m - 1) room_triangle(r, region, q[0], q[1], q[2], NULL);
            if (j > 0) room_triangle(r, region, q[0], q[2], q[3], NULL);
        }
}

/* A pinhole at `eye` toward `target`; its image of a plane at distance d is width d/focal wide. */
static inline igi_camera room_camera(igi_vec eye, igi_vec target, int pixels, double focal)
{
    igi_vec back = igi_normalize(igi_sub(eye, target)), right, up;
    igi_frame_of(back, &right, &up);
    igi_camera c = {.width = pixels,
                    .height = pixels,
                    .fl_x = pixels * focal,
                    .fl_y = pixels * focal,
                    .cx = pixels / 2.0,
                    .cy = pixels / 2.0};
    float columns[4][3] = {{right.x, right.y, right.z},
                           {up.x, up.y, up.z},
                           {back.x, back.y, back.z},
                           {eye.x, eye.y, eye.z}};
    for (int row = 0; row < 3; row++)
        for (int k = 0; k < 4; k++) c.camera_to_world[row][k] = (double)columns[k][row];
    return c;
}

#endif
