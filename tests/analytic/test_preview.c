/* SPDX-License-Identifier: Apache-2.0
 *
 * The preview against path tracing, and paths that end with radiosity against those that do not.
 */
#include "room.h"

#include "base/context_private.h"
#include "render/layers.h"
#include "render/path.h"
#include "render/smooth.h"

/* A cube of 1 m whose ceiling emits 1 W m^-2; a glossy floor if wanted. */
static room *cube(double albedo, bool glossy)
{
    room *r = room_new(2);
    uint32_t wall = room_region(r, "wall", albedo), lamp = room_lamp(r, "lamp", 1 / IGI_PI);
    uint32_t floor = room_region(r, "floor", glossy ? albedo / 2 : albedo);
    const uint32_t regions[6] = {floor, lamp, wall, wall, wall, wall};
    if (glossy) {
        r->list[floor].model = IGI_GGX;
        r->list[floor].specular = .1;
        r->list[floor].alpha = .3;
    }
    room_box(r, regions, 1);
    return r;
}

typedef enum manner { PLAIN, PREVIEW, EXPECTING, MISLED } manner;

static layered_frame take(room *r, const igi_camera *camera, int samples, manner how)
{
    layered_frame f;
    igi_renderer *renderer;
    igi_render_options options;
    igi_render_options_init(&options);
    options.samples = samples;
    CHECK_OK(r->ctx, igi_renderer_create(r->ctx, &r->scene, &r->materials, r->lights,
                                         r->scene.light_count, &renderer));
    if (how == PREVIEW) CHECK_OK(r->ctx, igi_renderer_add_cache(r->ctx, renderer));
    if (how == EXPECTING || how == MISLED) {
        for (size_t i = 0; i < r->scene.region_count && how == MISLED; i++)
            renderer->finishes[i].albedo[0] *= 1.5f;
        CHECK_OK(r->ctx, igi_renderer_expect(r->ctx, renderer, 1e7));
        CHECK(renderer->expected);
        for (size_t i = 0; i < r->scene.region_count && how == MISLED; i++)
            renderer->finishes[i].albedo[0] /= 1.5f;
    }
    CHECK_OK(r->ctx, layered_frame_render(r->ctx, renderer, camera, 3, &options, 0, true, 1, &f));
    if (how == PREVIEW)
        CHECK_OK(r->ctx, igi_smooth_indirect(r->ctx, renderer, camera, f.layers[LAYER_PICTURE],
                                             f.layers[LAYER_DIRECT], f.layers[LAYER_ALBEDO]));
    igi_renderer_destroy(renderer);
    return f;
}

/* Walls, edges and a lobe: the mean within one per cent, blocks of 4 x 4 pixels within three. */
static void compare(double albedo, bool glossy)
{
    room *r = cube(albedo, glossy);
    igi_camera camera = room_camera(igi_v(.1f, .1f, .8f), igi_v(.8f, .7f, .2f), 48, .7);
    layered_frame got = take(r, &camera, 16, PREVIEW), want = take(r, &camera, 256, PLAIN);
    double squared = 0, a = 0, b = 0;
    for (int i = 0; i < 144; i++) {
        double x = 0, y = 0;
        for (int k = 0; k < 16; k++) {
            int at = (i / 12 * 4 + k / 4) * 48 + i % 12 * 4 + k % 4;
            x += (double)got.layers[LAYER_PICTURE]->samples[at];
            y += (double)want.layers[LAYER_PICTURE]->samples[at];
        }
        squared += (x / y - 1) * (x / y - 1) / 144;
        a += x;
        b += y;
    }
    CHECK_NEAR(a / b, 1, .01);
    CHECK(sqrt(squared) < .03);
    layered_frame_clear(&got);
    layered_frame_clear(&want);
    room_free(r);
}

static void diffuse(void)
{
    compare(.5, false);
    compare(.9, false);
}

static void glossy(void)
{
    compare(.7, true);
}

/* The mean of a picture, the standard deviation of that mean, and the rays that it took. */
typedef struct summary {
    double mean, sigma, rays;
} summary;

static summary summarize(bool glossy, int samples, manner how)
{
    room *r = cube(.6, glossy);
    igi_camera camera = room_camera(igi_v(.1f, .1f, .8f), igi_v(.8f, .7f, .2f), 48, .7);
    uint64_t before = atomic_load(&r->ctx->rays);
    layered_frame f = take(r, &camera, samples, how);
    summary s = {0, 0, (double)(atomic_load(&r->ctx->rays) - before)};
    for (int i = 0; i < 48 * 48; i++) {
        s.mean += (double)f.layers[LAYER_PICTURE]->samples[i] / (48 * 48);
        s.sigma += (double)f.layers[LAYER_VARIANCE]->samples[i];
    }
    s.sigma = sqrt(s.sigma) / (48 * 48);
    layered_frame_clear(&f);
    room_free(r);
    return s;
}

/* Whatever the radiosity is, the mean stays; where it is about right, less work does. */
static void expected(void)
{
    for (int glossy = 0; glossy < 2; glossy++) {
        summary plain = summarize(glossy, 256, PLAIN), some;
        some = summarize(glossy, 256, EXPECTING);
        CHECK_NEAR(some.mean / plain.mean, 1, 4 * hypot(some.sigma, plain.sigma) / plain.mean);
        CHECK(some.sigma < 2e-3 * plain.mean);
        CHECK(some.sigma * some.sigma * some.rays < .8 * plain.sigma * plain.sigma * plain.rays);
        some = summarize(glossy, 256, MISLED);
        CHECK_NEAR(some.mean / plain.mean, 1, 4 * hypot(some.sigma, plain.sigma) / plain.mean);
        CHECK(some.sigma < 3e-3 * plain.mean);
    }
}

/* Of few paths there is nothing to be saved. */
static void not_worth_it(void)
{
    room *r = cube(.5, false);
    igi_renderer *renderer;
    CHECK_OK(r->ctx, igi_renderer_create(r->ctx, &r->scene, &r->materials, r->lights,
                                         r->scene.light_count, &renderer));
    CHECK_OK(r->ctx, igi_renderer_expect(r->ctx, renderer, 100));
    CHECK(!renderer->expected);
    igi_renderer_destroy(renderer);
    room_free(r);
}

TEST_MAIN({"diffuse", diffuse}, {"glossy", glossy}, {"expected", expected},
          {"not worth it", not_worth_it})
