/* SPDX-License-Identifier: Apache-2.0
 *
 * The preview against path tracing.
 */
#include "room.h"

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

static layered_frame take(room *r, const igi_camera *camera, int samples, bool preview)
{
    layered_frame f;
    igi_renderer *renderer;
    igi_render_options options;
    igi_render_options_init(&options);
    options.samples = samples;
    CHECK_OK(r->ctx, igi_renderer_create(r->ctx, &r->scene, &r->materials, r->lights,
                                         r->scene.light_count, &renderer));
    if (preview) CHECK_OK(r->ctx, igi_renderer_add_cache(r->ctx, renderer));
    CHECK_OK(r->ctx, layered_frame_render(r->ctx, renderer, camera, 3, &options, 0, true, 1, &f));
    if (preview)
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
    layered_frame got = take(r, &camera, 16, true), want = take(r, &camera, 256, false);
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

TEST_MAIN({"diffuse", diffuse}, {"glossy", glossy})
