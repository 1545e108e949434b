/* SPDX-License-Identifier: Apache-2.0
 *
 * A lens that nobody calibrated but many own: distortion and vignetting from lensfun's database, by the
 * names that EXIF gives. Lensfun's models differ from igi's, so that its corrections are sampled and
 * igi's polynomials fitted to them. Scale is left in the focal length:
 *
 *     r_d / r_u = s (1 + k1 x^2 + k2 x^4 + k3 x^6),   x = r_u / f,   and the lens has f s pixels.
 */
#include "base/context.h"
#include "base/solve.h"
#include "lens/lens_private.h"

#include <lensfun/lensfun.h>

#include <math.h>
#include <stdio.h>
#include <string.h>

#define SAMPLES 64
/* Vignetting depends on the distance a little; rooms are about so large. */
#define DISTANCE_M 3
#define COLUMNS 17
#define ROWS 13
/* Of the full frame, mm; a crop factor is the ratio of diagonals. */
#define FULL_DIAGONAL 43.2666

typedef struct search {
    lfDatabase *db;
    const lfCamera **cameras;
    const lfLens **lenses;
} search;

static void end_search(search *s)
{
    lf_free((void *)s->cameras);
    lf_free((void *)s->lenses);
    if (s->db) lf_db_destroy(s->db);
}

static igi_status find_lens(igi_context *ctx, const char *path, const igi_photo *photo,
                            const char *name, search *s)
{
    s->db = lf_db_new();
    if (!s->db || lf_db_load(s->db) != LF_NO_ERROR)
        return igi_fail(
            ctx, IGI_E_SYSTEM,
            "lensfun: no database; install liblensfun-data-v1, or calibrate by a board");
    if (!photo->camera[0] || !(photo->focal_mm > 0))
        return igi_fail(ctx, IGI_E_DATA,
                        "%s: EXIF names no camera or no focal length; take a photograph as the "
                        "camera wrote it",
                        path);
    /* By all words of the name: with the maker's or without, as cameras write it. */
    s->cameras = lf_db_find_cameras_ext(s->db, NULL, photo->camera, 0);
    if (!s->cameras || !s->cameras[0])
        return igi_fail(ctx, IGI_E_NO_ANSWER,
                        "%s: lensfun knows no camera '%s'; calibrate by a board", path,
                        photo->camera);
    if (!name && photo->lens[0]) name = photo->lens;
    s->lenses = lf_db_find_lenses_hd(s->db, s->cameras[0], NULL, name, 0);
    if (!s->lenses || !s->lenses[0])
        return igi_fail(
            ctx, IGI_E_NO_ANSWER,
            "%s: lensfun knows no lens '%s' for the camera '%s'; name it with --lens, or "
            "calibrate by a board",
            path, name ? name : "", photo->camera);
    if (!name && s->lenses[1])
        return igi_fail(
            ctx, IGI_E_DATA,
            "%s: EXIF does not name the lens, and '%s' takes many ('%s', '%s' ...); name "
            "it with --lens",
            path, photo->camera, lf_mlstr_get(s->lenses[0]->Model),
            lf_mlstr_get(s->lenses[1]->Model));
    return IGI_OK;
}

/* Adds ratio = r_d / r_u at t = r_u / r_max to the normal equations of 1, t^2, t^4, t^6. */
static void add_sample(double a[16], double b[4], double t, double ratio)
{
    const double row[4] = {1, t * t, t * t * t * t, t * t * t * t * t * t};
    for (int i = 0; i < 4; i++) {
        for (int j = 0; j < 4; j++) a[4 * i + j] += row[i] * row[j];
        b[i] += row[i] * ratio;
    }
}

/* From the lens' centre to the farthest corner. */
static bool fit_distortion(lfModifier *modifier, const lfLens *lens, const lfCamera *body,
                           double focal_mm, igi_calibration *c)
{
    double w = c->width - 1, h = c->height - 1, ratios[SAMPLES], a[16] = {0}, b[4] = {0}, sum = 0;
    double longer = w > h ? w : h;
    double x0 = w / 2 + (double)lens->CenterX * longer, y0 = h / 2 + (double)lens->CenterY * longer;
    double x1 = x0 > w / 2 ? 0 : w, y1 = y0 > h / 2 ? 0 : h, most = hypot(x1 - x0, y1 - y0);
    for (int i = 0; i < SAMPLES; i++) {
        double t = (i + 1.) / SAMPLES;
        float x = (float)(x0 + t * (x1 - x0)), y = (float)(y0 + t * (y1 - y0)), seen[2];
        if (!lf_modifier_apply_geometry_distortion(modifier, x, y, 1, 1, seen)) return false;
        ratios[i] = hypot((double)seen[0] - x0, (double)seen[1] - y0) / (t * most);
        add_sample(a, b, t, ratios[i]);
    }
    if (!igi_solve_cholesky(a, 4, b, 1) || !(b[0] > 0)) return false;
    for (int i = 0; i < SAMPLES; i++) {
        double t = (i + 1.) / SAMPLES, t2 = t * t;
        double off = (b[0] + t2 * (b[1] + t2 * (b[2] + t2 * b[3])) - ratios[i]) * t * most;
        sum += off * off;
    }
    double f = focal_mm * hypot(c->width, c->height) * (double)body->CropFactor / FULL_DIAGONAL;
    double scale = f / most * (f / most);
    c->lens = (igi_camera){.width = c->width, .height = c->height};
    c->lens.fl_x = c->lens.fl_y = b[0] * f;
    c->lens.cx = x0 + .5;
    c->lens.cy = y0 + .5;
    c->lens.k1 = b[1] / b[0] * scale;
    c->lens.k2 = b[2] / b[0] * scale * scale;
    c->lens.k3 = b[3] / b[0] * scale * scale * scale;
    c->rms_px = sqrt(sum / SAMPLES);
    memset(c->deviations, 0, sizeof c->deviations);
    c->has_lens = true;
    return true;
}

static igi_status fit_vignetting(igi_context *ctx, lfModifier *modifier, const igi_photo *photo,
                                 igi_calibration *c)
{
    double places[COLUMNS * ROWS][2], transmissions[COLUMNS * ROWS];
    const int size[2] = {c->width, c->height};
    for (int i = 0; i < COLUMNS * ROWS; i++) {
        float x = (float)(c->width - 1) * (float)(i % COLUMNS) / (COLUMNS - 1);
        float y = (float)(c->height - 1) * (float)(i / COLUMNS) / (ROWS - 1);
        float pixel = 1; /* becomes 1/V */
        if (!lf_modifier_apply_color_modification(modifier, &pixel, x, y, 1, 1, LF_CR_1(INTENSITY),
                                                  sizeof pixel) ||
            !(pixel > 0))
            return IGI_OK;
        places[i][0] = (double)x + .5;
        places[i][1] = (double)y + .5;
        transmissions[i] = 1 / (double)pixel;
    }
    IGI_TRY(igi_vignetting_fit(ctx, (const double(*)[2])places, transmissions, COLUMNS * ROWS, size,
                               &c->vignetting));
    c->vignetting.f_number = photo->f_number;
    c->vignetting.focal_mm = photo->focal_mm;
    return IGI_OK;
}

/* The only "view" is the database's entry. */
static igi_status name_source(igi_context *ctx, const lfLens *lens, igi_calibration *c)
{
    igi_calibration_forget_views(c);
    IGI_TRY(IGI_ALLOC(ctx, 1, &c->views));
    IGI_TRY(igi_strprintf(ctx, &c->views[0].file, "lensfun: %s", lf_mlstr_get(lens->Model)));
    c->views[0].rms_px = c->rms_px;
    c->views[0].used = true;
    c->view_count = 1;
    return IGI_OK;
}

static igi_status take_over(igi_context *ctx, const char *path, const igi_photo *photo,
                            const search *s, igi_calibration *c)
{
    const lfLens *lens = s->lenses[0];
    igi_status status = IGI_OK;
    lfModifier *modifier = lf_modifier_new(lens, s->cameras[0]->CropFactor, c->width, c->height);
    if (!modifier) return igi_fail(ctx, IGI_E_SYSTEM, "%s: no memory for lensfun", path);
    int has = lf_modifier_initialize(modifier, lens, LF_PF_F32, (float)photo->focal_mm,
                                     (float)photo->f_number, DISTANCE_M, 1, lens->Type,
                                     LF_MODIFY_DISTORTION | LF_MODIFY_VIGNETTING, 0);
    bool found = has & LF_MODIFY_DISTORTION &&
                 fit_distortion(modifier, lens, s->cameras[0], photo->focal_mm, c);
    if (found) status = name_source(ctx, lens, c);
    if (status == IGI_OK && has & LF_MODIFY_VIGNETTING && photo->f_number > 0) {
        c->vignetting.known = false;
        status = fit_vignetting(ctx, modifier, photo, c);
        found = found || c->vignetting.known;
    }
    lf_modifier_destroy(modifier);
    if (status != IGI_OK || found) return status;
    return igi_fail(ctx, IGI_E_NO_ANSWER,
                    "%s: lensfun has neither distortion nor vignetting of '%s' at %.3g mm and "
                    "f/%.3g; calibrate by a board and a flat field",
                    path, lf_mlstr_get(lens->Model), photo->focal_mm, photo->f_number);
}

igi_status igi_calibrate_lensfun(igi_context *ctx, const char *path, const char *lens,
                                 igi_calibration **calibration)
{
    igi_status status = IGI_OK;
    igi_photo *photo = NULL;
    search s = {0};
    igi_calibration *own = NULL, **target = *calibration ? calibration : &own;
    IGI_TRY_GOTO(igi_photo_probe(ctx, path, &photo));
    IGI_TRY_GOTO(igi_calibration_for(ctx, path, photo, target));
    IGI_TRY_GOTO(find_lens(ctx, path, photo, lens, &s));
    IGI_TRY_GOTO(take_over(ctx, path, photo, &s, *target));
    *calibration = *target;
    own = NULL;
cleanup:
    end_search(&s);
    igi_photo_destroy(photo);
    igi_calibration_destroy(own);
    return status;
}
