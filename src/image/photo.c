/* SPDX-License-Identifier: Apache-2.0
 *
 * Photographs: which reader a file needs, and what EXIF says.
 */
#include "base/context.h"
#include "image/image_private.h"
#include "image/photo_private.h"

#include <libexif/exif-data.h>

#include <errno.h>
#include <string.h>
#include <sys/stat.h>

igi_status igi_photo_shape(igi_context *ctx, const char *path, const double size[2], int channels,
                           int levels, bool pixels, igi_photo *photo)
{
    if (!(size[0] >= 1 && size[1] >= 1 && size[0] <= IGI_IMAGE_MAX_SIDE &&
          size[1] <= IGI_IMAGE_MAX_SIDE &&
          size[0] * size[1] * channels <= (double)IGI_IMAGE_MAX_SAMPLES))
        return igi_fail(ctx, IGI_E_DATA,
                        "%s: %.0f x %.0f pixels are more than igi reads, or none; scale it down",
                        path, size[0], size[1]);
    photo->width = (int)size[0];
    photo->height = (int)size[1];
    photo->channels = channels;
    photo->levels = levels;
    if (!pixels) return IGI_OK;
    size_t count = (size_t)photo->width * (size_t)photo->height * (size_t)channels;
    return IGI_ALLOC(ctx, count, &photo->codes);
}

igi_status igi_photo_broken(igi_context *ctx, const char *path, const char *kind,
                            const char *message)
{
    return igi_fail(ctx, IGI_E_DATA, "%s: not a whole %s (%s); copy or export it again", path, kind,
                    message);
}

static double exif_number(ExifData *exif, ExifTag tag)
{
    ExifEntry *entry = exif_data_get_entry(exif, tag);
    if (!entry || !entry->data) return 0;
    ExifByteOrder order = exif_data_get_byte_order(exif);
    if (entry->format == EXIF_FORMAT_SHORT && entry->size >= 2)
        return exif_get_short(entry->data, order);
    if (entry->format == EXIF_FORMAT_LONG && entry->size >= 4)
        return exif_get_long(entry->data, order);
    if (entry->format == EXIF_FORMAT_RATIONAL && entry->size >= 8) {
        ExifRational value = exif_get_rational(entry->data, order);
        return value.denominator ? (double)value.numerator / value.denominator : 0;
    }
    return 0;
}

static void exif_text(ExifData *exif, ExifTag tag, char *out, size_t size)
{
    ExifEntry *entry = exif_data_get_entry(exif, tag);
    size_t length = 0;
    if (!entry || entry->format != EXIF_FORMAT_ASCII || !entry->data) return;
    while (length + 1 < size && length < entry->size && entry->data[length]) {
        unsigned char c = entry->data[length];
        out[length++] = c >= 32 && c < 127 ? (char)c : '?';
    }
    while (length && out[length - 1] == ' ') length--;
    out[length] = '\0';
}

void igi_photo_read_exif(const unsigned char *block, size_t size, igi_photo *photo)
{
    if (size > 1u << 20) return;
    ExifData *exif = exif_data_new_from_data(block, (unsigned int)size);
    if (!exif) return;
    photo->time_s = exif_number(exif, EXIF_TAG_EXPOSURE_TIME);
    photo->f_number = exif_number(exif, EXIF_TAG_FNUMBER);
    photo->iso = exif_number(exif, EXIF_TAG_ISO_SPEED_RATINGS);
    photo->focal_mm = exif_number(exif, EXIF_TAG_FOCAL_LENGTH);
    double orientation = exif_number(exif, EXIF_TAG_ORIENTATION);
    photo->orientation = orientation >= 1 && orientation <= 8 ? (int)orientation : 0;
    exif_text(exif, EXIF_TAG_MODEL, photo->camera, sizeof photo->camera);
    exif_text(exif, (ExifTag)0xa434, photo->lens, sizeof photo->lens); /* LensModel, EXIF 2.3 */
    exif_data_unref(exif);
}

static igi_photo_reader reader_of(const unsigned char magic[12])
{
    if (magic[0] == 0xff && magic[1] == 0xd8) return igi_photo_read_jpeg;
    if (memcmp(magic, "\x89PNG\r\n\x1a\n", 8) == 0) return igi_photo_read_png;
    return igi_photo_read_raw; /* most raw formats are TIFFs inside: it hands plain TIFFs on */
}

static bool is_radiance(const unsigned char magic[12])
{
    return memcmp(magic, "\x76\x2f\x31\x01", 4) == 0 || memcmp(magic, "#?", 2) == 0;
}

static igi_status read_photo(igi_context *ctx, const char *path, bool pixels, igi_photo **photo)
{
    igi_status status = IGI_OK;
    igi_photo *made = NULL;
    unsigned char magic[12] = {0};
    struct stat about;
    *photo = NULL;
    FILE *file = fopen(path, "rb");
    if (!file || fstat(fileno(file), &about) != 0) {
        bool missing = errno == ENOENT || errno == ENOTDIR;
        status = igi_fail(ctx, missing ? IGI_E_DATA : IGI_E_SYSTEM,
                          "%s: cannot be opened (%s); check the name and the permissions", path,
                          strerror(errno));
        goto cleanup;
    }
    if (!S_ISREG(about.st_mode) || fread(magic, 1, sizeof magic, file) < sizeof magic) {
        status = igi_fail(ctx, IGI_E_DATA,
                          "%s: not a photograph; name a JPEG, PNG, TIFF or raw "
                          "file",
                          path);
        goto cleanup;
    }
    if (is_radiance(magic)) {
        status = igi_fail(ctx, IGI_E_DATA,
                          "%s: holds radiance already; name photographs as the camera wrote them",
                          path);
        goto cleanup;
    }
    rewind(file);
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &made));
    IGI_TRY_GOTO(reader_of(magic)(ctx, path, file, pixels, made));
    *photo = made;
    made = NULL;
cleanup:
    if (file) fclose(file);
    igi_photo_destroy(made);
    return status;
}

igi_status igi_photo_load(igi_context *ctx, const char *path, igi_photo **photo)
{
    return read_photo(ctx, path, true, photo);
}

igi_status igi_photo_probe(igi_context *ctx, const char *path, igi_photo **photo)
{
    return read_photo(ctx, path, false, photo);
}

void igi_photo_destroy(igi_photo *photo)
{
    if (!photo) return;
    igi_free(photo->codes);
    igi_free(photo);
}
