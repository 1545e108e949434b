/* SPDX-License-Identifier: Apache-2.0
 *
 * The error bars of relit pictures: materials are drawn about the true ones with the standard
 * deviations that they state, and the pictures scatter as the error bars say, pixel by pixel and as
 * a whole.
 */
#include "test.h"

#include "base/rng.h"
#include "material/result.h"
#include "render/cache.h"
#include "render/doubt.h"

#include <unistd.h>

#define DRAWS 16

static const char spec[] =
    "{ \"igi_synth\": 1, \"name\": \"x\",\n"
    "  \"materials\": { \"wall\": { \"albedo\": 0.7 }, \"floor\": { \"albedo\": [0.5, 0.4, 0.3] "
    "},\n"
    "    \"box\": { \"albedo\": 0.3, \"model\": \"ward\", \"specular\": 0.1, \"alpha\": 0.2 },\n"
    "    \"lamp\": { \"emitter\": true } },\n"
    "  \"shapes\": [ { \"type\": \"room\", \"size\": [3, 3, 2.5], \"floor\": \"floor\", "
    "\"ceiling\": \"wall\", \"walls\": \"wall\",\n"
    "      \"panels\": [ { \"from\": [1, 1], \"to\": [2, 2], \"material\": \"lamp\" } ] },\n"
    "    { \"type\": \"box\", \"at\": [1.2, 1.9, 0], \"size\": [0.8, 0.7, 0.8], \"material\": "
    "\"box\" } ],\n"
    "  \"lights\": [ { \"type\": \"area\", \"region\": \"lamp\", \"radiance\": [6, 6, 6] } ],\n"
    "  \"views\": { \"width\": 24, \"height\": 18, \"count\": 2, \"samples\": 1, \"fov_deg\": 80 } "
    "}\n";

static igi_context *ctx;
static igi_scene *scene, *photographed;
static igi_materials *materials;
static char folder[] = "test_doubt_XXXXXX";

static void open_room(void)
{
    char truth[64];
    if (scene) return;
    ctx = test_context(2);
    if (!mkdtemp(folder)) abort();
    FILE *file = fopen("test_doubt.json", "w");
    if (!file || fputs(spec, file) < 0 || fclose(file) != 0) abort();
    CHECK_OK(ctx, igi_synth(ctx, "test_doubt.json", folder));
    CHECK_OK(ctx, igi_scene_load(ctx, folder, &photographed));
    snprintf(truth, sizeof truth, "%s/truth", folder);
    CHECK_OK(ctx, igi_result_load(ctx, truth, &scene, &materials));
    if (!scene || !photographed) abort();
}

/* Standard deviations such as recovery states. */
static void state_errors(double scale)
{
    for (size_t i = 0; i < materials->count; i++) {
        igi_material *m = &materials->materials[i];
        for (int b = 0; b < 3 && !m->emitter; b++)
            m->albedo_std[b] = scale * (0.01 + 0.01 * (double)i) * m->albedo[b];
        if (m->model == IGI_LAMBERT) continue;
        m->specular_std = scale * 0.1 * m->specular;
        m->alpha_std = scale * 0.1 * m->alpha;
    }
}

static double gauss(igi_rng *rng)
{
    double sum = -6;
    for (int k = 0; k < 12; k++) sum += (double)igi_rng_float(rng);
    return sum;
}

/* A picture by paths with radiosity at their second edge: with the same random numbers each time. */
static igi_image *picture_of(void)
{
    igi_renderer *renderer = NULL;
    igi_image *picture = NULL;
    igi_render_options options;
    igi_render_options_init(&options);
    options.samples = 4;
    CHECK_OK(ctx, igi_renderer_create(ctx, scene, materials, materials->lights,
                                      materials->light_count, &renderer));
    const igi_cache_options rough = {.rays = 8, .light_points = 4, .patch_share = 0.02f};
    CHECK_OK(ctx, igi_cache_create(ctx, renderer, &rough, &renderer->cache));
    renderer->cache_edge = 2;
    const igi_camera *camera = &photographed->frames[0].camera;
    CHECK_OK(ctx, igi_image_create(ctx, camera->width, camera->height, 3, &picture));
    igi_layers layers = {.pictures = &picture};
    CHECK_OK(ctx, igi_renderer_frames(ctx, renderer, camera, 1, &options, 5, &layers));
    igi_renderer_destroy(renderer);
    return picture;
}

static void doubt_of(const igi_image *picture, igi_image **sigma, igi_picture_doubt *summary)
{
    igi_renderer *renderer = NULL;
    igi_doubt *doubt = NULL;
    CHECK_OK(ctx, igi_renderer_create(ctx, scene, materials, materials->lights,
                                      materials->light_count, &renderer));
    CHECK_OK(ctx, igi_doubt_create(ctx, renderer, materials, NULL, &doubt));
    CHECK_OK(ctx, igi_doubt_picture(ctx, doubt, &photographed->frames[0].camera, 7, picture, sigma,
                                    summary));
    igi_doubt_destroy(doubt);
    igi_renderer_destroy(renderer);
    if (!*sigma) abort();
}

/* Every uncertain number drawn anew. */
static void draw_materials(const igi_material *nominal, igi_rng *rng)
{
    for (size_t i = 0; i < materials->count; i++) {
        igi_material *m = &materials->materials[i];
        double z = gauss(rng);
        for (int b = 0; b < 3; b++)
            m->albedo[b] = nominal[i].albedo[b] + z * nominal[i].albedo_std[b];
        m->specular = fmax(0, nominal[i].specular + gauss(rng) * nominal[i].specular_std);
        m->alpha = fmax(.01, nominal[i].alpha + gauss(rng) * nominal[i].alpha_std);
        for (int b = 0; b < 3; b++) m->specular_rgb[b] = m->specular;
    }
}

static void scatter(void)
{
    igi_material nominal[16];
    igi_image *picture, *sigma = NULL;
    igi_picture_doubt summary;
    igi_rng rng = igi_rng_make(11, 0);
    double squares = 0, whole = 0, mean = 0;
    size_t within = 0, all = 0;
    open_room();
    state_errors(1);
    picture = picture_of();
    doubt_of(picture, &sigma, &summary);
    CHECK(summary.pixel > .01 && summary.pixel < .1);
    CHECK(summary.picture > .3 * summary.pixel && summary.picture <= summary.pixel);
    size_t count = (size_t)picture->width * (size_t)picture->height * 3;
    for (size_t i = 0; i < count; i++) mean += (double)picture->samples[i];
    memcpy(nominal, materials->materials, materials->count * sizeof *nominal);
    for (int k = 0; k < DRAWS; k++) {
        draw_materials(nominal, &rng);
        igi_image *other = picture_of();
        double sum = 0;
        for (size_t i = 0; i < count; i++) {
            double change = (double)(other->samples[i] - picture->samples[i]);
            sum += change;
            if (!(sigma->samples[i] > 0)) continue;
            double z = change / (double)sigma->samples[i];
            squares += z * z;
            within += fabs(z) < 2;
            all++;
        }
        whole += (sum / mean / summary.picture) * (sum / mean / summary.picture) / DRAWS;
        igi_image_destroy(other);
    }
    memcpy(materials->materials, nominal, materials->count * sizeof *nominal);
    printf("    within 2 sigma %.3f, rms %.2f; the picture as a whole: rms %.2f\n",
           (double)within / (double)all, sqrt(squares / (double)all), sqrt(whole));
    CHECK(all > count / 2 * DRAWS);
    /* 16 draws of a handful of numbers: a standard deviation of them is known within a fifth */
    CHECK((double)within / (double)all > .88 && (double)within / (double)all < .995);
    CHECK(sqrt(squares / (double)all) > .7 && sqrt(squares / (double)all) < 1.35);
    CHECK(sqrt(whole) > .6 && sqrt(whole) < 1.5);
    igi_image_destroy(picture);
    igi_image_destroy(sigma);
}

static void certain(void)
{
    igi_image *picture, *sigma = NULL;
    igi_picture_doubt summary;
    open_room();
    state_errors(0);
    picture = picture_of();
    doubt_of(picture, &sigma, &summary);
    CHECK(summary.pixel < 1e-6 && summary.picture < 1e-6);
    for (int i = 0; i < sigma->width * sigma->height * 3; i++)
        CHECK(sigma->samples[i] <= 1e-5f * picture->samples[i]);
    igi_image_destroy(picture);
    igi_image_destroy(sigma);
}

static void clean_up(void)
{
    char command[100];
    if (!scene) return;
    igi_materials_destroy(materials);
    igi_scene_destroy(scene);
    igi_scene_destroy(photographed);
    igi_context_destroy(ctx);
    snprintf(command, sizeof command, "rm -rf %s test_doubt.json", folder);
    if (system(command) != 0) printf("left behind: %s\n", folder);
}

TEST_MAIN({"scatter", scatter}, {"certain", certain}, {"", clean_up})
