/* SPDX-License-Identifier: Apache-2.0
 *
 * A floor of 2 x 2 m under a point lamp, with a plate that throws a shadow: irradiance, texels and
 * the evidence for a texture against closed forms.
 */
#include "test.h"

#include "base/rng.h"
#include "maps/maps_private.h"
#include "rooms.h"

#include <string.h>

#define PER_FRAME 40000
#define FRAMES 4
#define COUNT (PER_FRAME * FRAMES)

static const double lamp_at[3] = {1.1, 0.9, 2};

typedef struct world {
    igi_context *ctx;
    room *room;
    float uvs[4][6];
    igi_region regions[2];
    igi_light light;
    igi_frame frames[FRAMES];
    igi_scene scene;
    igi_observations seen;
    size_t frame_begin[FRAMES + 1];
    uint32_t surface[COUNT], pixel[COUNT];
    float uv[COUNT][2], radiance[COUNT];
    igi_recover_options options;
    igi_tracer *tracer;
    igi_patches *patches;
    igi_problem *problem;
    igi_diffuse *diffuse;
    igi_field *field;
    igi_layout *layout;
    igi_material list[2];
    igi_materials materials;
} world;

/* The plate covers [.5,.7] x [.5,.9] at 0.5 m. */
static bool is_lit(double x, double y)
{
    double t = 0.5 / lamp_at[2];
    double px = x + t * (lamp_at[0] - x), py = y + t * (lamp_at[1] - y);
    return !(px > 0.5 && px < 0.7 && py > 0.5 && py < 0.9);
}

static double irradiance(double x, double y)
{
    double dx = lamp_at[0] - x, dy = lamp_at[1] - y,
           d2 = dx * dx + dy * dy + lamp_at[2] * lamp_at[2];
    return is_lit(x, y) ? 10 * lamp_at[2] / (d2 * sqrt(d2)) : 0;
}

typedef double (*paint)(double x, double y);

static double plain(double x, double y)
{
    (void)x;
    (void)y;
    return 0.6;
}

/* Squares of 1/8 m, as wide as 4 texels of a map of 64. */
static double checkers(double x, double y)
{
    return ((int)floor(x * 8) + (int)floor(y * 8)) % 2 ? 0.3 : 0.7;
}

/* One point of the floor, seen by all frames. */
static void see(world *w, paint albedo, size_t i, igi_rng *rng, double noise)
{
    double x = 2 * (double)igi_rng_float(rng), y = 2 * (double)igi_rng_float(rng);
    bool upper = y > x; /* triangles (0,0) (2,0) (2,2) and (0,0) (2,2) (0,2) */
    w->surface[i] = upper ? 2 : 0;
    w->uv[i][0] = (float)(upper ? x / 2 : (x - y) / 2);
    w->uv[i][1] = (float)(upper ? (y - x) / 2 : y / 2);
    double error = noise * ((double)igi_rng_float(rng) - 0.5);
    w->radiance[i] = (float)(albedo(x, y) / IGI_PI * irradiance(x, y) * (1 + error));
}

static void make_scene(world *w)
{
    const double floor_at[3] = {0, 0, 0}, x[3] = {2, 0, 0}, y[3] = {0, 2, 0};
    const double plate_at[3] = {.5, .5, .5}, px[3] = {.2, 0, 0}, py[3] = {0, .4, 0};
    const float uvs[2][6] = {{0, 0, 1, 0, 1, 1}, {0, 0, 1, 1, 0, 1}};
    room_quad(w->room, floor_at, x, y, 1, 0);
    room_quad(w->room, plate_at, px, py, 1, 1);
    for (int t = 0; t < 4; t++) memcpy(w->uvs[t], uvs[t % 2], sizeof w->uvs[t]);
    w->room->mesh.uvs = w->uvs[0];
    w->regions[0] = (igi_region){.name = (char[]){"floor"}, .textured = IGI_AUTO, .has_uvs = true};
    w->regions[1] = (igi_region){.name = (char[]){"plate"}, .textured = IGI_AUTO, .has_uvs = true};
    w->light = (igi_light){.type = IGI_LIGHT_POINT,
                           .region = -1,
                           .known = true,
                           .value = {10},
                           .position = {lamp_at[0], lamp_at[1], lamp_at[2]}};
    for (int f = 0; f < FRAMES; f++)
        w->frames[f] = (igi_frame){
            .camera = {.width = 200,
                       .height = 200,
                       .fl_x = 200,
                       .fl_y = 200,
                       .cx = 100,
                       .cy = 100,
                       .camera_to_world = {{1, 0, 0, 0.9 + 0.1 * f}, {0, 1, 0, 1}, {0, 0, 1, 3}}}};
    w->scene = (igi_scene){.bands = 1,
                           .mesh = w->room->mesh,
                           .region_count = 2,
                           .regions = w->regions,
                           .light_count = 1,
                           .lights = &w->light,
                           .frame_count = FRAMES,
                           .frames = w->frames};
}

static world *world_new(int threads, paint albedo, double noise)
{
    world *w = calloc(1, sizeof *w);
    if (!w) abort();
    w->ctx = test_context(threads);
    w->room = room_new();
    make_scene(w);
    igi_rng rng = igi_rng_make(3, 4);
    for (size_t i = 0; i < COUNT; i++) see(w, albedo, i, &rng, noise);
    for (size_t f = 0; f <= FRAMES; f++) w->frame_begin[f] = f * PER_FRAME;
    w->seen = (igi_observations){.bands = 1,
                                 .count = COUNT,
                                 .frame_count = FRAMES,
                                 .frame_begin = w->frame_begin,
                                 .surface = w->surface,
                                 .uv = w->uv[0],
                                 .pixel = w->pixel,
                                 .radiance = w->radiance};
    igi_recover_options_init(&w->options);
    CHECK_OK(w->ctx, igi_tracer_create(w->ctx, &w->scene.mesh, &w->tracer));
    CHECK_OK(w->ctx, igi_patches_create(w->ctx, &w->scene.mesh, 0.06f, &w->patches));
    CHECK_OK(w->ctx, igi_problem_create(w->ctx, &w->scene, w->tracer, &w->seen, w->patches,
                                        &w->options, &w->problem));
    CHECK_OK(w->ctx, igi_diffuse_create(w->ctx, w->problem, &w->diffuse));
    w->diffuse->ignores_indirect = true;
    CHECK_OK(w->ctx, igi_field_create(w->ctx, w->problem, w->diffuse, &w->field));
    CHECK_OK(w->ctx, igi_layout_create(w->ctx, &w->scene, &w->layout));
    w->list[0] = (igi_material){.albedo = {0.5}, .albedo_std = {0.1}, .determined = true};
    w->materials = (igi_materials){.bands = 1, .count = 2, .materials = w->list};
    return w;
}

static void world_free(world *w)
{
    igi_image_destroy(w->list[0].map);
    igi_image_destroy(w->list[0].map_std);
    igi_layout_destroy(w->layout);
    igi_field_destroy(w->field);
    igi_diffuse_destroy(w->diffuse);
    igi_problem_destroy(w->problem);
    igi_patches_destroy(w->patches);
    igi_tracer_destroy(w->tracer);
    igi_context_destroy(w->ctx);
    free(w->room);
    free(w);
}

/* Largest relative error of lit points away from the shadow's edge, and the share of all points
 * whose irradiance is off by more than 2 %. */
static void measure_field(const world *w, double *largest, double *wrong)
{
    igi_rng rng = igi_rng_make(8, 8);
    int n = 4000, off = 0;
    *largest = 0;
    for (int k = 0; k < n; k++) {
        float u = igi_rng_float(&rng), v = igi_rng_float(&rng) * (1 - u), e;
        igi_vec p = igi_triangle_point(&w->scene.mesh, 0, u, v);
        double want = irradiance((double)p.x, (double)p.y);
        igi_field_irradiance(w->field, 0, u, v, &e);
        double error = fabs((double)e - want) / (want > 0 ? want : 0.5);
        off += error > 0.02;
        bool near_edge = false;
        for (int c = 0; c < 9; c++)
            near_edge |= is_lit((double)p.x + 0.15 * (c % 3 - 1),
                                (double)p.y + 0.15 * (c / 3 - 1)) !=
                         is_lit((double)p.x, (double)p.y);
        if (!near_edge) *largest = fmax(*largest, error);
    }
    *wrong = (double)off / n;
}

static void field_under_a_lamp(void)
{
    world *w = world_new(1, plain, 0);
    double largest, wrong, refined;
    measure_field(w, &largest, &wrong);
    CHECK(largest < 2e-3);
    CHECK(wrong > 0.01); /* the shadow's edge, as sharp as the patches */
    CHECK_OK(w->ctx, igi_field_refine(w->ctx, w->field, 0));
    measure_field(w, &largest, &refined);
    CHECK(largest < 2e-3);
    CHECK(refined < 0.004 && refined < wrong / 4);
    world_free(w);
}

/* Shares of determined texels that are off by more than `tolerance`. */
static double share_off(const world *w, paint albedo, double tolerance, double *determined)
{
    const igi_image *map = w->list[0].map;
    double off = 0, known = 0;
    for (int j = 0; j < map->height; j++)
        for (int i = 0; i < map->width; i++) {
            const float *texel = map->samples + (size_t)(j * map->width + i) * 2;
            double x = 2 * (i + 0.5) / map->width, y = 2 * (1 - (j + 0.5) / map->height);
            if (texel[1] < 0.5f) continue;
            known++;
            off += fabs((double)texel[0] / albedo(x, y) - 1) > tolerance;
        }
    *determined = known / (map->width * map->height);
    return off / known;
}

static void checkered_floor(void)
{
    world *w = world_new(1, checkers, 0.1);
    double determined;
    w->options.map_size = 64;
    CHECK_OK(w->ctx, igi_maps_create(w->ctx, w->problem, w->field, w->layout, &w->materials, NULL));
    CHECK(w->list[0].textured && !w->list[1].map);
    CHECK(w->list[0].map->width == 64 && w->list[0].map->channels == 2);
    /* 12 of the 16 texels of a square lie at its rim; sharpening gets half of them right. */
    CHECK(share_off(w, checkers, 0.03, &determined) < 0.45);
    CHECK(share_off(w, checkers, 0.40, &determined) < 0.02);
    CHECK(determined > 0.9);
    CHECK_NEAR(w->list[0].albedo[0], 0.5, 0.005);
    world_free(w);
}

static void plain_floor(void)
{
    world *w = world_new(1, plain, 0.1);
    double determined;
    CHECK_OK(w->ctx, igi_maps_create(w->ctx, w->problem, w->field, w->layout, &w->materials, NULL));
    CHECK(!w->list[0].textured);
    CHECK(w->list[0].map->width <= 64 && w->list[0].map_std->channels == 1);
    CHECK(share_off(w, plain, 0.02, &determined) < 0.05);
    CHECK(determined > 0.9);
    w->regions[0].textured = IGI_YES; /* the manifest has the last word */
    igi_image_destroy(w->list[0].map);
    igi_image_destroy(w->list[0].map_std);
    CHECK_OK(w->ctx, igi_maps_create(w->ctx, w->problem, w->field, w->layout, &w->materials, NULL));
    CHECK(w->list[0].textured && w->list[0].map->width == 128); /* pixels of 1.5 cm on 2 m */
    CHECK(share_off(w, plain, 0.03, &determined) < 0.05);
    world_free(w);
}

/* Texels are off by half as much again as their standard deviations say where noise alone is to blame:
 * sharpening passes on more of it than the sums know of. Rims of a pattern hide that elsewhere. */
static void texels_know_their_errors(void)
{
    world *w = world_new(1, plain, 0.5);
    double squares = 0, known = 0;
    w->options.map_size = 64;
    w->regions[0].textured = IGI_YES;
    CHECK_OK(w->ctx, igi_maps_create(w->ctx, w->problem, w->field, w->layout, &w->materials, NULL));
    const igi_image *map = w->list[0].map, *std = w->list[0].map_std;
    for (size_t i = 0; i < 64 * 64; i++) {
        if (map->samples[2 * i + 1] < 0.5f) continue;
        double z = ((double)map->samples[2 * i] - 0.6) / (double)std->samples[i];
        squares += fmin(z * z, 16); /* the plate's shadow ends within a few of them */
        known++;
    }
    CHECK(known > 0.95 * 64 * 64);
    CHECK_NEAR(sqrt(squares / known), 1.6, 0.15);
    world_free(w);
}

/* Coordinates beyond the square: a texture that repeats, or a rounded rim. */
static void places_repeat(void)
{
    float x, y, uvs[6] = {-0.25f, 1.25f, 2.25f, 0, 1, 1};
    uint32_t of[1] = {0};
    igi_region region = {.has_uvs = true, .uvs_wrap = true};
    igi_scene scene = {.mesh = {.triangle_count = 1, .regions = of}, .regions = &region};
    igi_layout layout = {&scene, uvs};
    igi_layout_place(&layout, 0, 0, 0, 16, &x, &y);
    CHECK_NEAR((double)x, 12, 1e-4);
    CHECK_NEAR((double)y, 12, 1e-4); /* rows run down from v = 1 */
    igi_layout_place(&layout, 0, 1, 0, 16, &x, &y);
    CHECK_NEAR((double)x, 4, 1e-4);
    region.uvs_wrap = false;
    igi_layout_place(&layout, 0, 0, 0, 16, &x, &y);
    CHECK_NEAR((double)x, 0, 0);
    CHECK_NEAR((double)y, 0, 0);
}

static void same_for_any_threads(void)
{
    world *a = world_new(1, checkers, 0.1), *b = world_new(5, checkers, 0.1);
    CHECK_OK(a->ctx, igi_maps_create(a->ctx, a->problem, a->field, a->layout, &a->materials, NULL));
    CHECK_OK(b->ctx, igi_maps_create(b->ctx, b->problem, b->field, b->layout, &b->materials, NULL));
    const igi_image *p = a->list[0].map, *q = b->list[0].map;
    CHECK(p->width == q->width && p->height == q->height);
    size_t n = (size_t)p->width * (size_t)p->height;
    CHECK(memcmp(p->samples, q->samples, 2 * n * sizeof(float)) == 0);
    CHECK(memcmp(a->list[0].map_std->samples, b->list[0].map_std->samples, n * sizeof(float)) == 0);
    CHECK(a->list[0].albedo[0] == b->list[0].albedo[0]);
    world_free(a);
    world_free(b);
}

static void holes_are_filled(void)
{
    igi_context *ctx = test_context(1);
    float image[64] = {0}, weight[64] = {0}, fallback = 9;
    CHECK_OK(ctx, igi_fill_holes(ctx, image, weight, 8, 1, &fallback));
    for (int i = 0; i < 64; i++) CHECK_NEAR((double)image[i], 9, 1e-6);
    image[10] = 2; /* the one known texel is all there is to go by, and stays */
    weight[10] = 1;
    CHECK_OK(ctx, igi_fill_holes(ctx, image, weight, 8, 1, &fallback));
    for (int i = 0; i < 64; i++) CHECK_NEAR((double)image[i], 2, 1e-6);
    igi_context_destroy(ctx);
}

TEST_MAIN({"field_under_a_lamp", field_under_a_lamp}, {"checkered_floor", checkered_floor},
          {"plain_floor", plain_floor}, {"texels_know_their_errors", texels_know_their_errors},
          {"places_repeat", places_repeat}, {"same_for_any_threads", same_for_any_threads},
          {"holes_are_filled", holes_are_filled})
