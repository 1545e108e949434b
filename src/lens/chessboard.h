/* SPDX-License-Identifier: Apache-2.0
 *
 * Views of a board while a lens is fitted to them: chessboard.c finds them, chessboard_fit.c fits.
 */
#ifndef IGI_SRC_LENS_CHESSBOARD_H
#define IGI_SRC_LENS_CHESSBOARD_H

#include <igi/lens.h>

/* Fewer views are no calibration. */
#define BOARD_LEAST_VIEWS 3

typedef struct board_session {
    const igi_chessboard *board;
    size_t points, found; /* corners a board; views with a board */
    float *corners;       /* [count][points][2]: those of found views first */
    float *grid;          /* [points][3] */
    size_t *view;         /* [found] which photograph */
    bool *used;           /* [found] */
} board_session;

/* Fits the lens, leaving bad views out, and notes each view's residuals in `c`. */
IGI_MUST_USE igi_status board_fit_good_views(igi_context *ctx, board_session *s,
                                             igi_calibration *c);

#endif
