/* SPDX-License-Identifier: Apache-2.0
 *
 * Frames in passes and in layers.
 */
#include "room.h"

#include "render/layers.h"

/* A floor under a point light; a wall beside it if wanted. */
static room *lit_floor(bool wall)
{
    room *r = room_new(2);
    room_quad(r, room_region(r, "floor", .5), igi_v(-2, -2, 0), igi_v(4, 0, 0), igi_v(0, 4, 0));
    if (wall)
        room_quad(r, room_region(r, "wall", .8), igi_v(-2, 2, 0), igi_v(4, 0, 0), igi_v(0, 0, 2));
    (void)room_light(
        r, (igi_light){.type = IGI_LIGHT_POINT, .region = -1, .position = {0, 0, 1}, .value = {3}});
    return r;
}

static layered_frame take(room *r, int samples, double target, bool apart)
{
    layered_frame f;
    igi_renderer *renderer;
    igi_render_options options;
    igi_camera camera = room_camera(igi_v(0, -4, 3), igi_v(0, 1, 0), 24, 1);
    igi_render_options_init(&options);
    options.samples = samples;
    CHECK_OK(r->ctx, igi_renderer_create(r->ctx, &r->scene, &r->materials, r->lights,
                                         r->scene.light_count, &renderer));
    CHECK_OK(r->ctx, layered_frame_render(r->ctx, renderer, &camera, 7, &options, target, apart,
                                          r->scene.bands, &f));
    igi_renderer_destroy(renderer);
    if (!f.layers[0]) abort();
    return f;
}

/* The parts add up to the picture; a floor alone gets no indirect light, one beside a wall does. */
static void parts(void)
{
    for (int wall = 0; wall < 2; wall++) {
        room *r = lit_floor(wall);
        layered_frame f = take(r, 16, 0, true), plain = take(r, 16, 0, false);
        igi_image *joined = NULL;
        double sums[4] = {0};
        CHECK_OK(r->ctx, layered_frame_join(r->ctx, &f, &joined));
        if (!joined) abort();
        CHECK_STR(joined->names[0], "albedo.Y");
        CHECK_STR(joined->names[2], "indirect.Y");
        for (int i = 0; i < 24 * 24; i++) {
            const float *v = joined->samples + (size_t)i * 4;
            double picture = (double)f.layers[LAYER_PICTURE]->samples[i];
            CHECK_NEAR((double)(v[1] + v[2]), picture, 1e-6 + 1e-5 * picture);
            CHECK_NEAR((double)plain.layers[LAYER_PICTURE]->samples[i], picture,
                       1e-6 + 1e-5 * picture);
            for (int k = 0; k < 4; k++) sums[k] += (double)v[k];
        }
        CHECK_NEAR((double)joined->samples[(size_t)(18 * 24 + 12) * 4], .5, 1e-6);
        CHECK(sums[1] > 0);
        if (wall) CHECK(sums[2] > .02 * sums[1]);
        else CHECK_NEAR(sums[2] / sums[1], 0, 1e-6);
        igi_image_destroy(joined);
        layered_frame_clear(&f);
        layered_frame_clear(&plain);
        room_free(r);
    }
}

/* Passes follow until the noise is at the target, which falls with the root of their number. */
static void target(void)
{
    room *r = lit_floor(true);
    layered_frame one = take(r, 16, 0, false);
    layered_frame many = take(r, 16, one.noise / 3, false),
                  again = take(r, 16, one.noise / 3, false);
    CHECK(one.samples == 16 && one.noise > 0);
    CHECK(many.noise <= one.noise / 3);
    CHECK(many.samples >= 16 * 6 && many.samples <= 16 * 14 && many.samples % 16 == 0);
    CHECK(memcmp(many.layers[0]->samples, again.layers[0]->samples, 24 * 24 * sizeof(float)) == 0);
    /* The stated noise is that of the picture: against one of many more paths. */
    layered_frame truth = take(r, 4096, 0, false);
    double squared = 0, stated = 0;
    for (int i = 0; i < 24 * 24; i++) {
        double d = (double)(many.layers[0]->samples[i] - truth.layers[0]->samples[i]);
        squared += d * d;
        stated += (double)many.layers[LAYER_VARIANCE]->samples[i];
    }
    CHECK_NEAR(squared / stated, 1, .3); /* 24^2 pixels of heavy tails */
    layered_frame_clear(&one);
    layered_frame_clear(&many);
    layered_frame_clear(&again);
    layered_frame_clear(&truth);
    room_free(r);
}

TEST_MAIN({"parts", parts}, {"target", target})
