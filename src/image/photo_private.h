/* SPDX-License-Identifier: Apache-2.0
 *
 * The readers behind igi_photo_load. Each takes an open file at its beginning and fills *photo;
 * with `pixels` false, all but the codes.
 */
#ifndef IGI_SRC_IMAGE_PHOTO_PRIVATE_H
#define IGI_SRC_IMAGE_PHOTO_PRIVATE_H

#include <igi/photo.h>

#include <stdio.h>

typedef igi_status (*igi_photo_reader)(igi_context *ctx, const char *path, FILE *file, bool pixels,
                                       igi_photo *photo);

igi_status igi_photo_read_jpeg(igi_context *ctx, const char *path, FILE *file, bool pixels,
                               igi_photo *photo);
igi_status igi_photo_read_png(igi_context *ctx, const char *path, FILE *file, bool pixels,
                              igi_photo *photo);
igi_status igi_photo_read_tiff(igi_context *ctx, const char *path, FILE *file, bool pixels,
                               igi_photo *photo);
igi_status igi_photo_read_raw(igi_context *ctx, const char *path, FILE *file, bool pixels,
                              igi_photo *photo);

/* Checks the size that a header claims, sets it, and makes room for the codes. */
igi_status igi_photo_shape(igi_context *ctx, const char *path, const double size[2], int channels,
                           int levels, bool pixels, igi_photo *photo);
/* The sentence for a file that its library cannot read. */
igi_status igi_photo_broken(igi_context *ctx, const char *path, const char *kind,
                            const char *message);
/* What an EXIF block ("Exif\0\0" first) says. Damaged blocks say nothing. */
void igi_photo_read_exif(const unsigned char *block, size_t size, igi_photo *photo);

#endif
