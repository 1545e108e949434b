/* SPDX-License-Identifier: Apache-2.0
 *
 * The pictures of igi check's page: a room is cut open from outside, points lie where they are drawn,
 * colours are those of what is there.
 */
#include "test.h"

#include "check/view.h"
#include "scene/camera.h"

#include <unistd.h>

static const char spec[] =
    "{ \"igi_synth\": 1, \"name\": \"x\",\n"
    "  \"materials\": { \"shell\": { \"albedo\": 0.5 }, \"floor\": { \"albedo\": 0.5 },\n"
    "    \"box\": { \"albedo\": 0.5 }, \"lamp\": { \"emitter\": true } },\n"
    "  \"shapes\": [ { \"type\": \"room\", \"size\": [3, 3, 2.5], \"floor\": \"floor\", "
    "\"ceiling\": \"shell\", \"walls\": \"shell\",\n"
    "      \"panels\": [ { \"from\": [1, 1], \"to\": [2, 2], \"material\": \"lamp\" } ] },\n"
    "    { \"type\": \"box\", \"at\": [1, 1.7, 0], \"size\": [0.8, 0.7, 0.8], \"material\": "
    "\"box\" "
    "} ],\n"
    "  \"lights\": [ { \"type\": \"area\", \"region\": \"lamp\", \"radiance\": [6, 6, 6] } ],\n"
    "  \"views\": { \"width\": 64, \"height\": 48, \"count\": 8, \"samples\": 4, \"fov_deg\": 80 } "
    "}\n";

static igi_context *ctx;
static igi_scene *scene;
static igi_tracer *tracer;
static igi_observations *observations;
static igi_survey survey;
static char folder[] = "test_view_XXXXXX";

static void open_room(void)
{
    if (scene) return;
    ctx = test_context(2);
    if (!mkdtemp(folder)) abort();
    FILE *file = fopen("test_view.json", "w");
    if (!file || fputs(spec, file) < 0 || fclose(file) != 0) abort();
    CHECK_OK(ctx, igi_synth(ctx, "test_view.json", folder));
    CHECK_OK(ctx, igi_scene_load(ctx, folder, &scene));
    if (!scene) abort();
    CHECK_OK(ctx, igi_tracer_create(ctx, &scene->mesh, &tracer));
    CHECK_OK(ctx, igi_observe(ctx, scene, tracer, 0, &observations));
    CHECK_OK(ctx, igi_survey_create(ctx, scene, tracer, observations, &survey));
    if (!survey.views) abort();
}

static igi_vec hit_point(const igi_hit *hit)
{
    return igi_triangle_point(&scene->mesh, hit->triangle, hit->u, hit->v);
}

static const char *name_at(const igi_view *view, int x, int y)
{
    const igi_hit *hit = igi_view_hit(view, x, y);
    return hit->triangle == IGI_NO_HIT ? ""
                                       : scene->regions[scene->mesh.regions[hit->triangle]].name;
}

/* Every ray's point is drawn within the pixel that the ray belongs to. */
static void check_places(const igi_view *view)
{
    double worst = 0;
    for (int y = 0; y < view->height; y += 5)
        for (int x = 0; x < view->width; x += 5) {
            double px = -9, py = -9, inside = .5 / view->fine;
            const igi_hit *hit = igi_view_hit(view, x, y);
            if (hit->triangle == IGI_NO_HIT) continue;
            CHECK(igi_view_project(view, hit_point(hit), &px, &py));
            worst = fmax(worst, fmax(fabs(px - x - inside), fabs(py - y - inside)));
        }
    CHECK(worst < 0.02);
    if (worst >= 0.02) printf("    off by %.3g pixels\n", worst);
}

static void coverage(void)
{
    open_room();
    size_t sides = 2 * survey.patches->count;
    for (size_t side = 0; side < sides; side++) {
        CHECK((survey.views[side] > 0) == (survey.seen[side] > 0));
        CHECK((survey.cosine[side] > 0) == (survey.seen[side] > 0));
        CHECK(survey.views[side] <= scene->frame_count && survey.cosine[side] <= 1.00001f);
    }
}

static void room_from_outside(void)
{
    bool *cut = NULL;
    igi_view view;
    open_room();
    CHECK_NEAR((double)igi_survey_up(&survey).z, 1, 0);
    CHECK_OK(ctx, igi_survey_outside(ctx, &survey, &cut));
    if (!cut) abort();
    for (size_t side = 0; side < 2 * survey.patches->count; side++)
        if (cut[side]) CHECK(survey.views[side] == 0);
    igi_view_outside(&survey, igi_v(0, 0, -1), 60, &view);
    view.cut = cut;
    CHECK_OK(ctx, igi_view_look(ctx, &view));
    CHECK(abs(view.height - 60) <= 1);                       /* 3 m by 3 m */
    CHECK_STR(name_at(&view, 30, view.height / 2), "floor"); /* through lamp and ceiling */
    CHECK_STR(name_at(&view, 20, view.height - 34), "box");
    check_places(&view);
    igi_view_clear(&view);
    view.cut = NULL; /* with nothing cut away, the ceiling hides the room */
    CHECK_OK(ctx, igi_view_look(ctx, &view));
    CHECK_STR(name_at(&view, 4, view.height / 2), "shell");
    igi_view_clear(&view);
    igi_free(cut);
}

static void colours(void)
{
    uint8_t *by_side = NULL, *pixels = NULL;
    igi_view view;
    open_room();
    igi_view_of_camera(&survey, &scene->frames[0].camera, 32, &view);
    CHECK(view.height == 24);
    CHECK_OK(ctx, igi_view_look(ctx, &view));
    check_places(&view);
    CHECK_OK(ctx, IGI_ALLOC(ctx, 6 * survey.patches->count, &by_side));
    if (!by_side) abort();
    for (uint32_t side = 0; side < 2 * survey.patches->count; side++)
        if (survey.patches->triangle[side >> 1] != IGI_NO_HIT)
            by_side[3 * side + igi_patch_region(survey.patches, side >> 1) % 3] = 200;
    CHECK_OK(ctx, igi_view_paint(ctx, &view, by_side, &pixels));
    for (int i = 0; i < view.width * view.height; i++) {
        const igi_hit *hit = igi_view_hit(&view, i % view.width, i / view.width);
        if (scene->regions[scene->mesh.regions[hit->triangle]].emitter) continue;
        size_t band = scene->mesh.regions[hit->triangle] % 3;
        CHECK(pixels[4 * i + 3] == 255);
        for (size_t c = 0; c < 3; c++)
            CHECK(c == band ? pixels[4 * (size_t)i + c] >= 100 && pixels[4 * (size_t)i + c] <= 200
                            : pixels[4 * (size_t)i + c] == 0);
    }
    igi_view_clear(&view);
    igi_free(by_side);
    igi_free(pixels);
}

/* A mirror in the floor below the lamp shows it to an eye beside the lamp, and not to one far off. */
static void mirrored_lamp(void)
{
    open_room();
    igi_vec up = igi_v(0, 0, 1);
    CHECK(igi_survey_mirrors_lamp(&survey, igi_v(1.5f, 1.2f, 2), igi_v(1.5f, 1.3f, 0), up));
    CHECK(!igi_survey_mirrors_lamp(&survey, igi_v(0.2f, 0.2f, 0.3f), igi_v(1.5f, 1.3f, 0), up));
}

/* Every allocation may fail: then a sentence, and no page. */
static void no_memory(void)
{
    igi_check *found = NULL;
    char path[100];
    igi_status status = IGI_E_SYSTEM;
    open_room();
    snprintf(path, sizeof path, "%s/check.html", folder);
    for (long n = 200; status != IGI_OK && n < 1000000; n += n / 2) {
        igi_fail_allocation_after(ctx, n);
        status = igi_check_page(ctx, scene, folder, &found);
        CHECK(status == IGI_OK || (status == IGI_E_SYSTEM && !found));
        CHECK((access(path, F_OK) == 0) == (status == IGI_OK));
    }
    igi_fail_allocation_after(ctx, -1);
    CHECK(status == IGI_OK);
    igi_check_destroy(found);
}

static void clean_up(void)
{
    char command[100];
    if (!scene) return;
    igi_survey_clear(&survey);
    igi_observations_destroy(observations);
    igi_tracer_destroy(tracer);
    igi_scene_destroy(scene);
    igi_context_destroy(ctx);
    snprintf(command, sizeof command, "rm -rf %s test_view.json", folder);
    if (system(command) != 0) printf("left behind: %s\n", folder);
}

TEST_MAIN({"coverage", coverage}, {"room_from_outside", room_from_outside}, {"colours", colours},
          {"mirrored_lamp", mirrored_lamp}, {"no_memory", no_memory}, {"", clean_up})
