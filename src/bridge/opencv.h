/* SPDX-License-Identifier: Apache-2.0
 *
 * OpenCV behind C: chessboards, camera calibration, and its HDR methods for comparison. No C++ type
 * and no exception passes. Coordinates are OpenCV's: pixel (0,0) is centred at (0,0).
 */
#ifndef IGI_SRC_BRIDGE_OPENCV_H
#define IGI_SRC_BRIDGE_OPENCV_H

#include <igi/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/* The inner corners of a chessboard in grey[height][width], row by row: corners[rows][columns][2],
 * refined below a pixel. *found: whether the whole board was. */
IGI_MUST_USE igi_status igi_cv_find_chessboard(igi_context *ctx, const uint8_t *grey, int width,
                                               int height, int columns, int rows, float *corners,
                                               bool *found);

/* A ChArUco board: a chessboard with a marker in each white square, so that part of it is enough. */
typedef struct igi_cv_charuco {
    int columns, rows;      /* inner corners */
    double marker_share;    /* side of a marker / side of a square */
    const char *dictionary; /* of markers, OpenCV's name without DICT_: "5X5_100" */
} igi_cv_charuco;

/* Corners as above, NaN where one was not seen; *found of them. IGI_E_USAGE: an unknown dictionary, or
 * one with too few markers, or igi was built without these boards. */
IGI_MUST_USE igi_status igi_cv_find_charuco(igi_context *ctx, const uint8_t *grey, int width,
                                            int height, const igi_cv_charuco *board, float *corners,
                                            size_t *found);
/* The board's picture, a square `side` pixels: grey[(rows+1) side][(columns+1) side]. */
IGI_MUST_USE igi_status igi_cv_draw_charuco(igi_context *ctx, const igi_cv_charuco *board, int side,
                                            uint8_t *grey);

#define IGI_CV_PARAMETERS 9 /* fx fy cx cy k1 k2 p1 p2 k3 */

typedef struct igi_cv_views {
    int width, height;    /* of the photographs */
    size_t count, points; /* views, and points a view */
    const float *board;   /* [points][3] in the board's own axes */
    const float *corners; /* [count][points][2] pixels; NaN: not seen */
} igi_cv_views;

/* Zhang's method. *rms over all points; view_rms[count]; deviations of the parameters. */
IGI_MUST_USE igi_status igi_cv_calibrate(igi_context *ctx, const igi_cv_views *views,
                                         double parameters[IGI_CV_PARAMETERS],
                                         double deviations[IGI_CV_PARAMETERS], double *rms,
                                         double *view_rms);

/* What the lens leaves of each view in its best pose: seen less expected, pixels, residuals[count][points][2];
 * NaN where a corner was not seen. */
IGI_MUST_USE igi_status igi_cv_residuals(igi_context *ctx, const igi_cv_views *views,
                                         const double parameters[IGI_CV_PARAMETERS],
                                         float *residuals);

/* From a file of OpenCV's (YAML or XML): image_width, image_height, camera_matrix and
 * distortion_coefficients, up to five. */
IGI_MUST_USE igi_status igi_cv_load_lens(igi_context *ctx, const char *path, int size[2],
                                         double parameters[IGI_CV_PARAMETERS]);

typedef struct igi_cv_bracket {
    int width, height;
    size_t count;
    const uint8_t *const *photos; /* [count], each [height][width][3] */
    const float *times_s;         /* [count] */
} igi_cv_bracket;

/* response[256][3] in the order of the photographs' channels. */
IGI_MUST_USE igi_status igi_cv_response(igi_context *ctx, const igi_cv_bracket *bracket,
                                        bool robertson, float *response);
/* radiance[height][width][3]. */
IGI_MUST_USE igi_status igi_cv_merge(igi_context *ctx, const igi_cv_bracket *bracket,
                                     const float *response, bool robertson, float *radiance);

#ifdef __cplusplus
}
#endif
#endif
