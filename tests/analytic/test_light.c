/* SPDX-License-Identifier: Apache-2.0
 *
 * Irradiance by every kind of light against closed forms and brute force.
 */
#include "test.h"

#include "light/light.h"

#define MAX_TRIANGLES 2000

/* A scene made of triangles without shared corners; region 0 is matter, region 1 the lamp. */
typedef struct room {
    float positions[MAX_TRIANGLES * 9];
    uint32_t triangles[MAX_TRIANGLES * 3], regions_of[MAX_TRIANGLES];
    igi_region regions[2];
    igi_scene scene;
    igi_light light;
    igi_context *ctx;
    igi_tracer *tracer;
    igi_lighting *lighting;
} room;

static room *room_new(void)
{
    room *r = calloc(1, sizeof *r);
    if (!r) abort();
    r->ctx = test_context(1);
    r->light = (igi_light){.type = IGI_LIGHT_AREA, .region = 1, .known = true, .value = {1}};
    return r;
}

static void add_triangle(room *r, uint32_t region, igi_vec a, igi_vec b, igi_vec c)
{
    size_t t = r->scene.mesh.triangle_count++;
    igi_vec corners[3] = {a, b, c};
    if (t >= MAX_TRIANGLES) abort();
    memcpy(r->positions + 9 * t, corners, sizeof corners);
    for (uint32_t k = 0; k < 3; k++) r->triangles[3 * t + k] = (uint32_t)(3 * t) + k;
    r->regions_of[t] = region;
}

/* A parallelogram; its front is where edge x, edge y look counter-clockwise. */
static void add_quad(room *r, uint32_t region, igi_vec corner, igi_vec x, igi_vec y)
{
    igi_vec b = igi_add(corner, x), c = igi_add(b, y), d = igi_add(corner, y);
    add_triangle(r, region, corner, b, c);
    add_triangle(r, region, corner, c, d);
}

/* A sphere of 2 n (m - 1) triangles, front outside. */
static void add_sphere(room *r, uint32_t region, igi_vec centre, float radius, int n, int m)
{
    for (int j = 0; j < m; j++)
        for (int i = 0; i < n; i++) {
            igi_vec q[4];
            for (int k = 0; k < 4; k++) {
                float theta = IGI_PIF * (float)(j + (k == 1 || k == 2)) / (float)m;
                float phi = 2 * IGI_PIF * (float)((i + (k >= 2)) % n) / (float)n;
                igi_vec d = {sinf(theta) * cosf(phi), sinf(theta) * sinf(phi), cosf(theta)};
                q[k] = igi_madd(centre, d, radius);
            }
            if (j < m - 1) add_triangle(r, region, q[0], q[1], q[2]);
            if (j > 0) add_triangle(r, region, q[0], q[2], q[3]);
        }
}

static void room_build(room *r)
{
    igi_mesh *mesh = &r->scene.mesh;
    mesh->positions = r->positions;
    mesh->triangles = r->triangles;
    mesh->regions = r->regions_of;
    mesh->vertex_count = 3 * mesh->triangle_count;
    static char names[2][8] = {"matter", "lamp"};
    for (int i = 0; i < 2; i++) r->regions[i].name = names[i];
    r->scene.regions = r->regions;
    r->scene.region_count = 2;
    r->scene.bands = 1;
    CHECK_OK(r->ctx, igi_tracer_create(r->ctx, mesh, &r->tracer));
    CHECK_OK(r->ctx, igi_lighting_create(r->ctx, &r->scene, &r->light, 1, &r->lighting));
}

static void room_free(room *r)
{
    igi_lighting_destroy(r->lighting);
    igi_tracer_destroy(r->tracer);
    igi_context_destroy(r->ctx);
    free(r);
}

static double irradiance(const room *r, igi_vec point, igi_vec normal, int rays, uint64_t key)
{
    return (double)igi_light_irradiance(r->lighting, r->tracer, 0, point, normal, rays, key);
}

/* The mean of many patterns. */
static double mean_irradiance(const room *r, igi_vec point, igi_vec normal, int rays, int patterns)
{
    double sum = 0;
    for (int k = 0; k < patterns; k++) sum += irradiance(r, point, normal, rays, (uint64_t)k);
    return sum / patterns;
}

/* Midpoint rule on n^2 small triangles of each of the lamp's, with visibility. */
static double brute_force(const room *r, igi_vec point, igi_vec normal, int n)
{
    const igi_mesh *mesh = &r->scene.mesh;
    double sum = 0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) {
        if (mesh->regions[t] != 1) continue;
        igi_vec light_normal = igi_triangle_normal(mesh, t);
        double area = (double)igi_triangle_area(mesh, t) / (n * n);
        for (int i = 0; i < n; i++)
            for (int j = 0; j < 2 * (n - i) - 1; j++) {
                float third = j % 2 ? 2 / 3.0f : 1 / 3.0f;
                float u = ((float)i + third) / (float)n, v = ((float)(j / 2) + third) / (float)n;
                igi_vec p = igi_triangle_point(mesh, t, u, v), d = igi_sub(p, point);
                double d2 = (double)igi_dot(d, d);
                double a = (double)igi_dot(d, normal), b = -(double)igi_dot(d, light_normal);
                if (a <= 0 || b <= 0 || igi_occluded(r->tracer, point, p)) continue;
                sum += a * b / (d2 * d2) * area;
            }
    }
    return sum;
}

static const igi_vec up = {0, 0, 1};

/* Unit square lamp at height 1, facing down. */
static room *square_room(void)
{
    room *r = room_new();
    add_quad(r, 1, igi_v(0, 0, 1), igi_v(0, 1, 0), igi_v(1, 0, 0));
    return r;
}

static void square(void)
{
    room *r = square_room();
    room_build(r);
    /* The element under the corner of a unit square at distance 1 (Howell, B-3). */
    for (int rays = 1; rays < 20; rays += 3)
        CHECK_NEAR(irradiance(r, igi_v(0, 0, 0), up, rays, 7) / IGI_PI, 0.138531605994893, 2e-7);
    CHECK(irradiance(r, igi_v(0, 0, 2), igi_v(0, 0, -1), 4, 7) == 0); /* the lamp's back */
    CHECK(irradiance(r, igi_v(0, 0, 0), igi_v(0, 0, -1), 4, 7) == 0); /* below the horizon */
    /* A tilted element whose horizon cuts the lamp. */
    igi_vec tilted = igi_normalize(igi_v(1, .2f, -.3f)), point = igi_v(.4f, .3f, .2f);
    CHECK_NEAR(irradiance(r, point, tilted, 4, 7) / brute_force(r, point, tilted, 400), 1, 2e-4);
    room_free(r);
}

static void bulb(void)
{
    room *r = room_new();
    add_sphere(r, 1, igi_v(0, 0, 1), .1f, 20, 12);
    room_build(r);
    igi_vec points[] = {{.3f, 0, 0}, {.1f, .05f, .85f}, {3, 1, -2}, {0, .6f, .95f}};
    for (int i = 0; i < 4; i++)
        CHECK_NEAR(irradiance(r, points[i], up, 4, 7) / brute_force(r, points[i], up, 40), 1, 1e-3);
    room_free(r);
}

static void shadow(void)
{
    room *r = square_room();
    add_quad(r, 0, igi_v(.1f, -.3f, .4f), igi_v(.5f, .2f, 0), igi_v(-.1f, .5f, .1f));
    room_build(r);
    igi_vec points[] = {{0, 0, 0}, {.3f, 0, 0}, {.7f, .5f, 0}};
    for (int i = 0; i < 3; i++) {
        double truth = brute_force(r, points[i], up, 400);
        /* 5 sigma of a visible fraction of .5 from 640,000 rays that were random. */
        CHECK_NEAR(mean_irradiance(r, points[i], up, 16, 40000) / truth, 1, 3e-3);
        CHECK_NEAR(mean_irradiance(r, points[i], up, 4096, 40) / truth, 1, 3e-3);
    }
    room_free(r);
    r = room_new();
    add_sphere(r, 1, igi_v(0, 0, 1), .1f, 20, 12);
    add_quad(r, 0, igi_v(.1f, -2, .5f), igi_v(2, 0, 0), igi_v(0, 4, 0));
    room_build(r);
    igi_vec half = {.15f, .1f, 0};
    CHECK_NEAR(mean_irradiance(r, half, up, 16, 4000) / brute_force(r, half, up, 40), 1, 5e-3);
    room_free(r);
}

static void samples(void)
{
    room *r = square_room();
    room_build(r);
    igi_vec point = {.2f, -.4f, .1f};
    double sum = 0;
    int n = 100;
    for (int i = 0; i < n * n; i++) {
        igi_light_sample s;
        float u = ((float)(i % n) + .5f) / (float)n, v = ((float)(i / n) + .5f) / (float)n;
        CHECK(igi_light_sample_toward(r->lighting, 0, point, u, v, &s));
        sum += (double)(s.weight * s.direction.z) / (n * n);
        igi_hit hit = igi_trace(r->tracer, point, s.direction);
        if (hit.triangle == IGI_NO_HIT) continue; /* through the very edge */
        float pdf = igi_light_pdf(r->lighting, 0, point, s.direction, &hit);
        CHECK_NEAR((double)(pdf / s.pdf), 1, 1e-3);
    }
    CHECK_NEAR(sum / irradiance(r, point, up, 1, 1), 1, 1e-3);
    room_free(r);
}

/* The light is something else than the square, which stays as matter, unless `open`. */
static room *other_room(igi_light light, bool open)
{
    room *r = room_new();
    r->light = light;
    if (open) add_quad(r, 0, igi_v(50, 50, -9), igi_v(0, 1, 0), igi_v(1, 0, 0));
    else add_quad(r, 0, igi_v(0, 0, 1), igi_v(0, 1, 0), igi_v(1, 0, 0));
    room_build(r);
    return r;
}

static void small_lights(void)
{
    igi_light point = {.type = IGI_LIGHT_POINT, .region = -1, .position = {0, 0, 2}, .value = {1}};
    room *r = other_room(point, true);
    CHECK_NEAR(irradiance(r, igi_v(1, 0, 0), up, 4, 1), 2 / pow(5, 1.5), 1e-6);
    room_free(r);
    r = other_room(point, false);
    CHECK(irradiance(r, igi_v(.5f, .5f, 0), up, 4, 1) == 0);
    CHECK(irradiance(r, igi_v(-.5f, .5f, 0), up, 4, 1) > 0);
    room_free(r);
    igi_light spot = {.type = IGI_LIGHT_SPOT, .region = -1, .position = {0, 0, 2},
                      .direction = {0, 0, -1}, .cutoff_deg = 40, .beam_deg = 20, .value = {1}};
    r = other_room(spot, true);
    CHECK_NEAR(irradiance(r, igi_v(0, 0, 0), up, 4, 1), .25, 1e-6);
    float x = 2 * tanf(30 * IGI_PIF / 180), c = cosf(30 * IGI_PIF / 180);
    CHECK_NEAR(irradiance(r, igi_v(x, 0, 0), up, 4, 1), .5 * (double)(c * c * c) / 4, 1e-5);
    CHECK(irradiance(r, igi_v(1.7f, 0, 0), up, 4, 1) == 0);
    room_free(r);
    igi_light sun = {.type = IGI_LIGHT_DIRECTIONAL, .region = -1, .direction = {0, .6, -.8}, .value = {1}};
    r = other_room(sun, false);
    CHECK_NEAR(irradiance(r, igi_v(-.5f, 0, 0), up, 4, 1), .8, 1e-6);
    CHECK(irradiance(r, igi_v(.5f, 1, 0), up, 4, 1) == 0);
    room_free(r);
}

static void line(void)
{
    igi_light tube = {.type = IGI_LIGHT_LINE, .region = -1, .position = {-1, .5, 2},
                      .end = {2, 1, 3}, .value = {1}};
    room *r = other_room(tube, true);
    igi_vec normals[] = {{0, 0, 1}, {1, 0, 0}, {.6f, 0, -.8f}};
    igi_vec point = {.3f, 0, 1.8f};
    for (int i = 0; i < 3; i++) {
        double sum = 0, length = sqrt(9 + .25 + 1);
        int n = 20000;
        for (int k = 0; k < n; k++) {
            float t = ((float)k + .5f) / (float)n;
            igi_vec d = igi_sub(igi_v(-1 + 3 * t, .5f + .5f * t, 2 + t), point);
            float l = igi_length(d);
            sum += (double)fmaxf(0.0f, igi_dot(d, normals[i]) / (l * l * l)) * length / n;
        }
        CHECK_NEAR(irradiance(r, point, normals[i], 4, 9) / sum, 1, 1e-4);
    }
    room_free(r);
    r = other_room(tube, false);
    double half = mean_irradiance(r, igi_v(.5f, .5f, 0), up, 8, 2000), all = 0;
    int n = 20000;
    for (int k = 0; k < n; k++) {
        igi_light_sample s;
        float u = ((float)k + .5f) / (float)n;
        CHECK(igi_light_sample_toward(r->lighting, 0, igi_v(.5f, .5f, 0), u, 0, &s));
        igi_vec at = igi_madd(igi_v(.5f, .5f, 0), s.direction, s.distance);
        if (!igi_occluded(r->tracer, igi_v(.5f, .5f, 0), at))
            all += (double)(s.weight * s.direction.z) / n;
    }
    CHECK_NEAR(half / all, 1, 5e-3);
    room_free(r);
}

static void ambient(void)
{
    igi_light sky = {.type = IGI_LIGHT_AMBIENT, .region = -1, .value = {1}};
    room *r = other_room(sky, false);
    CHECK_NEAR(irradiance(r, igi_v(0, 0, 1.5f), up, 16, 1), IGI_PI, 1e-6);
    /* All but the square. */
    CHECK_NEAR(mean_irradiance(r, igi_v(0, 0, 0), up, 64, 4000) / IGI_PI, 1 - 0.138531605994893, 1e-3);
    igi_hit miss = {.triangle = IGI_NO_HIT};
    float radiance[1] = {2};
    igi_lighting_add_emitted(r->lighting, up, &miss, radiance);
    CHECK_NEAR((double)radiance[0], 3, 0);
    room_free(r);
}

static void refusals(void)
{
    room *r = square_room();
    room_build(r);
    igi_light twice[2] = {r->light, r->light};
    igi_lighting *l;
    CHECK(igi_lighting_create(r->ctx, &r->scene, twice, 2, &l) == IGI_E_DATA);
    CHECK_CONTAINS(igi_context_message(r->ctx), "two area lights name the region 'lamp'");
    CHECK(l == NULL);
    for (long n = 0; n < 4; n++) {
        igi_fail_allocation_after(r->ctx, n);
        CHECK(igi_lighting_create(r->ctx, &r->scene, &r->light, 1, &l) == IGI_E_SYSTEM);
        CHECK(l == NULL);
    }
    igi_fail_allocation_after(r->ctx, -1);
    CHECK_OK(r->ctx, igi_lighting_create(r->ctx, &r->scene, NULL, 0, &l));
    CHECK(igi_lighting_of_triangle(l, 0) == -1); /* left out: dark */
    igi_lighting_destroy(l);
    room_free(r);
}

TEST_MAIN({"square", square}, {"bulb", bulb}, {"shadow", shadow}, {"samples", samples},
          {"small lights", small_lights}, {"line", line}, {"ambient", ambient},
          {"refusals", refusals})
