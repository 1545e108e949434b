/* SPDX-License-Identifier: Apache-2.0
 *
 * Irradiance by every kind of light against closed forms and brute force.
 */
#include "test.h"

#include "room.h"

/* A room of one light, ready to be asked. */
typedef struct lit {
    room *room;
    igi_tracer *tracer;
    igi_lighting *lighting;
} lit;

static lit light_up(room *r)
{
    lit l = {.room = r};
    CHECK_OK(r->ctx, igi_tracer_create(r->ctx, &r->scene.mesh, &l.tracer));
    CHECK_OK(r->ctx, igi_lighting_create(r->ctx, &r->scene, r->lights, 1, &l.lighting));
    return l;
}

static void put_out(lit *l)
{
    igi_lighting_destroy(l->lighting);
    igi_tracer_destroy(l->tracer);
    room_free(l->room);
}

static double irradiance(const lit *r, igi_vec point, igi_vec normal, int rays, uint64_t key)
{
    return (double)igi_light_irradiance(r->lighting, r->tracer, 0, point, normal, rays, key);
}

/* The mean of many patterns. */
static double mean_irradiance(const lit *r, igi_vec point, igi_vec normal, int rays, int patterns)
{
    double sum = 0;
    for (int k = 0; k < patterns; k++) sum += irradiance(r, point, normal, rays, (uint64_t)k);
    return sum / patterns;
}

/* Midpoint rule on n^2 small triangles of each of the lamp's, with visibility. */
static double brute_force(const lit *r, igi_vec point, igi_vec normal, int n)
{
    const igi_mesh *mesh = &r->room->scene.mesh;
    double sum = 0, n_of = r->room->lights[0].profile;
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
                double share = pow(b / sqrt(d2), n_of), mean = .5 * (n_of + 2);
                sum += a * b / (d2 * d2) * area * mean * share;
            }
    }
    return sum;
}

static const igi_vec up = {0, 0, 1};

/* Unit square lamp at height 1, facing down. */
static room *square_room(void)
{
    room *r = room_new(1);
    (void)room_region(r, "matter", 0);
    room_quad(r, room_lamp(r, "lamp", 1), igi_v(0, 0, 1), igi_v(0, 1, 0), igi_v(1, 0, 0));
    return r;
}

static room *bulb_room(void)
{
    room *r = room_new(1);
    (void)room_region(r, "matter", 0);
    room_sphere(r, room_lamp(r, "lamp", 1), igi_v(0, 0, 1), .1f, 20, 12, false);
    return r;
}

static void square(void)
{
    lit l = light_up(square_room()), *r = &l;
    /* The element under the corner of a unit square at distance 1 (Howell, B-3). */
    for (int rays = 1; rays < 20; rays += 3)
        CHECK_NEAR(irradiance(r, igi_v(0, 0, 0), up, rays, 7) / IGI_PI, 0.138531605994893, 2e-7);
    CHECK(irradiance(r, igi_v(0, 0, 2), igi_v(0, 0, -1), 4, 7) == 0); /* the lamp's back */
    CHECK(irradiance(r, igi_v(0, 0, 0), igi_v(0, 0, -1), 4, 7) == 0); /* below the horizon */
    /* A tilted element whose horizon cuts the lamp. */
    igi_vec tilted = igi_normalize(igi_v(1, .2f, -.3f)), point = igi_v(.4f, .3f, .2f);
    CHECK_NEAR(irradiance(r, point, tilted, 4, 7) / brute_force(r, point, tilted, 400), 1, 2e-4);
    put_out(r);
}

static void bulb(void)
{
    lit l = light_up(bulb_room()), *r = &l;
    igi_vec points[] = {{.3f, 0, 0}, {.1f, .05f, .85f}, {3, 1, -2}, {0, .6f, .95f}};
    for (int i = 0; i < 4; i++)
        CHECK_NEAR(irradiance(r, points[i], up, 4, 7) / brute_force(r, points[i], up, 40), 1, 1e-3);
    /* From as near as the closed form serves to where a triangle is its centre. */
    for (float z = 0.88f; z > -1; z -= 0.06f) {
        igi_vec below = igi_v(0.02f, -0.01f, z);
        double open = (double)igi_light_irradiance(r->lighting, NULL, 0, below, up, 1, 0);
        CHECK_NEAR(open / brute_force(r, below, up, 16), 1, 5e-4);
    }
    put_out(r);
}

static void shadow(void)
{
    room *square = square_room();
    room_quad(square, 0, igi_v(.1f, -.3f, .4f), igi_v(.5f, .2f, 0), igi_v(-.1f, .5f, .1f));
    lit l = light_up(square), *r = &l;
    igi_vec points[] = {{0, 0, 0}, {.3f, 0, 0}, {.7f, .5f, 0}};
    for (int i = 0; i < 3; i++) {
        double truth = brute_force(r, points[i], up, 400);
        /* 5 sigma of a visible fraction of .5 from 640,000 rays that were random. */
        CHECK_NEAR(mean_irradiance(r, points[i], up, 16, 40000) / truth, 1, 3e-3);
        CHECK_NEAR(mean_irradiance(r, points[i], up, 4096, 40) / truth, 1, 3e-3);
    }
    put_out(r);
    room *bulb = bulb_room();
    room_quad(bulb, 0, igi_v(.1f, -2, .5f), igi_v(2, 0, 0), igi_v(0, 4, 0));
    l = light_up(bulb);
    igi_vec half = {.15f, .1f, 0};
    CHECK_NEAR(mean_irradiance(r, half, up, 16, 4000) / brute_force(r, half, up, 40), 1, 5e-3);
    put_out(r);
}

static void samples(void)
{
    lit l = light_up(square_room()), *r = &l;
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
    put_out(r);
}

/* The light is something else than the square, which stays as matter, unless `open`. */
static lit other_room(igi_light light, bool open)
{
    room *r = room_new(1);
    (void)room_region(r, "matter", 0);
    (void)room_light(r, light);
    if (open) room_quad(r, 0, igi_v(50, 50, -9), igi_v(0, 1, 0), igi_v(1, 0, 0));
    else room_quad(r, 0, igi_v(0, 0, 1), igi_v(0, 1, 0), igi_v(1, 0, 0));
    return light_up(r);
}

/* Samples by what they give: right on average from anywhere, and nearly all of one weight. */
static void facing_samples(void)
{
    enum { SIDE = 64 };
    static const float heights[] = {0, 0.5f, 0.9f, 0.99f};
    for (int k = 0; k < 16; k++) {
        room *r = k < 8 ? square_room() : bulb_room();
        lit l = light_up(r);
        igi_vec point = igi_v(k % 2 ? 0.01f : 1.5f, 0.4f, k < 8 ? heights[k / 2] : 0.0f);
        igi_vec normal = igi_normalize(igi_v(k % 2 ? 1 : -1, 0.2f, k % 4 < 2 ? 0.0f : 1.0f));
        double open = 0, sum = 0, squares = 0;
        for (int i = 0; i < SIDE * SIDE; i++) {
            igi_light_sample s;
            float u = ((float)(i / SIDE) + 0.5f) / SIDE, v = ((float)(i % SIDE) + 0.5f) / SIDE;
            open = (double)igi_light_sample_facing(l.lighting, 0, point, normal, u, v, &s);
            double carried = (double)(s.weight * fmaxf(0.0f, igi_dot(s.direction, normal)));
            sum += carried / (SIDE * SIDE);
            squares += carried * carried / (SIDE * SIDE);
        }
        CHECK_NEAR(open, irradiance(&l, point, normal, 1, 0), 1e-6);
        CHECK_NEAR(sum, open, 0.01 * open + 1e-6);
        CHECK(squares < 4 * sum * sum);
        put_out(&l);
    }
}

static const double exponents[] = {0.5, 2, 8, 40};

/* A disc of mean radiance 1 above the point: L = (n + 2)/2 cos^n, and on the axis both cosines are one,
 * E = 2 pi integral of L cos sin = pi (1 - cos^(n + 2) of its edge). */
static void profile_of_a_disc(void)
{
    enum { SIDES = 48 };
    static const float heights[] = {0.05f, 0.4f, 1, 5};
    for (int k = 0; k < 16; k++) {
        room *r = room_new(1);
        (void)room_region(r, "matter", 0);
        uint32_t lamp = room_lamp(r, "lamp", 1);
        double n = r->lights[0].profile = exponents[k % 4];
        float h = heights[k / 4], step = 2 * IGI_PIF / SIDES;
        float out = sqrtf(step / sinf(step)); /* as large as the disc of radius 1 */
        for (int i = 0; i < SIDES; i++) {
            float a = step * (float)i, b = a + step;
            room_triangle(r, lamp, igi_v(0, 0, h), igi_v(out * cosf(b), out * sinf(b), h),
                          igi_v(out * cosf(a), out * sinf(a), h), NULL);
        }
        lit l = light_up(r);
        double edge = (double)h / hypot(1, (double)h), truth = IGI_PI * (1 - pow(edge, n + 2));
        CHECK_NEAR(irradiance(&l, igi_v(0, 0, 0), up, 4, 1) / truth, 1, 1e-3);
        put_out(&l);
    }
}

/* Of the square and of the bulb, from far, near and beside, with a shadow too; samples of all kinds
 * say the same. */
static void profile_of_lamps(void)
{
    enum { SAMPLES = 1 << 12, SET = 4096 };
    static igi_light_sample set[SET];
    static const igi_vec points[] = {{.3f, .2f, 0}, {-.2f, .4f, .8f}, {1.5f, -2, -3}};
    for (int k = 0; k < 24; k++) {
        room *r = k < 12 ? square_room() : bulb_room();
        r->lights[0].profile = exponents[k % 4];
        lit l = light_up(r);
        igi_vec point = points[k / 4 % 3], normal = igi_normalize(igi_v(.5f, -.1f, 1));
        double truth = brute_force(&l, point, normal, k < 12 ? 200 : 16), toward = 0, facing = 0;
        CHECK_NEAR(irradiance(&l, point, normal, 4, 7), truth, 1e-3 * truth + 1e-7);
        for (int i = 0; i < SAMPLES; i++) {
            igi_light_sample s;
            float u = (float)fmod(.5 + i * .7548776662466927, 1);
            float v = (float)fmod(.5 + i * .5698402909980532, 1);
            if (igi_light_sample_toward(l.lighting, 0, point, u, v, &s))
                toward += (double)(s.weight * fmaxf(0.0f, igi_dot(s.direction, normal)));
            (void)igi_light_sample_facing(l.lighting, 0, point, normal, u, v, &s);
            facing += (double)(s.weight * fmaxf(0.0f, igi_dot(s.direction, normal)));
            igi_hit hit = igi_trace(l.tracer, point, s.direction);
            float met[1] = {0}, last = 0;
            if (!(s.weight > 0) || hit.triangle == IGI_NO_HIT || hit.back) continue;
            igi_lighting_add_emitted(l.lighting, s.direction, &hit, met);
            igi_vec front = igi_triangle_normal(&r->scene.mesh, hit.triangle);
            last = powf(-igi_dot(front, s.direction), (float)exponents[k % 4]);
            CHECK_NEAR((double)met[0], .5 * (exponents[k % 4] + 2) * (double)last, 1e-4);
        }
        size_t count = igi_light_sample_set(l.lighting, 0, point, SET, (float[2]){.5f, .5f}, set);
        double all = 0;
        for (size_t i = 0; i < count; i++)
            all += (double)(set[i].weight * fmaxf(0.0f, igi_dot(set[i].direction, normal)));
        CHECK_NEAR(toward / SAMPLES, truth, .03 * truth + 1e-6);
        CHECK_NEAR(facing / SAMPLES, truth, .03 * truth + 1e-6);
        CHECK_NEAR(all, truth, .03 * truth + 1e-6);
        put_out(&l);
    }
    room *shadowed = square_room();
    shadowed->lights[0].profile = 4;
    room_quad(shadowed, 0, igi_v(.1f, -.3f, .4f), igi_v(.5f, .2f, 0), igi_v(-.1f, .5f, .1f));
    lit l = light_up(shadowed);
    igi_vec point = {.3f, 0, 0};
    double truth = brute_force(&l, point, up, 400);
    CHECK_NEAR(mean_irradiance(&l, point, up, 16, 10000) / truth, 1, 5e-3);
    put_out(&l);
}

static void small_lights(void)
{
    igi_light point = {.type = IGI_LIGHT_POINT, .region = -1, .position = {0, 0, 2}, .value = {1}};
    lit l = other_room(point, true), *r = &l;
    CHECK_NEAR(irradiance(r, igi_v(1, 0, 0), up, 4, 1), 2 / pow(5, 1.5), 1e-6);
    put_out(r);
    l = other_room(point, false);
    CHECK(irradiance(r, igi_v(.5f, .5f, 0), up, 4, 1) == 0);
    CHECK(irradiance(r, igi_v(-.5f, .5f, 0), up, 4, 1) > 0);
    put_out(r);
    igi_light spot = {.type = IGI_LIGHT_SPOT,
                      .region = -1,
                      .position = {0, 0, 2},
                      .direction = {0, 0, -1},
                      .cutoff_deg = 40,
                      .beam_deg = 20,
                      .value = {1}};
    l = other_room(spot, true);
    CHECK_NEAR(irradiance(r, igi_v(0, 0, 0), up, 4, 1), .25, 1e-6);
    float x = 2 * tanf(30 * IGI_PIF / 180), c = cosf(30 * IGI_PIF / 180);
    CHECK_NEAR(irradiance(r, igi_v(x, 0, 0), up, 4, 1), .5 * (double)(c * c * c) / 4, 1e-5);
    CHECK(irradiance(r, igi_v(1.7f, 0, 0), up, 4, 1) == 0);
    put_out(r);
    igi_light sun = {
        .type = IGI_LIGHT_DIRECTIONAL, .region = -1, .direction = {0, .6, -.8}, .value = {1}};
    l = other_room(sun, false);
    CHECK_NEAR(irradiance(r, igi_v(-.5f, 0, 0), up, 4, 1), .8, 1e-6);
    CHECK(irradiance(r, igi_v(.5f, 1, 0), up, 4, 1) == 0);
    put_out(r);
}

static void line(void)
{
    igi_light tube = {.type = IGI_LIGHT_LINE,
                      .region = -1,
                      .position = {-1, .5, 2},
                      .end = {2, 1, 3},
                      .value = {1}};
    lit l = other_room(tube, true), *r = &l;
    igi_vec normals[] = {{0, 0, 1}, {1, 0, 0}, {.6f, 0, -.8f}};
    igi_vec point = {.3f, 0, 1.8f};
    for (int i = 0; i < 3; i++) {
        double sum = 0, length = sqrt(9 + .25 + 1);
        int n = 20000;
        for (int k = 0; k < n; k++) {
            float t = ((float)k + .5f) / (float)n;
            igi_vec d = igi_sub(igi_v(-1 + 3 * t, .5f + .5f * t, 2 + t), point);
            float distance = igi_length(d);
            sum += (double)fmaxf(0.0f, igi_dot(d, normals[i]) / powf(distance, 3)) * length / n;
        }
        CHECK_NEAR(irradiance(r, point, normals[i], 4, 9) / sum, 1, 1e-4);
    }
    put_out(r);
    l = other_room(tube, false);
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
    put_out(r);
}

static void ambient(void)
{
    igi_light sky = {.type = IGI_LIGHT_AMBIENT, .region = -1, .value = {1}};
    lit l = other_room(sky, false), *r = &l;
    CHECK_NEAR(irradiance(r, igi_v(0, 0, 1.5f), up, 16, 1), IGI_PI, 1e-6);
    /* All but the square. */
    CHECK_NEAR(mean_irradiance(r, igi_v(0, 0, 0), up, 64, 4000) / IGI_PI, 1 - 0.138531605994893,
               1e-3);
    igi_hit miss = {.triangle = IGI_NO_HIT};
    float radiance[1] = {2};
    igi_lighting_add_emitted(r->lighting, up, &miss, radiance);
    CHECK_NEAR((double)radiance[0], 3, 0);
    igi_lighting_add_met(r->lighting, igi_v(0, 0, 1.5f), up, &miss, 0.1f, INFINITY, radiance);
    CHECK_NEAR((double)radiance[0], 4, 0); /* no sample finds it */
    put_out(r);
}

/* A map of 8 x 4 pixels; `bright` holds the only pixel that is not dark, or -1: all are 1. */
static void write_map(igi_context *ctx, int bright)
{
    igi_image *map = NULL;
    CHECK_OK(ctx, igi_image_create(ctx, 8, 4, 1, &map));
    for (int i = 0; i < 32; i++) map->samples[i] = bright < 0 ? 1 : i == bright ? 2 : 0;
    CHECK_OK(ctx, igi_image_save_exr(ctx, map, IGI_EXR_FLOAT, "test_light_sky.exr"));
    igi_image_destroy(map);
}

static igi_light env_light(double rotation_deg)
{
    static char path[] = "test_light_sky.exr";
    return (igi_light){.type = IGI_LIGHT_ENV,
                       .region = -1,
                       .file = path,
                       .rotation_deg = rotation_deg,
                       .value = {1}};
}

/* Each band's irradiance is asked for by shining in that band alone. */
static void coloured_environment(igi_context *ctx)
{
    igi_image *map = NULL;
    CHECK_OK(ctx, igi_image_create(ctx, 8, 4, 2, &map));
    for (int i = 0; i < 64; i++) map->samples[i] = i % 2 ? 3 : i < 32 ? 1 : 0;
    CHECK_OK(ctx, igi_image_save_exr(ctx, map, IGI_EXR_FLOAT, "test_light_sky.exr"));
    igi_image_destroy(map);
    for (int band = 0; band < 2; band++) {
        igi_light light = env_light(0);
        light.value[0] = band == 0;
        light.value[1] = band == 1;
        room *empty = square_room();
        empty->scene.bands = empty->materials.bands = 2;
        empty->scene.light_count = 0;
        empty->scene.mesh.triangle_count = 0;
        (void)room_light(empty, light);
        lit l = light_up(empty), *r = &l;
        CHECK_NEAR(mean_irradiance(r, igi_v(0, 0, 0), up, 64, 400) / IGI_PI, band ? 3 : 1, 2e-2);
        put_out(r);
    }
}

/* The overcast sky has a closed form, E = L_z pi (1 + 2 (2/3)) / 3; the sun at 60 degrees gives about
 * 100 klx (IES: 127.5 e^(-.21 m) klx), the clear dome 8 to 20 klx; clear is bluer than the sun. */
static void sky_by_the_sun(void)
{
    enum { OVERCAST, CLEAR };
    for (int cloudiness = CLEAR; cloudiness >= OVERCAST; cloudiness--) {
        igi_light light = {.type = IGI_LIGHT_ENV,
                           .region = -1,
                           .value = {1},
                           .sky = {true, 60, 90, 3, cloudiness == OVERCAST}};
        lit l = other_room(light, true), *r = &l;
        double klx = mean_irradiance(r, igi_v(0, 0, 0), up, 64, 400) * 179 / 1000;
        double east = mean_irradiance(r, igi_v(0, 0, 0), igi_v(1, 0, 0), 64, 400) * 179 / 1000;
        double west = mean_irradiance(r, igi_v(0, 0, 0), igi_v(-1, 0, 0), 64, 400) * 179 / 1000;
        printf("cloudiness %d: %.2f klx; toward east %.2f, west %.2f\n", cloudiness == OVERCAST,
               klx, east, west);
        if (cloudiness == OVERCAST) {
            double zenith = 0.123 + 8.6 * sin(IGI_PI / 3);
            CHECK_NEAR(klx, zenith * IGI_PI * 7 / 9, 0.01 * klx);
            CHECK_NEAR(east, west, 0.02 * east);
        } else {
            CHECK(klx > 85 && klx < 125);
            CHECK(east > 40 && east < 75 && west > 2 && west < 12);
        }
        put_out(r);
    }
}

static void environment(void)
{
    igi_context *ctx = test_context(1);
    write_map(ctx, -1);
    lit l = other_room(env_light(0), false), *r = &l;
    CHECK_NEAR(mean_irradiance(r, igi_v(0, 0, 1.5f), up, 64, 4000) / IGI_PI, 1, 4e-3);
    CHECK_NEAR(mean_irradiance(r, igi_v(0, 0, 0), up, 64, 4000) / IGI_PI, 1 - 0.138531605994893,
               4e-3);
    put_out(r);
    /* Row 1 spans 45 to 90 degrees from +Z; column 4 lies right of +X: azimuth -45 to 0 degrees.
     * Turned by 90 degrees: 45 to 90. E = 2 int z dz dphi = 2 (1/2)(cos^2 45) pi/4. */
    write_map(ctx, 12);
    for (int turned = 0; turned < 2; turned++) {
        l = other_room(env_light(turned ? 90 : 0), true);
        CHECK_NEAR(mean_irradiance(r, igi_v(0, 0, 0), up, 64, 400), IGI_PI / 8, 2e-3);
        for (int k = 0; k < 100; k++) {
            igi_light_sample s;
            igi_hit miss = {.triangle = IGI_NO_HIT};
            float u = ((float)k + .5f) / 100, v = (float)(k * 37 % 100) / 100, radiance[1] = {0};
            CHECK(igi_light_sample_toward(r->lighting, 0, igi_v(0, 0, 0), u, v, &s));
            double azimuth = (double)atan2f(s.direction.y, s.direction.x) * 180 / IGI_PI;
            CHECK_NEAR(azimuth, turned ? 67.5 : -22.5, 22.51);
            CHECK_NEAR((double)s.direction.z, .3536, .3537);
            CHECK_NEAR((double)igi_light_pdf(r->lighting, 0, igi_v(0, 0, 0), s.direction, &miss),
                       (double)s.pdf, 1e-6);
            igi_light_add_sky(r->lighting, 0, s.direction, radiance);
            CHECK(radiance[0] == 2 && s.tint[0] == 2 && isinf(s.distance));
            igi_lighting_add_met(r->lighting, igi_v(0, 0, 0), s.direction, &miss, 3 * s.pdf, 2,
                                 radiance);
            CHECK_NEAR((double)radiance[0], 2 + 2 * 3 / (3 + 2.), 1e-5);
        }
        double open = 0, carried = 0; /* as recovery looks for the light */
        for (int k = 0; k < 4096; k++) {
            igi_light_sample s;
            float u = ((float)(k / 64) + .5f) / 64, v = ((float)(k % 64) + .5f) / 64;
            open += (double)igi_light_sample_facing(r->lighting, 0, igi_v(0, 0, 0), up, u, v, &s);
            carried += (double)(s.weight * fmaxf(0.0f, igi_dot(s.direction, up)));
        }
        CHECK_NEAR(open / 4096, IGI_PI / 8, 1e-3);
        CHECK_NEAR(carried / 4096, IGI_PI / 8, 1e-3);
        put_out(r);
    }
    coloured_environment(ctx);
    remove("test_light_sky.exr");
    igi_context_destroy(ctx);
}

static void write_profile(const char *text)
{
    FILE *file = fopen("test_light.ies", "w");
    if (!file || fputs(text, file) < 0 || fclose(file) != 0) abort();
}

static void goniometric(void)
{
    static char path[] = "test_light.ies";
    igi_light lamp = {.type = IGI_LIGHT_GONIOMETRIC,
                      .region = -1,
                      .file = path,
                      .position = {0, 0, 2},
                      .value = {1}};
    /* 100 (times 2) straight down, falling linearly to 0 at 90 degrees, twice that toward +-Y. */
    write_profile("IESNA:LM-63-2002\n[TEST] none\nTILT=NONE\n1 1000 2 3 2 1 2 .1 .1 0\n1 1 50\n"
                  "0 45 90\n0 90\n100 50 0\n100,100,0\n");
    lit l = other_room(lamp, true), *r = &l;
    CHECK_NEAR(irradiance(r, igi_v(0, 0, 0), up, 4, 1), 200 / 4.0, 1e-4);
    double c3 = pow(.5, 1.5); /* at 45 degrees E = I cos^3/h^2 */
    CHECK_NEAR(irradiance(r, igi_v(-2, 0, 0), up, 4, 1), 100 * c3 / 4, 1e-3);
    CHECK_NEAR(irradiance(r, igi_v(0, -2, 0), up, 4, 1), 200 * c3 / 4, 1e-3);
    float d = 2 / sqrtf(2);
    CHECK_NEAR(irradiance(r, igi_v(-d, d, 0), up, 4, 1), 150 * c3 / 4, 1e-3);
    CHECK(irradiance(r, igi_v(0, 0, 3), igi_v(0, 0, -1), 4, 1) == 0); /* above: beyond 90 */
    put_out(r);
    static const struct {
        const char *text, *sentence;
    } bad[] = {{"IESNA\n", "no TILT= line"},
               {"TILT=INCLUDE\n", "only TILT=NONE"},
               {"TILT=NONE\n1 1000 2", "head is cut short"},
               {"TILT=NONE\n1 1 1 99999 1 1 2 0 0 0 1 1 1", "out of range"},
               {"TILT=NONE\n1 1 1 2 1 2 2 0 0 0 1 1 1", "type C"},
               {"TILT=NONE\n1 1 1 2 1 1 2 0 0 0 1 1 1 0 0 0", "do not rise"},
               {"TILT=NONE\n1 1 1 2 1 1 2 0 0 0 1 1 1 0 90 0 5", "among the candela"},
               {"TILT=NONE\n1 1 1 2 1 1 2 0 0 0 1 1 1 0 90 0 5 -1", "below zero"}};
    room *empty = square_room();
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        igi_lighting *none;
        write_profile(bad[i].text);
        CHECK(igi_lighting_create(empty->ctx, &empty->scene, &lamp, 1, &none) == IGI_E_DATA);
        CHECK_CONTAINS(igi_context_message(empty->ctx), bad[i].sentence);
    }
    room_free(empty);
    remove("test_light.ies");
}

static void write_ldt(int symmetry, const char *body)
{
    FILE *file = fopen("test_light.ldt", "w");
    if (!file) abort();
    fprintf(file, "igi\n2\n%d\n8\n45\n3\n45\n\nlamp\n1\nl.ldt\ntoday\n", symmetry);
    for (int i = 13; i <= 22; i++) fprintf(file, "100\n"); /* sizes */
    fprintf(file, "90\n2\n0\n1\n1\nLED\n500\n3000\n80\n10\n");
    for (int i = 0; i < 10; i++) fprintf(file, "0.5\n"); /* direct ratios */
    for (int i = 0; i < 8; i++) fprintf(file, "%d\n", 45 * i);
    if (fprintf(file, "0\n45\n90\n%s", body) < 0 || fclose(file) != 0) abort();
}

/* Candela per 1000 lm, with 500 lm and a factor of 2: the numbers are candela. 8 planes, 45 degrees
 * apart; at gamma = 45 plane k has 10 (k + 1). */
static void eulumdat(void)
{
    static char path[] = "test_light.ldt";
    igi_light lamp = {.type = IGI_LIGHT_GONIOMETRIC,
                      .region = -1,
                      .file = path,
                      .position = {0, 0, 2},
                      .value = {1}};
    static const struct {
        int symmetry;
        const char *body;
        double east, south_east, west; /* toward C = 0, 315 and 180 degrees */
    } cases[] = {
        {0, "8\n10\n0\n8\n20\n0\n8\n30\n0\n8\n40\n0\n8\n50\n0\n8\n60\n0\n8\n70\n0\n8\n80\n0\n", 10,
         80, 50},
        {1, "8\n10\n0\n", 10, 10, 10},
        {2, "8\n10\n0\n8\n20\n0\n8\n30\n0\n8\n40\n0\n8\n50\n0\n", 10, 20, 50},
        {3, "8\n70\n0\n8\n80\n0\n8\n10\n0\n8\n20\n0\n8\n30\n0\n", 10, 80, 10},
        {4, "8\n10\n0\n8\n20\n0\n8\n30\n0\n", 10, 20, 10},
    };
    double c3 = pow(.5, 1.5); /* at 45 degrees E = I cos^3/h^2 */
    float d = 2 / sqrtf(2);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        write_ldt(cases[i].symmetry, cases[i].body);
        lit l = other_room(lamp, true), *r = &l;
        CHECK_NEAR(irradiance(r, igi_v(0, 0, 0), up, 4, 1), 8 / 4.0, 1e-4);
        CHECK_NEAR(irradiance(r, igi_v(2, 0, 0), up, 4, 1), cases[i].east * c3 / 4, 1e-4);
        CHECK_NEAR(irradiance(r, igi_v(d, -d, 0), up, 4, 1), cases[i].south_east * c3 / 4, 1e-4);
        CHECK_NEAR(irradiance(r, igi_v(-2, 0, 0), up, 4, 1), cases[i].west * c3 / 4, 1e-4);
        put_out(r);
    }
    static const struct {
        int symmetry;
        const char *body, *sentence;
    } bad[] = {{7, "", "test_light.ldt:3: no usable EULUMDAT profile: its symmetry"},
               {1, "8\n10\n", "ends among the angles or intensities"},
               {1, "8\n-10\n0\n", "below zero"}};
    room *empty = square_room();
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        igi_lighting *none;
        write_ldt(bad[i].symmetry, bad[i].body);
        CHECK(igi_lighting_create(empty->ctx, &empty->scene, &lamp, 1, &none) == IGI_E_DATA);
        CHECK_CONTAINS(igi_context_message(empty->ctx), bad[i].sentence);
    }
    room_free(empty);
    remove("test_light.ldt");
}

static void refusals(void)
{
    lit square_lit = light_up(square_room()), *r = &square_lit;
    igi_light twice[2] = {r->room->lights[0], r->room->lights[0]};
    igi_lighting *l;
    CHECK(igi_lighting_create(r->room->ctx, &r->room->scene, twice, 2, &l) == IGI_E_DATA);
    CHECK_CONTAINS(igi_context_message(r->room->ctx), "two area lights name the region 'lamp'");
    CHECK(l == NULL);
    for (long n = 0; n < 4; n++) {
        igi_fail_allocation_after(r->room->ctx, n);
        CHECK(igi_lighting_create(r->room->ctx, &r->room->scene, &r->room->lights[0], 1, &l) ==
              IGI_E_SYSTEM);
        CHECK(l == NULL);
    }
    igi_fail_allocation_after(r->room->ctx, -1);
    CHECK_OK(r->room->ctx, igi_lighting_create(r->room->ctx, &r->room->scene, NULL, 0, &l));
    CHECK(igi_lighting_of_triangle(l, 0) == -1); /* left out: dark */
    igi_lighting_destroy(l);
    put_out(r);
}

TEST_MAIN({"square", square}, {"bulb", bulb}, {"shadow", shadow}, {"samples", samples},
          {"facing samples", facing_samples}, {"profile of a disc", profile_of_a_disc},
          {"profile of lamps", profile_of_lamps}, {"small lights", small_lights}, {"line", line},
          {"ambient", ambient}, {"environment", environment}, {"sky by the sun", sky_by_the_sun},
          {"goniometric", goniometric}, {"eulumdat", eulumdat}, {"refusals", refusals})
