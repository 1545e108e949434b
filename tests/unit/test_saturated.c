/* SPDX-License-Identifier: Apache-2.0
 *
 * What igi merge marks as saturated, recovery does not believe.
 */
#include "test.h"

#include "observe/observations.h"
#include "observe/saturation.h"

#include <sys/stat.h>
#include <unistd.h>

static const char spec[] =
    "{ \"igi_synth\": 1, \"name\": \"x\", \"materials\": { \"all\": { \"albedo\": 0.5 } },\n"
    "  \"shapes\": [ { \"type\": \"room\", \"size\": [3, 3, 3], \"floor\": \"all\", \"ceiling\": "
    "\"all\", \"walls\": \"all\" } ],\n"
    "  \"lights\": [ { \"type\": \"point\", \"position\": [1.5, 1.5, 2], \"intensity\": [1, 1, 1] "
    "} ],\n"
    "  \"views\": { \"width\": 32, \"height\": 24, \"count\": 1, \"samples\": 4 } }\n";

/* Adds the channels of a merge; the left half is saturated and has nonsense for radiance, one
 * pixel on the right was never reached by the lens. */
static void spoil(igi_context *ctx, const char *path)
{
    igi_image *image = NULL, *spoilt = NULL;
    CHECK_OK(ctx, igi_image_load_exr(ctx, path, &image));
    if (!image) return;
    CHECK_OK(ctx, igi_image_create(ctx, 32, 24, 5, &spoilt));
    static const char *const names[5] = {"R", "G", "B", "saturated", "variance.R"};
    for (int c = 0; c < 5; c++) snprintf(spoilt->names[c], IGI_CHANNEL_NAME_SIZE, "%s", names[c]);
    for (int i = 0; i < 32 * 24; i++)
        for (int c = 0; c < 5; c++) {
            float value = c < 3 ? image->samples[3 * i + c] : c == 3 ? 0.f : .01f;
            if (i % 32 < 16) value = c < 3 ? 1e6f : 1.f;
            if (i == 12 * 32 + 24) value = NAN;
            spoilt->samples[5 * i + c] = value;
        }
    CHECK_OK(ctx, igi_image_save_exr(ctx, spoilt, IGI_EXR_FLOAT, path));
    igi_image_destroy(spoilt);
    igi_image_destroy(image);
}

static void saturated_pixels_are_left_out(void)
{
    igi_context *ctx = test_context(1);
    igi_scene *scene = NULL;
    igi_tracer *tracer = NULL;
    igi_observations *o = NULL;
    char folder[] = "test_saturated_XXXXXX";
    if (!mkdtemp(folder)) abort();
    FILE *file = fopen("test_saturated.json", "w");
    if (!file || fputs(spec, file) < 0 || fclose(file) != 0) abort();
    CHECK_OK(ctx, igi_synth(ctx, "test_saturated.json", folder));
    char path[100];
    snprintf(path, sizeof path, "%s/images/0000.exr", folder);
    spoil(ctx, path);
    CHECK_OK(ctx, igi_scene_load(ctx, folder, &scene));
    if (scene) {
        CHECK(scene->bands == 3); /* neither the mask nor the variance is a band */
        CHECK_OK(ctx, igi_tracer_create(ctx, &scene->mesh, &tracer));
        CHECK_OK(ctx, igi_observe(ctx, scene, tracer, 0, &o));
    }
    if (o) {
        int wrong = 0;
        for (size_t i = 0; i < o->count; i++)
            wrong += o->pixel[i] % 32 < 16 || !(o->radiance[3 * i] < 1e3f);
        CHECK(o->count > 100 && o->count < 16 * 24);
        CHECK(wrong == 0 && o->warning_count == 0);
    }
    igi_observations_destroy(o);
    igi_tracer_destroy(tracer);
    igi_scene_destroy(scene);
    igi_context_destroy(ctx);
    char command[100];
    snprintf(command, sizeof command, "rm -rf %s test_saturated.json", folder);
    if (system(command) != 0) printf("left behind: %s\n", folder);
}

/* A floor, and walls, of 64 pixels each: evenly lit without noise, `spots` of the floor cut off. */
static size_t left_out_of(size_t spots, size_t *warnings)
{
    enum { EACH = 64 };
    igi_context *ctx = test_context(1);
    igi_region regions[2] = {{.name = (char *)(uintptr_t) "floor"},
                             {.name = (char *)(uintptr_t) "wall"}};
    uint32_t of_triangle[2] = {0, 1}, surface[2 * EACH], pixel[2 * EACH];
    float uv[4 * EACH] = {0}, radiance[2 * EACH];
    size_t begin[2] = {0, 2 * EACH};
    igi_scene scene = {.bands = 1, .region_count = 2, .regions = regions};
    scene.mesh.regions = of_triangle;
    igi_observations o = {.bands = 1,
                          .count = 2 * EACH,
                          .frame_count = 1,
                          .frame_begin = begin,
                          .surface = surface,
                          .uv = uv,
                          .pixel = pixel,
                          .radiance = radiance};
    for (uint32_t i = 0; i < 2 * EACH; i++) {
        surface[i] = i % 2 << 1;
        pixel[i] = i;
        radiance[i] = i % 2 ? .3f : .5f;
        if (i % 2 == 0 && i / 2 < spots) radiance[i] = .9f;
    }
    CHECK_OK(ctx, igi_observations_unclip(ctx, &scene, &o));
    *warnings = o.warning_count;
    for (size_t i = 0; i < o.warning_count; i++) igi_free(o.warnings[i]);
    igi_free(o.warnings);
    igi_context_destroy(ctx);
    return 2 * EACH - o.count;
}

static void even_light_is_not_saturated(void)
{
    size_t warnings;
    CHECK(left_out_of(0, &warnings) == 0 && warnings == 0);
    CHECK(left_out_of(20, &warnings) == 20 && warnings == 1);
}

TEST_MAIN({"saturated_pixels_are_left_out", saturated_pixels_are_left_out},
          {"even_light_is_not_saturated", even_light_is_not_saturated})
