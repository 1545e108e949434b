/* SPDX-License-Identifier: Apache-2.0
 *
 * What a mirror sends on of a lamp that touches it: all of it, whatever the seed.
 */
#include "test.h"

#include "room.h"
#include "specular/lobe_photons.h"

#define SIDES_AT_MOST 4096
#define TOUCHING 0.200043776075403 /* form factor of squares at right angles, a common edge */

/* A cube of side 1 with a mirror for a floor and a wall that shines. Of light that left the lamp
 * downward nothing comes back to the lamp. */
static void mirror_and_lamp(void)
{
    room *r = room_new(1);
    uint32_t mirror = room_region(r, "mirror", 0), left = room_region(r, "left", .5),
             right = room_region(r, "right", .5), rest = room_region(r, "rest", .5),
             lamp = room_lamp(r, "lamp", 1);
    room_box(r, (const uint32_t[6]){mirror, rest, left, right, lamp, rest}, 1);
    igi_tracer *tracer = NULL;
    igi_lighting *lighting = NULL;
    igi_patches *patches = NULL;
    igi_rows *rows = NULL;
    static uint8_t wanted[SIDES_AT_MOST];
    static size_t begin[SIDES_AT_MOST + 1];
    static float received[SIDES_AT_MOST];
    CHECK_OK(r->ctx, igi_tracer_create(r->ctx, &r->scene.mesh, &tracer));
    CHECK_OK(r->ctx, igi_lighting_create(r->ctx, &r->scene, r->lights, 1, &lighting));
    CHECK_OK(r->ctx, igi_patches_create(r->ctx, &r->scene.mesh, .1f, &patches));
    CHECK(2 * patches->count <= SIDES_AT_MOST);
    for (uint32_t p = 0; p < patches->count; p++)
        wanted[2 * p] = patches->area[p] > 0 && igi_patch_region(patches, p) != lamp;
    igi_sites sites = {begin, NULL, NULL, NULL};
    igi_gather_options options = {.rays = 0, .light_points = 4, .wanted = wanted};
    CHECK_OK(r->ctx, igi_rows_create(r->ctx, &r->scene, patches, tracer, lighting, &sites, &options,
                                     &rows));
    igi_lobe lobes[5] = {{.model = IGI_LAMBERT}};
    lobes[mirror] = (igi_lobe){.model = IGI_GGX, .alpha = .01f, .specular = {1}};
    igi_problem problem = {.scene = &r->scene,
                           .tracer = tracer,
                           .patches = patches,
                           .lighting = lighting,
                           .light_count = 1,
                           .lights = r->lights,
                           .bands = 1};
    igi_radiance_field field = {.problem = &problem, .lobes = lobes};
    for (uint64_t round = 1; round <= 5; round++) {
        double flux[5] = {0}, all = 0;
        memset(received, 0, sizeof received);
        CHECK_OK(r->ctx, igi_lobe_photons_add(r->ctx, &field, rows, round, received));
        for (size_t i = 0; i < rows->count; i++) {
            uint32_t patch = rows->side[i] >> 1;
            double arrives = (double)(received[i] * patches->area[patch]);
            flux[igi_patch_region(patches, patch)] += arrives;
            all += arrives;
        }
        /* three standard deviations of 12,800 paths, and of what a fifth of them each bring */
        CHECK_NEAR(all / (IGI_PI * TOUCHING), 1, .02);
        CHECK_NEAR(flux[left] / flux[right], 1, .1);
    }
    igi_rows_destroy(rows);
    igi_patches_destroy(patches);
    igi_lighting_destroy(lighting);
    igi_tracer_destroy(tracer);
    room_free(r);
}

TEST_MAIN({"mirror and lamp", mirror_and_lamp})
