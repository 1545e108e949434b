/* SPDX-License-Identifier: Apache-2.0
 *
 * Rays: a bundle meets what its rays meet one by one, and what is no ray meets nothing.
 */
#include "test.h"

#include "room.h"

static room *plain_room(igi_tracer **tracer)
{
    room *r = room_new(1);
    uint32_t wall = room_region(r, "wall", .5);
    room_quad(r, wall, igi_v(-1, -1, 0), igi_v(2, 0, 0), igi_v(0, 2, 0));
    CHECK_OK(r->ctx, igi_tracer_create(r->ctx, &r->scene.mesh, tracer));
    return r;
}

static void no_rays(void)
{
    igi_tracer *t;
    room *r = plain_room(&t);
    igi_vec above = igi_v(.1f, .2f, 1), down = igi_v(0, 0, -1);
    CHECK(igi_trace(t, above, down).triangle != IGI_NO_HIT);
    CHECK(igi_occluded_toward(t, above, down, INFINITY));
    const igi_vec bad[] = {igi_v(NAN, 0, -1), igi_v(INFINITY, 0, -1), igi_v(0, 0, -INFINITY)};
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        CHECK(igi_trace(t, above, bad[i]).triangle == IGI_NO_HIT);
        CHECK(igi_trace(t, bad[i], down).triangle == IGI_NO_HIT);
        CHECK(!igi_occluded_toward(t, above, bad[i], 10));
        CHECK(!igi_occluded(t, above, bad[i]));
    }
    CHECK(!igi_occluded_toward(t, above, down, NAN));
    igi_vec directions[2] = {down, bad[0]};
    igi_hit hits[2];
    igi_trace_bundle(t, above, directions, 2, hits);
    CHECK(hits[0].triangle != IGI_NO_HIT);
    CHECK(hits[1].triangle == IGI_NO_HIT);
    igi_tracer_destroy(t);
    room_free(r);
}

static void bundles(void)
{
    igi_tracer *t;
    room *r = plain_room(&t);
    igi_vec eye = igi_v(.13f, .07f, 1.5f), directions[IGI_TRACE_BUNDLE];
    for (int count = 1; count <= IGI_TRACE_BUNDLE; count++) {
        igi_hit hits[IGI_TRACE_BUNDLE];
        for (int i = 0; i < count; i++)
            directions[i] = igi_normalize(igi_v(.25f * (float)i - 1, .11f * (float)count, -1));
        igi_trace_bundle(t, eye, directions, count, hits);
        for (int i = 0; i < count; i++) {
            igi_hit one = igi_trace(t, eye, directions[i]);
            CHECK(hits[i].triangle == one.triangle);
            CHECK(hits[i].back == one.back);
            if (one.triangle == IGI_NO_HIT) continue;
            CHECK_NEAR((double)hits[i].distance, (double)one.distance, 1e-5);
            CHECK_NEAR((double)hits[i].u, (double)one.u, 1e-5);
            CHECK_NEAR((double)hits[i].v, (double)one.v, 1e-5);
        }
    }
    igi_tracer_destroy(t);
    room_free(r);
}

TEST_MAIN({"no rays", no_rays}, {"bundles", bundles})
