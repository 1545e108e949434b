/* SPDX-License-Identifier: Apache-2.0
 *
 * The lens that the views of a board agree on.
 *
 * A bent or another board, a resized or mirrored photograph, a blurred one: such a view draws the lens
 * toward itself, and its own residual tells but a part of that. What it costs is what all residuals
 * together lose when it goes,
 *     cost^2 = (SSE with it - SSE without it) / its corners,
 * which for a good view is the variance of a corner, wherever in the picture it lies. The dearest bad
 * view is left out and the rest fitted again, until none is. (A board found one square off is no bad
 * view: its pose takes that up.)
 */
#include "base/context.h"
#include "base/order.h"
#include "bridge/opencv.h"
#include "lens/chessboard.h"

#include <math.h>
#include <string.h>

/* A view is bad when its cost is this many times the others' median RMS: thirteen good photographs reach
 * 1.3, a mirrored one 2.5. Only views whose RMS is this much above the median are tried. */
#define BAD_RATIO 2.0
#define SUSPECT_RATIO 1.4
#define MOST_SUSPECTS 3
typedef struct lens_fit {
    double parameters[IGI_CV_PARAMETERS], deviations[IGI_CV_PARAMETERS];
    double rms, square; /* px; the sum of squared residuals */
    double median;      /* of the views' RMS */
} lens_fit;

/* Where the searches work: all [found]. */
typedef struct scratch {
    float *packed; /* [found][points][2] */
    double *rms, *sorted;
    double *view_rms; /* of those in use, in the place of each */
} scratch;

static size_t count_corners(const board_session *s, size_t view)
{
    size_t count = 0;
    for (size_t p = 0; p < s->points; p++) count += !isnan(s->corners[(view * s->points + p) * 2]);
    return count;
}

/* One fit to the views in use. */
static igi_status fit(igi_context *ctx, const board_session *s, const igi_calibration *c,
                      scratch *w, lens_fit *out)
{
    igi_cv_views views = {c->width, c->height, 0, s->points, s->grid, w->packed};
    size_t corners = 0, k = 0;
    for (size_t v = 0; v < s->found; v++) {
        if (!s->used[v]) continue;
        memcpy(w->packed + views.count++ * s->points * 2, s->corners + v * s->points * 2,
               s->points * 2 * sizeof *w->packed);
        corners += count_corners(s, v);
    }
    IGI_TRY(igi_cv_calibrate(ctx, &views, out->parameters, out->deviations, &out->rms, w->rms));
    out->square = out->rms * out->rms * (double)corners;
    for (size_t v = 0; v < s->found; v++)
        if (s->used[v]) w->view_rms[v] = w->rms[k++];
    memcpy(w->sorted, w->rms, k * sizeof *w->sorted);
    out->median = igi_median(w->sorted, k);
    return IGI_OK;
}

/* The view of the largest RMS below `below` among those in use; s->found: none. */
static size_t next_suspect(const board_session *s, const double *rms, double below)
{
    size_t worst = s->found;
    for (size_t v = 0; v < s->found; v++)
        if (s->used[v] && rms[v] < below && (worst == s->found || rms[v] > rms[worst])) worst = v;
    return worst;
}

/* Leaves out the view that costs most, if it is bad; *whole is the fit to all, then to the rest. */
static igi_status drop_worst(igi_context *ctx, board_session *s, const igi_calibration *c,
                             scratch *w, lens_fit *whole, bool *dropped)
{
    size_t suspects[MOST_SUSPECTS], count = 0, in_use = 0, worst = 0;
    double below = HUGE_VAL, dearest = BAD_RATIO;
    lens_fit best = *whole, without;
    for (size_t v = 0; v < s->found; v++) in_use += s->used[v];
    while (in_use > BOARD_LEAST_VIEWS && count < MOST_SUSPECTS) {
        size_t v = next_suspect(s, w->view_rms, below);
        if (v == s->found || w->view_rms[v] < SUSPECT_RATIO * whole->median) break;
        below = w->view_rms[v];
        suspects[count++] = v;
    }
    for (size_t i = 0; i < count; i++) {
        s->used[suspects[i]] = false;
        igi_status status = fit(ctx, s, c, w, &without);
        s->used[suspects[i]] = true;
        IGI_TRY(status);
        double cost = sqrt(fmax(0, whole->square - without.square) /
                           (double)count_corners(s, suspects[i]));
        if (cost <= dearest * without.median) continue;
        dearest = cost / without.median;
        worst = suspects[i];
        best = without;
    }
    *dropped = dearest > BAD_RATIO;
    if (*dropped) s->used[worst] = false;
    *whole = best;
    return IGI_OK;
}

static void keep_lens(igi_calibration *c, const lens_fit *fit)
{
    const double *p = fit->parameters;
    memcpy(c->deviations, fit->deviations, sizeof c->deviations);
    c->rms_px = fit->rms;
    c->lens.fl_x = p[0];
    c->lens.fl_y = p[1];
    c->lens.cx = p[2] + .5; /* OpenCV's pixels are centred at whole numbers */
    c->lens.cy = p[3] + .5;
    c->lens.k1 = p[4];
    c->lens.k2 = p[5];
    c->lens.p1 = p[6];
    c->lens.p2 = p[7];
    c->lens.k3 = p[8];
    c->has_lens = true;
}

/* Of all views, also of those left out, by the lens of the others. */
static igi_status note_residuals(igi_context *ctx, const board_session *s, igi_calibration *c,
                                 scratch *w, const lens_fit *fit)
{
    igi_cv_views views = {c->width, c->height, s->found, s->points, s->grid, s->corners};
    IGI_TRY(igi_cv_residuals(ctx, &views, fit->parameters, w->packed));
    for (size_t v = 0; v < s->found; v++) {
        igi_calibration_view *view = &c->views[s->view[v]];
        double sum = 0;
        IGI_TRY(IGI_ALLOC(ctx, s->points, &view->corners));
        for (size_t p = v * s->points; p < (v + 1) * s->points; p++) {
            const float *d = w->packed + 2 * p, *at = s->corners + 2 * p;
            if (isnan(d[0])) continue;
            double *to = view->corners[view->corner_count++];
            to[0] = (double)at[0] + .5, to[1] = (double)at[1] + .5;
            to[2] = (double)d[0], to[3] = (double)d[1];
            sum += to[2] * to[2] + to[3] * to[3];
        }
        view->used = s->used[v];
        view->rms_px = sqrt(sum / (double)view->corner_count);
    }
    return IGI_OK;
}

igi_status board_fit_good_views(igi_context *ctx, board_session *s, igi_calibration *c)
{
    igi_status status = IGI_OK;
    scratch w = {0};
    lens_fit lens;
    bool dropped;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, s->found * s->points * 2, &w.packed));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, s->found, &w.rms));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, s->found, &w.sorted));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, s->found, &w.view_rms));
    do {
        IGI_TRY_GOTO(fit(ctx, s, c, &w, &lens));
        IGI_TRY_GOTO(drop_worst(ctx, s, c, &w, &lens, &dropped));
    } while (dropped);
    keep_lens(c, &lens);
    IGI_TRY_GOTO(note_residuals(ctx, s, c, &w, &lens));
cleanup:
    igi_free(w.packed);
    igi_free(w.rms);
    igi_free(w.sorted);
    igi_free(w.view_rms);
    return status;
}
