/* SPDX-License-Identifier: Apache-2.0
 *
 * Intrinsics and distortion from photographs of a chessboard (Zhang 2000, OpenCV's).
 */
#include "base/file.h"
#include "bridge/opencv.h"
#include "lens/chessboard.h"
#include "lens/lens_private.h"

#include <string.h>

/* Photographs beyond these are no calibration. */
#define MOST_VIEWS 10000
/* Of the focal length: a standard deviation that is worth a word. */
#define ROUGH .01
/* Of a board with markers, this many corners and this part of them are enough. */
#define LEAST_CORNERS 8
#define LEAST_PART .25

static igi_status grey_of(igi_context *ctx, const igi_photo *photo, uint8_t **grey)
{
    size_t count = (size_t)photo->width * (size_t)photo->height;
    int drop = photo->levels == 256 ? 0 : 8;
    IGI_TRY(IGI_ALLOC(ctx, count, grey));
    for (size_t i = 0; i < count; i++) {
        const uint16_t *p = photo->codes + i * (size_t)photo->channels;
        if (photo->channels == 1) (*grey)[i] = (uint8_t)(p[0] >> drop);
        else (*grey)[i] = (uint8_t)((299u * p[0] + 587u * p[1] + 114u * p[2] + 500) / 1000 >> drop);
    }
    return IGI_OK;
}

/* Into the place of the next view. */
static igi_status find_corners(igi_context *ctx, const board_session *s, const igi_photo *photo,
                               const uint8_t *grey, bool *found)
{
    const igi_chessboard *b = s->board;
    float *corners = s->corners + s->found * s->points * 2;
    if (!b->markers)
        return igi_cv_find_chessboard(ctx, grey, photo->width, photo->height, b->columns, b->rows,
                                      corners, found);
    igi_cv_charuco board = {b->columns, b->rows, b->marker_m / b->square_m, b->markers};
    size_t count;
    IGI_TRY(igi_cv_find_charuco(ctx, grey, photo->width, photo->height, &board, corners, &count));
    *found = count >= LEAST_CORNERS && (double)count >= LEAST_PART * (double)s->points;
    return IGI_OK;
}

static igi_status add_view(igi_context *ctx, board_session *s, size_t index, const char *path,
                           igi_calibration **calibration)
{
    igi_status status = IGI_OK;
    igi_photo *photo = NULL;
    uint8_t *grey = NULL;
    bool found = false;
    IGI_TRY_GOTO(igi_photo_load(ctx, path, &photo));
    IGI_TRY_GOTO(igi_calibration_for(ctx, path, photo, calibration));
    IGI_TRY_GOTO(grey_of(ctx, photo, &grey));
    IGI_TRY_GOTO(find_corners(ctx, s, photo, grey, &found));
    if (found) {
        s->used[s->found] = true;
        s->view[s->found++] = index;
    }
cleanup:
    igi_free(grey);
    igi_photo_destroy(photo);
    return status;
}

static igi_status prepare(igi_context *ctx, board_session *s, size_t count)
{
    IGI_TRY(IGI_ALLOC(ctx, count * s->points * 2, &s->corners));
    IGI_TRY(IGI_ALLOC(ctx, s->points * 3, &s->grid));
    IGI_TRY(IGI_ALLOC(ctx, count, &s->view));
    IGI_TRY(IGI_ALLOC(ctx, count, &s->used));
    for (size_t i = 0; i < s->points; i++) {
        s->grid[3 * i] = (float)((double)(i % (size_t)s->board->columns) * s->board->square_m);
        s->grid[3 * i + 1] = (float)((double)(i / (size_t)s->board->columns) * s->board->square_m);
    }
    return IGI_OK;
}

static igi_status name_views(igi_context *ctx, const char *const *paths, size_t count,
                             igi_calibration *c)
{
    igi_calibration_forget_views(c);
    IGI_TRY(IGI_ALLOC(ctx, count, &c->views));
    for (size_t i = 0; i < count; i++) {
        IGI_TRY(igi_strdup(ctx, igi_file_name(paths[i]), &c->views[i].file));
        c->view_count = i + 1;
    }
    return IGI_OK;
}

igi_status igi_calibrate_chessboard(igi_context *ctx, const char *const *paths, size_t count,
                                    const igi_chessboard *board, igi_calibration **calibration)
{
    igi_status status = IGI_OK;
    board_session s = {.board = board, .points = (size_t)board->columns * (size_t)board->rows};
    igi_calibration *own = NULL, **target = *calibration ? calibration : &own;
    if (board->columns < 3 || board->rows < 3 || board->columns > 100 || board->rows > 100 ||
        !(board->square_m > 0) || count < 1 || count > MOST_VIEWS ||
        (board->markers && !(board->marker_m > 0 && board->marker_m < board->square_m)))
        return igi_fail(
            ctx, IGI_E_USAGE,
            "chessboard: 3 to 100 inner corners a side, a positive square, markers that "
            "are smaller than it and at most %d photographs, please",
            MOST_VIEWS);
    for (size_t i = 0; i < count; i++)
        for (size_t k = 0; k < i; k++)
            if (strcmp(paths[i], paths[k]) == 0)
                return igi_fail(ctx, IGI_E_DATA,
                                "%s: named twice: twice it would count as two; name it once",
                                paths[i]);
    igi_stage_begin(ctx, "chessboard");
    IGI_TRY_GOTO(prepare(ctx, &s, count));
    for (size_t i = 0; i < count; i++) {
        IGI_TRY_GOTO(igi_progress(ctx, (double)i / (double)count));
        IGI_TRY_GOTO(add_view(ctx, &s, i, paths[i], target));
    }
    if (s.found < BOARD_LEAST_VIEWS) {
        status = igi_fail(ctx, IGI_E_DATA,
                          "%s: %s board of %d x %d inner corners is seen in %zu of %zu "
                          "photographs; %d are needed, better a dozen",
                          paths[0], board->markers ? "enough of the" : "the whole", board->columns,
                          board->rows, s.found, count, BOARD_LEAST_VIEWS);
        goto cleanup;
    }
    IGI_TRY_GOTO(name_views(ctx, paths, count, *target));
    IGI_TRY_GOTO(board_fit_good_views(ctx, &s, *target));
    if ((*target)->deviations[0] > ROUGH * (*target)->lens.fl_x)
        igi_warn(ctx,
                 "%s: the photographs tell the focal length to %.1f %% alone; take more, with the "
                 "board tilted and in the corners of the picture",
                 paths[0], 100 * (*target)->deviations[0] / (*target)->lens.fl_x);
    *calibration = *target;
    own = NULL;
cleanup:
    igi_stage_begin(ctx, NULL);
    igi_calibration_destroy(own);
    igi_free(s.corners);
    igi_free(s.grid);
    igi_free(s.view);
    igi_free(s.used);
    return status;
}
