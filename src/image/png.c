/* SPDX-License-Identifier: Apache-2.0
 *
 * PNG through libpng, in memory.
 */
#include "base/context.h"

#include <igi/image.h>

#include <png.h>

#include <setjmp.h>
#include <string.h>

/* The bytes written so far; grown as libpng hands them over. */
typedef struct writing {
    igi_context *ctx;
    uint8_t *bytes;
    size_t size, capacity;
    igi_status status;
    jmp_buf out;
} writing;

static void stop(png_structp png, png_const_charp message)
{
    writing *w = png_get_error_ptr(png);
    if (w->status == IGI_OK)
        w->status = igi_fail(w->ctx, IGI_E_INTERNAL, "png: %s; report this", message);
    longjmp(w->out, 1);
}

static void ignore(png_structp png, png_const_charp message)
{
    (void)png;
    (void)message;
}

static void append(png_structp png, png_bytep data, size_t size)
{
    writing *w = png_get_io_ptr(png);
    uint8_t *grown = igi_grow(w->ctx, w->bytes, &w->capacity, w->size + size, 1);
    if (!grown) {
        w->status = IGI_E_SYSTEM;
        png_error(png, "no memory");
    }
    w->bytes = grown;
    memcpy(w->bytes + w->size, data, size);
    w->size += size;
}

static void flush(png_structp png)
{
    (void)png;
}

/* False after libpng called stop(). Nothing here lives across the jump but what *w points to. */
static bool write_png(writing *w, png_structp png, png_infop info, const uint8_t *pixels,
                      const int shape[3])
{
    static const int colour_types[] = {0, PNG_COLOR_TYPE_GRAY, 0, PNG_COLOR_TYPE_RGB,
                                       PNG_COLOR_TYPE_RGB_ALPHA};
    if (setjmp(w->out)) return false;
    png_set_write_fn(png, w, append, flush);
    png_set_compression_level(png, 3);
    png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
    png_set_IHDR(png, info, (png_uint_32)shape[0], (png_uint_32)shape[1], 8, colour_types[shape[2]],
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    png_set_sRGB(png, info, PNG_sRGB_INTENT_PERCEPTUAL);
    png_write_info(png, info);
    for (size_t y = 0; y < (size_t)shape[1]; y++)
        png_write_row(png, pixels + y * (size_t)shape[0] * (size_t)shape[2]);
    png_write_end(png, info);
    return true;
}

igi_status igi_image_encode_png(igi_context *ctx, const uint8_t *pixels, int width, int height,
                                int channels, uint8_t **bytes, size_t *size)
{
    igi_status status = IGI_OK;
    png_structp png = NULL;
    png_infop info = NULL;
    writing w = {.ctx = ctx};
    const int shape[3] = {width, height, channels};
    *bytes = NULL;
    *size = 0;
    if (width < 1 || height < 1 || (channels != 1 && channels != 3 && channels != 4))
        return igi_fail(ctx, IGI_E_USAGE, "png: %d x %d pixels of %d channels; give 1, 3 or 4",
                        width, height, channels);
    png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &w, stop, ignore);
    if (png) info = png_create_info_struct(png);
    if (!info) {
        status = igi_fail(ctx, IGI_E_SYSTEM,
                          "png: no memory to encode %d x %d pixels; use a "
                          "smaller image",
                          width, height);
    } else if (!write_png(&w, png, info, pixels, shape)) {
        status = w.status;
    } else {
        *bytes = w.bytes;
        *size = w.size;
        w.bytes = NULL;
    }
    png_destroy_write_struct(&png, &info);
    igi_free(w.bytes);
    return status;
}
