/* SPDX-License-Identifier: Apache-2.0
 *
 * Loading a scene while the n-th allocation fails, for every n: a sentence, no crash, no leak (the
 * last is AddressSanitizer's to see).
 */
#include "unit/scene_fixture.h"

#define FOLDER "scratch_oom_scene"

/* Fails allocation 0, 1, 2 ... until loading succeeds; how many failed. */
static int count_failures(void)
{
    for (int n = 0; n < 10000; n++) {
        igi_context *ctx = test_context(1);
        igi_scene *scene = NULL;
        igi_fail_allocation_after(ctx, n);
        igi_status status = igi_scene_load(ctx, FOLDER, &scene);
        if (status == IGI_OK) {
            CHECK(scene && scene->frame_count == 2);
            igi_scene_destroy(scene);
            igi_context_destroy(ctx);
            return n;
        }
        CHECK(status == IGI_E_SYSTEM && !scene);
        CHECK_CONTAINS(igi_context_message(ctx), "memory");
        igi_context_destroy(ctx);
    }
    CHECK(false);
    return 0;
}

static void transforms_and_obj(void)
{
    write_fixture(FOLDER);
    write_text("scene.obj", BOX_OBJ "f 1 1 1\n"); /* with a warning */
    CHECK(count_failures() > 40);
}

static void colmap_and_ply(void)
{
    write_fixture(FOLDER);
    (void)mkdir(FOLDER "/colmap", 0777);
    write_text("colmap/cameras.txt", "1 PINHOLE 8 6 5 5 4 3\n");
    write_text("colmap/images.txt", "1 1 0 0 0 0 0 0 1 a.exr\n\n2 1 0 0 0 0 0 0 1 b.png\n\n");
    write_text("scene.ply", "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
                            "property float y\nproperty float z\nelement face 1\n"
                            "property list uchar int vertex_indices\nend_header\n"
                            "0 0 0\n1 0 0\n1 1 0\n3 0 1 2\n");
    write_text("scene.json", "{\"igi\":1,\"mesh\":\"scene.ply\",\"cameras\":\"colmap\","
                             "\"lights\":[{\"type\":\"env\",\"image\":\"images/a.exr\"}]}");
    CHECK(count_failures() > 40);
}

static void lights(void)
{
    igi_context *ctx = test_context(1);
    igi_scene *scene = NULL;
    igi_light *list = NULL;
    size_t count = 0;
    write_fixture(FOLDER);
    write_text("lights.json", "{\"lights\":[" BOX_LIGHT "]}");
    CHECK_OK(ctx, igi_scene_load(ctx, FOLDER, &scene));
    for (int n = 0; n < 100 && !list; n++) {
        igi_fail_allocation_after(ctx, n);
        igi_status status = igi_lights_load(ctx, scene, FOLDER "/lights.json", &list, &count);
        CHECK(status == (list ? IGI_OK : IGI_E_SYSTEM));
    }
    CHECK(list && count == 1);
    igi_lights_destroy(list, count);
    igi_scene_destroy(scene);
    igi_context_destroy(ctx);
}

TEST_MAIN({"transforms and OBJ", transforms_and_obj}, {"COLMAP and PLY", colmap_and_ply},
          {"lights", lights})
