/* SPDX-License-Identifier: Apache-2.0
 *
 * The analytical cases of CIE 171:2006, "Test cases to assess the accuracy of lighting computer
 * programs", in the standard's kind of rooms, through the renderer: 0.5 % a point. The truth is
 * computed here from the laws that the standard's tables come from:
 *   5.2 point lights: E = I cos/d^2
 *   5.3 area lights: E = L times the polygon's form factor times pi (Lambert)
 *   5.4 flux: what a lamp emits arrives, all of it
 *   5.6 reflection of a lit square: E = rho E0 F
 *   5.7 the same beyond an obstruction: F of the part that is seen
 *   5.8 a closed room of uniform rho: mean E = Phi / (S (1 - rho))
 */
#include "room.h"

/* Illuminance of the lambert surface that a picture from `eye` toward `at` shows; its standard
 * deviation must be below `noise` of it. */
static double read_off(room *r, igi_vec eye, igi_vec at, double rho, int pixels, double focal,
                       int samples, double noise)
{
    igi_camera camera = room_camera(eye, at, pixels, focal);
    igi_render_options options;
    igi_image *image, *variance;
    igi_render_options_init(&options);
    options.samples = samples;
    options.max_depth = 1 << 20;
    CHECK_OK(r->ctx, igi_render(r->ctx, &r->scene, &r->materials, r->lights, r->scene.light_count,
                                &camera, &options, &image, &variance));
    double sum = 0, spread = 0, n = (double)pixels * pixels;
    for (int i = 0; i < pixels * pixels; i++) {
        sum += (double)image->samples[i] / n;
        spread += (double)variance->samples[i];
    }
    CHECK(sqrt(spread) / n < noise * sum);
    igi_image_destroy(image);
    igi_image_destroy(variance);
    return sum * IGI_PI / rho;
}

static double point_read_off(room *r, igi_vec at, int samples)
{
    return read_off(r, igi_v(2, 2, 1.5f), at, .5, 16, 1000, samples, .002);
}

/* 4 m x 4 m x 3 m of which one surface at a time reflects, so that all light on it is direct. */
static room *dark_room(int bright)
{
    room *r = room_new(2);
    uint32_t black = room_region(r, "black", 0), grey = room_region(r, "grey", .5);
    igi_vec x = {4, 0, 0}, y = {0, 4, 0}, z = {0, 0, 3}, o = {0, 0, 0};
    room_quad(r, bright == 0 ? grey : black, o, x, y);
    room_quad(r, black, z, y, x);
    room_quad(r, black, o, z, x);
    room_quad(r, black, y, x, z);
    room_quad(r, bright == 1 ? grey : black, o, y, z);
    room_quad(r, black, x, z, y);
    return r;
}

static const igi_vec floor_points[] = {
    {.25f, .25f, 0}, {.75f, 1.25f, 0}, {1.25f, 3.75f, 0}, {2.25f, 1.75f, 0}};
static const igi_vec wall_points[] = {
    {0, .25f, .25f}, {0, 1.25f, 1}, {0, 2.25f, 2}, {0, 3.75f, 2.75f}};

static void point_lights(void)
{
    igi_vec lamp = {2, 2, 2.9f}; /* 1,000 cd below the ceiling's centre */
    for (int surface = 0; surface < 2; surface++)
        for (int k = 0; k < 4; k++) {
            room *r = dark_room(surface);
            (void)room_light(r, (igi_light){.type = IGI_LIGHT_POINT,
                                            .position = {2, 2, (double)lamp.z},
                                            .value = {1000}});
            igi_vec at = surface ? wall_points[k] : floor_points[k], d = igi_sub(lamp, at);
            double l = (double)igi_length(d),
                   e = 1000 * (double)(surface ? d.x : d.z) / (l * l * l);
            CHECK_NEAR(point_read_off(r, at, 4) / e, 1, .005);
            room_free(r);
        }
}

/* Form factor from a point to a polygon in front of it (Lambert); corners in a ring. */
static double form_factor(igi_vec at, igi_vec normal, const igi_vec *corners, int count)
{
    double sum = 0;
    for (int i = 0; i < count; i++) {
        igi_vec a = igi_sub(corners[i], at), b = igi_sub(corners[(i + 1) % count], at);
        igi_vec c = igi_cross(a, b);
        double s = (double)igi_length(c);
        sum += atan2(s, (double)igi_dot(a, b)) * (double)igi_dot(normal, c) / s;
    }
    return fabs(sum) / (2 * IGI_PI);
}

static void area_lights(void)
{
    for (int surface = 0; surface < 2; surface++)
        for (int k = 0; k < 4; k++) {
            room *r = dark_room(surface);
            igi_vec corners[4] = {
                {1.5f, 1.5f, 2.99f}, {1.5f, 2.5f, 2.99f}, {2.5f, 2.5f, 2.99f}, {2.5f, 1.5f, 2.99f}};
            room_quad(r, room_lamp(r, "lamp", 100), corners[0], igi_v(0, 1, 0), igi_v(1, 0, 0));
            igi_vec at = surface ? wall_points[k] : floor_points[k];
            igi_vec normal = surface ? igi_v(1, 0, 0) : igi_v(0, 0, 1);
            double e = 100 * IGI_PI * form_factor(at, normal, corners, 4);
            CHECK_NEAR(point_read_off(r, at, 256) / e, 1, .005);
            room_free(r);
        }
}

/* A lamp of radiance 100 close under the ceiling: its flux pi L A reaches floor and walls. Each is
 * read off whole from the cube's centre, where a face fills the picture and every pixel covers the
 * same area of it. */
static void flux(void)
{
    const float sides[] = {.2f, .5f, 1};
    for (int k = 0; k < 3; k++) {
        room *r = room_new(2);
        uint32_t grey = room_region(r, "grey", 1e-3);
        uint32_t regions[6] = {grey, grey, grey, grey, grey, grey};
        room_box(r, regions, 4);
        float a = sides[k], o = 2 - a / 2;
        room_quad(r, room_lamp(r, "lamp", 100), igi_v(o, o, 3.999f), igi_v(0, a, 0),
                  igi_v(a, 0, 0));
        double emitted = IGI_PI * 100 * (double)(a * a);
        double got = 0;
        for (int face = 0; face < 5; face++) {
            igi_vec centre = {2, 2, 2}, at = centre;
            float *axis = face == 4 ? &at.z : face / 2 ? &at.y : &at.x;
            *axis = face == 4 ? 0 : face % 2 ? 4 : 0;
            got += 16 * read_off(r, centre, at, 1e-3, 32, .5, 64, .002);
        }
        CHECK_NEAR(got / emitted, 1, .005);
        room_free(r);
    }
}

/* A square of rho .8 and side a on the floor under sunlight straight from above; black besides. */
static room *sunlit(float a, uint32_t *grey)
{
    room *r = room_new(2);
    *grey = room_region(r, "grey", .5);
    uint32_t white = room_region(r, "white", .8);
    room_quad(r, white, igi_v(-a / 2, -a / 2, 0), igi_v(a, 0, 0), igi_v(0, a, 0));
    (void)room_light(
        r, (igi_light){.type = IGI_LIGHT_DIRECTIONAL, .direction = {0, 0, -1}, .value = {1000}});
    return r;
}

/* A vertical receiver, facing -x, at x; or a level one, facing down, above the sunlit square's
 * side, where the sun reaches only its back. */
static void add_receiver(room *r, uint32_t grey, igi_vec at, bool vertical)
{
    if (vertical)
        room_quad(r, grey, igi_sub(at, igi_v(0, .01f, .01f)), igi_v(0, 0, .02f), igi_v(0, .02f, 0));
    else
        room_quad(r, grey, igi_sub(at, igi_v(.01f, .01f, 0)), igi_v(0, .02f, 0), igi_v(.02f, 0, 0));
}

static double read_receiver(room *r, igi_vec at, bool vertical, int samples)
{
    igi_vec eye = igi_add(at, vertical ? igi_v(-.03f, .01f, .02f) : igi_v(.1f, .2f, -.5f));
    return read_off(r, eye, at, .5, 32, 10000, samples, .0025);
}

static void reflection(void)
{
    igi_vec places[] = {{.55f, 0, .2f}, {.6f, .2f, .1f}, {.6f, -.3f, .3f}, {.7f, 0, .5f}};
    igi_vec corners[4] = {{-.5f, -.5f, 0}, {.5f, -.5f, 0}, {.5f, .5f, 0}, {-.5f, .5f, 0}};
    for (int vertical = 0; vertical < 2; vertical++)
        for (int k = 0; k < 3 + !vertical; k++) {
            uint32_t grey;
            room *r = sunlit(1, &grey);
            add_receiver(r, grey, places[k], vertical);
            igi_vec normal = vertical ? igi_v(-1, 0, 0) : igi_v(0, 0, -1);
            double e = .8 * 1000 * form_factor(places[k], normal, corners, 4);
            CHECK_NEAR(read_receiver(r, places[k], vertical, 2048) / e, 1, .005);
            room_free(r);
        }
}

/* A black wall at x = .55 stands between the receiver, at x = .6 and z = .4, and the square: what
 * passes x = .55 at the height z comes from .05/(.6 - x) = 1 - z/.4. */
static void obstruction(void)
{
    static const struct {
        float bottom, height, from, to; /* of the wall; of the part of the square that is seen */
    } walls[] = {{0, .3f, -.5f, .4f}, {.36f, 1, .1f, .5f}};
    for (int k = 0; k < 2; k++) {
        igi_vec at = {.6f, .1f, .4f};
        uint32_t grey;
        room *r = sunlit(1, &grey);
        add_receiver(r, grey, at, true);
        room_quad(r, room_region(r, "black", 0), igi_v(.55f, -5, walls[k].bottom), igi_v(0, 10, 0),
                  igi_v(0, 0, walls[k].height));
        float from = walls[k].from, to = walls[k].to;
        igi_vec seen[4] = {{from, -.5f, 0}, {to, -.5f, 0}, {to, .5f, 0}, {from, .5f, 0}};
        double e = .8 * 1000 * form_factor(at, igi_v(-1, 0, 0), seen, 4);
        CHECK_NEAR(read_receiver(r, at, true, 2048) / e, 1, .005);
        room_free(r);
    }
}

/* 10,000 lm in the middle of a cube of 4 m, whose faces are all alike. */
static void interreflection(void)
{
    const double rhos[] = {1e-3, .1, .5, .8, .9, .95, .99};
    const int samples[] = {16, 64, 256, 1024, 1024, 1024, 1024};
    for (int k = 0; k < 7; k++) {
        room *r = room_new(2);
        uint32_t wall = room_region(r, "wall", rhos[k]);
        uint32_t regions[6] = {wall, wall, wall, wall, wall, wall};
        room_box(r, regions, 4);
        (void)room_light(r, (igi_light){.type = IGI_LIGHT_POINT,
                                        .position = {2, 2, 2},
                                        .value = {10000 / (4 * IGI_PI)}});
        double mean = read_off(r, igi_v(2, 2, 2), igi_v(2, 2, 0), rhos[k], 16, .5, samples[k],
                               .003);
        CHECK_NEAR(mean / (10000 / 96.0 / (1 - rhos[k])), 1, .005);
        room_free(r);
    }
}

TEST_MAIN({"5.2 point lights", point_lights}, {"5.3 area lights", area_lights}, {"5.4 flux", flux},
          {"5.6 reflection", reflection}, {"5.7 obstruction", obstruction},
          {"5.8 interreflection", interreflection})
