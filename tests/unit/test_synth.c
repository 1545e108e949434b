/* SPDX-License-Identifier: Apache-2.0
 *
 * igi_synth: what it writes can be read and agrees with itself; the same spec gives the same bytes;
 * mistakes in a spec are named.
 */
#include "test.h"

#include <sys/stat.h>
#include <unistd.h>

static const char *const SPEC = "test_synth_spec.json";

static const char room[] =
    "{ \"igi_synth\": 1, \"name\": \"tiny\",\n"
    "  \"materials\": {\n"
    "    \"floor\": { \"texture\": { \"kind\": \"noise\", \"colours\": [[0.6, 0.5, 0.4], [0.2, "
    "0.2, 0.3]], \"cells\": 3, \"size\": 32 } },\n"
    "    \"wall\": { \"albedo\": [0.5, 0.6, 0.7] },\n"
    "    \"block\": { \"albedo\": 0.3, \"model\": \"ggx\", \"specular\": 0.05, \"alpha\": 0.25 },\n"
    "    \"lamp\": { \"emitter\": true } },\n"
    "  \"shapes\": [\n"
    "    { \"type\": \"room\", \"size\": [3, 4, 2.5], \"floor\": \"floor\", \"ceiling\": \"wall\", "
    "\"walls\": \"wall\", \"tile\": [2, 2],\n"
    "      \"panels\": [ { \"from\": [1, 1], \"to\": [2, 2], \"material\": \"lamp\" } ] },\n"
    "    { \"type\": \"sphere\", \"centre\": [1, 2, 0.5], \"radius\": 0.4, \"around\": 12, "
    "\"rings\": 6, \"material\": \"block\" },\n"
    "    { \"type\": \"box\", \"at\": [2.2, 3, 0], \"size\": [0.5, 0.6, 0.7], \"turn_deg\": 20, "
    "\"material\": \"block\" },\n"
    "    { \"type\": \"quad\", \"corner\": [0.01, 1, 1], \"u\": [0, 1, 0], \"v\": [0, 0, 1], "
    "\"material\": \"block\" } ],\n"
    "  \"lights\": [ { \"type\": \"area\", \"region\": \"lamp\", \"radiance\": [3, 2, 1] } ],\n"
    "  \"views\": { \"width\": 24, \"height\": 18, \"count\": 6, \"samples\": 4, \"unseen\": { "
    "\"low\": [2.5, 3.5, 0], \"high\": [3, 4, 2.5] } },\n"
    "  \"heldout\": { \"count\": 1 },\n"
    "  \"relit\": [ { \"lights\": [ { \"type\": \"point\", \"position\": [1.5, 2, 2], "
    "\"intensity\": [1, 1, 1] } ], \"views\": { \"ring\": { \"centre\": [1.5, 2, 1], \"radius\": "
    "1.2, \"height\": 0.2 }, \"count\": 2 } },\n"
    "             { \"lights\": [], \"views\": { \"look\": [ { \"eye\": [0.5, 0.5, 1], \"target\": "
    "[1.5, 1.5, 2.5] } ] } } ] }\n";

static void write_spec(const char *text)
{
    FILE *file = fopen(SPEC, "w");
    if (!file || fputs(text, file) < 0 || fclose(file) != 0) abort();
}

/* The spec with one piece of it replaced. */
static void write_changed(const char *from, const char *to)
{
    static char text[sizeof room + 256];
    const char *at = strstr(room, from);
    if (!at) abort();
    snprintf(text, sizeof text, "%.*s%s%s", (int)(at - room), room, to, at + strlen(from));
    write_spec(text);
}

static const igi_material *find(const igi_materials *materials, const char *name)
{
    for (size_t i = 0; i < materials->count; i++)
        if (strcmp(materials->materials[i].region, name) == 0) return &materials->materials[i];
    abort();
}

static void whole_folder(void)
{
    igi_context *ctx = test_context(2);
    igi_scene *scene = NULL;
    igi_materials *truth = NULL;
    igi_frame *frames = NULL;
    igi_light *lights = NULL;
    igi_image *image = NULL;
    size_t count = 0;
    write_spec(room);
    CHECK_OK(ctx, igi_synth(ctx, SPEC, "test_synth_a"));
    CHECK_OK(ctx, igi_scene_load(ctx, "test_synth_a", &scene));
    CHECK_OK(ctx, igi_materials_load(ctx, "test_synth_a/truth", &truth));
    if (!scene || !truth) abort();
    CHECK_STR(scene->name, "tiny");
    CHECK(scene->frame_count == 6 && scene->bands == 3 && scene->light_count == 1);
    CHECK(scene->warning_count == 0);
    CHECK(scene->region_count == 4 && truth->count == 4);
    const igi_material *floor = find(truth, "floor"), *block = find(truth, "block");
    CHECK(floor->map && floor->map->width == 32 && scene->regions[0].uvs_wrap);
    CHECK(floor->albedo[0] > .25 && floor->albedo[0] < .55);
    CHECK(block->model == IGI_GGX);
    CHECK_NEAR(block->alpha, .25, 1e-9);
    CHECK_NEAR(block->specular, .05, 1e-9);
    CHECK(find(truth, "lamp")->emitter);
    CHECK(floor->observed > .5 && floor->observed < 1);
    CHECK_OK(ctx, igi_frames_load(ctx, "test_synth_a/heldout/transforms.json", &frames, &count));
    CHECK(count == 1 && access(frames[0].path, R_OK) == 0);
    igi_frames_destroy(frames, count);
    CHECK_OK(ctx, igi_lights_load(ctx, scene, "test_synth_a/relit/lights.json", &lights, &count));
    CHECK(count == 1 && lights[0].type == IGI_LIGHT_POINT);
    igi_lights_destroy(lights, count);
    /* No light is on in the second: black, the lamp too, at which it looks. */
    CHECK_OK(ctx, igi_image_load_exr(ctx, "test_synth_a/relit2/images/0000.exr", &image));
    float brightest = 0;
    for (int i = 0; image && i < 24 * 18 * 3; i++) brightest = fmaxf(brightest, image->samples[i]);
    CHECK(brightest == 0);
    igi_image_destroy(image);
    CHECK_OK(ctx, igi_image_load_exr(ctx, scene->frames[0].path, &image));
    for (int i = 0; image && i < 24 * 18 * 3; i++) brightest = fmaxf(brightest, image->samples[i]);
    CHECK(brightest > .1f && brightest <= 3.01f);
    igi_image_destroy(image);
    igi_materials_destroy(truth);
    igi_scene_destroy(scene);
    igi_context_destroy(ctx);
}

static double mean_of(igi_context *ctx, const char *path)
{
    igi_image *image = NULL;
    double sum = 0;
    CHECK_OK(ctx, igi_image_load_exr(ctx, path, &image));
    if (!image) return -1;
    size_t count = (size_t)image->width * (size_t)image->height * (size_t)image->channels;
    for (size_t i = 0; i < count; i++) sum += (double)image->samples[i] / (double)count;
    igi_image_destroy(image);
    return sum;
}

/* The truth, and the same as a recovery's folder with scene.glb, give the photographs again. */
static void relight(void)
{
    igi_context *ctx = test_context(2);
    igi_scene *scene = NULL;
    igi_materials *truth = NULL;
    igi_relight_options options;
    igi_relight_options_init(&options);
    options.render.samples = 256;
    options.variance = true;
    write_spec(room);
    CHECK_OK(ctx, igi_synth(ctx, SPEC, "test_synth_a"));
    CHECK_OK(ctx, igi_scene_load(ctx, "test_synth_a", &scene));
    CHECK_OK(ctx, igi_materials_load(ctx, "test_synth_a/truth", &truth));
    if (!scene || !truth) abort();
    (void)mkdir("test_synth_result", 0777);
    (void)mkdir("test_synth_relit", 0777);
    for (size_t i = 0; i < scene->region_count;
         i++) /* as a recovery has them: in the scene's order */
        CHECK_STR(truth->materials[i].region, scene->regions[i].name);
    CHECK_OK(ctx, igi_materials_save(ctx, truth, scene, "test_synth_result"));
    CHECK_OK(ctx, igi_materials_save_glb(ctx, truth, scene, "test_synth_result/scene.glb"));
    static const char *const from[] = {"test_synth_a/truth", "test_synth_result"};
    for (int i = 0; i < 2; i++) {
        CHECK_OK(ctx, igi_relight(ctx, from[i], "test_synth_a/transforms.json", &options,
                                  "test_synth_relit"));
        double want = mean_of(ctx, scene->frames[2].path);
        CHECK_NEAR(mean_of(ctx, "test_synth_relit/0002.exr") / want, 1, .05);
        CHECK(mean_of(ctx, "test_synth_relit/0002.variance.exr") < .01 * want * want);
    }
    options.lights = "test_synth_a/relit/lights.json";
    CHECK_OK(ctx, igi_relight(ctx, from[0], "test_synth_a/relit/transforms.json", &options,
                              "test_synth_relit"));
    double want = mean_of(ctx, "test_synth_a/relit/images/0001.exr");
    CHECK_NEAR(mean_of(ctx, "test_synth_relit/0001.exr") / want, 1, .05);
    CHECK(igi_relight(ctx, "test_synth_relit", "test_synth_a/transforms.json", &options,
                      "test_synth_relit") == IGI_E_DATA);
    CHECK_CONTAINS(igi_context_message(ctx), "neither materials.json nor truth.json");
    igi_materials_destroy(truth);
    igi_scene_destroy(scene);
    igi_context_destroy(ctx);
}

static bool same_file(const char *name)
{
    char a[256], b[256];
    snprintf(a, sizeof a, "test_synth_a/%s", name);
    snprintf(b, sizeof b, "test_synth_b/%s", name);
    FILE *x = fopen(a, "rb"), *y = fopen(b, "rb");
    bool same = x && y;
    for (int c = 0; same && c != EOF;) {
        c = fgetc(x);
        same = c == fgetc(y);
    }
    if (x) fclose(x);
    if (y) fclose(y);
    return same;
}

static void same_bytes(void)
{
    static const char *const files[] = {"scene.json",
                                        "scene.obj",
                                        "transforms.json",
                                        "images/0000.exr",
                                        "images/0005.exr",
                                        "truth/truth.json",
                                        "truth/albedo/floor.exr",
                                        "heldout/images/0000.exr",
                                        "heldout/transforms.json",
                                        "relit/lights.json",
                                        "relit/images/0001.exr"};
    igi_context *one = test_context(1), *seven = test_context(7);
    write_spec(room);
    CHECK_OK(one, igi_synth(one, SPEC, "test_synth_a"));
    CHECK_OK(seven, igi_synth(seven, SPEC, "test_synth_b"));
    for (size_t i = 0; i < sizeof files / sizeof files[0]; i++) CHECK(same_file(files[i]));
    igi_context_destroy(one);
    igi_context_destroy(seven);
}

static void mistakes(void)
{
    static const struct {
        const char *from, *to, *sentence;
    } all[] = {
        {"\"albedo\": 0.3", "\"albedo\": 1.3", "materials.block.albedo"},
        {"\"albedo\": 0.3", "\"albedoo\": 0.3", "albedoo"},
        {"\"model\": \"ggx\"", "\"model\": \"shiny\"", "no model is \"shiny\""},
        {"\"alpha\": 0.25", "\"alpha\": 0", "alpha"},
        {", \"alpha\": 0.25", "", "needs \"alpha\""},
        {"\"kind\": \"noise\"", "\"kind\": \"marble\"", "no texture is \"marble\""},
        {"\"walls\": \"wall\"", "\"walls\": \"brick\"", "no material is named \"brick\""},
        {"\"walls\": \"wall\"", "\"walls\": [\"wall\"]", "south, north, west, east"},
        {"\"tile\": [2, 2]", "\"tile\": [2, 2.5]", "whole numbers"},
        {"\"type\": \"sphere\"", "\"type\": \"torus\"", "no shape is \"torus\""},
        {"\"radius\": 0.4, ", "", "needs \"radius\""},
        {"\"region\": \"lamp\"", "\"region\": \"lamb\"", "did you mean \"lamp\"?"},
        {"\"count\": 6", "\"count\": 1.5", "whole number"},
        {"\"samples\": 4", "\"samples\": 4, \"clearance\": 3", "no place for a camera"},
        {"\"igi_synth\": 1", "\"igi_synth\": 2", "reads version 1"},
        {"\"name\": \"tiny\",", "\"name\": \"tiny\"", "no valid JSON"},
    };
    igi_context *ctx = test_context(1);
    for (size_t i = 0; i < sizeof all / sizeof all[0]; i++) {
        write_changed(all[i].from, all[i].to);
        CHECK(igi_synth(ctx, SPEC, "test_synth_c") == IGI_E_DATA);
        CHECK_CONTAINS(igi_context_message(ctx), all[i].sentence);
    }
    CHECK(igi_synth(ctx, "no-such-spec.json", "test_synth_c") == IGI_E_DATA);
    write_spec(room);
    CHECK(igi_synth(ctx, SPEC, "/proc/nowhere") == IGI_E_SYSTEM);
    igi_context_destroy(ctx);
}

/* Every spec of the repository is sound: each is made with a few pixels. */
static void shipped_specs(void)
{
    static const char *const names[] = {"demo-room",   "cornell-box",       "cubical-room",
                                        "office",      "white-room-hidden", "colour-bleeding",
                                        "many-lights", "no-highlight"};
    static char text[16384];
    igi_context *ctx = test_context(2);
    for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
        char path[512];
        snprintf(path, sizeof path, IGI_SOURCE_DIR "/datasets-synthetic/%s.json", names[i]);
        FILE *file = fopen(path, "r");
        if (!file) abort();
        size_t size = fread(text, 1, sizeof text - 1, file);
        fclose(file);
        text[size] = 0;
        static const char *const keys[] = {"\"samples\": ", "\"width\": ", "\"height\": "};
        for (size_t k = 0; k < 3; k++)
            for (char *at = text; (at = strstr(at, keys[k])) != NULL;) {
                at += strlen(keys[k]); /* the number there becomes 8 */
                size_t digits = strspn(at, "0123456789");
                memset(at, ' ', digits);
                at[0] = '8';
            }
        write_spec(text);
        CHECK_OK(ctx, igi_synth(ctx, SPEC, "test_synth_d"));
    }
    igi_context_destroy(ctx);
}

TEST_MAIN({"whole folder", whole_folder}, {"same bytes", same_bytes}, {"mistakes", mistakes},
          {"shipped specs", shipped_specs}, {"relight", relight})
