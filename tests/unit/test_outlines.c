/* SPDX-License-Identifier: Apache-2.0
 *
 * A lamp's area in photographs against its area in the mesh, and light where the mesh has gaps.
 */
#include "room.h"

#include "observe/outlines.h"
#include "scene/camera.h"

enum { PIXELS = 64, PARTS = 8 };

/* A closed box of 3 m with a lamp of the given side below its ceiling; `walls` 5: one is missing. */
static room *make_room(float side, int walls)
{
    room *r = room_new(1);
    uint32_t wall = room_region(r, "wall", .5), lamp = room_lamp(r, "lamp", 10);
    igi_vec o = {0, 0, 0}, x = {3, 0, 0}, y = {0, 3, 0}, z = {0, 0, 3};
    room_quad(r, wall, o, x, y);
    room_quad(r, wall, z, y, x);
    room_quad(r, wall, o, z, x);
    room_quad(r, wall, y, x, z);
    room_quad(r, wall, o, y, z);
    if (walls == 6) room_quad(r, wall, x, z, y);
    float low = 1.4f - side / 2;
    room_quad(r, lamp, igi_v(low, low, 2.95f), igi_v(0, side, 0), igi_v(side, 0, 0));
    return r;
}

static igi_camera view(int number)
{
    const igi_vec eyes[3] = {{.5f, .7f, .4f}, {2.4f, .6f, .9f}, {1.9f, 2.3f, .3f}};
    return room_camera(eyes[number], igi_v(1.4f, 1.4f, 2.9f), PIXELS, .7);
}

/* What a camera sees of a room whose lamp shines with 10, everything else with .5. */
static igi_image *photograph(room *r, const igi_camera *camera)
{
    igi_tracer *tracer = NULL;
    igi_image *image = NULL;
    CHECK_OK(r->ctx, igi_tracer_create(r->ctx, &r->scene.mesh, &tracer));
    CHECK_OK(r->ctx, igi_image_create(r->ctx, PIXELS, PIXELS, 1, &image));
    if (!tracer || !image) abort();
    for (int i = 0; i < PIXELS * PIXELS * PARTS * PARTS; i++) {
        int pixel = i / (PARTS * PARTS), part = i % (PARTS * PARTS);
        double x = pixel % PIXELS + (part % PARTS + .5) / PARTS,
               y = (double)(pixel / PIXELS) + ((double)(part / PARTS) + .5) / PARTS;
        igi_hit hit = igi_trace(tracer, igi_camera_centre(camera),
                                igi_camera_direction(camera, x, y));
        bool lamp = hit.triangle != IGI_NO_HIT && r->regions_of[hit.triangle] == 1;
        image->samples[pixel] += (lamp ? 10.f : .5f) / (PARTS * PARTS);
    }
    igi_tracer_destroy(tracer);
    return image;
}

/* The lamp's size seen over meshed, and the gaps, of a mesh against photographs of the truth. */
static igi_lamp_size compare(room *mesh, room *truth, double *gaps)
{
    igi_outline *outlines = NULL;
    size_t count = 0;
    igi_tracer *tracer = NULL;
    *gaps = 0;
    CHECK_OK(mesh->ctx, igi_tracer_create(mesh->ctx, &mesh->scene.mesh, &tracer));
    for (int k = 0; k < 3 && tracer; k++) {
        igi_camera camera = view(k);
        igi_visible visible;
        igi_image *image = photograph(truth, &camera);
        CHECK_OK(mesh->ctx, igi_visible_create(mesh->ctx, &mesh->scene, tracer, &camera, &visible));
        CHECK_OK(mesh->ctx, igi_outlines_measure(mesh->ctx, &mesh->scene, tracer, &camera, image,
                                                 &visible, &outlines, &count));
        *gaps += igi_lit_gaps(&mesh->scene, image, &visible) / 3;
        igi_visible_clear(&visible);
        igi_image_destroy(image);
    }
    igi_lamp_size size = igi_outlines_sum(outlines, count, 1);
    igi_free(outlines);
    igi_tracer_destroy(tracer);
    return size;
}

static void a_lamp_of_another_size_is_measured(void)
{
    static const struct {
        float meshed, seen;
    } cases[] = {{.8f, .8f}, {.82f, .8f}, {.8f, .84f}, {.88f, .8f}};
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        room *mesh = make_room(cases[i].meshed, 6), *truth = make_room(cases[i].seen, 6);
        double gaps, want = pow((double)cases[i].seen / (double)cases[i].meshed, 2);
        igi_lamp_size size = compare(mesh, truth, &gaps);
        CHECK(size.photographs == 3);
        CHECK_NEAR(size.ratio, want, .004);
        CHECK(size.error < .006);
        CHECK(gaps == 0);
        room_free(mesh);
        room_free(truth);
    }
}

static void light_from_gaps_is_counted(void)
{
    room *mesh = make_room(.8f, 5), *truth = make_room(.8f, 6);
    double gaps;
    igi_lamp_size size = compare(mesh, truth, &gaps);
    CHECK(gaps > .02 && gaps < .4); /* one wall of those that the views show */
    CHECK_NEAR(size.ratio, 1, .004);
    room_free(mesh);
    room_free(truth);
}

TEST_MAIN({"a_lamp_of_another_size_is_measured", a_lamp_of_another_size_is_measured},
          {"light_from_gaps_is_counted", light_from_gaps_is_counted})
