/* SPDX-License-Identifier: Apache-2.0
 *
 * igi check finds each fault that is put into a good scene, and none in the good one.
 */
#include "test.h"

#include "base/context.h"

#include <unistd.h>

static const char spec[] =
    "{ \"igi_synth\": 1, \"name\": \"x\",\n"
    "  \"materials\": { \"shell\": { \"albedo\": 0.5 }, \"floor\": { \"albedo\": 0.5 }, \"box\": { "
    "\"albedo\": [0.5, 0.5, 0.4] },\n"
    "    \"lamp\": { \"emitter\": true } },\n"
    "  \"shapes\": [ { \"type\": \"room\", \"size\": [3, 3, 2.5], \"floor\": \"floor\", "
    "\"ceiling\": \"shell\", \"walls\": \"shell\",\n"
    "      \"panels\": [ { \"from\": [1, 1], \"to\": [2, 2], \"material\": \"lamp\" } ] },\n"
    "    { \"type\": \"box\", \"at\": [1.2, 1.9, 0], \"size\": [0.8, 0.7, 0.8], \"material\": "
    "\"box\" } ],\n"
    "  \"lights\": [ { \"type\": \"area\", \"region\": \"lamp\", \"radiance\": [6, 6, 6] } ],\n"
    "  \"views\": { \"width\": 80, \"height\": 60, \"count\": 10, \"samples\": 16, \"fov_deg\": 80 "
    "} }\n";

static igi_context *ctx;
static igi_scene *scene;
static igi_check *found;
static char folder[] = "test_check_XXXXXX";

static void open_room(void)
{
    if (scene) return;
    ctx = test_context(2);
    if (!mkdtemp(folder)) abort();
    FILE *file = fopen("test_check.json", "w");
    if (!file || fputs(spec, file) < 0 || fclose(file) != 0) abort();
    CHECK_OK(ctx, igi_synth(ctx, "test_check.json", folder));
    CHECK_OK(ctx, igi_scene_load(ctx, folder, &scene));
    if (!scene) abort();
}

/* Checks the scene as it now is. */
static void look(void)
{
    igi_check_destroy(found);
    CHECK_OK(ctx, igi_check_scene(ctx, scene, &found));
    if (!found) abort();
}

static const igi_assumption *of(const char *name)
{
    for (size_t i = 0; i < found->assumption_count; i++)
        if (strcmp(found->assumptions[i].name, name) == 0) return &found->assumptions[i];
    abort();
}

#define CHECK_VERDICT(name, want)                                                         \
    do {                                                                                  \
        CHECK_STR(igi_verdict_name(of(name)->verdict), igi_verdict_name(want));           \
        if (of(name)->verdict != (want)) printf("    %s: %s\n", name, of(name)->finding); \
        CHECK((of(name)->remedy != NULL) == ((want) != IGI_HOLDS));                       \
    } while (0)

static void a_good_scene(void)
{
    static const char *const holding[] = {"static", "exposure", "unclipped", "closed",
                                          "mesh",   "lights",   "energy",    "conditioned"};
    open_room();
    look();
    for (size_t i = 0; i < sizeof holding / sizeof holding[0]; i++)
        CHECK_VERDICT(holding[i], IGI_HOLDS);
    CHECK(found->verdict != IGI_FAILS && found->warning_count == 0);
    const igi_region_check *shell = &found->regions[0], *box = NULL;
    for (size_t r = 0; r < found->region_count; r++) {
        if (strcmp(found->regions[r].name, "shell") == 0) shell = &found->regions[r];
        if (strcmp(found->regions[r].name, "box") == 0) box = &found->regions[r];
    }
    if (!box) abort();
    CHECK_NEAR(shell->albedo[0], .5, .05);
    CHECK_NEAR(box->albedo[2], .4, .06);
    CHECK_NEAR(shell->area, 9 + 4 * 7.5 - 1, .01);
    CHECK(shell->observed > .5 && shell->observed < 1 && shell->escaped == 0);
    CHECK(shell->views > 5 && shell->views <= 10);
    CHECK(shell->angle_low_deg < 25 && shell->angle_high_deg > 65);
    CHECK(shell->highlights_predicted > 0 && shell->highlights_seen > 0);
    CHECK_NEAR(found->amplification, 2, .15); /* 1 / (1 - .5) */
}

static void a_hole(void)
{
    open_room();
    scene->mesh.triangle_count -= 2; /* a face of the box shows what is below the floor */
    size_t last = scene->mesh.triangle_count;
    uint32_t *corners = scene->mesh.triangles, keep[3];
    memcpy(keep, corners, sizeof keep);
    corners[0] = corners[1]; /* and half of the floor is gone */
    corners[2] = corners[1];
    look();
    CHECK_VERDICT("closed", IGI_DOUBTFUL);
    CHECK(of("closed")->number > .01);
    memcpy(corners, keep, sizeof keep);
    scene->mesh.triangle_count = last + 2;
}

static void faces(void)
{
    open_room();
    uint32_t *corners = scene->mesh.triangles, keep[6];
    memcpy(keep, corners, sizeof keep);
    memcpy(corners + 3, corners, 3 * sizeof *corners);
    look();
    CHECK_VERDICT("mesh", IGI_DOUBTFUL);
    CHECK(found->doubled_faces == 1);
    memcpy(corners, keep, sizeof keep);
    corners[4] = keep[5];
    corners[5] = keep[4];
    look();
    CHECK_VERDICT("mesh", IGI_DOUBTFUL);
    CHECK(found->doubled_faces == 0 && found->flipped_edges >= 1);
    memcpy(corners, keep, sizeof keep);
}

static void lights(void)
{
    open_room();
    const igi_light keep = scene->lights[0];
    scene->lights[0].known = false; /* its panel is seen */
    look();
    CHECK_VERDICT("lights", IGI_HOLDS);
    CHECK(found->lights[0].seen && !found->lights[0].known);
    CHECK_VERDICT("energy", IGI_HOLDS);
    scene->lights[0] = (igi_light){
        .type = IGI_LIGHT_POINT, .region = -1, .position = {1.5, 1.5, 2}};
    look();
    CHECK_VERDICT("lights", IGI_FAILS);
    CHECK_VERDICT("energy", IGI_DOUBTFUL);
    CHECK(isnan(found->amplification) && found->verdict == IGI_FAILS);
    scene->lights[0] = keep;
    for (int b = 0; b < 3; b++) scene->lights[0].value[b] /= 20;
    look();
    CHECK_VERDICT("lights", IGI_FAILS);
    CHECK_NEAR(of("lights")->number, 20, .2);
    CHECK_VERDICT("energy", IGI_FAILS);
    CHECK(of("energy")->number > 1.15);
    scene->lights[0] = keep;
}

/* One photograph shows one half of the room: where would one see the other half from? */
static void one_photograph(void)
{
    open_room();
    size_t keep = scene->frame_count;
    scene->frame_count = 1;
    look();
    CHECK_VERDICT("static", IGI_DOUBTFUL); /* nobody can tell */
    CHECK_VERDICT("exposure", IGI_DOUBTFUL);
    CHECK_VERDICT("observed", IGI_DOUBTFUL);
    CHECK_VERDICT("surroundings", IGI_DOUBTFUL);
    CHECK(found->unseen_area > .3 && of("surroundings")->has_view);
    const double *eye = of("surroundings")->eye, size[3] = {3, 3, 2.5};
    for (int k = 0; k < 3; k++) CHECK(eye[k] > 0 && eye[k] < size[k]);
    CHECK_CONTAINS(of("surroundings")->remedy, "add a photograph from about");
    scene->frame_count = keep;
}

static void cut_off(igi_image *image, float highest)
{
    for (int i = 0; i < image->width * image->height * 3; i++)
        image->samples[i] = fminf(image->samples[i], highest);
}

static void saturation(void)
{
    igi_image *image = NULL;
    open_room();
    char *path = scene->frames[3].path, other[200];
    snprintf(other, sizeof other, "%s/cut.exr", folder);
    CHECK_OK(ctx, igi_image_load_exr(ctx, path, &image));
    if (!image) abort();
    double mean = 0;
    for (int i = 0; i < image->width * image->height * 3; i++)
        mean += (double)fminf(image->samples[i], 2) / (image->width * image->height * 3);
    cut_off(image, (float)(1.2 * mean));
    CHECK_OK(ctx, igi_image_save_exr(ctx, image, IGI_EXR_FLOAT, other));
    scene->frames[3].path = other;
    look();
    scene->frames[3].path = path;
    CHECK_VERDICT("unclipped", IGI_DOUBTFUL);
    CHECK(of("unclipped")->frame == 3 && found->photos[3].saturated > .02);
    CHECK(found->photos[2].saturated == 0);
    CHECK(found->warning_count >= 1);
    if (found->warning_count) CHECK_CONTAINS(found->warnings[0], "share the largest value");
    igi_image_destroy(image);
}

/* What the agreement of the photographs finds (test_agreement) comes through. */
static void a_wrong_photograph(void)
{
    open_room();
    char *path = scene->frames[5].path;
    scene->frames[5].path = scene->frames[0].path;
    look();
    scene->frames[5].path = path;
    CHECK_VERDICT("static", IGI_DOUBTFUL);
    CHECK(of("static")->frame == 5 && found->photos[5].left_out && !found->photos[0].left_out);
    CHECK_CONTAINS(of("static")->remedy, "0005");
}

/* Every allocation may fail: then a sentence, and nothing half done. */
static void no_memory(void)
{
    open_room();
    igi_check *none = NULL;
    int failures = 0;
    igi_status status = IGI_E_SYSTEM;
    for (long n = 0; status != IGI_OK && n < 100000; n += 1 + n / 4) {
        igi_fail_allocation_after(ctx, n);
        status = igi_check_scene(ctx, scene, &none);
        failures += status != IGI_OK;
        CHECK(status == IGI_OK || (status == IGI_E_SYSTEM && none == NULL));
    }
    igi_fail_allocation_after(ctx, -1);
    CHECK(status == IGI_OK && failures > 10);
    igi_check_destroy(none);
}

static void clean_up(void)
{
    char command[100];
    if (!scene) return;
    igi_check_destroy(found);
    igi_scene_destroy(scene);
    igi_context_destroy(ctx);
    snprintf(command, sizeof command, "rm -rf %s test_check.json", folder);
    if (system(command) != 0) printf("left behind: %s\n", folder);
}

TEST_MAIN({"a_good_scene", a_good_scene}, {"a_hole", a_hole}, {"faces", faces}, {"lights", lights},
          {"one_photograph", one_photograph}, {"saturation", saturation},
          {"a_wrong_photograph", a_wrong_photograph}, {"no_memory", no_memory}, {"", clean_up})
