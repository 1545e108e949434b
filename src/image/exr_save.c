/* SPDX-License-Identifier: Apache-2.0
 *
 * Images into OpenEXR files, whole or not at all: written beside, then renamed.
 */
#include "base/file.h"
#include "image/exr_deflate.h"
#include "image/exr_private.h"

#include <igi/image.h>

#include <openexr.h>

#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* OpenEXRCore would print; what went wrong stands in the status. */
static void stay_silent(exr_const_context_t file, exr_result_t code, const char *message)
{
    (void)file;
    (void)code;
    (void)message;
}

static const float *channel_samples(const igi_image *image, const char *name)
{
    for (int c = 0; c < image->channels; c++)
        if (strcmp(image->names[c], name) == 0) return image->samples + c;
    return NULL;
}

/* Does a half float hold all of a channel, to the bit? Of its 23 bits of mantissa no more than ten are in
 * use then, and it lies between 2^-14 and 2^16, or is 0. */
static bool fits_half(const igi_image *image, const float *samples)
{
    size_t count = (size_t)image->width * (size_t)image->height, step = (size_t)image->channels;
    for (size_t i = 0; i < count; i++) {
        uint32_t bits;
        memcpy(&bits, &samples[i * step], sizeof bits);
        uint32_t exponent = bits >> 23 & 255;
        if (bits & 0x1fff || (bits << 1 && (exponent < 127 - 14 || exponent > 127 + 15)))
            return false;
    }
    return true;
}

static exr_result_t write_header(exr_context_t file, const igi_image *image, igi_exr_depth depth)
{
    int part = 0;
    exr_result_t code = exr_add_part(file, NULL, EXR_STORAGE_SCANLINE, &part);
    if (code == EXR_ERR_SUCCESS)
        code = exr_initialize_required_attr_simple(file, part, image->width, image->height,
                                                   EXR_COMPRESSION_ZIP);
    for (int c = 0; code == EXR_ERR_SUCCESS && c < image->channels; c++) {
        bool half = depth == IGI_EXR_HALF || fits_half(image, image->samples + c);
        code = exr_add_channel(file, part, image->names[c], half ? EXR_PIXEL_HALF : EXR_PIXEL_FLOAT,
                               EXR_PERCEPTUALLY_LOGARITHMIC, 1, 1);
    }
    if (code == EXR_ERR_SUCCESS && image->deviation > 0)
        code = exr_attr_set_float(file, part, IGI_EXR_DEVIATION, image->deviation);
    return code == EXR_ERR_SUCCESS ? exr_write_header(file) : code;
}

static exr_result_t write_pixels(igi_context *ctx, exr_context_t file, const igi_image *image,
                                 igi_exr_depth depth)
{
    exr_encode_pipeline_t pipeline = EXR_ENCODE_PIPELINE_INITIALIZER;
    /* The mantissas of floats are noise, on which effort is lost. */
    igi_exr_deflater deflater = {.ctx = ctx, .level = depth == IGI_EXR_HALF ? 6 : 1};
    int32_t lines = 1;
    size_t pixel = (size_t)image->channels, row = pixel * (size_t)image->width;
    exr_result_t code = exr_get_scanlines_per_chunk(file, 0, &lines);
    for (int y = 0; code == EXR_ERR_SUCCESS && y < image->height; y += lines) {
        exr_chunk_info_t chunk;
        code = exr_write_scanline_chunk_info(file, 0, y, &chunk);
        if (code != EXR_ERR_SUCCESS) break;
        code = y == 0 ? exr_encoding_initialize(file, 0, &chunk, &pipeline)
                      : exr_encoding_update(file, 0, &chunk, &pipeline);
        for (int c = 0; code == EXR_ERR_SUCCESS && c < pipeline.channel_count; c++) {
            exr_coding_channel_info_t *channel = &pipeline.channels[c];
            const float *samples = channel_samples(image, channel->channel_name);
            if (!samples) code = EXR_ERR_INVALID_ARGUMENT;
            else channel->encode_from_ptr = (const uint8_t *)(samples + (size_t)y * row);
            channel->user_pixel_stride = (int32_t)(pixel * sizeof(float));
            channel->user_line_stride = (int32_t)(row * sizeof(float));
            channel->user_bytes_per_element = sizeof(float);
            channel->user_data_type = EXR_PIXEL_FLOAT;
        }
        if (code == EXR_ERR_SUCCESS && y == 0) {
            code = exr_encoding_choose_default_routines(file, 0, &pipeline);
            pipeline.encoding_user_data = &deflater;
            pipeline.compress_fn = igi_exr_deflate;
        }
        if (code == EXR_ERR_SUCCESS) code = exr_encoding_run(file, 0, &pipeline);
    }
    igi_exr_deflater_free(&deflater, &pipeline);
    exr_encoding_destroy(file, &pipeline);
    return code;
}

igi_status igi_image_save_exr(igi_context *ctx, const igi_image *image, igi_exr_depth depth,
                              const char *path)
{
    igi_status status = IGI_OK;
    char *beside = NULL;
    exr_context_t file = NULL;
    exr_context_initializer_t options = EXR_DEFAULT_CONTEXT_INITIALIZER;
    options.error_handler_fn = stay_silent;
    IGI_TRY_GOTO(igi_make_parents(ctx, path));
    IGI_TRY_GOTO(igi_strprintf(ctx, &beside, "%s.%ld.part", path, (long)getpid()));
    errno = 0;
    exr_result_t code = exr_start_write(&file, beside, EXR_WRITE_FILE_DIRECTLY, &options);
    if (code == EXR_ERR_SUCCESS) code = write_header(file, image, depth);
    if (code == EXR_ERR_SUCCESS) code = write_pixels(ctx, file, image, depth);
    if (file) {
        exr_result_t closing = exr_finish(&file);
        if (code == EXR_ERR_SUCCESS) code = closing;
    }
    if (code != EXR_ERR_SUCCESS || rename(beside, path) != 0) {
        status = igi_fail_writing(ctx, path);
        (void)unlink(beside);
    }
cleanup:
    igi_free(beside);
    return status;
}
