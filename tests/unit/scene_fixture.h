/* SPDX-License-Identifier: Apache-2.0
 *
 * A small scene folder for tests of src/scene: an open box of three regions, two photographs of
 * 8x6 pixels. Each test spoils one of its files.
 */
#ifndef IGI_TESTS_SCENE_FIXTURE_H
#define IGI_TESTS_SCENE_FIXTURE_H

#include "test.h"

#include "base/context.h"

#include <sys/stat.h>
#include <unistd.h>

#define BOX_OBJ                                                                \
    "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n" \
    "vt 0 0\nvt 1 0\nvt 1 1\nvt 0 1\n"                                         \
    "usemtl floor\nf 1/1 2/2 3/3 4/4\nusemtl lamp\nf 5 8 7 6\nusemtl wall\nf 1 5 6 2\n"
#define BOX_SCENE                                                                                \
    "{ \"igi\": 1, \"name\": \"box\",\n  \"mesh\": \"scene.obj\",\n"                             \
    "  \"cameras\": \"transforms.json\",\n  \"lights\": [\n    %s ],\n  \"regions\": {\n    %s " \
    "}\n}\n"
#define BOX_LIGHT "{ \"type\": \"area\", \"region\": \"lamp\", \"radiance\": [1, 2, 3] }"
#define BOX_REGIONS "\"floor\": { \"textured\": true }, \"lamp\": { \"emitter\": true }"
#define POSE "[[1,0,0,0.5],[0,1,0,0.5],[0,0,1,0.9],[0,0,0,1]]"
#define BOX_CAMERAS                                                              \
    "{ \"w\": 8, \"h\": 6, \"fl_x\": 5,\n  \"frames\": [\n"                      \
    "    { \"file_path\": \"images/a.exr\", \"transform_matrix\": " POSE " },\n" \
    "    { \"file_path\": \"images/b\", \"transform_matrix\": " POSE " } ] }\n"

static const char *fixture_folder = "";

static inline void write_bytes(const char *name, const void *bytes, size_t size)
{
    char path[512];
    snprintf(path, sizeof path, "%s/%s", fixture_folder, name);
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(bytes, 1, size, file) != size || fclose(file) != 0) abort();
}

static inline void write_text(const char *name, const char *text)
{
    write_bytes(name, text, strlen(text));
}

static inline void write_scene(const char *lights, const char *regions)
{
    char text[4096];
    snprintf(text, sizeof text, BOX_SCENE, lights, regions);
    write_text("scene.json", text);
}

static inline void write_image(const char *name, int width, int height, int channels)
{
    char path[512];
    igi_context *ctx = test_context(1);
    igi_image *image = NULL;
    snprintf(path, sizeof path, "%s/%s", fixture_folder, name);
    if (igi_image_create(ctx, width, height, channels, &image) != IGI_OK ||
        igi_image_save_exr(ctx, image, IGI_EXR_HALF, path) != IGI_OK)
        abort();
    igi_image_destroy(image);
    igi_context_destroy(ctx);
}

/* The whole folder, good. One folder a test program: they may run side by side. */
static inline void write_fixture(const char *folder)
{
    char path[512];
    fixture_folder = folder;
    snprintf(path, sizeof path, "%s/images", folder);
    (void)mkdir(folder, 0777);
    (void)mkdir(path, 0777);
    write_text("scene.obj", BOX_OBJ);
    write_scene(BOX_LIGHT, BOX_REGIONS);
    write_text("transforms.json", BOX_CAMERAS);
    write_image("images/a.exr", 8, 6, 3);
    write_image("images/b.exr", 8, 6, 3);
}

/* The sentence of loading the folder now, "" when it succeeds. */
static inline const char *load_sentence(igi_status *status)
{
    static char sentence[1024];
    igi_context *ctx = test_context(1);
    igi_scene *scene = NULL;
    *status = igi_scene_load(ctx, fixture_folder, &scene);
    snprintf(sentence, sizeof sentence, "%s", *status == IGI_OK ? "" : igi_context_message(ctx));
    if ((*status == IGI_OK) != (scene != NULL)) abort(); /* a result, or a failure */
    igi_scene_destroy(scene);
    igi_context_destroy(ctx);
    return sentence;
}

/* Loading must fail so, with this in the sentence. */
#define CHECK_REFUSED(want_status, part)                     \
    do {                                                     \
        igi_status got_status_;                              \
        const char *sentence_ = load_sentence(&got_status_); \
        CHECK_CONTAINS(sentence_, part);                     \
        CHECK(got_status_ == (want_status));                 \
    } while (0)

#define CHECK_LOADS()                               \
    do {                                            \
        igi_status got_status_;                     \
        CHECK_STR(load_sentence(&got_status_), ""); \
        CHECK(got_status_ == IGI_OK);               \
    } while (0)

#endif
