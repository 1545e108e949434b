/* SPDX-License-Identifier: Apache-2.0
 *
 * Raw photographs through LibRaw: black level subtracted, linear, the same daylight white balance
 * and the same scale for every image of a camera, so that a set shares one unit. Whatever LibRaw
 * does not know may be a TIFF.
 */
#include "base/context.h"
#include "image/photo_private.h"

#include <libraw/libraw.h>

#include <string.h>
#include <unistd.h>

static void develop_plainly(libraw_output_params_t *params)
{
    params->output_bps = 16;
    params->gamm[0] = params->gamm[1] = 1;
    params->no_auto_bright = 1;
    params->adjust_maximum_thr = 0; /* else the white level follows the brightest pixel */
    params->use_camera_wb = params->use_auto_wb = 0;
    params->output_color = 1;
    params->user_flip = 0;
    params->highlight = 0;
}

static igi_status copy_pixels(igi_context *ctx, const char *path, libraw_data_t *raw,
                              igi_photo *photo)
{
    int code = libraw_unpack(raw);
    if (code == LIBRAW_SUCCESS) code = libraw_dcraw_process(raw);
    libraw_processed_image_t *image = NULL;
    if (code == LIBRAW_SUCCESS) image = libraw_dcraw_make_mem_image(raw, &code);
    if (!image) return igi_photo_broken(ctx, path, "raw photograph", libraw_strerror(code));
    igi_status status = IGI_OK;
    const double size[2] = {image->width, image->height};
    if (image->type != LIBRAW_IMAGE_BITMAP || image->bits != 16 || image->colors != 3)
        status = igi_photo_broken(ctx, path, "raw photograph", "it has not three colours");
    else status = igi_photo_shape(ctx, path, size, 3, 65536, true, photo);
    if (status == IGI_OK)
        memcpy(photo->codes, image->data,
               (size_t)photo->width * (size_t)photo->height * 3 * sizeof *photo->codes);
    libraw_dcraw_clear_mem(image);
    return status;
}

igi_status igi_photo_read_raw(igi_context *ctx, const char *path, FILE *file, bool pixels,
                              igi_photo *photo)
{
    igi_status status = IGI_OK;
    libraw_data_t *raw = libraw_init(0);
    if (!raw) return igi_fail(ctx, IGI_E_SYSTEM, "%s: no memory to read it", path);
    /* Without handlers LibRaw writes to stderr. */
    libraw_set_dataerror_handler(raw, NULL, NULL);
    int code = libraw_open_file(raw, path);
    if (code != LIBRAW_SUCCESS) {
        libraw_close(raw);
        return igi_photo_read_tiff(ctx, path, file, pixels, photo);
    }
    develop_plainly(&raw->params);
    photo->linear = true;
    /* LibRaw's numbers: half a turn, a quarter to the left, to the right. */
    photo->orientation = raw->sizes.flip == 3   ? 3
                         : raw->sizes.flip == 5 ? 8
                         : raw->sizes.flip == 6 ? 6
                                                : 1;
    photo->time_s = (double)raw->other.shutter;
    photo->f_number = (double)raw->other.aperture;
    photo->iso = (double)raw->other.iso_speed;
    photo->focal_mm = (double)raw->other.focal_len;
    snprintf(photo->camera, sizeof photo->camera, "%.63s", raw->idata.model);
    snprintf(photo->lens, sizeof photo->lens, "%.63s", raw->lens.Lens);
    const double size[2] = {raw->sizes.iwidth, raw->sizes.iheight};
    status = igi_photo_shape(ctx, path, size, 3, 65536, false, photo);
    if (status == IGI_OK && pixels) status = copy_pixels(ctx, path, raw, photo);
    libraw_close(raw);
    return status;
}
