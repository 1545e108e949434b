/* SPDX-License-Identifier: Apache-2.0
 *
 * OpenEXR files into images, through OpenEXRCore.
 *
 * The "canvas" is an image of the file's data window. Channels of full resolution are decoded
 * straight into it, interleaved; subsampled ones into planes of their own, then spread over it.
 * When data and display window agree, as in almost every photograph, the canvas is the result.
 */
#include "image/exr_private.h"

#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

static int ceil_div(int a, int b)
{
    return a / b + (a % b > 0);
}

/* How many of `count` pixels from `start` carry a sample when every step-th one does (those whose
 * coordinate divides by step). */
static int sampled(int start, int count, int step)
{
    return ceil_div(start + count, step) - ceil_div(start, step);
}

/* One decoding of one part. planes[i] is NULL for channels of full resolution. */
typedef struct decoding {
    const igi_exr_source *from;
    exr_context_t file;
    const igi_exr_layout *layout;
    igi_image *canvas;
    float *planes[IGI_EXR_MAX_CHANNELS];
    exr_decode_pipeline_t pipeline;
    bool ready;
} decoding;

/* Points each channel of the pipeline at where its samples go; false when the chunk does not lie
 * within the data window. x, y: of its first pixel, relative to the window. */
static bool aim(decoding *d, int x, int y, int width, int height)
{
    const igi_exr_layout *l = d->layout;
    if (x < 0 || y < 0 || width < 1 || height < 1 || width > l->data.width - x ||
        height > l->data.height - y || d->pipeline.channel_count != l->channels)
        return false;
    size_t channels = (size_t)l->channels;
    for (int i = 0; i < l->channels; i++) {
        exr_coding_channel_info_t *channel = &d->pipeline.channels[i];
        size_t row = (size_t)y, column = (size_t)x, row_size = (size_t)l->data.width, step = 1;
        float *to;
        if (d->planes[i]) {
            int xs = l->x_step[i], ys = l->y_step[i];
            row_size = (size_t)sampled(l->data.x, l->data.width, xs);
            row = (size_t)sampled(l->data.y, y, ys);
            column = (size_t)sampled(l->data.x, x, xs);
            if (channel->width < 0 || column + (size_t)channel->width > row_size) return false;
            to = d->planes[i] + row * row_size + column;
        } else {
            if (channel->width > width) return false;
            to = d->canvas->samples + (row * row_size + column) * channels + l->slot[i];
            step = channels;
        }
        channel->decode_to_ptr = (uint8_t *)to;
        channel->user_pixel_stride = (int32_t)(step * sizeof(float));
        channel->user_line_stride = (int32_t)(step * row_size * sizeof(float));
        channel->user_bytes_per_element = sizeof(float);
        channel->user_data_type = EXR_PIXEL_FLOAT;
    }
    return true;
}

/* OpenEXRCore 3.1's fast path from four half channels to interleaved RGBA exchanges R and A
 * (seen in 3.1.5). It is chosen by the order of the pointers: shuffled ones give the plain path. */
static exr_result_t choose_routines(decoding *d)
{
    exr_coding_channel_info_t *channels = d->pipeline.channels;
    bool shuffle = d->layout->channels == 4;
    uint8_t *first = channels[0].decode_to_ptr;
    if (shuffle) {
        channels[0].decode_to_ptr = channels[1].decode_to_ptr;
        channels[1].decode_to_ptr = first;
    }
    exr_result_t code = exr_decoding_choose_default_routines(d->file, 0, &d->pipeline);
    if (shuffle) {
        channels[1].decode_to_ptr = channels[0].decode_to_ptr;
        channels[0].decode_to_ptr = first;
    }
    return code;
}

static igi_status decode_chunk(igi_context *ctx, decoding *d, const exr_chunk_info_t *chunk, int x,
                               int y)
{
    const igi_exr_source *from = d->from;
    if (!d->ready) TRY_EXR(exr_decoding_initialize(d->file, 0, chunk, &d->pipeline));
    else TRY_EXR(exr_decoding_update(d->file, 0, chunk, &d->pipeline));
    if (!aim(d, x, y, chunk->width, chunk->height))
        return igi_fail(ctx, IGI_E_DATA,
                        "%s: a block of pixels lies outside the image; export or copy it again",
                        from->name);
    if (!d->ready) TRY_EXR(choose_routines(d));
    d->ready = true;
    TRY_EXR(exr_decoding_run(d->file, 0, &d->pipeline));
    return IGI_OK;
}

static igi_status decode_scanlines(igi_context *ctx, decoding *d)
{
    const igi_exr_source *from = d->from;
    const igi_exr_window *data = &d->layout->data;
    int32_t lines = 0;
    TRY_EXR(exr_get_scanlines_per_chunk(d->file, 0, &lines));
    if (lines < 1) lines = 1;
    for (int y = 0; y < data->height; y += lines) {
        exr_chunk_info_t chunk;
        TRY_EXR(exr_read_scanline_chunk_info(d->file, 0, data->y + y, &chunk));
        IGI_TRY(decode_chunk(ctx, d, &chunk, 0, y));
    }
    return IGI_OK;
}

static igi_status decode_tiles(igi_context *ctx, decoding *d)
{
    const igi_exr_source *from = d->from;
    const igi_exr_window *data = &d->layout->data;
    int32_t width = 0, height = 0;
    TRY_EXR(exr_get_tile_sizes(d->file, 0, 0, 0, &width, &height));
    if (width < 1 || height < 1)
        return igi_fail(ctx, IGI_E_DATA, "%s: its tiles have no size; export it again", from->name);
    for (int row = 0; row < ceil_div(data->height, height); row++)
        for (int column = 0; column < ceil_div(data->width, width); column++) {
            exr_chunk_info_t chunk;
            TRY_EXR(exr_read_tile_chunk_info(d->file, 0, column, row, 0, 0, &chunk));
            IGI_TRY(decode_chunk(ctx, d, &chunk, column * width, row * height));
        }
    return IGI_OK;
}

/* Spreads a plane that has a sample at each multiple of (xs,ys) over the canvas, linearly. */
static void spread(const decoding *d, int channel)
{
    const igi_exr_layout *l = d->layout;
    const float *plane = d->planes[channel];
    int xs = l->x_step[channel], ys = l->y_step[channel];
    int columns = sampled(l->data.x, l->data.width, xs);
    int rows = sampled(l->data.y, l->data.height, ys);
    int x_first = ceil_div(l->data.x, xs) * xs - l->data.x;
    int y_first = ceil_div(l->data.y, ys) * ys - l->data.y;
    if (columns < 1 || rows < 1) return;
    float *to = d->canvas->samples + l->slot[channel];
    for (int y = 0; y < l->data.height; y++) {
        int r0 = y < y_first ? 0 : (y - y_first) / ys;
        int r1 = r0 + 1 < rows ? r0 + 1 : r0;
        float fy = y < y_first ? 0 : (float)((y - y_first) % ys) / (float)ys;
        for (int x = 0; x < l->data.width; x++, to += l->channels) {
            int c0 = x < x_first ? 0 : (x - x_first) / xs;
            int c1 = c0 + 1 < columns ? c0 + 1 : c0;
            float fx = x < x_first ? 0 : (float)((x - x_first) % xs) / (float)xs;
            const float *a = plane + (size_t)r0 * (size_t)columns;
            const float *b = plane + (size_t)r1 * (size_t)columns;
            *to = (1 - fy) * ((1 - fx) * a[c0] + fx * a[c1]) + fy * ((1 - fx) * b[c0] + fx * b[c1]);
        }
    }
}

/* RY = (R-Y)/Y and BY = (B-Y)/Y, with Y the luminance of the file's own primaries. */
static void unmix_chroma(igi_image *canvas, const double luminance[3])
{
    size_t count = (size_t)canvas->width * (size_t)canvas->height;
    float wr = (float)luminance[0], wg = (float)luminance[1], wb = (float)luminance[2];
    for (float *p = canvas->samples; count--; p += canvas->channels) {
        float y = p[1];
        p[0] = (p[0] + 1) * y;
        p[2] = (p[2] + 1) * y;
        p[1] = (y - wr * p[0] - wb * p[2]) / wg;
    }
}

static igi_status convert_colours(igi_context *ctx, const igi_exr_source *from,
                                  const igi_exr_layout *l, igi_image *canvas)
{
    double to_xyz[3][3], m[3][3];
    if (!l->rgb || (!l->luma_chroma && !l->has_chromaticities)) return IGI_OK;
    if (!igi_rgb_to_xyz(&l->chromaticities, to_xyz) || !igi_rgb_to_rec709(&l->chromaticities, m) ||
        !(to_xyz[1][1] > 0))
        return igi_fail(ctx, IGI_E_DATA,
                        "%s: its chromaticities span no colour space; correct that attribute",
                        from->name);
    if (l->luma_chroma) unmix_chroma(canvas, to_xyz[1]);
    double off = 0;
    for (int i = 0; i < 9; i++) off = fmax(off, fabs(m[i / 3][i % 3] - (i % 4 == 0)));
    if (off < 1e-4) return IGI_OK; /* Rec.709, rounded */
    size_t count = (size_t)canvas->width * (size_t)canvas->height;
    for (float *p = canvas->samples; count--; p += canvas->channels) {
        double r = (double)p[0], g = (double)p[1], b = (double)p[2];
        for (int i = 0; i < 3; i++) p[i] = (float)(m[i][0] * r + m[i][1] * g + m[i][2] * b);
    }
    return IGI_OK;
}

/* Does the image get a channel that marks what lies outside the data window? */
static bool is_marked(const igi_exr_source *from, const igi_exr_layout *l)
{
    for (int i = 0; i < l->channels; i++)
        if (strcmp(l->names[i], "saturated") == 0) return false;
    return from->photograph && l->channels < IGI_EXR_MAX_CHANNELS;
}

/* The display window's part of the canvas; what lies outside is black, or NaN in a photograph, whose
 * mark is 0 elsewhere. */
static igi_status crop(igi_context *ctx, const igi_exr_source *from, const igi_exr_layout *l,
                       const igi_image *canvas, igi_image **image)
{
    size_t channels = (size_t)l->channels, stride = channels + is_marked(from, l);
    IGI_TRY(igi_image_create(ctx, l->display.width, l->display.height, (int)stride, image));
    if (stride > channels) snprintf((*image)->names[channels], IGI_CHANNEL_NAME_SIZE, "saturated");
    float *to = (*image)->samples;
    for (int y = 0; y < l->display.height; y++)
        for (int x = 0; x < l->display.width; x++, to += stride) {
            int64_t column = (int64_t)x + l->display.x - l->data.x;
            int64_t row = (int64_t)y + l->display.y - l->data.y;
            if (column >= 0 && row >= 0 && column < l->data.width && row < l->data.height)
                memcpy(to, canvas->samples + (size_t)(row * l->data.width + column) * channels,
                       channels * sizeof *to);
            else
                for (size_t c = 0; c < stride && from->photograph; c++) to[c] = NAN;
        }
    return IGI_OK;
}

static igi_status decode(igi_context *ctx, const igi_exr_source *from, exr_context_t file,
                         const igi_exr_layout *l, igi_image *canvas)
{
    igi_status status = IGI_OK;
    decoding d = {.from = from, .file = file, .layout = l, .canvas = canvas};
    for (int i = 0; i < l->channels; i++) {
        if (l->x_step[i] == 1 && l->y_step[i] == 1) continue;
        size_t size = (size_t)sampled(l->data.x, l->data.width, l->x_step[i]) *
                      (size_t)sampled(l->data.y, l->data.height, l->y_step[i]);
        IGI_TRY_GOTO(IGI_ALLOC(ctx, size, &d.planes[i]));
    }
    IGI_TRY_GOTO(l->tiled ? decode_tiles(ctx, &d) : decode_scanlines(ctx, &d));
    for (int i = 0; i < l->channels; i++)
        if (d.planes[i]) spread(&d, i);
    IGI_TRY_GOTO(convert_colours(ctx, from, l, canvas));
cleanup:
    exr_decoding_destroy(file, &d.pipeline);
    for (int i = 0; i < l->channels; i++) igi_free(d.planes[i]);
    return status;
}

static igi_status load(igi_context *ctx, igi_exr_source *from, igi_image **image)
{
    igi_status status = IGI_OK;
    exr_context_t file = NULL;
    igi_image *canvas = NULL, *made = NULL;
    igi_exr_layout l;
    IGI_TRY_GOTO(igi_exr_open(ctx, from, &file));
    IGI_TRY_GOTO(igi_exr_read_header(ctx, from, file, &l));
    IGI_TRY_GOTO(igi_image_create(ctx, l.data.width, l.data.height, l.channels, &canvas));
    IGI_TRY_GOTO(decode(ctx, from, file, &l, canvas));
    if (memcmp(&l.data, &l.display, sizeof l.data) == 0) {
        made = canvas;
        canvas = NULL;
    } else {
        IGI_TRY_GOTO(crop(ctx, from, &l, canvas, &made));
    }
    for (int i = 0; i < l.channels; i++)
        memcpy(made->names[l.slot[i]], l.names[i], IGI_CHANNEL_NAME_SIZE);
    made->deviation = l.deviation;
    *image = made;
cleanup:
    if (file) exr_finish(&file);
    igi_image_destroy(canvas);
    return status;
}

igi_status igi_exr_load_memory(igi_context *ctx, const char *name, const uint8_t *bytes,
                               size_t size, igi_image **image)
{
    igi_exr_source from = {.name = name, .fd = -1, .bytes = bytes, .size = size};
    *image = NULL;
    return load(ctx, &from, image);
}

static igi_status load_file(igi_context *ctx, const char *path, bool photograph, igi_image **image)
{
    igi_exr_source from = {.fd = -1, .photograph = photograph};
    *image = NULL;
    igi_status status = igi_exr_open_file(ctx, path, &from);
    if (status == IGI_OK) status = load(ctx, &from, image);
    if (from.fd >= 0) close(from.fd);
    return status;
}

igi_status igi_image_load_exr(igi_context *ctx, const char *path, igi_image **image)
{
    return load_file(ctx, path, false, image);
}

igi_status igi_image_load_photograph(igi_context *ctx, const char *path, igi_image **image)
{
    return load_file(ctx, path, true, image);
}
