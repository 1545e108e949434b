/* SPDX-License-Identifier: Apache-2.0
 *
 * Intrinsics and distortion from photographs of a chessboard (Zhang 2000, OpenCV's).
 *
 * A bent board, a blurred photograph or a mirrored match shows as a view whose residual stands out
 * from the others'. The worst such view is left out and the rest fitted again, until none does.
 */
#include "base/context.h"
#include "base/order.h"
#include "bridge/opencv.h"
#include "lens/lens_private.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* A view is bad when its residual is this many times the median of those in use. */
#define BAD_RATIO 3.0
/* Views and photographs beyond these are no calibration. */
#define LEAST_VIEWS 3
#define MOST_VIEWS 10000
/* Of a board with markers, this many corners and this part of them are enough. */
#define LEAST_CORNERS 8
#define LEAST_PART .25

typedef struct session {
    const igi_chessboard *board;
    size_t points, found; /* corners a board; views with a board */
    float *corners;       /* [count][points][2]: those of found views first */
    float *grid;          /* [points][3] */
    size_t *view;         /* [found] which photograph */
    bool *used;           /* [found] */
} session;

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
static igi_status find_corners(igi_context *ctx, const session *s, const igi_photo *photo,
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

static igi_status add_view(igi_context *ctx, session *s, size_t index, const char *path,
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

/* One fit to the views in use. rms[k]: of the k-th of them. */
static igi_status fit(igi_context *ctx, const session *s, igi_calibration *c, float *packed,
                      double *rms)
{
    igi_cv_views views = {c->width, c->height, 0, s->points, s->grid, packed};
    double parameters[IGI_CV_PARAMETERS];
    for (size_t v = 0; v < s->found; v++)
        if (s->used[v])
            memcpy(packed + views.count++ * s->points * 2, s->corners + v * s->points * 2,
                   s->points * 2 * sizeof *packed);
    IGI_TRY(igi_cv_calibrate(ctx, &views, parameters, c->deviations, &c->rms_px, rms));
    c->lens.fl_x = parameters[0];
    c->lens.fl_y = parameters[1];
    c->lens.cx = parameters[2] + .5; /* OpenCV's pixels are centred at whole numbers */
    c->lens.cy = parameters[3] + .5;
    c->lens.k1 = parameters[4];
    c->lens.k2 = parameters[5];
    c->lens.p1 = parameters[6];
    c->lens.p2 = parameters[7];
    c->lens.k3 = parameters[8];
    c->has_lens = true;
    return IGI_OK;
}

/* Notes the residuals; leaves out the worst view if it is bad. */
static bool drop_worst(session *s, igi_calibration *c, const double *rms, double *sorted)
{
    size_t count = 0, worst = 0;
    for (size_t v = 0; v < s->found; v++) {
        if (!s->used[v]) continue;
        igi_calibration_view *view = &c->views[s->view[v]];
        view->rms_px = sorted[count] = rms[count];
        count++;
        if (!s->used[worst] || view->rms_px > c->views[s->view[worst]].rms_px) worst = v;
    }
    qsort(sorted, count, sizeof *sorted, igi_compare_doubles);
    if (count <= LEAST_VIEWS || sorted[count - 1] <= BAD_RATIO * sorted[count / 2]) return false;
    s->used[worst] = false;
    return true;
}

static igi_status prepare(igi_context *ctx, session *s, size_t count)
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
    for (size_t i = 0; i < c->view_count; i++) igi_free(c->views[i].file);
    igi_free(c->views);
    c->views = NULL;
    c->view_count = 0;
    IGI_TRY(IGI_ALLOC(ctx, count, &c->views));
    for (size_t i = 0; i < count; i++) {
        const char *slash = strrchr(paths[i], '/');
        IGI_TRY(igi_strdup(ctx, slash ? slash + 1 : paths[i], &c->views[i].file));
        c->view_count = i + 1;
    }
    return IGI_OK;
}

static igi_status fit_good_views(igi_context *ctx, session *s, igi_calibration *c)
{
    igi_status status = IGI_OK;
    float *packed = NULL;
    double *rms = NULL, *sorted = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, s->found * s->points * 2, &packed));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, s->found, &rms));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, s->found, &sorted));
    do {
        IGI_TRY_GOTO(fit(ctx, s, c, packed, rms));
    } while (drop_worst(s, c, rms, sorted));
    for (size_t v = 0; v < s->found; v++) c->views[s->view[v]].used = s->used[v];
cleanup:
    igi_free(packed);
    igi_free(rms);
    igi_free(sorted);
    return status;
}

igi_status igi_calibrate_chessboard(igi_context *ctx, const char *const *paths, size_t count,
                                    const igi_chessboard *board, igi_calibration **calibration)
{
    igi_status status = IGI_OK;
    session s = {.board = board, .points = (size_t)board->columns * (size_t)board->rows};
    igi_calibration *own = NULL, **target = *calibration ? calibration : &own;
    if (board->columns < 3 || board->rows < 3 || board->columns > 100 || board->rows > 100 ||
        !(board->square_m > 0) || count < 1 || count > MOST_VIEWS ||
        (board->markers && !(board->marker_m > 0 && board->marker_m < board->square_m)))
        return igi_fail(
            ctx, IGI_E_USAGE,
            "chessboard: 3 to 100 inner corners a side, a positive square, markers that "
            "are smaller than it and at most %d photographs, please",
            MOST_VIEWS);
    igi_stage_begin(ctx, "chessboard");
    IGI_TRY_GOTO(prepare(ctx, &s, count));
    for (size_t i = 0; i < count; i++) {
        IGI_TRY_GOTO(igi_progress(ctx, (double)i / (double)count));
        IGI_TRY_GOTO(add_view(ctx, &s, i, paths[i], target));
    }
    if (s.found < LEAST_VIEWS) {
        status = igi_fail(ctx, IGI_E_DATA,
                          "%s: %s board of %d x %d inner corners is seen in %zu of %zu "
                          "photographs; %d are needed, better a dozen",
                          paths[0], board->markers ? "enough of the" : "the whole", board->columns,
                          board->rows, s.found, count, LEAST_VIEWS);
        goto cleanup;
    }
    IGI_TRY_GOTO(name_views(ctx, paths, count, *target));
    IGI_TRY_GOTO(fit_good_views(ctx, &s, *target));
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
