/* SPDX-License-Identifier: Apache-2.0
 *
 * Photographs that EXIF asks to turn: pixels stay as stored, and what does not fit is said.
 */
#include "test.h"

#include "base/context.h"
#include "lens/photographs.h"

#define WIDTH 24
#define HEIGHT 16

static uint16_t codes[WIDTH * HEIGHT * 3];

/* What comes of a photograph of this orientation for a camera of this size. */
static igi_status load(igi_context *ctx, int orientation, int width, int height, igi_image **image,
                       char **warning)
{
    igi_photo photo = {.width = WIDTH,
                       .height = HEIGHT,
                       .channels = 3,
                       .levels = 256,
                       .codes = codes,
                       .orientation = orientation};
    igi_exposure exposure = {.path = (char[]){"test_turned.png"}, .time_s = 1};
    igi_frame frame = {.name = (char[]){"0000"},
                       .path = (char[]){"0000"},
                       .camera = {.width = width, .height = height},
                       .exposure_count = 1,
                       .exposures = &exposure};
    igi_scene scene = {
        .bands = 3, .frame_count = 1, .frames = &frame, .exposures_response = IGI_RESPONSE_LINEAR};
    igi_photographs *photographs = NULL;
    *image = NULL;
    *warning = NULL;
    for (int i = 0; i < WIDTH * HEIGHT * 3; i++) codes[i] = (uint16_t)(20 + i % 200);
    CHECK_OK(ctx, igi_photo_save_png(ctx, &photo, "test_turned.png"));
    CHECK_OK(ctx, igi_photographs_open(ctx, &scene, &photographs));
    if (!photographs) return IGI_E_INTERNAL;
    igi_status status = igi_photographs_load(ctx, photographs, 0, image, warning);
    igi_photographs_close(photographs);
    remove("test_turned.png");
    return status;
}

static void pixels_stay_as_stored(void)
{
    igi_context *ctx = test_context(1);
    for (int orientation = 0; orientation <= 8; orientation++) {
        igi_image *image;
        char *warning;
        CHECK_OK(ctx, load(ctx, orientation, WIDTH, HEIGHT, &image, &warning));
        if (!image) continue;
        for (int i = 0; i < 4; i++) {
            size_t at = (size_t)(i / 2 * (HEIGHT - 1) * WIDTH + i % 2 * (WIDTH - 1));
            CHECK_NEAR((double)image->samples[at * (size_t)image->channels], codes[3 * at] / 255.,
                       2e-4);
        }
        /* A quarter turn would show in the sizes; of a half turn nothing tells. */
        bool open = orientation > 1 && orientation < 5;
        CHECK(open == (warning != NULL));
        if (warning) CHECK_CONTAINS(warning, "taken as stored, as COLMAP takes them");
        igi_image_destroy(image);
        igi_free(warning);
    }
    igi_context_destroy(ctx);
}

static void a_camera_of_the_turned_picture(void)
{
    igi_context *ctx = test_context(1);
    igi_image *image;
    char *warning;
    CHECK(load(ctx, 6, HEIGHT, WIDTH, &image, &warning) == IGI_E_DATA && !image && !warning);
    CHECK_CONTAINS(igi_context_message(ctx), "EXIF asks to turn them (orientation 6)");
    CHECK(load(ctx, 1, HEIGHT, WIDTH, &image, &warning) == IGI_E_DATA && !image && !warning);
    CHECK_CONTAINS(igi_context_message(ctx), "scale neither");
    igi_context_destroy(ctx);
}

TEST_MAIN({"pixels_stay_as_stored", pixels_stay_as_stored},
          {"a_camera_of_the_turned_picture", a_camera_of_the_turned_picture})
