/* SPDX-License-Identifier: Apache-2.0
 *
 * Photographs as a camera delivers them: integer codes, and what EXIF says about the exposure.
 */
#ifndef IGI_PHOTO_H
#define IGI_PHOTO_H

#include <igi/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/* codes[height][width][channels], row 0 at the top, as the sensor saw it: an orientation that EXIF
 * asks for is not applied, so that one calibration fits all photographs of a camera, and COLMAP's
 * cameras fit the photographs that it read. Numbers that the file does not state are 0, texts "". */
typedef struct igi_photo {
    int width, height;
    int channels; /* 1 or 3 */
    int levels;   /* codes run from 0 to levels - 1: 256 or 65536 */
    bool linear;  /* codes are proportional to light: developed from a raw file */
    uint16_t *codes;
    int orientation; /* EXIF's: 1 as stored, 3 to be turned by half, 6 and 8 by a quarter to be shown */
    double time_s, f_number, iso, focal_mm;
    char camera[64], lens[64];
} igi_photo;

/* Reads JPEG, PNG, TIFF or a raw file (as LibRaw knows them: linear Rec.709, daylight white
 * balance, so that a set shares one unit). Alpha is dropped, palettes are expanded. */
IGI_API IGI_MUST_USE igi_status igi_photo_load(igi_context *context, const char *path,
                                               igi_photo **photo);
/* The same without pixels: codes is NULL; what the header does not state stays 0. */
IGI_API IGI_MUST_USE igi_status igi_photo_probe(igi_context *context, const char *path,
                                                igi_photo **photo);
/* Writes a PNG of 8 or 16 bits with what the photograph knows of its exposure as EXIF; whole or not
 * at all. */
IGI_API IGI_MUST_USE igi_status igi_photo_save_png(igi_context *context, const igi_photo *photo,
                                                   const char *path);
IGI_API void igi_photo_destroy(igi_photo *photo);

#ifdef __cplusplus
}
#endif
#endif
