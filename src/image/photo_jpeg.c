/* SPDX-License-Identifier: Apache-2.0
 *
 * JPEG photographs through libjpeg. Missing or damaged data is an error here: libjpeg itself would
 * fill it with grey, which is no measurement.
 */
#include "base/context.h"
#include "image/photo_private.h"

#include <jpeglib.h>
#include <jerror.h>

#include <setjmp.h>
#include <string.h>

typedef struct reading {
    struct jpeg_error_mgr errors; /* first: libjpeg hands it back */
    struct jpeg_progress_mgr progress;
    jmp_buf out;
    igi_context *ctx;
    const char *path;
    igi_photo *photo;
    bool pixels;
    igi_status status;
    JSAMPLE *row;
} reading;

static void stop(j_common_ptr jpeg)
{
    reading *r = (reading *)jpeg->err;
    char message[JMSG_LENGTH_MAX];
    jpeg->err->format_message(jpeg, message);
    if (r->status == IGI_OK) r->status = igi_photo_broken(r->ctx, r->path, "JPEG file", message);
    longjmp(r->out, 1);
}

static void hear(j_common_ptr jpeg, int level)
{
    if (level >= 0) return;
    int code = jpeg->err->msg_code;
    if (code == JWRN_JPEG_EOF || code == JWRN_HIT_MARKER || code == JWRN_HUFF_BAD_CODE) stop(jpeg);
}

/* A progressive file may hold thousands of scans of a huge image, seconds of work each. */
static void watch(j_common_ptr jpeg)
{
    if (jpeg->is_decompressor && ((j_decompress_ptr)jpeg)->input_scan_number > 200) {
        jpeg->err->msg_code = JERR_BAD_PROGRESSION;
        stop(jpeg);
    }
}

static void read_metadata(reading *r, const struct jpeg_decompress_struct *jpeg)
{
    for (jpeg_saved_marker_ptr m = jpeg->marker_list; m; m = m->next)
        if (m->marker == JPEG_APP0 + 1 && m->data_length > 6 && memcmp(m->data, "Exif", 5) == 0) {
            igi_photo_read_exif(m->data, m->data_length, r->photo);
            return;
        }
}

/* False after stop(): the reason is in r->status. */
static bool decode(reading *r, struct jpeg_decompress_struct *jpeg, FILE *file)
{
    if (setjmp(r->out)) return false;
    jpeg_create_decompress(jpeg);
    jpeg->progress = &r->progress;
    jpeg->mem->max_memory_to_use = 1l << 30;
    jpeg_stdio_src(jpeg, file);
    jpeg_save_markers(jpeg, JPEG_APP0 + 1, 0xffff);
    jpeg_read_header(jpeg, TRUE);
    read_metadata(r, jpeg);
    int channels = jpeg->jpeg_color_space == JCS_GRAYSCALE ? 1 : 3;
    const double size[2] = {jpeg->image_width, jpeg->image_height};
    r->status = igi_photo_shape(r->ctx, r->path, size, channels, 256, r->pixels, r->photo);
    if (r->status != IGI_OK) return false;
    if (!r->pixels) return true;
    jpeg->out_color_space = channels == 1 ? JCS_GRAYSCALE : JCS_RGB;
    jpeg->dct_method = JDCT_ISLOW;
    jpeg_start_decompress(jpeg);
    size_t width = (size_t)r->photo->width * (size_t)channels;
    r->status = IGI_ALLOC(r->ctx, width, &r->row);
    if (r->status != IGI_OK) return false;
    for (size_t y = 0; jpeg->output_scanline < jpeg->output_height; y++) {
        jpeg_read_scanlines(jpeg, &r->row, 1);
        uint16_t *to = r->photo->codes + y * width;
        for (size_t i = 0; i < width; i++) to[i] = r->row[i];
    }
    jpeg_finish_decompress(jpeg);
    return true;
}

igi_status igi_photo_read_jpeg(igi_context *ctx, const char *path, FILE *file, bool pixels,
                               igi_photo *photo)
{
    reading r = {.ctx = ctx, .path = path, .photo = photo, .pixels = pixels};
    struct jpeg_decompress_struct jpeg;
    memset(&jpeg, 0, sizeof jpeg);
    jpeg.err = jpeg_std_error(&r.errors);
    r.errors.error_exit = stop;
    r.errors.emit_message = hear;
    r.progress.progress_monitor = watch;
    igi_status status = decode(&r, &jpeg, file) ? IGI_OK : r.status;
    jpeg_destroy_decompress(&jpeg);
    igi_free(r.row);
    return status;
}
