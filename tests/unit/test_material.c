/* SPDX-License-Identifier: Apache-2.0
 *
 * materials.json: what is written is what is read; names fit for files; truth.json; bad input.
 */
#include "test.h"

#include "material/material.h"
#include "material/result.h"

#include <sys/stat.h>

#define FOLDER "material_test"

static void write_text(const char *path, const char *text)
{
    FILE *file = fopen(path, "w");
    if (!file) abort();
    fputs(text, file);
    fclose(file);
}

static size_t read_bytes(const char *path, char *bytes, size_t size)
{
    FILE *file = fopen(path, "rb");
    if (!file) return 0;
    size_t n = fread(bytes, 1, size, file);
    fclose(file);
    return n;
}

static char *copy_of(igi_context *ctx, const char *text)
{
    char *copy = NULL;
    CHECK_OK(ctx, igi_strdup(ctx, text, &copy));
    return copy;
}

/* Two regions, the second glossy, named against the rules of file systems, and with a map. */
static igi_materials *sample(igi_context *ctx)
{
    igi_materials *m = igi_calloc(ctx, 1, sizeof *m);
    m->scene = copy_of(ctx, "test");
    m->bands = 3;
    m->count = 2;
    m->materials = igi_calloc(ctx, 2, sizeof *m->materials);
    m->materials[0] = (igi_material){.region = copy_of(ctx, "floor"),
                                     .determined = true,
                                     .albedo = {.1, .2, 1. / 3},
                                     .albedo_std = {1e-3, 2e-3, HUGE_VAL},
                                     .observed = .5,
                                     .views = 3};
    m->materials[1] = (igi_material){.region = copy_of(ctx, "../wall/%é"),
                                     .model = IGI_GGX,
                                     .determined = true,
                                     .albedo = {.7, .6, .5},
                                     .specular = .04,
                                     .specular_std = .001,
                                     .alpha = .2,
                                     .alpha_std = .01,
                                     .observed = 1,
                                     .views = 7,
                                     .textured = true};
    m->materials[1].warnings = igi_calloc(ctx, 1, sizeof(char *));
    m->materials[1].warnings[0] = copy_of(ctx, "a \"warning\" [1,\n 2]\\");
    m->materials[1].warning_count = 1;
    CHECK_OK(ctx, igi_image_create(ctx, 2, 2, 4, &m->materials[1].map));
    CHECK_OK(ctx, igi_image_create(ctx, 2, 2, 3, &m->materials[1].map_std));
    for (int i = 0; i < 16; i++) m->materials[1].map->samples[i] = (float)i / 16;
    for (int i = 0; i < 12; i++) m->materials[1].map_std->samples[i] = (float)i / 64;
    m->light_count = 1;
    m->lights = igi_calloc(ctx, 1, sizeof *m->lights);
    m->light_std = igi_calloc(ctx, 1, sizeof *m->light_std);
    m->lights[0] = (igi_light){.type = IGI_LIGHT_SPOT,
                               .region = -1,
                               .position = {1, 2, 3},
                               .direction = {0, 0, -1},
                               .cutoff_deg = 40,
                               .beam_deg = 30,
                               .value = {5, 6, 7}};
    m->light_std[0][1] = .25;
    return m;
}

static void written_is_read(void)
{
    igi_context *ctx = test_context(1);
    igi_materials *m = sample(ctx), *got = NULL;
    mkdir(FOLDER, 0777);
    CHECK_OK(ctx, igi_materials_save(ctx, m, NULL, FOLDER));
    CHECK_OK(ctx, igi_materials_load(ctx, FOLDER, &got));
    if (got) {
        CHECK_STR(got->scene, "test");
        CHECK(got->count == 2 && got->bands == 3 && got->light_count == 1);
        CHECK_NEAR(got->materials[0].albedo[2], 1. / 3, 1e-9);
        CHECK(isinf(got->materials[0].albedo_std[2]));
        CHECK(got->materials[0].views == 3 && !got->materials[0].textured);
        const igi_material *wall = &got->materials[1];
        CHECK_STR(wall->region, "../wall/%é");
        CHECK(wall->model == IGI_GGX && wall->warning_count == 1 && wall->map && wall->map_std);
        CHECK_STR(wall->warnings[0], "a \"warning\" [1,\n 2]\\");
        CHECK_NEAR(wall->alpha, .2, 1e-9);
        for (int i = 0; wall->map && i < 16; i++)
            CHECK_NEAR((double)wall->map->samples[i], i / 16., 1e-3);
        for (int i = 0; wall->map_std && i < 12; i++)
            CHECK_NEAR((double)wall->map_std->samples[i], i / 64., 1e-3);
        CHECK(got->lights[0].type == IGI_LIGHT_SPOT);
        CHECK_NEAR(got->lights[0].value[2], 7, 0);
        CHECK_NEAR(got->light_std[0][1], .25, 0);
    }
    igi_materials_destroy(got);
    igi_materials_destroy(m);
    igi_context_destroy(ctx);
}

static void same_content_same_bytes(void)
{
    igi_context *ctx = test_context(1);
    igi_materials *m = sample(ctx), *got = NULL;
    static char first[8192], second[8192];
    mkdir(FOLDER, 0777);
    CHECK_OK(ctx, igi_materials_save(ctx, m, NULL, FOLDER));
    size_t n = read_bytes(FOLDER "/materials.json", first, sizeof first);
    CHECK_OK(ctx, igi_materials_load(ctx, FOLDER, &got));
    if (got) CHECK_OK(ctx, igi_materials_save(ctx, got, NULL, FOLDER));
    CHECK(n > 100 && n < sizeof first);
    CHECK(read_bytes(FOLDER "/materials.json", second, sizeof second) == n);
    CHECK(memcmp(first, second, n) == 0);
    CHECK_CONTAINS(first, "\"albedo\": [0.7, 0.6, 0.5],\n");
    CHECK_CONTAINS(first, "\"warnings\": []");
    igi_materials_destroy(got);
    igi_materials_destroy(m);
    igi_context_destroy(ctx);
}

/* What is given is known: its standard deviation goes, and so does a map that an albedo replaces. */
static void edited(void)
{
    igi_context *ctx = test_context(1);
    igi_materials *m = sample(ctx);
    write_text(FOLDER "_edits.json", "{\"regions\": {\"floor\": {\"albedo\": [0.5, 0.6, 0.7]},"
                                     " \"../wall/%é\": {\"albedo_hsv\": [0, 0, 1], "
                                     "\"alpha\": 0.3}}}");
    CHECK_OK(ctx, igi_materials_edit(ctx, m, FOLDER "_edits.json"));
    const igi_material *floor = &m->materials[0], *wall = &m->materials[1];
    for (int b = 0; b < 3; b++) {
        CHECK_NEAR(floor->albedo[b], .5 + .1 * b, 1e-12);
        CHECK_NEAR(wall->albedo[b], 1, 1e-12);
        CHECK(floor->albedo_std[b] == 0 && wall->albedo_std[b] == 0);
    }
    CHECK(!wall->map && !wall->map_std && !wall->textured);
    CHECK_NEAR(wall->alpha, .3, 1e-12);
    CHECK(wall->alpha_std == 0 && wall->specular_std > 0);
    write_text(FOLDER "_edits.json", "{\"regions\": {\"flor\": {\"albedo\": [0, 0, 0]}}}");
    CHECK(igi_materials_edit(ctx, m, FOLDER "_edits.json") == IGI_E_DATA);
    igi_materials_destroy(m);
    igi_context_destroy(ctx);
}

static void file_name_is(igi_context *ctx, const char *region, const char *want)
{
    char *name = NULL;
    CHECK_OK(ctx, igi_region_file_name(ctx, region, &name));
    if (name) CHECK_STR(name, want);
    igi_free(name);
}

static void names_fit_for_files(void)
{
    igi_context *ctx = test_context(1);
    file_name_is(ctx, "back_wall", "back_wall");
    file_name_is(ctx, "a/b", "a%2Fb");
    file_name_is(ctx, "a%2Fb", "a%252Fb");
    file_name_is(ctx, "..", "%2E.");
    file_name_is(ctx, "tab\there", "tab%09here");
    file_name_is(ctx,
                 "d\xc3\xa9"
                 "cor",
                 "d\xc3\xa9"
                 "cor");
    char *a = NULL, *b = NULL, region[501] = {0};
    memset(region, '/', 500);
    CHECK_OK(ctx, igi_region_file_name(ctx, region, &a));
    region[499] = 'x';
    CHECK_OK(ctx, igi_region_file_name(ctx, region, &b));
    CHECK(a && b && strcmp(a, b) != 0);
    igi_free(a);
    igi_free(b);
    igi_context_destroy(ctx);
}

static void fails_with(igi_context *ctx, const char *json, const char *sentence)
{
    igi_materials *got = (igi_materials *)ctx; /* must become NULL */
    mkdir(FOLDER "_bad", 0777);
    write_text(FOLDER "_bad/truth.json", json);
    CHECK(igi_materials_load(ctx, FOLDER "_bad", &got) == IGI_E_DATA);
    CHECK(!got);
    CHECK_CONTAINS(igi_context_message(ctx), sentence);
}

static void bad_input_says_what(void)
{
    igi_context *ctx = test_context(1);
    fails_with(ctx, "{\n\n\"regions\": {,} }", "truth.json:3:");
    fails_with(ctx, "[]", "\"regions\" must be");
    fails_with(ctx, "{\"regions\": {\"a\": {}}}", "'a': \"albedo\" must be");
    fails_with(ctx, "{\"regions\": {\"a\": 3}}", "\"albedo\" must be");
    fails_with(ctx, "{\"regions\": {\"a\": {\"albedo\": [1,2,3]}, \"b\": {\"albedo\": [1]}}}",
               "'b': \"albedo\" must be an array of 3 numbers");
    fails_with(ctx, "{\"regions\": {\"a\": {\"albedo\": [1], \"model\": \"silk\"}}}",
               "\"model\" must be lambert, ward, ggx or phong");
    fails_with(ctx, "{\"regions\": {\"a\": {\"albedo\": [1], \"model\": \"ward\"}}}",
               "\"alpha\" must be above 0");
    fails_with(ctx, "{\"regions\": {\"a\": {\"albedo\": [1], \"texture\": \"none.exr\"}}}",
               "none.exr");
    igi_materials *got = NULL;
    CHECK(igi_materials_load(ctx, "/nonexistent", &got) == IGI_E_DATA);
    CHECK_CONTAINS(igi_context_message(ctx), "has neither materials.json nor truth.json");
    igi_context_destroy(ctx);
}

static void truth_of_a_scene(void)
{
    char path[512];
    if (!test_shared_data("scenes/cubical-room/truth", path, sizeof path)) return;
    igi_context *ctx = test_context(1);
    igi_materials *got = NULL;
    CHECK_OK(ctx, igi_materials_load(ctx, path, &got));
    if (got) {
        CHECK(got->count == 10 && got->bands == 3);
        CHECK_STR(got->materials[0].region, "floor");
        CHECK(got->materials[0].map && got->materials[0].map->channels == 4);
        CHECK_NEAR((double)got->materials[0].map->samples[3], 1, 0);
        CHECK_NEAR(got->materials[0].alpha, .12, 1e-12);
        CHECK(got->materials[9].emitter && got->lights[0].region == 9);
    }
    igi_materials_destroy(got);
    igi_context_destroy(ctx);
}

static void memory_runs_out(void)
{
    igi_context *ctx = test_context(1);
    igi_materials *m = sample(ctx);
    mkdir(FOLDER, 0777);
    CHECK_OK(ctx, igi_materials_save(ctx, m, NULL, FOLDER));
    igi_status status = IGI_E_SYSTEM;
    for (long n = 0; n < 1000 && status != IGI_OK; n++) {
        igi_materials *got = NULL;
        igi_fail_allocation_after(ctx, n);
        status = igi_materials_load(ctx, FOLDER, &got);
        CHECK((status == IGI_OK) == (got != NULL));
        CHECK(status == IGI_OK || status == IGI_E_SYSTEM);
        igi_materials_destroy(got);
    }
    CHECK(status == IGI_OK);
    igi_fail_allocation_after(ctx, -1);
    igi_materials_destroy(m);
    igi_context_destroy(ctx);
}

TEST_MAIN({"written_is_read", written_is_read},
          {"same_content_same_bytes", same_content_same_bytes}, {"edited", edited},
          {"names_fit_for_files", names_fit_for_files},
          {"bad_input_says_what", bad_input_says_what}, {"truth_of_a_scene", truth_of_a_scene},
          {"memory_runs_out", memory_runs_out})
