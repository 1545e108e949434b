/* SPDX-License-Identifier: Apache-2.0
 *
 * OpenEXR files into images, through OpenEXRCore.
 *
 * The "canvas" is an image of the file's data window. Channels of full resolution are decoded
 * straight into it, interleaved; subsampled ones into planes of their own, then spread over it.
 * When data and display window agree, as in almost every photograph, the canvas is the result.
 */
#include "base/context.h"
#include "image/image_private.h"

#include <openexr.h>

#include <errno.h>
#include <fcntl.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

#define MAX_CHANNELS (IGI_MAX_BANDS + 1)

/* Where the bytes come from: a file, or memory when fd < 0. */
typedef struct source {
    const char *name;
    int fd;
    const uint8_t *bytes;
    uint64_t size;
    char message[200]; /* OpenEXR's last word */
} source;

typedef struct window {
    int x, y, width, height;
} window;

/* What the header says. */
typedef struct layout {
    window data, display;
    bool tiled, luma_chroma, rgb;
    int channels;
    char names[MAX_CHANNELS][IGI_CHANNEL_NAME_SIZE];
    int slot[MAX_CHANNELS]; /* of each channel of the file, in the file's order: where it goes */
    int x_step[MAX_CHANNELS], y_step[MAX_CHANNELS]; /* its subsampling */
    igi_chromaticities chromaticities;
    bool has_chromaticities;
} layout;

static int64_t read_bytes(exr_const_context_t file, void *user, void *buffer, uint64_t size,
                          uint64_t offset, exr_stream_error_func_ptr_t error)
{
    (void)file;
    (void)error;
    source *from = user;
    if (offset >= from->size) return 0;
    if (size > from->size - offset) size = from->size - offset;
    if (from->fd < 0) {
        memcpy(buffer, from->bytes + offset, size);
        return (int64_t)size;
    }
    uint64_t done = 0;
    while (done < size) {
        ssize_t n = pread(from->fd, (char *)buffer + done, size - done, (off_t)(offset + done));
        if (n < 0 && errno == EINTR) continue;
        if (n <= 0) break;
        done += (uint64_t)n;
    }
    return (int64_t)done;
}

static int64_t tell_size(exr_const_context_t file, void *user)
{
    (void)file;
    return (int64_t)((source *)user)->size;
}

static void keep_message(exr_const_context_t file, exr_result_t code, const char *message)
{
    (void)code;
    void *user = NULL;
    if (!file || exr_get_user_data(file, &user) != EXR_ERR_SUCCESS || !user) return;
    source *from = user;
    snprintf(from->message, sizeof from->message, "%s", message);
}

static igi_status fail_exr(igi_context *ctx, const source *from, exr_result_t code)
{
    if (code == EXR_ERR_OUT_OF_MEMORY)
        return igi_fail(ctx, IGI_E_SYSTEM, "%s: no memory to decode it; use a smaller image",
                        from->name);
    return igi_fail(ctx, IGI_E_DATA,
                    "%s: not a whole OpenEXR image (%s); export or copy it again", from->name,
                    from->message[0] ? from->message : exr_get_default_error_message(code));
}

#define TRY_EXR(call)                                                    \
    do {                                                                 \
        exr_result_t code_ = (call);                                     \
        if (code_ != EXR_ERR_SUCCESS) return fail_exr(ctx, from, code_); \
    } while (0)

static igi_status open_source(igi_context *ctx, const char *path, source *from)
{
    struct stat about;
    from->name = path;
    from->fd = open(path, O_RDONLY | O_CLOEXEC);
    if (from->fd < 0 || fstat(from->fd, &about) != 0) {
        bool missing = errno == ENOENT || errno == ENOTDIR;
        return igi_fail(ctx, missing ? IGI_E_DATA : IGI_E_SYSTEM,
                        "%s: cannot be opened (%s); check the name and the permissions", path,
                        strerror(errno));
    }
    if (!S_ISREG(about.st_mode))
        return igi_fail(ctx, IGI_E_DATA, "%s: not a file; name an OpenEXR image", path);
    from->size = (uint64_t)about.st_size;
    return IGI_OK;
}

static igi_status open_exr(igi_context *ctx, source *from, exr_context_t *file)
{
    exr_context_initializer_t options = EXR_DEFAULT_CONTEXT_INITIALIZER;
    options.error_handler_fn = keep_message;
    options.user_data = from;
    options.read_fn = read_bytes;
    options.size_fn = tell_size;
    options.max_image_width = options.max_image_height = IGI_IMAGE_MAX_SIDE;
    options.max_tile_width = options.max_tile_height = IGI_IMAGE_MAX_SIDE;
    TRY_EXR(exr_start_read(file, from->name, &options));
    return IGI_OK;
}

static igi_status read_window(igi_context *ctx, const source *from, exr_attr_box2i_t box,
                              const char *what, window *out)
{
    int64_t width = (int64_t)box.max.x - box.min.x + 1, height = (int64_t)box.max.y - box.min.y + 1;
    if (width < 1 || height < 1 || width > IGI_IMAGE_MAX_SIDE || height > IGI_IMAGE_MAX_SIDE)
        return igi_fail(ctx, IGI_E_DATA,
                        "%s: its %s window has %lld x %lld pixels; the sides of an image are 1 to "
                        "%d",
                        from->name, what, (long long)width, (long long)height, IGI_IMAGE_MAX_SIDE);
    *out = (window){box.min.x, box.min.y, (int)width, (int)height};
    return IGI_OK;
}

/* The length of the one layer's prefix ("diffuse." in "diffuse.R") whose R, G and B stand for the
 * picture: 0 when bare R, G, B exist or no layer has all three; -1 when several have. */
static int layer_prefix(const exr_attr_chlist_t *list, int *example)
{
    int found = -2;
    for (int i = 0; i < list->num_channels; i++) {
        const char *name = list->entries[i].name.str;
        size_t length = strlen(name);
        if (length < 1 || name[length - 1] != 'R' || (length > 1 && name[length - 2] != '.'))
            continue;
        int complete = 0;
        for (int j = 0; j < list->num_channels; j++) {
            const char *other = list->entries[j].name.str;
            if (strlen(other) != length || strncmp(other, name, length - 1) != 0) continue;
            complete += other[length - 1] == 'G' || other[length - 1] == 'B';
        }
        if (complete != 2) continue;
        if (length == 1) return 0;
        *example = i;
        found = found == -2 ? (int)length - 1 : -1;
    }
    return found == -2 ? 0 : found;
}

static bool has_channel(const exr_attr_chlist_t *list, const char *name)
{
    for (int i = 0; i < list->num_channels; i++)
        if (strcmp(list->entries[i].name.str, name) == 0) return true;
    return false;
}

/* The order in which channels stand: R G B, or a lone Y, then A, then the others by name. */
static int rank(const char *name, const char *first)
{
    const char *at = name[0] && !name[1] ? strchr(first, name[0]) : NULL;
    return at ? (int)(at - first) : (int)strlen(first);
}

static igi_status arrange_channels(igi_context *ctx, const source *from,
                                   const exr_attr_chlist_t *list, layout *out)
{
    int ranks[MAX_CHANNELS], example = 0;
    int count = list->num_channels, prefix = layer_prefix(list, &example);
    if (count < 1 || count > MAX_CHANNELS)
        return igi_fail(ctx, IGI_E_DATA, "%s: it has %d channels; export 1 to %d of them",
                        from->name, count, MAX_CHANNELS);
    if (prefix < 0)
        return igi_fail(ctx, IGI_E_DATA,
                        "%s: several layers have R, G and B (one is '%s'); export one layer",
                        from->name, list->entries[example].name.str);
    const char *base = list->entries[example].name.str;
    out->luma_chroma = has_channel(list, "Y") && has_channel(list, "RY") &&
                       has_channel(list, "BY") && !has_channel(list, "G");
    for (int i = 0; i < count; i++) {
        const exr_attr_chlist_entry_t *entry = &list->entries[i];
        const char *name = entry->name.str;
        if (entry->x_sampling < 1 || entry->y_sampling < 1 || entry->x_sampling > 64 ||
            entry->y_sampling > 64)
            return igi_fail(ctx, IGI_E_DATA, "%s: channel %s is subsampled %d x %d; at most 64",
                            from->name, name, entry->x_sampling, entry->y_sampling);
        out->x_step[i] = entry->x_sampling;
        out->y_step[i] = entry->y_sampling;
        if (prefix > 0 && strncmp(name, base, (size_t)prefix) == 0) name += prefix;
        if (out->luma_chroma) /* each chroma takes the place of the colour it becomes */
            name = strcmp(name, "RY") == 0 ? "R" : strcmp(name, "BY") == 0 ? "B"
                   : strcmp(name, "Y") == 0 ? "G" : name;
        ranks[i] = rank(name, "RGBYA");
        out->slot[i] = 0;
        for (int j = 0; j < i; j++) /* the file's order is by name: equal ranks keep it */
            if (ranks[j] <= ranks[i]) out->slot[i]++;
            else out->slot[j]++;
        snprintf(out->names[i], IGI_CHANNEL_NAME_SIZE, "%s", name);
    }
    out->channels = count;
    out->rgb = out->luma_chroma || prefix > 0 ||
               (has_channel(list, "R") && has_channel(list, "G") && has_channel(list, "B"));
    return IGI_OK;
}

static igi_status read_header(igi_context *ctx, const source *from, exr_context_t file,
                              layout *out)
{
    exr_storage_t storage;
    exr_attr_box2i_t box;
    const exr_attr_chlist_t *list;
    const exr_attribute_t *attribute;
    memset(out, 0, sizeof *out);
    TRY_EXR(exr_get_storage(file, 0, &storage));
    if (storage != EXR_STORAGE_SCANLINE && storage != EXR_STORAGE_TILED)
        return igi_fail(ctx, IGI_E_DATA,
                        "%s: it holds deep data (several samples a pixel); flatten it first",
                        from->name);
    out->tiled = storage == EXR_STORAGE_TILED;
    TRY_EXR(exr_get_data_window(file, 0, &box));
    IGI_TRY(read_window(ctx, from, box, "data", &out->data));
    TRY_EXR(exr_get_display_window(file, 0, &box));
    IGI_TRY(read_window(ctx, from, box, "display", &out->display));
    TRY_EXR(exr_get_channels(file, 0, &list));
    IGI_TRY(arrange_channels(ctx, from, list, out));
    size_t data = (size_t)out->data.width * (size_t)out->data.height;
    size_t display = (size_t)out->display.width * (size_t)out->display.height;
    if ((data > display ? data : display) > IGI_IMAGE_MAX_SAMPLES / (size_t)out->channels)
        return igi_fail(ctx, IGI_E_DATA,
                        "%s: %d x %d pixels with %d channels are more than igi reads; scale it "
                        "down",
                        from->name, out->data.width, out->data.height, out->channels);
    out->chromaticities = igi_rec709;
    if (exr_get_attribute_by_name(file, 0, "chromaticities", &attribute) == EXR_ERR_SUCCESS &&
        attribute->type == EXR_ATTR_CHROMATICITIES) {
        const exr_attr_chromaticities_t *c = attribute->chromaticities;
        out->has_chromaticities = true;
        out->chromaticities = (igi_chromaticities){{{(double)c->red_x, (double)c->red_y},
                                                    {(double)c->green_x, (double)c->green_y},
                                                    {(double)c->blue_x, (double)c->blue_y},
                                                    {(double)c->white_x, (double)c->white_y}}};
    }
    return IGI_OK;
}

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
    const source *from;
    exr_context_t file;
    const layout *layout;
    igi_image *canvas;
    float *planes[MAX_CHANNELS];
    exr_decode_pipeline_t pipeline;
    bool ready;
} decoding;

/* Points each channel of the pipeline at where its samples go; false when the chunk does not lie
 * within the data window. x, y: of its first pixel, relative to the window. */
static bool aim(decoding *d, int x, int y, int width, int height)
{
    const layout *l = d->layout;
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

/* OpenEXRCore 3.1 has a shortcut for four interleaved channels of half that hands them out in
 * reverse. While it chooses, the channels stand in an order that it does not know as interleaved,
 * so that it takes its general way. */
static exr_result_t choose_routines(decoding *d)
{
    exr_coding_channel_info_t *c = d->pipeline.channels;
    uint8_t *second = d->pipeline.channel_count == 4 ? c[1].decode_to_ptr : NULL;
    if (second) c[1].decode_to_ptr = c[2].decode_to_ptr, c[2].decode_to_ptr = second;
    exr_result_t code = exr_decoding_choose_default_routines(d->file, 0, &d->pipeline);
    if (second) c[2].decode_to_ptr = c[1].decode_to_ptr, c[1].decode_to_ptr = second;
    return code;
}

static igi_status decode_chunk(igi_context *ctx, decoding *d, const exr_chunk_info_t *chunk, int x,
                               int y)
{
    const source *from = d->from;
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
    const source *from = d->from;
    const window *data = &d->layout->data;
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
    const source *from = d->from;
    const window *data = &d->layout->data;
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
    const layout *l = d->layout;
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
            *to = (1 - fy) * ((1 - fx) * a[c0] + fx * a[c1]) +
                  fy * ((1 - fx) * b[c0] + fx * b[c1]);
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

static igi_status convert_colours(igi_context *ctx, const source *from, const layout *l,
                                  igi_image *canvas)
{
    double to_xyz[3][3], m[3][3];
    if (!l->rgb || (!l->luma_chroma && !l->has_chromaticities)) return IGI_OK;
    if (!igi_rgb_to_xyz(&l->chromaticities, to_xyz) ||
        !igi_rgb_to_rec709(&l->chromaticities, m) || !(to_xyz[1][1] > 0))
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

/* The display window's part of the canvas, on black. */
static igi_status crop(igi_context *ctx, const layout *l, const igi_image *canvas,
                       igi_image **image)
{
    IGI_TRY(igi_image_create(ctx, l->display.width, l->display.height, l->channels, image));
    int64_t left = (int64_t)l->data.x - l->display.x, top = (int64_t)l->data.y - l->display.y;
    int64_t x0 = left > 0 ? left : 0, x1 = left + l->data.width;
    if (x1 > l->display.width) x1 = l->display.width;
    for (int64_t y = top > 0 ? top : 0; y < top + l->data.height && y < l->display.height; y++)
        if (x1 > x0)
            memcpy((*image)->samples + (y * l->display.width + x0) * l->channels,
                   canvas->samples + ((y - top) * l->data.width + x0 - left) * l->channels,
                   (size_t)(x1 - x0) * (size_t)l->channels * sizeof(float));
    return IGI_OK;
}

static igi_status decode(igi_context *ctx, const source *from, exr_context_t file,
                         const layout *l, igi_image *canvas)
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

static igi_status load(igi_context *ctx, source *from, igi_image **image)
{
    igi_status status = IGI_OK;
    exr_context_t file = NULL;
    igi_image *canvas = NULL, *made = NULL;
    layout l;
    IGI_TRY_GOTO(open_exr(ctx, from, &file));
    IGI_TRY_GOTO(read_header(ctx, from, file, &l));
    IGI_TRY_GOTO(igi_image_create(ctx, l.data.width, l.data.height, l.channels, &canvas));
    IGI_TRY_GOTO(decode(ctx, from, file, &l, canvas));
    if (memcmp(&l.data, &l.display, sizeof l.data) == 0) {
        made = canvas;
        canvas = NULL;
    } else {
        IGI_TRY_GOTO(crop(ctx, &l, canvas, &made));
    }
    for (int i = 0; i < l.channels; i++)
        memcpy(made->names[l.slot[i]], l.names[i], IGI_CHANNEL_NAME_SIZE);
    *image = made;
cleanup:
    if (file) exr_finish(&file);
    igi_image_destroy(canvas);
    return status;
}

igi_status igi_exr_load_memory(igi_context *ctx, const char *name, const uint8_t *bytes,
                               size_t size, igi_image **image)
{
    source from = {.name = name, .fd = -1, .bytes = bytes, .size = size};
    *image = NULL;
    return load(ctx, &from, image);
}

igi_status igi_image_load_exr(igi_context *ctx, const char *path, igi_image **image)
{
    source from = {.fd = -1};
    *image = NULL;
    igi_status status = open_source(ctx, path, &from);
    if (status == IGI_OK) status = load(ctx, &from, image);
    if (from.fd >= 0) close(from.fd);
    return status;
}

igi_status igi_image_probe_exr(igi_context *ctx, const char *path, int *width, int *height,
                               int *channels)
{
    igi_status status = IGI_OK;
    exr_context_t file = NULL;
    source from = {.fd = -1};
    layout l;
    *width = *height = *channels = 0;
    IGI_TRY_GOTO(open_source(ctx, path, &from));
    IGI_TRY_GOTO(open_exr(ctx, &from, &file));
    IGI_TRY_GOTO(read_header(ctx, &from, file, &l));
    *width = l.display.width;
    *height = l.display.height;
    *channels = l.channels;
cleanup:
    if (file) exr_finish(&file);
    if (from.fd >= 0) close(from.fd);
    return status;
}
