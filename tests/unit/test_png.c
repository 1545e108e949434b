/* SPDX-License-Identifier: Apache-2.0
 *
 * PNG: what igi encodes, libpng's own simple reader gives back.
 */
#include "test.h"

#include "base/context.h"
#include "base/rng.h"

#include <png.h>

static void round_trip_at(int width, int height, int channels)
{
    igi_context *ctx = test_context(1);
    size_t count = (size_t)width * (size_t)height * (size_t)channels, size = 0;
    uint8_t *pixels = malloc(count), *back = malloc(count), *bytes = NULL;
    igi_rng rng = igi_rng_make(1, 2);
    if (!pixels || !back) abort();
    for (size_t i = 0; i < count; i++) pixels[i] = (uint8_t)igi_rng_next(&rng);
    CHECK_OK(ctx, igi_image_encode_png(ctx, pixels, width, height, channels, &bytes, &size));
    png_image reader = {.version = PNG_IMAGE_VERSION};
    CHECK(bytes && png_image_begin_read_from_memory(&reader, bytes, size));
    CHECK((int)reader.width == width && (int)reader.height == height);
    reader.format = channels == 1   ? PNG_FORMAT_GRAY
                    : channels == 3 ? PNG_FORMAT_RGB
                                    : PNG_FORMAT_RGBA;
    CHECK(png_image_finish_read(&reader, NULL, back, 0, NULL));
    CHECK(memcmp(pixels, back, count) == 0);
    igi_image_free_bytes(bytes);
    free(back);
    free(pixels);
    igi_context_destroy(ctx);
}

static void round_trips(void)
{
    round_trip_at(1, 1, 1);
    round_trip_at(33, 17, 1);
    round_trip_at(64, 48, 3);
    round_trip_at(31, 9, 4);
}

static void flat_pictures_are_small(void)
{
    igi_context *ctx = test_context(1);
    size_t size = 0;
    uint8_t *pixels = calloc(320 * 240, 3), *bytes = NULL;
    CHECK_OK(ctx, igi_image_encode_png(ctx, pixels, 320, 240, 3, &bytes, &size));
    CHECK(size > 0 && size < 4000);
    igi_image_free_bytes(bytes);
    free(pixels);
    igi_context_destroy(ctx);
}

static void mistakes_are_refused(void)
{
    igi_context *ctx = test_context(1);
    uint8_t pixels[4] = {0}, *bytes = NULL;
    size_t size = 0;
    CHECK(igi_image_encode_png(ctx, pixels, 1, 1, 2, &bytes, &size) == IGI_E_USAGE && !bytes);
    CHECK(igi_image_encode_png(ctx, pixels, 0, 1, 1, &bytes, &size) == IGI_E_USAGE && !bytes);
    igi_fail_allocation_after(ctx, 0);
    CHECK(igi_image_encode_png(ctx, pixels, 1, 1, 1, &bytes, &size) == IGI_E_SYSTEM && !bytes);
    igi_context_destroy(ctx);
}

TEST_MAIN({"round_trips", round_trips}, {"flat_pictures_are_small", flat_pictures_are_small},
          {"mistakes_are_refused", mistakes_are_refused})
