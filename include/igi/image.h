/* SPDX-License-Identifier: Apache-2.0
 *
 * Images: linear float samples with named channels.
 */
#ifndef IGI_IMAGE_H
#define IGI_IMAGE_H

#include <igi/base.h>

#ifdef __cplusplus
extern "C" {
#endif

#define IGI_CHANNEL_NAME_SIZE 32

/* samples[height][width][channels], row 0 at the top, linear; radiance in W m^-2 sr^-1 per band
 * where it is a photograph. Channels R, G, B (and A) stand in that order; other channels follow
 * in the order of their names. */
typedef struct igi_image {
    int width, height; /* pixels, >= 1 */
    int channels;      /* 1..IGI_MAX_BANDS + 1 */
    char names[IGI_MAX_BANDS + 1][IGI_CHANNEL_NAME_SIZE];
    float *samples;
    float
        deviation; /* standard deviation of its samples against each other beyond noise, relative: what
                      * a recovered response leaves open (igi_response); 0: none is known. Files keep it */
} igi_image;

/* A zeroed image of the given size; names are R G B A for 3 or 4 channels, Y for one, else
 * "band00".. in order. IGI_E_SYSTEM when the memory does not suffice. */
IGI_API IGI_MUST_USE igi_status igi_image_create(igi_context *context, int width, int height,
                                                 int channels, igi_image **image);
IGI_API void igi_image_destroy(igi_image *image);

/* Reads an OpenEXR file: half, float or uint channels, any compression, scan lines or tiles (the
 * full-resolution level), the first part of several. The image has the size of the *display*
 * window; pixels outside the data window are 0. Luminance-chroma (Y, RY, BY) becomes R G B;
 * a lone Y stays one channel; CIE XYZ or other primaries in `chromaticities` are converted to
 * Rec.709 (D65). Deep data, and more than IGI_MAX_BANDS + 1 channels, are refused (IGI_E_DATA). */
IGI_API IGI_MUST_USE igi_status igi_image_load_exr(igi_context *context, const char *path,
                                                   igi_image **image);
/* The same of a photograph: nobody saw what lies outside the data window. It is NaN, also in a channel
 * "saturated", which is added where a data window is smaller and the file has none (0 inside). */
IGI_API IGI_MUST_USE igi_status igi_image_load_photograph(igi_context *context, const char *path,
                                                          igi_image **image);

/* Size and channel count from the header alone, as igi_image_load_exr would return them. *bands:
 * the channels but for alpha ("A") and what merging adds ("saturated", "variance.*"). */
IGI_API IGI_MUST_USE igi_status igi_image_probe_exr(igi_context *context, const char *path,
                                                    int *width, int *height, int *channels,
                                                    int *bands);

typedef enum igi_exr_depth { IGI_EXR_HALF, IGI_EXR_FLOAT } igi_exr_depth;

/* Writes an OpenEXR file (scan lines, ZIP), whole or not at all: beside, then renamed. Of floats, channels
 * that half floats hold to the bit are written as such. */
IGI_API IGI_MUST_USE igi_status igi_image_save_exr(igi_context *context, const igi_image *image,
                                                   igi_exr_depth depth, const char *path);

/* Encodes 8-bit pixels[height][width][channels] (1: grey, 3: RGB, 4: RGBA; already tone-mapped)
 * as PNG in memory. *bytes is the caller's, to be freed with igi_image_free_bytes. */
IGI_API IGI_MUST_USE igi_status igi_image_encode_png(igi_context *context, const uint8_t *pixels,
                                                     int width, int height, int channels,
                                                     uint8_t **bytes, size_t *size);
IGI_API void igi_image_free_bytes(uint8_t *bytes);

#ifdef __cplusplus
}
#endif
#endif
