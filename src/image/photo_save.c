/* SPDX-License-Identifier: Apache-2.0
 *
 * Photographs into PNG files with EXIF.
 */
#include "base/file.h"

#include <igi/photo.h>

#include <libexif/exif-data.h>
#include <png.h>

#include <errno.h>
#include <setjmp.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

typedef struct writing {
    jmp_buf out;
    FILE *file;
    const igi_photo *photo;
    uint8_t *row;
    unsigned char *exif; /* libexif's */
    unsigned int exif_size;
} writing;

static void stop(png_structp png, png_const_charp message)
{
    writing *w = png_get_error_ptr(png);
    (void)message;
    longjmp(w->out, 1);
}

static void ignore(png_structp png, png_const_charp message)
{
    (void)png;
    (void)message;
}

/* An entry of the given format with room for `count` values. */
static ExifEntry *add_entry(ExifData *exif, ExifIfd ifd, ExifTag tag, ExifFormat format,
                            unsigned long count)
{
    ExifMem *memory = exif_mem_new_default();
    ExifEntry *entry = memory ? exif_entry_new_mem(memory) : NULL;
    unsigned int size = (unsigned int)count * exif_format_get_size(format);
    if (entry) {
        entry->tag = tag;
        entry->format = format;
        entry->components = count;
        entry->size = size;
        entry->data = exif_mem_alloc(memory, size);
        if (entry->data) {
            exif_content_add_entry(exif->ifd[ifd], entry);
            exif_entry_unref(entry); /* the content keeps it */
        } else {
            exif_entry_unref(entry);
            entry = NULL;
        }
    }
    exif_mem_unref(memory);
    return entry;
}

static void add_rational(ExifData *exif, ExifTag tag, double value)
{
    if (!(value > 0)) return;
    ExifEntry *entry = add_entry(exif, EXIF_IFD_EXIF, tag, EXIF_FORMAT_RATIONAL, 1);
    double denominator = value < 1 ? 1e9 : value < 4000 ? 1e6 : 1;
    ExifRational rational = {(ExifLong)(value * denominator + .5), (ExifLong)denominator};
    if (entry) exif_set_rational(entry->data, EXIF_BYTE_ORDER_INTEL, rational);
}

static void make_exif(const igi_photo *photo, writing *w)
{
    ExifData *exif = exif_data_new();
    if (!exif) return;
    exif_data_set_byte_order(exif, EXIF_BYTE_ORDER_INTEL);
    add_rational(exif, EXIF_TAG_EXPOSURE_TIME, photo->time_s);
    add_rational(exif, EXIF_TAG_FNUMBER, photo->f_number);
    add_rational(exif, EXIF_TAG_FOCAL_LENGTH, photo->focal_mm);
    if (photo->iso > 0 && photo->iso < 65536) {
        ExifEntry *entry = add_entry(exif, EXIF_IFD_EXIF, EXIF_TAG_ISO_SPEED_RATINGS,
                                     EXIF_FORMAT_SHORT, 1);
        if (entry) exif_set_short(entry->data, EXIF_BYTE_ORDER_INTEL, (ExifShort)photo->iso);
    }
    if (photo->orientation > 1) {
        ExifEntry *entry = add_entry(exif, EXIF_IFD_0, EXIF_TAG_ORIENTATION, EXIF_FORMAT_SHORT, 1);
        if (entry)
            exif_set_short(entry->data, EXIF_BYTE_ORDER_INTEL, (ExifShort)photo->orientation);
    }
    if (photo->camera[0]) {
        size_t length = strlen(photo->camera) + 1;
        ExifEntry *entry = add_entry(exif, EXIF_IFD_0, EXIF_TAG_MODEL, EXIF_FORMAT_ASCII, length);
        if (entry) memcpy(entry->data, photo->camera, length);
    }
    exif_data_save_data(exif, &w->exif, &w->exif_size);
    exif_data_unref(exif);
}

/* False when libpng gave up. */
static bool write_png(writing *w, png_structp png, png_infop info)
{
    const igi_photo *photo = w->photo;
    int depth = photo->levels == 256 ? 8 : 16;
    size_t width = (size_t)photo->width * (size_t)photo->channels;
    if (setjmp(w->out)) return false;
    png_init_io(png, w->file);
    png_set_compression_level(png, 3);
    png_set_filter(png, PNG_FILTER_TYPE_BASE, PNG_FILTER_SUB);
    png_set_IHDR(png, info, (png_uint_32)photo->width, (png_uint_32)photo->height, depth,
                 photo->channels == 1 ? PNG_COLOR_TYPE_GRAY : PNG_COLOR_TYPE_RGB,
                 PNG_INTERLACE_NONE, PNG_COMPRESSION_TYPE_DEFAULT, PNG_FILTER_TYPE_DEFAULT);
    if (w->exif_size > 6) png_set_eXIf_1(png, info, w->exif_size - 6, w->exif + 6); /* "Exif\0\0" */
    png_write_info(png, info);
    for (size_t y = 0; y < (size_t)photo->height; y++) {
        const uint16_t *codes = photo->codes + y * width;
        for (size_t i = 0; i < width; i++) {
            if (depth == 8) {
                w->row[i] = (uint8_t)codes[i];
            } else {
                w->row[2 * i] = (uint8_t)(codes[i] >> 8);
                w->row[2 * i + 1] = (uint8_t)(codes[i] & 255);
            }
        }
        png_write_row(png, w->row);
    }
    png_write_end(png, NULL); /* with `info`, libpng 1.6 writes eXIf once more */
    return true;
}

igi_status igi_photo_save_png(igi_context *ctx, const igi_photo *photo, const char *path)
{
    igi_status status = IGI_OK;
    igi_file file;
    png_structp png = NULL;
    png_infop info = NULL;
    bool written = false;
    writing w = {.photo = photo};
    IGI_TRY_GOTO(IGI_ALLOC(ctx, (size_t)photo->width * (size_t)photo->channels * 2, &w.row));
    IGI_TRY_GOTO(igi_file_begin(ctx, path, &file));
    w.file = file.stream;
    png = png_create_write_struct(PNG_LIBPNG_VER_STRING, &w, stop, ignore);
    if (png) info = png_create_info_struct(png);
    if (info) {
        make_exif(photo, &w);
        written = write_png(&w, png, info);
    }
    status = igi_file_end(ctx, &file, written ? IGI_OK : igi_fail_writing(ctx, path));
cleanup:
    png_destroy_write_struct(&png, &info);
    free(w.exif);
    igi_free(w.row);
    return status;
}
