/* SPDX-License-Identifier: Apache-2.0
 *
 * PNG photographs of 8 or 16 bits through libpng.
 */
#include "base/context.h"
#include "image/photo_private.h"

#include <png.h>

#include <setjmp.h>
#include <string.h>

typedef struct reading {
    jmp_buf out;
    igi_context *ctx;
    const char *path;
    igi_photo *photo;
    bool pixels;
    igi_status status;
    png_bytep buffer;
    png_bytepp rows;
} reading;

static void stop(png_structp png, png_const_charp message)
{
    reading *r = png_get_error_ptr(png);
    if (r->status == IGI_OK) r->status = igi_photo_broken(r->ctx, r->path, "PNG file", message);
    longjmp(r->out, 1);
}

static void ignore(png_structp png, png_const_charp message)
{
    (void)png;
    (void)message;
}

static void read_metadata(reading *r, png_structp png, png_infop info)
{
    png_uint_32 size = 0;
    png_bytep data = NULL;
    if (!png_get_eXIf_1(png, info, &size, &data) || size < 8 || size > 1u << 20) return;
    unsigned char *block;
    if (IGI_ALLOC(r->ctx, (size_t)size + 6, &block) != IGI_OK) return;
    memcpy(block, "Exif\0", 6);
    memcpy(block + 6, data, size);
    igi_photo_read_exif(block, (size_t)size + 6, r->photo);
    igi_free(block);
}

/* Interlaced or not, whole rows of 1 or 3 channels with 8 or 16 bits. */
static void read_pixels(reading *r, png_structp png, png_infop info)
{
    igi_photo *photo = r->photo;
    size_t width = (size_t)photo->width * (size_t)photo->channels, height = (size_t)photo->height;
    size_t bytes = photo->levels == 256 ? 1 : 2;
    if (png_get_rowbytes(png, info) != width * bytes) png_error(png, "unexpected row size");
    r->status = IGI_ALLOC(r->ctx, height, &r->rows);
    if (r->status == IGI_OK && bytes == 1)
        r->status = IGI_ALLOC(r->ctx, width * height, &r->buffer);
    if (r->status != IGI_OK) longjmp(r->out, 1);
    for (size_t y = 0; y < height; y++)
        r->rows[y] = bytes == 1 ? r->buffer + y * width : (png_bytep)(photo->codes + y * width);
    png_read_image(png, r->rows);
    if (bytes == 1)
        for (size_t i = 0; i < width * height; i++) photo->codes[i] = r->buffer[i];
}

/* False after stop(): the reason is in r->status. */
static bool decode(reading *r, png_structp png, png_infop info, FILE *file)
{
    static const union {
        uint16_t word;
        uint8_t byte;
    } endian = {1};
    if (setjmp(r->out)) return false;
    png_init_io(png, file);
    png_read_info(png, info);
    png_byte type = png_get_color_type(png, info), depth = png_get_bit_depth(png, info);
    png_set_expand(png); /* palettes, few bits and tRNS become 8 bits and alpha */
    png_set_strip_alpha(png);
    if (depth == 16 && endian.byte) png_set_swap(png);
    png_set_interlace_handling(png);
    png_read_update_info(png, info);
    bool grey = type == PNG_COLOR_TYPE_GRAY || type == PNG_COLOR_TYPE_GRAY_ALPHA;
    const double size[2] = {png_get_image_width(png, info), png_get_image_height(png, info)};
    r->status = igi_photo_shape(r->ctx, r->path, size, grey ? 1 : 3, depth == 16 ? 65536 : 256,
                                r->pixels, r->photo);
    if (r->status != IGI_OK) return false;
    if (r->pixels) {
        read_pixels(r, png, info);
        png_read_end(png, info);
    }
    read_metadata(r, png, info);
    return true;
}

igi_status igi_photo_read_png(igi_context *ctx, const char *path, FILE *file, bool pixels,
                              igi_photo *photo)
{
    reading r = {.ctx = ctx, .path = path, .photo = photo, .pixels = pixels};
    png_structp png = png_create_read_struct(PNG_LIBPNG_VER_STRING, &r, stop, ignore);
    png_infop info = png ? png_create_info_struct(png) : NULL;
    igi_status status = IGI_OK;
    if (!info) status = igi_fail(ctx, IGI_E_SYSTEM, "%s: no memory to read it", path);
    else if (!decode(&r, png, info, file)) status = r.status;
    png_destroy_read_struct(&png, &info, NULL);
    igi_free(r.buffer);
    igi_free(r.rows);
    return status;
}
