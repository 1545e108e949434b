/* SPDX-License-Identifier: Apache-2.0
 *
 * OpenEXR's ZIP compression by libdeflate, for exr_save.c.
 */
#ifndef IGI_SRC_IMAGE_EXR_DEFLATE_H
#define IGI_SRC_IMAGE_EXR_DEFLATE_H

#include "base/context.h"

#include <openexr.h>

/* What a pipeline compresses with, as its encoding_user_data; all zero at first but context and
 * level. */
typedef struct igi_exr_deflater {
    igi_context *ctx;
    int level; /* libdeflate's */
    struct libdeflate_compressor *compressor;
    uint8_t *ordered, *compressed; /* each [size] */
    size_t size;
} igi_exr_deflater;

/* For exr_encode_pipeline_t.compress_fn. */
exr_result_t igi_exr_deflate(exr_encode_pipeline_t *pipeline);
/* Before the pipeline is destroyed. */
void igi_exr_deflater_free(igi_exr_deflater *deflater, exr_encode_pipeline_t *pipeline);

#endif
