/* SPDX-License-Identifier: Apache-2.0
 *
 * Lamps of ten and of four pixels, read from pixels each of which shows its surroundings as well.
 */
#include "room.h"

#include "observe/small_lamps.h"
#include "scene/camera.h"

enum { PIXELS = 64, POINTS = 4096, NEAR = 7, VIEWS = 3 };
#define RADIANCE 10.0

/* A closed box of 3 m with a lamp of the given side below its ceiling, and before the first camera,
 * if wanted, a thread that runs across the lamp. */
static room *make_room(float side, bool thread, double profile)
{
    static const igi_vec eyes[VIEWS] = {{.5f, .7f, .4f}, {2.4f, .6f, .9f}, {1.9f, 2.3f, .3f}};
    static igi_frame frames[VIEWS];
    room *r = room_new(1);
    uint32_t wall = room_region(r, "wall", .5), lamp = room_lamp(r, "lamp", 0);
    const uint32_t walls[6] = {wall, wall, wall, wall, wall, wall};
    room_box(r, walls, 3);
    r->lights[0].known = false;
    r->lights[0].profile = profile;
    float low = 1.4f - side / 2;
    room_quad(r, lamp, igi_v(low, low, 2.95f), igi_v(0, side, 0), igi_v(side, 0, 0));
    if (thread) room_quad(r, wall, igi_v(1.3f, 1.39f, 2.9f), igi_v(.3f, 0, 0), igi_v(0, .02f, 0));
    for (int k = 0; k < VIEWS; k++)
        frames[k].camera = room_camera(eyes[k], igi_v(1.4f, 1.4f, 2.9f), PIXELS, .7);
    r->scene.frames = frames;
    r->scene.frame_count = VIEWS;
    return r;
}

/* The lamp shines, down; what is around it grows brighter from side to side. */
static float radiance(const room *r, igi_vec direction, const igi_hit *hit)
{
    if (hit->triangle == IGI_NO_HIT) return 0;
    float n = (float)r->lights[0].profile;
    if (r->regions_of[hit->triangle] == 1)
        return (float)RADIANCE * (n + 2) / 2 * powf(direction.z, n);
    return .4f + .1f * igi_triangle_point(&r->scene.mesh, hit->triangle, hit->u, hit->v).x;
}

/* Many rays a pixel where the lamp is, one elsewhere. */
static igi_image *photograph(room *r, const igi_tracer *tracer, const igi_camera *camera)
{
    igi_image *image = NULL;
    CHECK_OK(r->ctx, igi_image_create(r->ctx, PIXELS, PIXELS, 1, &image));
    if (!image) abort();
    for (int i = 0; i < PIXELS * PIXELS; i++) {
        int x = i % PIXELS, y = i / PIXELS;
        bool near = abs(x - PIXELS / 2) < NEAR && abs(y - PIXELS / 2) < NEAR;
        int rays = near ? POINTS : 1;
        double sum = 0;
        for (int k = 0; k < rays; k++) { /* points of the plastic number's recurrence */
            double u = fmod(.5 + k * .7548776662466927, 1), v = fmod(.5 + k * .5698402909980532, 1);
            igi_vec direction = igi_camera_direction(camera, x + u, y + v);
            igi_hit hit = igi_trace(tracer, igi_camera_centre(camera), direction);
            sum += (double)radiance(r, direction, &hit);
        }
        image->samples[i] = (float)(sum / rays);
    }
    return image;
}

/* As a lens that is a little out of focus has it: 1 2 1 across, then down. */
static void blur(igi_image *image)
{
    for (int axis = 0; axis < 2; axis++) {
        float old[PIXELS * PIXELS];
        int step = axis ? PIXELS : 1;
        memcpy(old, image->samples, sizeof old);
        for (int i = PIXELS + 1; i < PIXELS * (PIXELS - 1) - 1; i++)
            image->samples[i] = .5f * old[i] + .25f * (old[i - step] + old[i + step]);
    }
}

static igi_lamp_value read_lamp(float side, bool thread, bool blurred, double profile,
                                double *area_px)
{
    room *r = make_room(side, thread, profile);
    igi_tracer *tracer = NULL;
    igi_lamp_reading *readings = NULL;
    size_t count = 0;
    CHECK_OK(r->ctx, igi_tracer_create(r->ctx, &r->scene.mesh, &tracer));
    for (size_t k = 0; k < VIEWS && tracer; k++) {
        const igi_camera *camera = &r->scene.frames[k].camera;
        igi_visible visible;
        igi_image *image = photograph(r, tracer, camera);
        if (blurred) blur(image);
        CHECK_OK(r->ctx, igi_visible_create(r->ctx, &r->scene, tracer, camera, &visible));
        CHECK_OK(r->ctx, igi_lamps_measure(r->ctx, &r->scene, tracer, k, image, &visible, &readings,
                                           &count));
        igi_visible_clear(&visible);
        igi_image_destroy(image);
    }
    *area_px = 0;
    for (size_t i = 0; i < count; i++) *area_px += readings[i].area_px / (double)count;
    igi_lamp_value value = igi_lamps_sum(readings, count, 1, 1);
    igi_free(readings);
    igi_tracer_destroy(tracer);
    room_free(r);
    return value;
}

static void few_pixels(void)
{
    static const float sides[] = {.2f, .126f};
    static const double areas[] = {10, 4};
    for (int k = 0; k < 2; k++) {
        double area;
        igi_lamp_value lamp = read_lamp(sides[k], false, false, 0, &area);
        CHECK(lamp.photographs == VIEWS);
        CHECK_NEAR(area, areas[k], .15 * areas[k]);
        CHECK_NEAR(lamp.radiance[0], RADIANCE, .001 * RADIANCE);
        CHECK(lamp.error[0] < .003 * RADIANCE);
    }
}

/* All of its light is counted where the outline is not sharp; that is known less well. */
static void blurred_lamp(void)
{
    double area;
    igi_lamp_value lamp = read_lamp(.2f, false, true, 0, &area);
    CHECK_NEAR(lamp.radiance[0], RADIANCE, .02 * RADIANCE);
    CHECK_NEAR(lamp.radiance[0], RADIANCE, 3 * lamp.error[0]);
}

/* Each photograph has it at another angle, and all tell one value. */
static void with_a_profile(void)
{
    double area;
    igi_lamp_value lamp = read_lamp(.2f, false, false, 3, &area);
    CHECK(lamp.photographs == VIEWS);
    CHECK_NEAR(lamp.radiance[0], RADIANCE, 3 * lamp.error[0]);
    CHECK(lamp.error[0] < .005 * RADIANCE);
}

static void hidden_in_part(void)
{
    double area;
    CHECK(read_lamp(.2f, true, false, 0, &area).photographs == 0);
}

TEST_MAIN({"few_pixels", few_pixels}, {"blurred_lamp", blurred_lamp},
          {"with_a_profile", with_a_profile}, {"hidden_in_part", hidden_in_part})
