/* SPDX-License-Identifier: Apache-2.0
 *
 * What a lens and a camera do to radiance, measured and undone: distortion, vignetting, response.
 */
#ifndef IGI_LENS_H
#define IGI_LENS_H

#include <igi/hdr.h>
#include <igi/scene.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Transmission relative to that at the centre: V = 1 + k[0] r^2 + k[1] r^4 + k[2] r^6, r the
 * distance from (centre_x, centre_y) in half diagonals of the image. */
typedef struct igi_vignetting {
    bool known;
    double centre_x, centre_y; /* pixels; pixel (0,0) covers [0,1)x[0,1) */
    double k[3];
    double rms;                /* of what the polynomial leaves, relative to the centre */
    double f_number, focal_mm; /* it was measured at; 0: not known */
} igi_vignetting;

typedef struct igi_calibration_view {
    char *file;
    double rms_px;
    bool used; /* false: no board was found (rms_px is 0), or it disagrees with the others */
    /* Corners: place in the photograph, pixels, and how far from where the lens expects it to be. Known
     * while calibrating; no file keeps them. */
    size_t corner_count;
    double (*corners)[4]; /* x y dx dy */
} igi_calibration_view;

typedef struct igi_calibration {
    char *camera;      /* its name by EXIF, "" when not known */
    int width, height; /* pixels of the photographs that it is for */
    bool has_lens;     /* `lens` is known */
    igi_camera lens;   /* without a pose; deviations in the order fl_x fl_y cx cy k1 k2 p1 p2 k3 */
    double deviations[9];
    double rms_px;
    size_t view_count;
    igi_calibration_view *views;
    igi_vignetting vignetting;
    igi_response *response; /* NULL: not known */
} igi_calibration;

/* An empty one, for photographs of the given size. */
IGI_API IGI_MUST_USE igi_status igi_calibration_create(igi_context *context, int width, int height,
                                                       igi_calibration **calibration);
/* calib/NAME.json (schema in calib/README.md). */
IGI_API IGI_MUST_USE igi_status igi_calibration_load(igi_context *context, const char *path,
                                                     igi_calibration **calibration);
IGI_API IGI_MUST_USE igi_status igi_calibration_save(igi_context *context,
                                                     const igi_calibration *calibration,
                                                     const char *path);
/* The same by the file's ending: .yml, .yaml, .xml of OpenCV (image_width, image_height,
 * camera_matrix, distortion_coefficients); cameras.txt, cameras.bin of COLMAP (the first camera);
 * else calib/NAME.json. Of a foreign file there is the lens alone. Written are .yml, .txt, .json. */
IGI_API IGI_MUST_USE igi_status igi_calibration_import(igi_context *context, const char *path,
                                                       igi_calibration **calibration);
IGI_API IGI_MUST_USE igi_status igi_calibration_export(igi_context *context,
                                                       const igi_calibration *calibration,
                                                       const char *path);
IGI_API void igi_calibration_destroy(igi_calibration *calibration);

typedef struct igi_chessboard {
    int columns, rows; /* inner corners */
    double square_m;
    const char *markers; /* of a ChArUco board, as "5X5_100" (OpenCV's name); NULL: it has none */
    double marker_m;     /* side of the markers */
} igi_chessboard;

/* Intrinsics and distortion from photographs of a chessboard, at least three of which must show it
 * whole, or enough of it if it has markers. Views that disagree with the others are found and left out; their
 * rms_px is by the lens of the others. The photographs' size is checked against that of the calibration when *calibration is not NULL; else one is made. */
IGI_API IGI_MUST_USE igi_status igi_calibrate_chessboard(igi_context *context,
                                                         const char *const *paths, size_t count,
                                                         const igi_chessboard *board,
                                                         igi_calibration **calibration);

/* A picture (SVG) of what the lens leaves: every corner with its residual, and each view's RMS; what was left
 * out is red. IGI_E_USAGE for a calibration that no board was just calibrated by. */
IGI_API IGI_MUST_USE igi_status igi_calibration_draw_residuals(igi_context *context,
                                                               const igi_calibration *calibration,
                                                               const char *path);

/* Vignetting from photographs of an evenly lit surface that fills the frame, through the
 * calibration's response (linear photographs need none). *calibration as above. */
IGI_API IGI_MUST_USE igi_status igi_calibrate_flat(igi_context *context, const char *const *paths,
                                                   size_t count, igi_calibration **calibration);

/* Vignetting from the scene alone: what two photographs show of one matt place differs by it. The
 * images are those of the scene, merged from their exposures where it names brackets, as the lens
 * shaded them: of a calibration that it names, the lens and the response are used, not the
 * vignetting. A few places that shine are outvoted. */
IGI_API IGI_MUST_USE igi_status igi_calibrate_overlap(igi_context *context, const igi_scene *scene,
                                                      igi_calibration **calibration);

/* Distortion and, where the f-number is known, vignetting from lensfun's database, by the camera, the
 * focal length and the lens that the photograph's EXIF names; `lens` names it where EXIF does not (NULL).
 * The focal length in pixels is the nominal one, and no standard deviations are known. *calibration as
 * above. IGI_E_NO_ANSWER: the database does not know them. */
IGI_API IGI_MUST_USE igi_status igi_calibrate_lensfun(igi_context *context, const char *path,
                                                      const char *lens,
                                                      igi_calibration **calibration);

/* Fits V to `count` measured transmissions of any scale at places (x,y), pixels of an image of
 * the given size. IGI_E_NO_ANSWER when they do not determine it. */
IGI_API IGI_MUST_USE igi_status igi_vignetting_fit(igi_context *context, const double (*places)[2],
                                                   const double *transmissions, size_t count,
                                                   const int size[2], igi_vignetting *vignetting);
/* V at a place; never below .01. */
IGI_API double igi_vignetting_at(const igi_vignetting *vignetting, double x, double y,
                                 const int size[2]);

/* Undoes vignetting and distortion, resampling once (bicubic, without overshoot). Channels named
 * "variance.*" are carried along as variances, "saturated" as a mask. *camera, if not NULL,
 * becomes the pinhole that the result shows: the calibration's without distortion. Pixels that the
 * photograph does not reach are NaN, which recovery leaves out. */
IGI_API IGI_MUST_USE igi_status igi_correct(igi_context *context,
                                            const igi_calibration *calibration,
                                            const igi_image *image, igi_image **corrected,
                                            igi_camera *camera);

/* Reads a scene's calibration, if it names one, and holds it against the cameras and the exposures: what
 * recovery does first. */
IGI_API IGI_MUST_USE igi_status igi_photographs_check(igi_context *context, const igi_scene *scene);

/* The forward direction, for tests of the whole chain: what a camera makes of light. */
typedef struct igi_sensor {
    double full_well_e, read_noise_e; /* electrons: at full scale, and of reading */
    int bits; /* of its codes, 8..16; files have 8 or 16, filled from above */
} igi_sensor;

/* A photograph of `radiance`, an image as the lens throws it (distortion is the renderer's part):
 * vignetting, exposure h = 1 / (the radiance that gives full scale), photon and read noise, clipping,
 * the calibration's response if it has one (of as many levels as the file), codes. The exposure's
 * numbers go into EXIF. */
IGI_API IGI_MUST_USE igi_status igi_photograph(igi_context *context, const igi_image *radiance,
                                               const igi_calibration *calibration,
                                               const igi_sensor *sensor,
                                               const igi_exposure *exposure, uint64_t seed,
                                               igi_photo **photo);

#ifdef __cplusplus
}
#endif
#endif
