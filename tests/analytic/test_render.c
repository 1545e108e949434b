/* SPDX-License-Identifier: Apache-2.0
 *
 * Pictures whose radiance is known: furnaces, the inside of a sphere, lobes by quadrature, maps;
 * and that the variance is honest and the bytes are the same for any number of threads.
 */
#include "room.h"

#include "base/context.h"
#include "brdf/brdf.h"

typedef struct picture {
    double mean, sigma; /* of the first band over the picture; standard deviation of that mean */
    igi_image *image, *variance;
} picture;

static picture take_camera(room *r, igi_camera camera, int samples, int depth)
{
    picture p = {0, 0, NULL, NULL};
    igi_render_options options;
    igi_render_options_init(&options);
    options.samples = samples;
    options.max_depth = depth;
    CHECK_OK(r->ctx, igi_render(r->ctx, &r->scene, &r->materials, r->lights, r->scene.light_count,
                                &camera, &options, &p.image, &p.variance));
    if (!p.image) abort();
    size_t pixels = (size_t)p.image->width * (size_t)p.image->height;
    double variance = 0;
    for (size_t i = 0; i < pixels; i++) {
        p.mean += (double)p.image->samples[i * (size_t)p.image->channels] / (double)pixels;
        variance += (double)p.variance->samples[i * (size_t)p.image->channels];
    }
    p.sigma = sqrt(variance) / (double)pixels;
    return p;
}

static void drop(picture *p)
{
    igi_image_destroy(p->image);
    igi_image_destroy(p->variance);
}

/* The mean radiance of a picture from `eye` at `target`. */
static picture take(room *r, igi_vec eye, igi_vec target, int pixels, double focal, int samples)
{
    picture p = take_camera(r, room_camera(eye, target, pixels, focal), samples, 1 << 20);
    drop(&p);
    return p;
}

/* Albedo 1 under uniform light is that light, without noise. */
static void white_furnace(void)
{
    room *r = room_new(1);
    room_sphere(r, room_region(r, "ball", 1), igi_v(0, 0, 0), 1, 32, 16, false);
    (void)room_light(r, (igi_light){.type = IGI_LIGHT_AMBIENT, .value = {2}});
    picture p = take_camera(r, room_camera(igi_v(4, 1, 0), igi_v(0, 0, 0), 24, 2), 8, 64);
    for (int i = 0; i < 24 * 24; i++) CHECK_NEAR((double)p.image->samples[i], 2, 1e-5);
    drop(&p);
    room_free(r);
}

/* One wall glows with 1, the others reflect all: 1 comes from everywhere (a hot cavity). */
static void closed_furnace(void)
{
    room *r = room_new(2);
    uint32_t white = room_region(r, "white", 1), lamp = room_lamp(r, "lamp", 1);
    uint32_t regions[6] = {white, white, white, lamp, white, white};
    room_box(r, regions, 4);
    picture p = take(r, igi_v(2, 2, 2), igi_v(2, 0, 1), 32, 1, 256);
    CHECK_NEAR(p.mean, 1, 4 * p.sigma);
    CHECK_NEAR(p.mean, 1, 2e-3);
    room_free(r);
}

/* A point light in the middle of a sphere: E = I/R^2/(1 - rho) everywhere. */
static void sphere_interior(void)
{
    const double rhos[] = {.2, .5, .8, .95};
    for (int k = 0; k < 4; k++) {
        room *r = room_new(2);
        uint32_t wall = room_region(r, "wall", rhos[k]);
        room_sphere(r, wall, igi_v(0, 0, 0), 2, 128, 64, true);
        (void)room_light(r, (igi_light){.type = IGI_LIGHT_POINT, .value = {5}});
        picture p = take(r, igi_v(.5f, .3f, -.8f), igi_v(-2, 0, .3f), 32, 1, 64);
        double e = 5 / 4.0 / (1 - rhos[k]), got = p.mean * IGI_PI / rhos[k];
        /* The facets lie up to 1 - cos(pi/128) within the sphere and lean up to 1.4 degrees. */
        CHECK_NEAR(got / e, 1, 2e-3 + 4 * p.sigma / p.mean);
        CHECK(p.sigma / p.mean < 4e-3);
        room_free(r);
    }
}

static const igi_model lobes[] = {IGI_WARD, IGI_GGX, IGI_PHONG};

static room *lobe_room(igi_model model, double albedo, double specular, double alpha)
{
    room *r = room_new(1);
    uint32_t plane = room_region(r, "plane", albedo);
    r->list[plane].model = model;
    r->list[plane].specular = specular;
    r->list[plane].alpha = alpha;
    room_quad(r, plane, igi_v(-1, -1, 0), igi_v(2, 0, 0), igi_v(0, 2, 0));
    return r;
}

static igi_vec eye_at(double degrees)
{
    float t = (float)(degrees * IGI_PI / 180);
    return igi_v(5 * sinf(t), 0, 5 * cosf(t));
}

/* BRDF times cosine of the lobe room's plane. */
static double reflect(const room *r, igi_vec in, igi_vec out)
{
    const igi_material *m = &r->list[0];
    float scale, base;
    igi_lobe_terms(m->model, (float)m->alpha, in, out, &scale, &base);
    double f = m->albedo[0] / IGI_PI + m->specular * (double)scale + (double)base;
    return f * (double)fmaxf(0.0f, in.z);
}

/* A map of bright and dark pixels lights a glossy plane; samples of the map and of the lobe share
 * the work. The truth is the sum over fine pieces of the map. */
static void environment(void)
{
    static char path[] = "test_render_sky.exr";
    for (int m = 0; m < 3; m++) {
        room *r = lobe_room(lobes[m], .3, .4, .2);
        igi_image *map = NULL;
        CHECK_OK(r->ctx, igi_image_create(r->ctx, 16, 8, 1, &map));
        for (int i = 0; i < 128; i++) map->samples[i] = i % 5 == 0 ? 9 : (float)(i % 3);
        CHECK_OK(r->ctx, igi_image_save_exr(r->ctx, map, IGI_EXR_FLOAT, path));
        (void)room_light(r, (igi_light){.type = IGI_LIGHT_ENV, .file = path, .value = {2}});
        igi_vec out = igi_normalize(eye_at(40));
        double sum = 0;
        enum { FINE = 1600 };
        for (int j = 0; j < FINE / 2; j++)
            for (int i = 0; i < FINE; i++) {
                double theta = IGI_PI * (j + .5) / (FINE / 2),
                       phi = IGI_PI - 2 * IGI_PI * (i + .5) / FINE;
                igi_vec in = {(float)(sin(theta) * cos(phi)), (float)(sin(theta) * sin(phi)),
                              (float)cos(theta)};
                double weight = 2 * IGI_PI / FINE * IGI_PI / (FINE / 2) * sin(theta);
                int pixel = j / (FINE / 16) * 16 + i / (FINE / 16);
                if (in.z > 0) sum += 2 * (double)map->samples[pixel] * reflect(r, in, out) * weight;
            }
        picture p = take(r, eye_at(40), igi_v(0, 0, 0), 8, 1000, 2048);
        CHECK_NEAR(p.mean / sum, 1, 4 * p.sigma / p.mean + 1e-3);
        CHECK(p.sigma / p.mean < 4e-3);
        igi_image_destroy(map);
        room_free(r);
    }
    remove(path);
}

/* Under uniform light a plane shows its directional albedo. */
static void lobes_in_ambient(void)
{
    for (int m = 0; m < 3; m++)
        for (int a = 0; a < 2; a++)
            for (int angle = 10; angle < 80; angle += 30) {
                room *r = lobe_room(lobes[m], .3, .4, a ? .15 : .6);
                (void)room_light(r, (igi_light){.type = IGI_LIGHT_AMBIENT, .value = {1}});
                igi_vec out = igi_normalize(eye_at(angle));
                double albedo = 0;
                int n = 800;
                for (int i = 0; i < n * n; i++) { /* uniform in cos and in azimuth */
                    float z = ((float)(i / n) + .5f) / (float)n, s = sqrtf(1 - z * z);
                    float phi = 2 * IGI_PIF * ((float)(i % n) + .5f) / (float)n;
                    igi_vec in = {s * cosf(phi), s * sinf(phi), z};
                    albedo += reflect(r, in, out) * 2 * IGI_PI / ((double)n * n);
                }
                picture p = take(r, eye_at(angle), igi_v(0, 0, 0), 8, 100, 2048);
                CHECK_NEAR(p.mean / albedo, 1, 4 * p.sigma / p.mean + 1e-3);
                CHECK(p.sigma / p.mean < 2e-3);
                room_free(r);
            }
}

/* A square lamp over the plane, by quadrature over the lamp: light samples, BRDF samples and
 * their sharing all enter. */
static void lobes_under_a_lamp(void)
{
    for (int m = 0; m < 3; m++)
        for (int a = 0; a < 3; a++) {
            room *r = lobe_room(lobes[m], .2, .3, a == 0 ? .5 : a == 1 ? .15 : .05);
            room_quad(r, room_lamp(r, "lamp", 3), igi_v(-1.6f, -.4f, 1), igi_v(0, .8f, 0),
                      igi_v(.8f, 0, 0));
            igi_vec out = igi_normalize(eye_at(50));
            double sum = 0;
            int n = 600;
            for (int i = 0; i < n * n; i++) {
                igi_vec to = {-1.6f + .8f * ((float)(i / n) + .5f) / (float)n,
                              -.4f + .8f * ((float)(i % n) + .5f) / (float)n, 1};
                double d2 = (double)igi_dot(to, to);
                sum += 3 * reflect(r, igi_normalize(to), out) / sqrt(d2) / d2 * .64 /
                       ((double)n * n);
            }
            picture p = take(r, eye_at(50), igi_v(0, 0, 0), 8, 1000, 1024);
            CHECK_NEAR(p.mean / sum, 1, 4 * p.sigma / p.mean + 1e-3);
            CHECK(p.sigma / p.mean < 5e-3);
            room_free(r);
        }
}

/* Every kind of small light gives rho/pi E. */
static void small_lights(void)
{
    igi_light lights[] = {
        {.type = IGI_LIGHT_POINT, .position = {.5, .2, 2}, .value = {3}},
        {.type = IGI_LIGHT_SPOT,
         .position = {0, .3, 2},
         .direction = {0, 0, -1},
         .cutoff_deg = 30,
         .beam_deg = 5,
         .value = {3}},
        {.type = IGI_LIGHT_LINE, .position = {-1, 0, 1}, .end = {1, 1, 2}, .value = {3}},
        {.type = IGI_LIGHT_DIRECTIONAL, .direction = {.6, 0, -.8}, .value = {3}}};
    for (int k = 0; k < 4; k++) {
        room *r = lobe_room(IGI_LAMBERT, .5, 0, 0);
        (void)room_light(r, lights[k]);
        igi_tracer *tracer;
        igi_lighting *lighting;
        CHECK_OK(r->ctx, igi_tracer_create(r->ctx, &r->scene.mesh, &tracer));
        CHECK_OK(r->ctx, igi_lighting_create(r->ctx, &r->scene, r->lights, 1, &lighting));
        double e = 3 * (double)igi_light_irradiance(lighting, tracer, 0, igi_v(0, 0, 0),
                                                    igi_v(0, 0, 1), 4, 1);
        picture p = take(r, eye_at(30), igi_v(0, 0, 0), 8, 10000, 256);
        CHECK(e > 0);
        CHECK_NEAR(p.mean / (e * .5 / IGI_PI), 1, 4 * p.sigma / p.mean + 1e-4);
        igi_lighting_destroy(lighting);
        igi_tracer_destroy(tracer);
        room_free(r);
    }
}

/* Row 0 of a map is v = 1; texel centres are at halves. */
static void maps(void)
{
    room *r = lobe_room(IGI_LAMBERT, .5, 0, 0);
    r->list[0].textured = true;
    CHECK_OK(r->ctx, igi_image_create(r->ctx, 4, 4, 1, &r->list[0].map));
    for (int i = 0; i < 16; i++) r->list[0].map->samples[i] = (float)(i + 1) / 16;
    (void)room_light(r, (igi_light){.type = IGI_LIGHT_AMBIENT, .value = {1}});
    for (int wraps = 0; wraps < 2; wraps++) {
        r->regions[0].uvs_wrap = wraps;
        for (int i = 0; i < 16; i++) { /* look at the middle of each texel */
            igi_vec at = {-1 + .5f * ((float)(i % 4) + .5f), 1 - .5f * ((float)(i / 4) + .5f), 0};
            picture p = take(r, igi_v(at.x, at.y, 3), at, 4, 1e5, 4);
            CHECK_NEAR(p.mean, (i + 1) / 16.0, 1e-4);
        }
        /* At a corner the map repeats, or stays. */
        picture p = take(r, igi_v(-.99999f, .99999f, 3), igi_v(-.99999f, .99999f, 0), 4, 1e6, 4);
        CHECK_NEAR(p.mean, wraps ? (1 + 4 + 13 + 16) / 64.0 : 1 / 16.0, 1e-4);
    }
    igi_image_destroy(r->list[0].map);
    room_free(r);
}

/* Both sides reflect, an emitter shines on its front alone, and a dark one is black. */
static void sides(void)
{
    room *r = lobe_room(IGI_LAMBERT, .5, 0, 0);
    (void)room_light(r, (igi_light){.type = IGI_LIGHT_POINT, .position = {0, 0, -1}, .value = {1}});
    picture p = take(r, igi_v(0, 0, -3), igi_v(0, 0, 0), 4, 1e4, 4);
    CHECK_NEAR(p.mean, .5 / IGI_PI, 1e-5);
    room_free(r);
    r = room_new(1);
    room_quad(r, room_lamp(r, "lamp", 2), igi_v(-1, -1, 0), igi_v(2, 0, 0), igi_v(0, 2, 0));
    CHECK_NEAR(take(r, igi_v(0, 0, 3), igi_v(0, 0, 0), 4, 1e4, 4).mean, 2, 0);
    CHECK_NEAR(take(r, igi_v(0, 0, -3), igi_v(0, 0, 0), 4, 1e4, 4).mean, 0, 0);
    r->scene.light_count = 0;
    CHECK_NEAR(take(r, igi_v(0, 0, 3), igi_v(0, 0, 0), 4, 1e4, 4).mean, 0, 0);
    room_free(r);
}

/* A Cornell-like box of sixteen bands. */
static room *box_room(int threads, int bands)
{
    room *r = room_new(threads);
    uint32_t grey = room_region(r, "grey", .6), other = room_region(r, "other", .3);
    for (int b = 0; b < bands; b++) r->list[other].albedo[b] = .05 * b + .1;
    uint32_t regions[6] = {grey, grey, other, other, grey, grey};
    r->scene.bands = r->materials.bands = bands;
    room_box(r, regions, 4);
    room_quad(r, room_lamp(r, "lamp", 5), igi_v(1.5f, 1.5f, 3.99f), igi_v(0, 1, 0), igi_v(1, 0, 0));
    return r;
}

static void variance_is_honest(void)
{
    room *r = box_room(2, 1);
    igi_camera camera = room_camera(igi_v(.3f, .4f, 2), igi_v(3, 2, 1), 40, .8);
    picture a = take_camera(r, camera, 512, 64), b;
    igi_context_options options; /* another seed */
    igi_context_options_init(&options);
    options.seed = 2;
    igi_context_destroy(r->ctx);
    if (igi_context_create(&options, &r->ctx) != IGI_OK) abort();
    b = take_camera(r, camera, 512, 64);
    double sum = 0;
    int n = 0, far = 0;
    for (int i = 0; i < 1600; i++) {
        double v = (double)(a.variance->samples[i] + b.variance->samples[i]);
        double d = (double)(a.image->samples[i] - b.image->samples[i]);
        if (!(v > 0)) continue; /* the lamp itself */
        sum += d * d / v;
        far += d * d / v > 16;
        n++;
    }
    CHECK(n > 1000);
    CHECK_NEAR(sum / n, 1.03, .12); /* 31 degrees of freedom; 3 sigma of 1600 pixels */
    CHECK(far < 8);
    drop(&a);
    drop(&b);
    room_free(r);
}

static void same_bytes(void)
{
    picture pictures[3];
    int threads[] = {1, 2, 7};
    for (int k = 0; k < 3; k++) {
        room *r = box_room(threads[k], 16);
        pictures[k] = take_camera(r, room_camera(igi_v(.3f, .4f, 2), igi_v(3, 2, 1), 40, .8), 4,
                                  64);
        size_t bytes = 1600 * 16 * sizeof(float);
        CHECK(memcmp(pictures[k].image->samples, pictures[0].image->samples, bytes) == 0);
        room_free(r);
    }
    for (int k = 0; k < 3; k++) drop(&pictures[k]);
}

static void depth(void)
{
    room *r = box_room(1, 1);
    igi_camera camera = room_camera(igi_v(2, 2, 2), igi_v(2, 2, 0), 8, 2);
    picture one = take_camera(r, camera, 16, 1), two = take_camera(r, camera, 16, 2);
    picture all = take_camera(r, camera, 16, 64);
    CHECK(one.mean == 0); /* the lamp alone, and it is behind */
    CHECK(two.mean > 0 && all.mean > 1.2 * two.mean);
    drop(&one);
    drop(&two);
    drop(&all);
    room_free(r);
}

static void refusals(void)
{
    room *r = box_room(1, 1);
    igi_camera camera = room_camera(igi_v(2, 2, 2), igi_v(2, 2, 0), 2, 2);
    igi_render_options options;
    igi_image *image, *variance;
    igi_render_options_init(&options);
    options.samples = 0;
    CHECK(igi_render(r->ctx, &r->scene, &r->materials, r->lights, 1, &camera, &options, &image,
                     &variance) == IGI_E_USAGE);
    CHECK(!image && !variance);
    r->materials.count = 1;
    CHECK(igi_render(r->ctx, &r->scene, &r->materials, r->lights, 1, &camera, NULL, &image,
                     &variance) == IGI_E_DATA);
    CHECK_CONTAINS(igi_context_message(r->ctx), "none for the region 'other'");
    r->materials.count = 3;
    igi_status status = IGI_E_SYSTEM;
    long n = 0;
    for (; status == IGI_E_SYSTEM && n < 100; n++) {
        igi_fail_allocation_after(r->ctx, n);
        status = igi_render(r->ctx, &r->scene, &r->materials, r->lights, 1, &camera, NULL, &image,
                            &variance);
        CHECK((status == IGI_OK) == (image != NULL));
    }
    CHECK(status == IGI_OK && n > 5);
    igi_image_destroy(image);
    igi_image_destroy(variance);
    room_free(r);
}

TEST_MAIN({"white furnace", white_furnace}, {"closed furnace", closed_furnace},
          {"sphere interior", sphere_interior}, {"lobes in ambient", lobes_in_ambient},
          {"environment", environment}, {"lobes under a lamp", lobes_under_a_lamp},
          {"small lights", small_lights}, {"maps", maps}, {"sides", sides},
          {"variance is honest", variance_is_honest}, {"same bytes", same_bytes}, {"depth", depth},
          {"refusals", refusals})
