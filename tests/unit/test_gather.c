/* SPDX-License-Identifier: Apache-2.0
 *
 * Rows of gathered light: what a light without a place sends past an awning, and what it does not.
 */
#include "test.h"

#include "room.h"
#include "transport/gather.h"

#define SIDES_AT_MOST 4096

static void sun_and_awning(void)
{
    room *r = room_new(1);
    uint32_t floor = room_region(r, "floor", .5), awning = room_region(r, "awning", .5);
    room_quad(r, floor, igi_v(-2, -2, 0), igi_v(4, 0, 0), igi_v(0, 4, 0));
    room_quad(r, awning, igi_v(0, -2, 1), igi_v(2, 0, 0), igi_v(0, 4, 0));
    room_light(
        r, (igi_light){
               .type = IGI_LIGHT_DIRECTIONAL, .region = -1, .direction = {0, 0, -1}, .value = {1}});
    igi_tracer *tracer = NULL;
    igi_lighting *lighting = NULL;
    igi_patches *patches = NULL;
    igi_rows *rows = NULL;
    static uint8_t wanted[SIDES_AT_MOST];
    static size_t begin[SIDES_AT_MOST + 1];
    CHECK_OK(r->ctx, igi_tracer_create(r->ctx, &r->scene.mesh, &tracer));
    CHECK_OK(r->ctx, igi_lighting_create(r->ctx, &r->scene, r->lights, 1, &lighting));
    CHECK_OK(r->ctx, igi_patches_create(r->ctx, &r->scene.mesh, .25f, &patches));
    CHECK(2 * patches->count <= SIDES_AT_MOST);
    for (uint32_t p = 0; p < patches->count; p++)
        wanted[2 * p] = patches->area[p] > 0 && igi_patch_region(patches, p) == floor;
    igi_sites sites = {begin, NULL, NULL, NULL};
    igi_gather_options options = {.rays = 0, .light_points = 4, .wanted = wanted};
    CHECK_OK(r->ctx, igi_rows_create(r->ctx, &r->scene, patches, tracer, lighting, &sites, &options,
                                     &rows));
    size_t lit = 0, dark = 0;
    for (size_t i = 0; i < rows->count; i++) {
        float x = rows->point[3 * i];
        if (fabsf(x) < .3f) continue; /* the shadow's edge */
        CHECK_NEAR((double)rows->direct[i], x < 0 ? 1 : 0, 1e-6);
        CHECK_NEAR((double)rows->open[i], 1, 1e-6);
        if (x < 0) lit++;
        else dark++;
    }
    CHECK(lit > 50);
    CHECK(dark > 50);
    igi_rows_destroy(rows);
    igi_patches_destroy(patches);
    igi_lighting_destroy(lighting);
    igi_tracer_destroy(tracer);
    room_free(r);
}

TEST_MAIN({"sun and awning", sun_and_awning})
