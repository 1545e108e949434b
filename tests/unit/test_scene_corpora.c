/* SPDX-License-Identifier: Apache-2.0
 *
 * Scenes and broken files by others, from the optional folder of shared data.
 */
#include "scene_fixture.h"

#include "scene/json.h"
#include "scene/mesh.h"

#include <dirent.h>

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

static void scenes(void)
{
    static const struct {
        const char *name;
        size_t triangles, regions, lights;
    } known[] = {{"cornell-diffuse", 46, 8, 1},
                 {"cubical-room", 122, 10, 1},
                 {"office", 1752, 17, 2},
                 {"living-room", 134481, 30, 3}};
    for (size_t i = 0; i < COUNT(known); i++) {
        char path[600], name[64];
        snprintf(name, sizeof name, "scenes/%s", known[i].name);
        if (!test_shared_data(name, path, sizeof path)) continue;
        igi_context *ctx = test_context(1);
        igi_scene *scene = NULL;
        CHECK_OK(ctx, igi_scene_load(ctx, path, &scene));
        if (scene) {
            CHECK_STR(scene->name, known[i].name);
            CHECK(scene->mesh.triangle_count == known[i].triangles);
            CHECK(scene->region_count == known[i].regions);
            CHECK(scene->light_count == known[i].lights);
            CHECK(scene->frame_count == 24 && scene->bands == 3 && scene->warning_count == 0);
        }
        igi_scene_destroy(scene);
        igi_context_destroy(ctx);
    }
}

/* Calls `visit` for every file of the folder with that ending, without following deeper. */
static int visit_files(const char *folder, const char *ending,
                       void (*visit)(const char *path, const char *name))
{
    int count = 0;
    char path[1200];
    DIR *directory = opendir(folder);
    if (!directory) return 0;
    for (const struct dirent *entry; (entry = readdir(directory));) {
        if (!igi_ends_with(entry->d_name, ending)) continue;
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        visit(path, entry->d_name);
        count++;
    }
    closedir(directory);
    return count;
}

static void visit_json(const char *path, const char *name)
{
    igi_context *ctx = test_context(1);
    igi_json_file file;
    igi_status status = igi_json_load(ctx, path, &file);
    CHECK(status == IGI_OK || status == IGI_E_DATA);
    CHECK((status == IGI_OK) == (file.root != NULL));
    if (name[0] == 'n') CHECK(status == IGI_E_DATA);
    if (status == IGI_OK) igi_json_unload(&file);
    else CHECK_CONTAINS(igi_context_message(ctx), path);
    igi_context_destroy(ctx);
}

static void broken_json(void)
{
    char path[600];
    if (!test_shared_data("real/bad_inputs/json/test_parsing", path, sizeof path)) return;
    CHECK(visit_files(path, ".json", visit_json) > 100);
}

static void visit_mesh(const char *path, const char *name)
{
    igi_context *ctx = test_context(1);
    igi_scene *scene = NULL;
    if (IGI_ALLOC(ctx, 1, &scene) != IGI_OK) abort();
    igi_status status = igi_mesh_load(ctx, scene, path);
    CHECK(status == IGI_OK || status == IGI_E_DATA);
    if (status == IGI_E_DATA) CHECK_CONTAINS(igi_context_message(ctx), name);
    else CHECK(scene->mesh.triangle_count > 0 && scene->region_count > 0);
    igi_scene_destroy(scene);
    igi_context_destroy(ctx);
}

static void broken_meshes(void)
{
    char path[600];
    if (test_shared_data("real/bad_inputs/obj/models", path, sizeof path))
        CHECK(visit_files(path, ".obj", visit_mesh) > 10);
    if (test_shared_data("real/bad_inputs/gltf/test/base/data/glb", path, sizeof path))
        CHECK(visit_files(path, ".glb", visit_mesh) > 10);
    if (test_shared_data("real/bad_inputs/gltf/test/base/data/mesh", path, sizeof path))
        CHECK(visit_files(path, ".gltf", visit_mesh) > 0);
}

/* 67 frames as instant-ngp ships them; 17 of the photographs are not there. */
static void fox(void)
{
    char path[600];
    if (!test_shared_data("real/multiview_fox/transforms.json", path, sizeof path)) return;
    igi_context *ctx = test_context(1);
    igi_frame *frames = NULL;
    size_t count = 0;
    int missing = 0;
    CHECK_OK(ctx, igi_frames_load(ctx, path, &frames, &count));
    for (size_t i = 0; i < count; i++) missing += !igi_file_exists(frames[i].path);
    CHECK(count == 67 && missing == 17);
    if (count) CHECK(frames[0].camera.width == 1080 && frames[0].camera.height == 1920);
    igi_frames_destroy(frames, count);
    igi_context_destroy(ctx);
}

TEST_MAIN({"scenes", scenes}, {"broken JSON", broken_json}, {"broken meshes", broken_meshes},
          {"fox", fox})
