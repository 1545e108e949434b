/* SPDX-License-Identifier: Apache-2.0
 *
 * The whole way of error bars: a room with a texture and a lobe is recovered from its photographs, and
 * its picture under a lamp that was never there differs from the true one by as much as it says. What
 * is stated of a textured region's mean is about its mean, and what is stated of its texels is not.
 */
#include "test.h"

#include "render/doubt.h"

#include <igi/igi.h>

#include <unistd.h>

#define BLOCK 4

static const char spec[] =
    "{ \"igi_synth\": 1, \"name\": \"bars\", \"highlights\": false,\n"
    "  \"materials\": { \"wall\": { \"albedo\": [0.65, 0.6, 0.5] },\n"
    "    \"floor\": { \"texture\": { \"kind\": \"checker\", \"cells\": 6, \"size\": 48,\n"
    "      \"colours\": [[0.5, 0.4, 0.3], [0.3, 0.24, 0.2]] } },\n"
    "    \"box\": { \"albedo\": [0.2, 0.3, 0.4], \"model\": \"ward\", \"specular\": 0.1, "
    "\"alpha\": 0.15 },\n"
    "    \"east\": { \"albedo\": [0.6, 0.3, 0.25] }, \"lamp\": { \"emitter\": true } },\n"
    "  \"shapes\": [ { \"type\": \"room\", \"size\": [3, 3.4, 2.5], \"floor\": \"floor\", "
    "\"ceiling\": \"wall\",\n"
    "      \"walls\": [\"wall\", \"wall\", \"wall\", \"east\"],\n"
    "      \"panels\": [ { \"from\": [1, 1.2], \"to\": [2, 2.2], \"material\": \"lamp\" } ] },\n"
    "    { \"type\": \"box\", \"at\": [1.2, 1.9, 0], \"size\": [1, 0.8, 0.5], \"turn_deg\": 8, "
    "\"material\": \"box\" } ],\n"
    "  \"lights\": [ { \"type\": \"area\", \"region\": \"lamp\", \"radiance\": [6, 6, 6] } ],\n"
    "  \"views\": { \"width\": 64, \"height\": 48, \"count\": 10, \"samples\": 16, \"fov_deg\": 80 "
    "},\n"
    "  \"relit\": [ { \"lights\": [ { \"type\": \"point\", \"position\": [1.2, 0.9, 2], "
    "\"intensity\": [1, 1, 1] } ],\n"
    "    \"views\": { \"width\": 48, \"height\": 36, \"count\": 3, \"samples\": 1 } } ] }\n";

static igi_context *ctx;
static igi_scene *scene;
static igi_materials *truth;
static igi_recovery *found;
static char folder[] = "test_error_bars_XXXXXX";

static void open_room(void)
{
    char path[64];
    if (scene) return;
    ctx = test_context(2);
    if (!mkdtemp(folder)) abort();
    FILE *file = fopen("test_error_bars.json", "w");
    if (!file || fputs(spec, file) < 0 || fclose(file) != 0) abort();
    CHECK_OK(ctx, igi_synth(ctx, "test_error_bars.json", folder));
    CHECK_OK(ctx, igi_scene_load(ctx, folder, &scene));
    snprintf(path, sizeof path, "%s/truth", folder);
    CHECK_OK(ctx, igi_materials_load(ctx, path, &truth));
    if (!scene || !truth) abort();
    CHECK_OK(ctx, igi_recover(ctx, scene, NULL, &found));
    if (!found) abort();
}

/* The same paths for both: their noise is in the materials' difference alone. */
static igi_image *picture_of(const igi_materials *m, const igi_light *lights, size_t count,
                             const igi_camera *camera)
{
    igi_image *picture = NULL;
    igi_render_options options;
    igi_render_options_init(&options);
    options.samples = 32;
    CHECK_OK(ctx, igi_render(ctx, scene, m, lights, count, camera, &options, &picture, NULL));
    if (!picture) abort();
    return picture;
}

static double block_mean(const igi_image *image, int x, int y, int band)
{
    double sum = 0;
    for (int i = 0; i < BLOCK * BLOCK; i++) {
        size_t pixel = (size_t)(y + i / BLOCK) * (size_t)image->width + (size_t)(x + i % BLOCK);
        sum += (double)image->samples[pixel * 3 + (size_t)band];
    }
    return sum / (BLOCK * BLOCK);
}

static void count_blocks(const igi_image *got, const igi_image *want, const igi_image *sigma,
                         size_t *within, size_t *all)
{
    for (int y = 0; y + BLOCK <= got->height; y += BLOCK)
        for (int x = 0; x + BLOCK <= got->width; x += BLOCK)
            for (int b = 0; b < 3; b++) {
                double std = block_mean(sigma, x, y, b);
                double off = block_mean(got, x, y, b) - block_mean(want, x, y, b);
                if (!(std > 0)) continue;
                *within += fabs(off) < 2 * std;
                ++*all;
            }
}

static void relit(void)
{
    char path[96];
    igi_light *lights = NULL;
    igi_frame *frames = NULL;
    igi_renderer *renderer = NULL;
    igi_doubt *doubt = NULL;
    size_t light_count = 0, frame_count = 0, within = 0, all = 0;
    double stated = 0;
    open_room();
    snprintf(path, sizeof path, "%s/relit/lights.json", folder);
    CHECK_OK(ctx, igi_lights_load(ctx, scene, path, &lights, &light_count));
    snprintf(path, sizeof path, "%s/relit/transforms.json", folder);
    CHECK_OK(ctx, igi_frames_load(ctx, path, &frames, &frame_count));
    CHECK_OK(ctx,
             igi_renderer_create(ctx, scene, found->materials, lights, light_count, &renderer));
    CHECK_OK(ctx, igi_doubt_create(ctx, renderer, found->materials, NULL, &doubt));
    for (size_t f = 0; f < frame_count && doubt; f++) {
        const igi_camera *camera = &frames[f].camera;
        igi_image *got = picture_of(found->materials, lights, light_count, camera), *sigma = NULL;
        igi_image *want = picture_of(truth, lights, light_count, camera);
        igi_picture_doubt summary;
        CHECK_OK(ctx, igi_doubt_picture(ctx, doubt, camera, 7, got, &sigma, &summary));
        stated += summary.pixel / (double)frame_count;
        count_blocks(got, want, sigma, &within, &all);
        igi_image_destroy(got);
        igi_image_destroy(want);
        igi_image_destroy(sigma);
    }
    double share = (double)within / (double)all;
    printf("    within 2 sigma %.3f of %zu blocks; sigma %.4f of a pixel\n", share, all, stated);
    CHECK(all > 500);
    CHECK(share > .9 && share < .997);
    CHECK(stated < .05);
    igi_doubt_destroy(doubt);
    igi_renderer_destroy(renderer);
    igi_frames_destroy(frames, frame_count);
    igi_lights_destroy(lights, light_count);
}

static void texture(void)
{
    const igi_material *got = NULL, *want = NULL;
    open_room();
    for (size_t i = 0; i < truth->count; i++)
        if (strcmp(truth->materials[i].region, "floor") == 0) want = &truth->materials[i];
    for (size_t i = 0; i < found->materials->count; i++)
        if (strcmp(found->materials->materials[i].region, "floor") == 0)
            got = &found->materials->materials[i];
    CHECK(got && want && got->textured);
    if (!got || !want) return;
    double texel = 0, n = 0, spread = 0;
    for (int i = 0; i < got->map->width * got->map->height; i++) {
        const float *at = got->map->samples + 4 * i;
        if (!(at[3] > .5f)) continue;
        texel += (double)got->map_std->samples[3 * i];
        spread += pow((double)at[0] - got->albedo[0], 2);
        n++;
    }
    texel /= n;
    spread = sqrt(spread / n);
    printf("    mean %.4f +- %.4f (true %.4f), a texel +- %.4f, the pattern %.4f\n", got->albedo[0],
           got->albedo_std[0], want->albedo[0], texel, spread);
    for (int b = 0; b < 3; b++)
        CHECK(fabs(got->albedo[b] - want->albedo[b]) < 3 * got->albedo_std[b]);
    CHECK(got->albedo_std[0] < .02 * got->albedo[0]);
    CHECK(texel > got->albedo_std[0] && texel < spread);
}

static void clean_up(void)
{
    char command[100];
    if (!scene) return;
    igi_recovery_destroy(found);
    igi_materials_destroy(truth);
    igi_scene_destroy(scene);
    igi_context_destroy(ctx);
    snprintf(command, sizeof command, "rm -rf %s test_error_bars.json", folder);
    if (system(command) != 0) printf("left behind: %s\n", folder);
}

TEST_MAIN({"relit", relit}, {"texture", texture}, {"", clean_up})
