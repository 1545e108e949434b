/* SPDX-License-Identifier: Apache-2.0
 *
 * Photographs that something is wrong with are found by name, and those alone; without harm to
 * what is right.
 */
#include "test.h"

#include "observe/faults.h"
#include "observe/edges.h"
#include "observe/glare.h"
#include "scene/camera.h"

#include <unistd.h>

static const char spec[] =
    "{ \"igi_synth\": 1, \"name\": \"x\",\n"
    "  \"materials\": { \"floor\": { \"albedo\": 0.4 }, \"wall\": { \"albedo\": 0.6 },\n"
    "    \"block\": { \"albedo\": 0.15 }, \"case\": { \"albedo\": 0.8 } },\n"
    "  \"shapes\": [ { \"type\": \"room\", \"size\": [4, 4, 3], \"floor\": \"floor\", \"ceiling\": "
    "\"wall\", \"walls\": \"wall\" },\n"
    "    { \"type\": \"box\", \"at\": [1.2, 1.3, 0], \"size\": [0.8, 0.8, 1.4], \"material\": "
    "\"block\" },\n"
    "    { \"type\": \"quad\", \"corner\": [0.4, 3.99, 0.8], \"u\": [1.1, 0, 0], \"v\": [0, 0, "
    "1.4], \"material\": \"block\" },\n"
    "    { \"type\": \"quad\", \"corner\": [2.1, 3.99, 0.8], \"u\": [1.1, 0, 0], \"v\": [0, 0, "
    "1.4], \"material\": \"block\" },\n"
    "    { \"type\": \"quad\", \"corner\": [0.01, 0.7, 0.8], \"u\": [0, 1.1, 0], \"v\": [0, 0, "
    "1.4], \"material\": \"block\" },\n"
    "    { \"type\": \"quad\", \"corner\": [3.99, 0.7, 0.8], \"u\": [0, 0, 1.4], \"v\": [0, 1.1, "
    "0], \"material\": \"block\" },\n"
    "    { \"type\": \"quad\", \"corner\": [3.99, 2.2, 0.8], \"u\": [0, 0, 1.4], \"v\": [0, 1.1, "
    "0], \"material\": \"block\" },\n"
    "    { \"type\": \"box\", \"at\": [2.8, 2.6, 0], \"size\": [0.7, 0.7, 1.1], \"turn_deg\": 20, "
    "\"material\": \"case\" } ],\n"
    "  \"lights\": [ { \"type\": \"point\", \"position\": [2, 2, 2.7], \"intensity\": [3, 3, 3] } "
    "],\n"
    "  \"views\": { \"width\": 160, \"height\": 120, \"count\": 12, \"samples\": 12, \"fov_deg\": "
    "75 "
    "} }\n";

static igi_context *ctx;
static igi_scene *scene;
static igi_tracer *tracer;
static char folder[] = "test_agreement_XXXXXX";

static void open_room(void)
{
    if (scene) return;
    ctx = test_context(2);
    if (!mkdtemp(folder)) abort();
    FILE *file = fopen("test_agreement.json", "w");
    if (!file || fputs(spec, file) < 0 || fclose(file) != 0) abort();
    CHECK_OK(ctx, igi_synth(ctx, "test_agreement.json", folder));
    CHECK_OK(ctx, igi_scene_load(ctx, folder, &scene));
    if (!scene) abort();
    CHECK_OK(ctx, igi_tracer_create(ctx, &scene->mesh, &tracer));
}

static igi_observations *observe(void)
{
    igi_observations *o = NULL;
    open_room();
    CHECK_OK(ctx, igi_observe(ctx, scene, tracer, 0, &o));
    if (!o) abort();
    return o;
}

/* Reconciles, and checks that exactly one warning was given, which contains both words. */
static void expect_one(igi_observations *o, const char *name, const char *word)
{
    bool waits;
    CHECK_OK(ctx, igi_observations_reconcile(ctx, scene, false, o, &waits));
    for (size_t i = 0; i < o->warning_count; i++) printf("    %s\n", o->warnings[i]);
    CHECK(o->warning_count == 1);
    if (o->warning_count == 0) return;
    CHECK_CONTAINS(o->warnings[0], name);
    CHECK_CONTAINS(o->warnings[0], word);
}

static size_t pixels_of(const igi_observations *o, size_t frame)
{
    return o->frame_begin[frame + 1] - o->frame_begin[frame];
}

static void nothing_is_wrong(void)
{
    igi_observations *o = observe();
    size_t count = o->count;
    double sum = 0, again = 0;
    for (size_t i = 0; i < 3 * count; i++) sum += (double)o->radiance[i];
    bool waits;
    CHECK_OK(ctx, igi_observations_reconcile(ctx, scene, false, o, &waits));
    for (size_t i = 0; i < 3 * o->count; i++) again += (double)o->radiance[i];
    for (size_t i = 0; i < o->warning_count; i++) printf("    %s\n", o->warnings[i]);
    CHECK(o->warning_count == 0 && o->count == count && sum == again);
    igi_observations_destroy(o);
}

static void an_exposure(void)
{
    igi_observations *o = observe();
    double before = 0, after = 0;
    for (size_t k = 3 * o->frame_begin[2]; k < 3 * o->frame_begin[3]; k++) {
        before += (double)o->radiance[k];
        o->radiance[k] *= 1.2f;
    }
    expect_one(o, "0002", "times as bright");
    for (size_t k = 3 * o->frame_begin[2]; k < 3 * o->frame_begin[3]; k++)
        after += (double)o->radiance[k];
    CHECK_NEAR(after / before, 1, .03);
    igi_observations_destroy(o);
}

/* All exposures wander by some 6 %: they are brought together. */
static void a_drift(void)
{
    static const float gains[12] = {1.06f, .93f,  1.08f, .95f,  1.f,  .91f,
                                    1.04f, 1.03f, .98f,  1.09f, .94f, 1.05f};
    igi_observations *o = observe();
    igi_agreement *a = NULL;
    igi_glimpses g = {0};
    for (size_t f = 0; f < 12; f++)
        for (size_t k = 3 * o->frame_begin[f]; k < 3 * o->frame_begin[f + 1]; k++)
            o->radiance[k] *= gains[f];
    expect_one(o, "drift by", "lock exposure");
    CHECK_OK(ctx, igi_glimpses_create(ctx, scene, o, &g));
    CHECK_OK(ctx, igi_agreement_create(ctx, scene, &g, &a));
    for (size_t f = 0; a && f < 12; f++) CHECK_NEAR(a->frames[f].gain, 1, .025);
    igi_agreement_destroy(a);
    igi_glimpses_clear(&g);
    igi_observations_destroy(o);
}

/* A hand before the lens: a part of the picture is dark. */
static void a_spoilt_piece(void)
{
    igi_observations *o = observe();
    size_t kept = pixels_of(o, 11), spoilt = pixels_of(o, 10);
    for (size_t i = o->frame_begin[10]; i < o->frame_begin[11]; i++)
        if (o->pixel[i] % 160 > 50 && o->pixel[i] % 160 < 110 && o->pixel[i] / 160 < 60)
            for (int b = 0; b < 3; b++) o->radiance[3 * i + (size_t)b] *= .1f;
    size_t count = o->count;
    uint32_t next = o->pixel[o->frame_begin[11]];
    expect_one(o, "0010", "left out");
    CHECK(pixels_of(o, 10) == 0 && pixels_of(o, 11) == kept && o->count == count - spoilt);
    CHECK(o->pixel[o->frame_begin[11]] == next);
    igi_observations_destroy(o);
}

/* Another photograph under this one's name. */
static void a_wrong_image(void)
{
    open_room();
    char *path = scene->frames[4].path;
    scene->frames[4].path = scene->frames[1].path;
    igi_observations *o = observe();
    scene->frames[4].path = path;
    expect_one(o, "0004", "left out");
    CHECK(pixels_of(o, 4) == 0);
    igi_observations_destroy(o);
}

static bool shows(const igi_observations *o, size_t i, const char *region)
{
    uint32_t r = scene->mesh.regions[igi_surface_triangle(o->surface[i])];
    return strcmp(scene->regions[r].name, region) == 0;
}

/* The sun mirrored in a wall that fills half a photograph: it is far brighter there than all others
 * are, and right. */
static void a_mirrored_sun(void)
{
    igi_observations *o = observe();
    size_t count = o->count, most = 0, frame = 0;
    for (size_t f = 0; f < o->frame_count; f++) {
        size_t n = 0;
        for (size_t i = o->frame_begin[f]; i < o->frame_begin[f + 1]; i++) n += shows(o, i, "wall");
        if (n > most) frame = f;
        if (n > most) most = n;
    }
    CHECK(2 * most > pixels_of(o, frame));
    for (size_t i = o->frame_begin[frame]; i < o->frame_begin[frame + 1]; i++)
        for (size_t b = 0; b < 3 && shows(o, i, "wall"); b++) o->radiance[3 * i + b] *= 5;
    bool waits;
    CHECK_OK(ctx, igi_observations_reconcile(ctx, scene, false, o, &waits));
    for (size_t i = 0; i < o->warning_count; i++) {
        printf("    %s\n", o->warnings[i]);
        CHECK(!strstr(o->warnings[i], scene->frames[frame].name));
    }
    CHECK(o->count == count);
    igi_observations_destroy(o);
}

/* Turns a camera so that what it sees moves by so many pixels to the right. */
static void turn(igi_camera *c, double pixels)
{
    double angle = -pixels / c->fl_x;
    for (int row = 0; row < 3; row++) {
        double x = c->camera_to_world[row][0], z = c->camera_to_world[row][2];
        c->camera_to_world[row][0] = cos(angle) * x + sin(angle) * z;
        c->camera_to_world[row][2] = cos(angle) * z - sin(angle) * x;
    }
}

/* What a camera turned by so many pixels is found to be off, when a photograph without noise shows
 * each region in a colour of its own. */
static igi_registration registration_of(size_t frame, double pixels)
{
    static const float colours[4] = {.4f, .6f, .15f, .8f};
    enum { SUB = 3 };
    igi_camera *camera = &scene->frames[frame].camera, right = *camera;
    igi_visible visible;
    igi_image *image = NULL;
    igi_registration r = {0};
    CHECK_OK(ctx, igi_image_create(ctx, camera->width, camera->height, 3, &image));
    if (!image) abort();
    for (int i = 0; i < camera->width * camera->height; i++)
        for (int k = 0; k < SUB * SUB; k++) {
            double x = i % camera->width + (k % SUB + .5) / SUB,
                   y = i / camera->width + (k / SUB + .5) / SUB;
            igi_hit hit = igi_trace(tracer, igi_camera_centre(camera),
                                    igi_camera_direction(camera, x, y));
            for (int b = 0; b < 3 && hit.triangle != IGI_NO_HIT; b++)
                image->samples[3 * i + b] += colours[scene->mesh.regions[hit.triangle] % 4] /
                                             (SUB * SUB);
        }
    turn(camera, pixels);
    CHECK_OK(ctx, igi_visible_create(ctx, scene, tracer, camera, &visible));
    CHECK_OK(ctx, igi_registration_measure(ctx, scene, tracer, camera, image, &visible, &r));
    *camera = right;
    igi_visible_clear(&visible);
    igi_image_destroy(image);
    return r;
}

static void a_camera(void)
{
    igi_observations *o = observe();
    igi_registration *r = o->registrations;
    for (size_t f = 0; f < 12; f++) r[f] = registration_of(f, f == 4 ? 2.5 : 0);
    for (size_t f = 0; f < 12; f++) {
        if (f != 4 && r[f].offset_error < .1) CHECK(hypot(r[f].offset[0], r[f].offset[1]) < .2);
    }
    /* 2.5 pixels in the picture's middle are 3.3 at its sides. */
    CHECK_NEAR(hypot(r[4].offset[0], r[4].offset[1]), 2.75, .25);
    expect_one(o, "0004", "pixels off the mesh's");
    CHECK(pixels_of(o, 4) > 0);
    igi_observations_destroy(o);
}

static void all_cameras(void)
{
    igi_observations *o = observe();
    for (size_t f = 0; f < 12; f++) o->registrations[f] = registration_of(f, f % 2 ? 1.5 : -1.5);
    expect_one(o, "the photographs' edges lie 1.", "register the cameras again");
    igi_observations_destroy(o);
}

static void estimate_veils(const igi_observations *o, igi_glare *common, igi_glare own[12])
{
    igi_glimpses g = {0};
    double bright[12] = {0};
    for (size_t k = 0; k < 12 * 3; k++) bright[k / 3] += o->mean[k];
    CHECK_OK(ctx, igi_glimpses_create(ctx, scene, o, &g));
    CHECK_OK(ctx, igi_glare_common(ctx, &g, scene->region_count, bright, 12, common));
    CHECK_OK(ctx, igi_glare_own(ctx, &g, scene->region_count, bright, 12, own));
    igi_glimpses_clear(&g);
}

/* Adds light to a picture, evenly: `share` of what it then is; its own, or from outside. */
static void strew(igi_observations *o, size_t frame, double share, bool own)
{
    double kept = own ? 1 - share : 1, grown = own ? 1 : 1 / (1 - share);
    for (size_t k = 3 * o->frame_begin[frame]; k < 3 * o->frame_begin[frame + 1]; k++)
        o->radiance[k] = (float)(kept * (double)o->radiance[k] +
                                 share * grown * o->mean[3 * frame + k % 3]);
    for (size_t b = 0; b < 3; b++) o->mean[3 * frame + b] *= grown;
}

static void no_veil(void)
{
    igi_observations *o = observe();
    igi_glare common, own[12];
    int known = 0;
    estimate_veils(o, &common, own);
    printf("    common %.4f +- %.4f\n", common.share, common.sigma);
    CHECK(fabs(common.share) < 3 * common.sigma && common.sigma < .004);
    for (int f = 0; f < 12; f++) {
        printf("    %.3f +- %.3f\n", own[f].share, own[f].sigma);
        CHECK(isinf(own[f].sigma) || fabs(own[f].share) < 3 * own[f].sigma);
        known += isfinite(own[f].sigma);
    }
    CHECK(known >= 8);
    igi_observations_destroy(o);
}

/* Light that shines into the lens of one camera adds some to all its pixels; it is taken off. */
static void a_veil(void)
{
    for (int own = 0; own < 2; own++) {
        igi_observations *o = observe();
        igi_glare common, glares[12];
        strew(o, 7, .15, own);
        estimate_veils(o, &common, glares);
        CHECK_NEAR(glares[7].share, .15, 3 * glares[7].sigma);
        expect_one(o, "image 0007: a veil of", "was taken off");
        CHECK_NEAR(o->veils[7].share, .15, 3 * glares[7].sigma);
        CHECK_NEAR(o->veils[7].kept, own ? 1 - o->veils[7].share : 1, 1e-12);
        estimate_veils(o, &common, glares);
        CHECK_NEAR(glares[7].share, 0, 2 * glares[7].sigma);
        igi_observations_destroy(o);
    }
}

/* A lens that is not clean: all photographs have the same share of their light strewn over them. */
static void a_common_veil(void)
{
    igi_observations *o = observe();
    igi_glare common, own[12];
    for (size_t f = 0; f < 12; f++) strew(o, f, .04, true);
    expect_one(o, "of the light strayed over the photographs", "taken off");
    for (size_t f = 0; f < 12; f++) CHECK_NEAR(o->veils[f].share, .04, .005);
    estimate_veils(o, &common, own);
    CHECK_NEAR(common.share, 0, 2 * common.sigma);
    igi_observations_destroy(o);
}

static void clean_up(void)
{
    char command[100];
    igi_tracer_destroy(tracer);
    igi_scene_destroy(scene);
    igi_context_destroy(ctx);
    snprintf(command, sizeof command, "rm -rf %s test_agreement.json", folder);
    if (scene && system(command) != 0) printf("left behind: %s\n", folder);
}

TEST_MAIN({"nothing_is_wrong", nothing_is_wrong}, {"an_exposure", an_exposure},
          {"a_drift", a_drift}, {"a_spoilt_piece", a_spoilt_piece},
          {"a_wrong_image", a_wrong_image}, {"a_mirrored_sun", a_mirrored_sun},
          {"a_camera", a_camera}, {"all_cameras", all_cameras}, {"no_veil", no_veil},
          {"a_veil", a_veil}, {"a_common_veil", a_common_veil}, {"", clean_up})
