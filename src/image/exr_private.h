/* SPDX-License-Identifier: Apache-2.0
 *
 * What opening an OpenEXR file and reading its pixels share; for exr_open.c and exr_load.c.
 */
#ifndef IGI_SRC_IMAGE_EXR_PRIVATE_H
#define IGI_SRC_IMAGE_EXR_PRIVATE_H

#include "base/context.h"
#include "image/image_private.h"

#include <openexr.h>

#define IGI_EXR_MAX_CHANNELS (IGI_MAX_BANDS + 1)

/* The attribute of igi_image.deviation, a float. */
#define IGI_EXR_DEVIATION "igiDeviation"

/* Where the bytes come from: a file, or memory when fd < 0. */
typedef struct igi_exr_source {
    const char *name;
    int fd;
    const uint8_t *bytes;
    uint64_t size;
    bool photograph;   /* nobody saw what lies outside the data window */
    char message[200]; /* OpenEXR's last word */
} igi_exr_source;

typedef struct igi_exr_window {
    int x, y, width, height;
} igi_exr_window;

/* What the header says. */
typedef struct igi_exr_layout {
    igi_exr_window data, display;
    bool tiled, luma_chroma, rgb;
    int channels;
    char names[IGI_EXR_MAX_CHANNELS][IGI_CHANNEL_NAME_SIZE];
    /* Of each channel, in the file's order: where it goes, and its subsampling. */
    int slot[IGI_EXR_MAX_CHANNELS];
    int x_step[IGI_EXR_MAX_CHANNELS], y_step[IGI_EXR_MAX_CHANNELS];
    igi_chromaticities chromaticities;
    bool has_chromaticities;
    float deviation;
} igi_exr_layout;

/* Opens the file at `path` for igi_exr_open; from->fd is then the caller's to close. */
IGI_MUST_USE igi_status igi_exr_open_file(igi_context *ctx, const char *path, igi_exr_source *from);
/* *file is the caller's, for exr_finish, and uses `from` as long as it lives. */
IGI_MUST_USE igi_status igi_exr_open(igi_context *ctx, igi_exr_source *from, exr_context_t *file);
/* Everything that the header claims is held against igi's limits here. */
IGI_MUST_USE igi_status igi_exr_read_header(igi_context *ctx, const igi_exr_source *from,
                                            exr_context_t file, igi_exr_layout *out);
igi_status igi_exr_fail(igi_context *ctx, const igi_exr_source *from, exr_result_t code);

/* For functions with `ctx` and `from`. */
#define TRY_EXR(call)                                                        \
    do {                                                                     \
        exr_result_t code_ = (call);                                         \
        if (code_ != EXR_ERR_SUCCESS) return igi_exr_fail(ctx, from, code_); \
    } while (0)

#endif
