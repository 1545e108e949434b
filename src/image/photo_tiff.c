/* SPDX-License-Identifier: Apache-2.0
 *
 * TIFF photographs through libtiff: 16-bit strips as they stand, everything else through libtiff's
 * own conversion to 8-bit RGB.
 */
#include "base/context.h"
#include "image/photo_private.h"

#include <tiffio.h>

#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

static void read_metadata(TIFF *tiff, igi_photo *photo)
{
    const char *model = NULL;
    toff_t directory = 0;
    uint16_t orientation = 0;
    if (TIFFGetField(tiff, TIFFTAG_ORIENTATION, &orientation) && orientation <= 8)
        photo->orientation = orientation;
    if (TIFFGetField(tiff, TIFFTAG_MODEL, &model) && model)
        snprintf(photo->camera, sizeof photo->camera, "%s", model);
    tdir_t here = TIFFCurrentDirectory(tiff);
    if (!TIFFGetField(tiff, TIFFTAG_EXIFIFD, &directory)) return;
    if (TIFFReadEXIFDirectory(tiff, directory)) {
        float time = 0, aperture = 0, focal = 0;
        uint16_t count = 0, *iso = NULL;
        if (TIFFGetField(tiff, EXIFTAG_EXPOSURETIME, &time)) photo->time_s = (double)time;
        if (TIFFGetField(tiff, EXIFTAG_FNUMBER, &aperture)) photo->f_number = (double)aperture;
        if (TIFFGetField(tiff, EXIFTAG_FOCALLENGTH, &focal)) photo->focal_mm = (double)focal;
        if (TIFFGetField(tiff, EXIFTAG_ISOSPEEDRATINGS, &count, &iso) && count && iso)
            photo->iso = iso[0];
    }
    TIFFSetDirectory(tiff, here);
}

/* Interleaved 16-bit scan lines; `samples` in the file may include alpha. */
static bool read_words(igi_context *ctx, TIFF *tiff, int samples, igi_photo *photo,
                       igi_status *status)
{
    size_t width = (size_t)photo->width, channels = (size_t)photo->channels;
    tmsize_t size = TIFFScanlineSize(tiff);
    uint16_t *row = NULL;
    bool whole = size >= (tmsize_t)(width * (size_t)samples * 2);
    if (whole) *status = IGI_ALLOC(ctx, (size_t)size / 2 + 1, &row);
    for (uint32_t y = 0; whole && row && y < (uint32_t)photo->height; y++) {
        whole = TIFFReadScanline(tiff, row, y, 0) == 1;
        uint16_t *to = photo->codes + (size_t)y * width * channels;
        for (size_t x = 0; whole && x < width; x++)
            for (size_t c = 0; c < channels; c++)
                to[x * channels + c] = row[x * (size_t)samples + c];
    }
    igi_free(row);
    return whole;
}

static bool read_converted(igi_context *ctx, TIFF *tiff, igi_photo *photo, igi_status *status)
{
    size_t pixels = (size_t)photo->width * (size_t)photo->height;
    uint32_t *rgba = NULL;
    uint16_t stored = ORIENTATION_TOPLEFT; /* asking for what it is leaves the rows as they are */
    TIFFGetFieldDefaulted(tiff, TIFFTAG_ORIENTATION, &stored);
    *status = IGI_ALLOC(ctx, pixels, &rgba);
    bool whole = rgba && TIFFReadRGBAImageOriented(tiff, (uint32_t)photo->width,
                                                   (uint32_t)photo->height, rgba, stored, 1) == 1;
    for (size_t i = 0; whole && i < pixels; i++) {
        uint16_t *to = photo->codes + i * (size_t)photo->channels;
        to[0] = (uint16_t)TIFFGetR(rgba[i]);
        if (photo->channels == 1) continue;
        to[1] = (uint16_t)TIFFGetG(rgba[i]);
        to[2] = (uint16_t)TIFFGetB(rgba[i]);
    }
    igi_free(rgba);
    return whole;
}

static igi_status decode(igi_context *ctx, const char *path, TIFF *tiff, bool pixels,
                         igi_photo *photo)
{
    igi_status status = IGI_OK;
    uint32_t width = 0, height = 0;
    uint16_t bits = 1, samples = 1, planes = 1, colours = 0, format = SAMPLEFORMAT_UINT;
    TIFFGetField(tiff, TIFFTAG_IMAGEWIDTH, &width);
    TIFFGetField(tiff, TIFFTAG_IMAGELENGTH, &height);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_BITSPERSAMPLE, &bits);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLESPERPIXEL, &samples);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_PLANARCONFIG, &planes);
    TIFFGetFieldDefaulted(tiff, TIFFTAG_SAMPLEFORMAT, &format);
    TIFFGetField(tiff, TIFFTAG_PHOTOMETRIC, &colours);
    bool grey = colours == PHOTOMETRIC_MINISBLACK;
    bool words = bits == 16 && planes == PLANARCONFIG_CONTIG && !TIFFIsTiled(tiff) &&
                 format == SAMPLEFORMAT_UINT &&
                 (grey ? samples >= 1 : colours == PHOTOMETRIC_RGB && samples >= 3);
    if (bits > 8 && !words)
        return igi_fail(ctx, IGI_E_DATA,
                        "%s: a TIFF of %d bits that is tiled, planar or not of 16-bit integers; "
                        "save it as plain 16-bit RGB, or as OpenEXR",
                        path, bits);
    const double size[2] = {width, height};
    IGI_TRY(igi_photo_shape(ctx, path, size, grey ? 1 : 3, words ? 65536 : 256, pixels, photo));
    read_metadata(tiff, photo);
    if (!pixels) return IGI_OK;
    bool whole = words ? read_words(ctx, tiff, samples, photo, &status)
                       : read_converted(ctx, tiff, photo, &status);
    if (status != IGI_OK) return status;
    return whole ? IGI_OK : igi_photo_broken(ctx, path, "TIFF file", "its pixels end early");
}

igi_status igi_photo_read_tiff(igi_context *ctx, const char *path, FILE *file, bool pixels,
                               igi_photo *photo)
{
    /* libtiff's handlers are the process's: its messages are switched off, the status speaks. */
    TIFFErrorHandler error = TIFFSetErrorHandler(NULL), warning = TIFFSetWarningHandler(NULL);
    int fd = dup(fileno(file)); /* TIFFClose closes it */
    TIFF *tiff = fd >= 0 ? TIFFFdOpen(fd, path, "rm") : NULL;
    igi_status status = tiff ? decode(ctx, path, tiff, pixels, photo)
                             : igi_photo_broken(ctx, path, "photograph",
                                                "neither JPEG, PNG, TIFF nor a known raw format");
    if (tiff) TIFFClose(tiff);
    else if (fd >= 0) close(fd);
    TIFFSetErrorHandler(error);
    TIFFSetWarningHandler(warning);
    return status;
}
