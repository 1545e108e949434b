/* SPDX-License-Identifier: Apache-2.0
 *
 * For src/image and its tests.
 */
#ifndef IGI_SRC_IMAGE_PRIVATE_H
#define IGI_SRC_IMAGE_PRIVATE_H

#include <igi/image.h>

/* 1 GiB of floats: an environment map of 16k x 4k in RGBA, or a photograph of 89 megapixels. What
 * a file claims is held against this before anything is allocated. */
#define IGI_IMAGE_MAX_SAMPLES ((size_t)1 << 28)
#define IGI_IMAGE_MAX_SIDE 65535

/* igi_image_load_exr from memory; `name` stands in the sentences. */
IGI_MUST_USE igi_status igi_exr_load_memory(igi_context *ctx, const char *name,
                                            const uint8_t *bytes, size_t size, igi_image **image);

/* CIE 1931 (x,y) of red, green, blue and white. */
typedef struct igi_chromaticities {
    double xy[4][2];
} igi_chromaticities;

/* Row-major m with XYZ = m RGB, luminance of white 1; false when the primaries span no space. */
bool igi_rgb_to_xyz(const igi_chromaticities *chromaticities, double m[3][3]);
/* Row-major m with RGB(Rec.709) = m RGB(of `chromaticities`). No adaptation of the white: the
 * light itself stays what it was. False when the primaries span no space. */
bool igi_rgb_to_rec709(const igi_chromaticities *chromaticities, double m[3][3]);
extern const igi_chromaticities igi_rec709;

#endif
