/* SPDX-License-Identifier: Apache-2.0
 *
 * A bar thinner than a pixel, which no ray through a pixel's middle meets, before a wall: pixels that
 * show the bar, that lie close beside it, and that lie apart.
 */
#include "test.h"

#include "observe/cover.h"
#include "observe/visible.h"
#include "room.h"

enum { PIXELS = 20 }; /* of 5 cm on the wall: pixel 13 shows x from .15 to .2 */

static void thin_bar(void)
{
    room *r = room_new(1);
    igi_tracer *tracer = NULL;
    igi_visible visible = {0};
    uint32_t wall = room_region(r, "wall", .5), bar = room_region(r, "bar", .5);
    room_quad(r, wall, igi_v(-2, -2, 0), igi_v(4, 0, 0), igi_v(0, 4, 0));
    room_quad(r, bar, igi_v(.155f, -2, .001f), igi_v(.01f, 0, 0), igi_v(0, 4, 0));
    CHECK_OK(r->ctx, igi_tracer_create(r->ctx, &r->scene.mesh, &tracer));
    const igi_camera camera = {.width = PIXELS,
                               .height = PIXELS,
                               .fl_x = 20,
                               .fl_y = 20,
                               .cx = PIXELS / 2,
                               .cy = PIXELS / 2,
                               .camera_to_world = {{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 1}}};
    CHECK_OK(r->ctx, igi_visible_create(r->ctx, &r->scene, tracer, &camera, &visible));
    for (uint32_t y = 2; visible.near_edge && y < PIXELS - 2; y++)
        for (uint32_t x = 2; x < PIXELS - 2; x++) {
            size_t rays = 0;
            uint32_t pixel = y * PIXELS + x;
            igi_cover want = x == 13 ? IGI_COVER_PART : x == 12 ? IGI_COVER_WHOLE : IGI_COVER_WIDE;
            CHECK(igi_cover_of(&r->scene, tracer, &camera, pixel, &rays) == want);
            CHECK(rays > 1 && (want == IGI_COVER_PART || rays > 64));
            CHECK(visible.near_edge[pixel] == 0); /* its neighbours do not tell */
        }
    igi_visible_clear(&visible);
    igi_tracer_destroy(tracer);
    room_free(r);
}

TEST_MAIN({"thin_bar", thin_bar})
