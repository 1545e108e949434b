/* SPDX-License-Identifier: Apache-2.0
 *
 * Calibrations of other programs: OpenCV's YAML or XML (image_width, image_height, camera_matrix,
 * distortion_coefficients), COLMAP's cameras.txt or cameras.bin. Only the lens passes. OpenCV counts
 * pixels from the first one's centre, COLMAP and igi from its corner.
 */
#include "base/file.h"
#include "bridge/opencv.h"
#include "lens/lens_private.h"
#include "scene/colmap_camera.h"
#include "scene/file_text.h"
#include "scene/frame.h"

#include <stdio.h>

static igi_status take_lens(igi_context *ctx, const char *path, const igi_camera *lens,
                            igi_calibration **calibration)
{
    const char *fault = igi_camera_fault(lens);
    if (fault) return igi_fail(ctx, IGI_E_DATA, "%s: %s; correct it", path, fault);
    IGI_TRY(igi_calibration_create(ctx, lens->width, lens->height, calibration));
    (*calibration)->lens = *lens;
    (*calibration)->has_lens = true;
    return IGI_OK;
}

igi_status igi_calibration_import(igi_context *ctx, const char *path, igi_calibration **calibration)
{
    igi_camera lens = {0};
    *calibration = NULL;
    if (igi_ends_with(path, ".txt") || igi_ends_with(path, ".bin")) {
        IGI_TRY(igi_colmap_read_camera(ctx, path, &lens));
        return take_lens(ctx, path, &lens, calibration);
    }
    if (!igi_calibration_is_opencv(path)) return igi_calibration_load(ctx, path, calibration);
    double p[IGI_CV_PARAMETERS];
    int size[2];
    if (!igi_file_exists(path))
        return igi_fail(ctx, IGI_E_DATA, "%s: no readable file; correct the name", path);
    IGI_TRY(igi_cv_load_lens(ctx, path, size, p));
    lens = (igi_camera){.width = size[0],
                        .height = size[1],
                        .fl_x = p[0],
                        .fl_y = p[1],
                        .cx = p[2] + .5,
                        .cy = p[3] + .5,
                        .k1 = p[4],
                        .k2 = p[5],
                        .p1 = p[6],
                        .p2 = p[7],
                        .k3 = p[8]};
    return take_lens(ctx, path, &lens, calibration);
}

static void write_opencv(FILE *file, const igi_calibration *c)
{
    const igi_camera *l = &c->lens;
    fprintf(file,
            "%%YAML:1.0\n---\nimage_width: %d\nimage_height: %d\n"
            "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n"
            "   data: [ %.17g, 0., %.17g, 0., %.17g, %.17g, 0., 0., 1. ]\n"
            "distortion_coefficients: !!opencv-matrix\n   rows: 5\n   cols: 1\n   dt: d\n"
            "   data: [ %.17g, %.17g, %.17g, %.17g, %.17g ]\n",
            c->width, c->height, l->fl_x, l->cx - .5, l->fl_y, l->cy - .5, l->k1, l->k2, l->p1,
            l->p2, l->k3);
    if (c->rms_px > 0) fprintf(file, "avg_reprojection_error: %.17g\n", c->rms_px);
}

static void write_colmap(FILE *file, const igi_calibration *c)
{
    const igi_camera *l = &c->lens;
    fprintf(file,
            "# CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]\n1 %s %d %d %.17g %.17g %.17g %.17g "
            "%.17g %.17g %.17g %.17g",
            l->k3 != 0 ? "FULL_OPENCV" : "OPENCV", c->width, c->height, l->fl_x, l->fl_y, l->cx,
            l->cy, l->k1, l->k2, l->p1, l->p2);
    if (l->k3 != 0) fprintf(file, " %.17g 0 0 0", l->k3);
    fputs("\n", file);
}

igi_status igi_calibration_export(igi_context *ctx, const igi_calibration *calibration,
                                  const char *path)
{
    bool colmap = igi_ends_with(path, ".txt");
    igi_file file;
    if (!colmap && !igi_calibration_is_opencv(path))
        return igi_calibration_save(ctx, calibration, path);
    if (igi_ends_with(path, ".xml"))
        return igi_fail(ctx, IGI_E_USAGE, "%s: OpenCV's XML is read, not written; name a .yml",
                        path);
    if (!calibration->has_lens)
        return igi_fail(ctx, IGI_E_DATA, "%s: the calibration has no lens to write", path);
    IGI_TRY(igi_file_begin(ctx, path, &file));
    (colmap ? write_colmap : write_opencv)(file.stream, calibration);
    return igi_file_end(ctx, &file, IGI_OK);
}
