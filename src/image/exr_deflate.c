/* SPDX-License-Identifier: Apache-2.0
 *
 * OpenEXR's ZIP compression by libdeflate, which needs a third of zlib's time. Half of what merging
 * five photographs costs was zlib, trying to compress the noise in the mantissas.
 *
 * The format: the even bytes of a chunk, then the odd ones, each less the one before plus 128, as a
 * zlib stream.
 */
#include "image/exr_deflate.h"

#include <libdeflate.h>

static void order_bytes(const uint8_t *from, size_t size, uint8_t *to)
{
    size_t even = (size + 1) / 2, odd = size / 2;
    uint8_t *second = to + even;
    to[0] = from[0];
    for (size_t i = 1; i < even; i++) to[i] = (uint8_t)(from[2 * i] - from[2 * i - 2] + 128);
    if (odd) second[0] = (uint8_t)(from[1] - from[2 * even - 2] + 128);
    for (size_t i = 1; i < odd; i++) second[i] = (uint8_t)(from[2 * i + 1] - from[2 * i - 1] + 128);
}

static exr_result_t make_room(igi_exr_deflater *d, size_t size)
{
    if (!d->compressor) d->compressor = libdeflate_alloc_compressor(d->level);
    if (!d->compressor) return EXR_ERR_OUT_OF_MEMORY;
    if (d->size >= size) return EXR_ERR_SUCCESS;
    igi_free(d->ordered);
    igi_free(d->compressed);
    d->ordered = igi_calloc(d->ctx, size, 1);
    d->compressed = igi_calloc(d->ctx, size, 1);
    d->size = d->ordered && d->compressed ? size : 0;
    return d->size ? EXR_ERR_SUCCESS : EXR_ERR_OUT_OF_MEMORY;
}

/* A chunk that does not get smaller is stored as it is. One that compressed to just its own size
 * would be taken for that when read (OpenEXR issue 2306, until 3.4.7): there is no room for it. */
exr_result_t igi_exr_deflate(exr_encode_pipeline_t *pipeline)
{
    igi_exr_deflater *d = pipeline->encoding_user_data;
    size_t size = pipeline->packed_bytes;
    exr_result_t code = make_room(d, size);
    if (code != EXR_ERR_SUCCESS) return code;
    order_bytes(pipeline->packed_buffer, size, d->ordered);
    size_t length = libdeflate_zlib_compress(d->compressor, d->ordered, size, d->compressed,
                                             size - 1);
    pipeline->compressed_buffer = length ? d->compressed : pipeline->packed_buffer;
    pipeline->compressed_bytes = length ? length : size;
    pipeline->compressed_alloc_size = 0; /* not the pipeline's to free */
    return EXR_ERR_SUCCESS;
}

void igi_exr_deflater_free(igi_exr_deflater *deflater, exr_encode_pipeline_t *pipeline)
{
    pipeline->compressed_buffer = NULL;
    libdeflate_free_compressor(deflater->compressor);
    igi_free(deflater->ordered);
    igi_free(deflater->compressed);
}
