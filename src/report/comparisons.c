/* SPDX-License-Identifier: Apache-2.0
 *
 * Photographs beside what the recovered materials predict, and where they differ.
 */
#include "report/colour.h"
#include "base/file.h"
#include "image/resample.h"

#include "base/order.h"
#include "material/material.h"

#include <igi/report.h>

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>

/* Few and small: what the page costs must stay far below what the recovery costs. Differences are
 * half as wide, which also averages the photographs' noise. */
enum { MOST_VIEWS = 4, WIDEST = 256 };
#define LIMIT 0.1f   /* the ramp of differences ends there: a tenth of the photograph */
#define MIDDLE 0.25f /* what the median of the photographs becomes, linear */

typedef struct writer {
    igi_context *ctx;
    const char *folder;
    igi_srgb srgb;
    float exposure;
    json_t *views;
} writer;

static float brightness(const float *pixel, int bands)
{
    float sum = 0;
    for (int b = 0; b < bands; b++) sum += pixel[b];
    return sum / (float)bands;
}

/* One exposure for all views, from every 16th pixel of every photograph shown. */
static igi_status find_exposure(writer *w, igi_image *const *photos, int count)
{
    size_t room = 0, found = 0;
    float *values = NULL;
    for (int i = 0; i < count; i++)
        room += (size_t)photos[i]->width * (size_t)photos[i]->height / 16 + 1;
    IGI_TRY(IGI_ALLOC(w->ctx, room, &values));
    for (int i = 0; i < count; i++) {
        size_t pixels = (size_t)photos[i]->width * (size_t)photos[i]->height;
        for (size_t p = 0; p < pixels && found < room; p += 16) {
            float x = brightness(photos[i]->samples + p * (size_t)photos[i]->channels,
                                 photos[i]->channels);
            if (isfinite(x) && x > 0) values[found++] = x;
        }
    }
    qsort(values, found, sizeof *values, igi_compare_floats);
    w->exposure = found ? MIDDLE / values[found / 2] : 1;
    igi_free(values);
    return IGI_OK;
}

static igi_status save_png(const writer *w, const uint8_t *pixels, const igi_image *like,
                           const char *name, const char *kind)
{
    igi_status status = IGI_OK;
    char *path = NULL;
    uint8_t *bytes = NULL;
    size_t size = 0;
    IGI_TRY_GOTO(igi_strprintf(w->ctx, &path, "%s/comparison/%s.%s.png", w->folder, name, kind));
    IGI_TRY_GOTO(igi_image_encode_png(w->ctx, pixels, like->width, like->height, 3, &bytes, &size));
    status = igi_file_save(w->ctx, path, bytes, size);
cleanup:
    igi_image_free_bytes(bytes);
    igi_free(path);
    return status;
}

/* What is not predicted is grey. */
static void tone_map(const writer *w, const igi_image *image, bool is_prediction, uint8_t *pixels)
{
    size_t count = (size_t)image->width * (size_t)image->height;
    for (size_t p = 0; p < count; p++) {
        const float *samples = image->samples + p * (size_t)image->channels;
        bool nothing = is_prediction && !(brightness(samples, image->channels) > 0);
        for (int c = 0; c < 3; c++) {
            float x = samples[igi_band_of(c, image->channels)] * w->exposure;
            pixels[3 * p + (size_t)c] = nothing ? 128 : igi_srgb_byte(&w->srgb, x);
        }
    }
}

/* Albedo is no radiance: 1 is white, whatever the exposure. */
static igi_status save_albedo(const writer *w, const igi_image *albedo, const char *name,
                              uint8_t *pixels)
{
    igi_image *small = NULL;
    IGI_TRY(igi_image_reduce(w->ctx, albedo, WIDEST, &small));
    for (size_t p = 0; p < (size_t)small->width * (size_t)small->height; p++)
        for (int c = 0; c < 3; c++) {
            size_t band = (size_t)igi_band_of(c, small->channels);
            float x = small->samples[p * (size_t)small->channels + band];
            pixels[3 * p + (size_t)c] = igi_srgb_byte(&w->srgb, x);
        }
    igi_status status = save_png(w, pixels, small, name, "albedo");
    igi_image_destroy(small);
    return status;
}

/* Paints (prediction - photograph)/photograph and returns the median of its size. Where nothing
 * is predicted (lamps, what no photograph determines) the picture is grey. */
static igi_status paint_difference(const writer *w, const igi_image *photo,
                                   const igi_image *prediction, uint8_t *pixels, double *median)
{
    int bands = photo->channels;
    size_t count = (size_t)photo->width * (size_t)photo->height, found = 0;
    float *sizes = NULL;
    IGI_TRY(IGI_ALLOC(w->ctx, count, &sizes));
    for (size_t p = 0; p < count; p++) {
        float a = brightness(photo->samples + p * (size_t)bands, bands);
        float b = brightness(prediction->samples + p * (size_t)bands, bands);
        if (!(a > 0) || !(b > 0) || !isfinite(a) || !isfinite(b)) {
            memset(pixels + 3 * p, 128, 3);
            continue;
        }
        float difference = (b - a) / a;
        sizes[found++] = fabsf(difference);
        igi_ramp_colour(igi_ramp_spread, .5f + .5f * difference / LIMIT, pixels + 3 * p);
    }
    qsort(sizes, found, sizeof *sizes, igi_compare_floats);
    *median = found ? (double)sizes[found / 2] : (double)NAN;
    igi_free(sizes);
    return IGI_OK;
}

/* The photograph with what is not predicted blackened, so that means over pixels compare the same
 * ones. */
static igi_status mask(igi_context *ctx, const igi_image *photo, const igi_image *prediction,
                       igi_image **masked)
{
    int bands = photo->channels;
    size_t count = (size_t)photo->width * (size_t)photo->height;
    IGI_TRY(igi_image_create(ctx, photo->width, photo->height, bands, masked));
    memcpy((*masked)->samples, photo->samples, count * (size_t)bands * sizeof *photo->samples);
    for (size_t p = 0; p < count; p++) {
        size_t at = p * (size_t)bands;
        if (!(brightness(prediction->samples + at, bands) > 0))
            memset((*masked)->samples + at, 0, (size_t)bands * sizeof *photo->samples);
    }
    return IGI_OK;
}

/* Half as large as the other pictures. */
static igi_status save_difference(const writer *w, const igi_image *photo,
                                  const igi_image *prediction, const char *name, uint8_t *pixels,
                                  double *median)
{
    igi_status status = IGI_OK;
    igi_image *masked = NULL, *a = NULL, *b = NULL;
    IGI_TRY_GOTO(mask(w->ctx, photo, prediction, &masked));
    IGI_TRY_GOTO(igi_image_reduce(w->ctx, masked, WIDEST / 2, &a));
    IGI_TRY_GOTO(igi_image_reduce(w->ctx, prediction, WIDEST / 2, &b));
    IGI_TRY_GOTO(paint_difference(w, a, b, pixels, median));
    IGI_TRY_GOTO(save_png(w, pixels, a, name, "difference"));
cleanup:
    igi_image_destroy(masked);
    igi_image_destroy(a);
    igi_image_destroy(b);
    return status;
}

static igi_status note_view(writer *w, const igi_comparison *c, const char *file,
                            const igi_image *image, double median)
{
    const char *frame = c->frame;
    json_t *view = json_pack("{s:s, s:s, s:i, s:i, s:i, s:b}", "frame", frame, "file", file,
                             "width", image->width, "height", image->height, "regions", c->regions,
                             "albedo", c->albedo != NULL);
    json_object_set_new(view, "median_difference", isnan(median) ? json_null() : json_real(median));
    if (json_array_append_new(w->views, view))
        return igi_fail(w->ctx, IGI_E_DATA, "%s: the image's name is not UTF-8; rename it", frame);
    return IGI_OK;
}

static igi_status save_view(writer *w, const igi_comparison *view, const igi_image *photo)
{
    igi_status status = IGI_OK;
    igi_image *prediction = NULL;
    char *name = NULL;
    uint8_t *pixels = NULL;
    double median = 0;
    IGI_TRY_GOTO(igi_region_file_name(w->ctx, view->frame, &name));
    IGI_TRY_GOTO(igi_image_reduce(w->ctx, view->prediction, WIDEST, &prediction));
    IGI_TRY_GOTO(IGI_ALLOC(w->ctx, 3 * (size_t)photo->width * (size_t)photo->height, &pixels));
    tone_map(w, photo, false, pixels);
    IGI_TRY_GOTO(save_png(w, pixels, photo, name, "photo"));
    tone_map(w, prediction, true, pixels);
    IGI_TRY_GOTO(save_png(w, pixels, photo, name, "prediction"));
    IGI_TRY_GOTO(save_difference(w, view->photo, view->prediction, name, pixels, &median));
    if (view->albedo) IGI_TRY_GOTO(save_albedo(w, view->albedo, name, pixels));
    IGI_TRY_GOTO(note_view(w, view, name, photo, median));
cleanup:
    igi_image_destroy(prediction);
    igi_free(name);
    igi_free(pixels);
    return status;
}

static igi_status save_index(const writer *w)
{
    igi_status status = IGI_OK;
    char *path = NULL;
    json_t *root = json_pack("{s:f, s:f, s:O}", "exposure", (double)w->exposure, "limit",
                             (double)LIMIT, "views", w->views);
    IGI_TRY_GOTO(igi_strprintf(w->ctx, &path, "%s/comparison/index.json", w->folder));
    status = igi_file_save_json(w->ctx, path, root, 6);
cleanup:
    json_decref(root);
    igi_free(path);
    return status;
}

igi_status igi_comparisons_save(igi_context *ctx, const igi_recovery *recovery, const char *folder)
{
    igi_status status = IGI_OK;
    writer w = {.ctx = ctx, .folder = folder, .views = json_array()};
    igi_image *photos[MOST_VIEWS] = {NULL};
    const igi_comparison *chosen[MOST_VIEWS];
    size_t total = recovery->comparison_count;
    int count = total < MOST_VIEWS ? (int)total : MOST_VIEWS;
    char *path = NULL;
    igi_srgb_make(&w.srgb);
    IGI_TRY_GOTO(igi_strprintf(ctx, &path, "%s/comparison", folder));
    if (mkdir(path, 0777) && errno != EEXIST)
        IGI_TRY_GOTO(igi_fail(ctx, IGI_E_SYSTEM, "%s: cannot be made (%s)", path, strerror(errno)));
    for (int i = 0; i < count; i++) {
        chosen[i] = &recovery->comparisons[(size_t)i * total / (size_t)count];
        IGI_TRY_GOTO(igi_image_reduce(ctx, chosen[i]->photo, WIDEST, &photos[i]));
    }
    IGI_TRY_GOTO(find_exposure(&w, photos, count));
    for (int i = 0; i < count; i++) IGI_TRY_GOTO(save_view(&w, chosen[i], photos[i]));
    IGI_TRY_GOTO(save_index(&w));
cleanup:
    for (int i = 0; i < count; i++) igi_image_destroy(photos[i]);
    json_decref(w.views);
    igi_free(path);
    return status;
}
