/* SPDX-License-Identifier: Apache-2.0
 *
 * Vignetting from overlapping photographs of a room.
 */
#include "test.h"

#include <unistd.h>

static const char spec[] =
    "{ \"igi_synth\": 1, \"name\": \"x\",\n"
    "  \"materials\": { \"floor\": { \"albedo\": 0.4 }, \"wall\": { \"albedo\": 0.6 } },\n"
    "  \"shapes\": [ { \"type\": \"room\", \"size\": [4, 4, 3], \"floor\": \"floor\", \"ceiling\": "
    "\"wall\", \"walls\": \"wall\" } ],\n"
    "  \"lights\": [ { \"type\": \"point\", \"position\": [2, 2, 2], \"intensity\": [1, 1, 1] } "
    "],\n"
    "  \"views\": { \"width\": 96, \"height\": 72, \"count\": 8, \"samples\": 16, \"fov_deg\": 70 "
    "} "
    "}\n";

static const int size[2] = {96, 72};

static void shade(igi_context *ctx, const char *folder, int frame, const igi_vignetting *v)
{
    char path[100];
    igi_image *image = NULL;
    snprintf(path, sizeof path, "%s/images/%04d.exr", folder, frame);
    CHECK_OK(ctx, igi_image_load_exr(ctx, path, &image));
    if (!image) return;
    for (int i = 0; i < size[0] * size[1] * 3; i++) {
        int x = i / 3 % size[0], y = i / 3 / size[0];
        image->samples[i] *= (float)igi_vignetting_at(v, x + .5, y + .5, size);
    }
    CHECK_OK(ctx, igi_image_save_exr(ctx, image, IGI_EXR_FLOAT, path));
    igi_image_destroy(image);
}

static void vignetting_from_a_room(void)
{
    const igi_vignetting truth = {
        .known = true, .centre_x = 50, .centre_y = 35, .k = {-.35, .1, -.05}};
    igi_context *ctx = test_context(2);
    igi_scene *scene = NULL;
    igi_calibration *c = NULL;
    char folder[] = "test_overlap_XXXXXX", command[100];
    if (!mkdtemp(folder)) abort();
    FILE *file = fopen("test_overlap.json", "w");
    if (!file || fputs(spec, file) < 0 || fclose(file) != 0) abort();
    CHECK_OK(ctx, igi_synth(ctx, "test_overlap.json", folder));
    for (int i = 0; i < 8; i++) shade(ctx, folder, i, &truth);
    CHECK_OK(ctx, igi_scene_load(ctx, folder, &scene));
    if (scene) CHECK_OK(ctx, igi_calibrate_overlap(ctx, scene, &c));
    if (c) {
        double sum = 0;
        int count = 0;
        for (int y = 0; y <= size[1]; y += 4)
            for (int x = 0; x <= size[0]; x += 4, count++) {
                double off = igi_vignetting_at(&c->vignetting, x, y, size) /
                                 igi_vignetting_at(&truth, x, y, size) -
                             1;
                sum += off * off;
            }
        printf("overlap: rms %.4f, centre %.1f %.1f\n", sqrt(sum / count), c->vignetting.centre_x,
               c->vignetting.centre_y);
        CHECK(sqrt(sum / count) < .01);
        CHECK(c->vignetting.known && !c->has_lens && c->width == size[0]);
    }
    igi_calibration_destroy(c);
    igi_scene_destroy(scene);
    igi_context_destroy(ctx);
    snprintf(command, sizeof command, "rm -rf %s test_overlap.json", folder);
    if (system(command) != 0) printf("left behind: %s\n", folder);
}

TEST_MAIN({"vignetting_from_a_room", vignetting_from_a_room})
