/* SPDX-License-Identifier: Apache-2.0
 *
 * What cameras and their handling do to photographs: response, glare, vignetting, exposure,
 * saturation, noise, quantisation, broken and mistaken files.
 */
#include "chart/sweep.h"

#include <string.h>

typedef struct photo_job {
    double severity, mean;
    const chart_change *change;
    igi_rng rng;
    int bands;
} photo_job;

/* Changes one pixel's bands; (x,y) in [0,1]. */
typedef void (*pixel_fn)(photo_job *job, float *pixel, double x, double y);

static void each_pixel(const chart_subject *s, photo_job *job, size_t frame, pixel_fn change)
{
    igi_image *photo = s->photos[frame];
    for (int y = 0; y < photo->height; y++)
        for (int x = 0; x < photo->width; x++)
            change(job, photo->samples + (size_t)(y * photo->width + x) * (size_t)photo->channels,
                   (x + .5) / photo->width, (y + .5) / photo->height);
}

static photo_job make_job(const chart_change *change, double severity, const chart_subject *s)
{
    return (photo_job){.severity = severity,
                       .mean = chart_photo_mean(s),
                       .change = change,
                       .rng = chart_stream(s, change->kind->name),
                       .bands = s->scene->bands};
}

static igi_status change_all(const chart_change *change, double severity, chart_subject *s,
                             pixel_fn pixel)
{
    photo_job job = make_job(change, severity, s);
    for (size_t f = 0; f < s->scene->frame_count; f++) each_pixel(s, &job, f, pixel);
    return IGI_OK;
}

static void clip_pixel(photo_job *j, float *p, double x, double y)
{
    (void)x;
    (void)y;
    for (int b = 0; b < j->bands; b++) p[b] = fminf(p[b], (float)(j->severity * j->mean));
}

/* Everything above `severity` times the mean reads as that, and nothing marks it. */
static igi_status clip(igi_context *ctx, const chart_change *c, double severity, chart_subject *s)
{
    (void)ctx;
    return change_all(c, severity, s, clip_pixel);
}

static void gamma_pixel(photo_job *j, float *p, double x, double y)
{
    (void)x;
    (void)y;
    for (int b = 0; b < j->bands; b++)
        p[b] = (float)(j->mean * pow(fmax(0, (double)p[b]) / j->mean, j->severity));
}

static igi_status bend(igi_context *ctx, const chart_change *c, double severity, chart_subject *s)
{
    (void)ctx;
    return change_all(c, severity, s, gamma_pixel);
}

static void vignette_pixel(photo_job *j, float *p, double x, double y)
{
    double r2 = 2 * ((x - .5) * (x - .5) + (y - .5) * (y - .5)); /* 1 in the corner */
    for (int b = 0; b < j->bands; b++) p[b] *= (float)(1 - j->severity * r2);
}

static igi_status vignette(igi_context *ctx, const chart_change *c, double severity,
                           chart_subject *s)
{
    (void)ctx;
    return change_all(c, severity, s, vignette_pixel);
}

static void noise_pixel(photo_job *j, float *p, double x, double y)
{
    (void)x;
    (void)y;
    for (int b = 0; b < j->bands; b++) {
        double shot = sqrt(fmax(0, (double)p[b]) * j->mean);
        p[b] += (float)(j->severity * shot * chart_normal(&j->rng));
    }
}

/* Photon noise: severity is its share of a pixel as bright as the mean. */
static igi_status noise(igi_context *ctx, const chart_change *c, double severity, chart_subject *s)
{
    (void)ctx;
    return change_all(c, severity, s, noise_pixel);
}

static void quantise_pixel(photo_job *j, float *p, double x, double y)
{
    (void)x;
    (void)y;
    /* Full scale at 16 times the mean: lamps are clipped, as in a single exposure. */
    double top = exp2(j->severity) - 1, full = 16 * j->mean;
    for (int b = 0; b < j->bands; b++)
        p[b] = (float)(floor(fmin(top, (double)p[b] / full * top) + .5) / top * full);
}

/* Linear codes of `severity` bits. */
static igi_status quantise(igi_context *ctx, const chart_change *c, double severity,
                           chart_subject *s)
{
    (void)ctx;
    return change_all(c, severity, s, quantise_pixel);
}

static void break_pixel(photo_job *j, float *p, double x, double y)
{
    static const float values[] = {NAN, INFINITY, -INFINITY, -1e3f};
    (void)x;
    (void)y;
    double chance = (double)igi_rng_float(&j->rng);
    uint32_t which = igi_rng_next(&j->rng) % 4;
    if (chance < j->severity) p[igi_rng_next(&j->rng) % (uint32_t)j->bands] = values[which];
}

static igi_status broken(igi_context *ctx, const chart_change *c, double severity, chart_subject *s)
{
    (void)ctx;
    return change_all(c, severity, s, break_pixel);
}

/* Light strayed in the lens: `severity` of all light falls evenly onto the picture. */
static igi_status glare(igi_context *ctx, const chart_change *c, double severity, chart_subject *s)
{
    (void)ctx;
    (void)c;
    size_t bands = (size_t)s->scene->bands;
    for (size_t f = 0; f < s->scene->frame_count; f++) {
        igi_image *photo = s->photos[f];
        size_t pixels = (size_t)photo->width * (size_t)photo->height;
        for (size_t b = 0; b < bands; b++) {
            double mean = 0;
            for (size_t i = 0; i < pixels; i++)
                mean += (double)photo->samples[i * (bands + 1) + b] / (double)pixels;
            for (size_t i = 0; i < pixels; i++) {
                float *x = &photo->samples[i * (bands + 1) + b];
                *x = (float)((1 - severity) * (double)*x + severity * mean);
            }
        }
    }
    return IGI_OK;
}

static void scale_photo(const chart_subject *s, size_t frame, double factor)
{
    igi_image *photo = s->photos[frame];
    size_t bands = (size_t)s->scene->bands, pixels = (size_t)photo->width * (size_t)photo->height;
    for (size_t i = 0; i < pixels; i++)
        for (size_t b = 0; b < bands; b++) photo->samples[i * (bands + 1) + b] *= (float)factor;
}

/* Each photograph brighter or darker by its own factor, of standard deviation `severity`. */
static igi_status drift(igi_context *ctx, const chart_change *c, double severity, chart_subject *s)
{
    (void)ctx;
    igi_rng rng = chart_stream(s, c->kind->name);
    for (size_t f = 0; f < s->scene->frame_count; f++)
        scale_photo(s, f, exp(severity * chart_normal(&rng)));
    return IGI_OK;
}

/* All photographs brighter than the lamps' stated values say. */
static igi_status unit(igi_context *ctx, const chart_change *c, double severity, chart_subject *s)
{
    (void)ctx;
    (void)c;
    for (size_t f = 0; f < s->scene->frame_count; f++) scale_photo(s, f, severity);
    return IGI_OK;
}

/* The contents of a block are what stands beside it: a thing that was moved between shots. */
static void paste(igi_image *photo, double share, igi_rng *rng)
{
    int w = (int)(sqrt(share) * photo->width + .5), h = (int)(sqrt(share) * photo->height + .5);
    if (w < 1 || h < 1) return;
    size_t pixel = (size_t)photo->channels;
    int x0 = (int)(igi_rng_float(rng) * (float)(photo->width - w));
    int y0 = (int)(igi_rng_float(rng) * (float)(photo->height - h));
    int x1 = (x0 + photo->width / 2) % (photo->width - w + 1);
    for (int y = y0; y < y0 + h; y++) {
        float *row = photo->samples + (size_t)y * (size_t)photo->width * pixel;
        memmove(row + (size_t)x0 * pixel, row + (size_t)x1 * pixel,
                (size_t)w * pixel * sizeof(float));
    }
}

/* In every other photograph a block, `severity` of it, shows something else. */
static igi_status moved(igi_context *ctx, const chart_change *c, double severity, chart_subject *s)
{
    (void)ctx;
    igi_rng rng = chart_stream(s, c->kind->name);
    for (size_t f = 0; f < s->scene->frame_count; f += 2) paste(s->photos[f], severity, &rng);
    return IGI_OK;
}

static void garble(igi_image *photo, const char *way, igi_rng *rng)
{
    size_t pixels = (size_t)photo->width * (size_t)photo->height, n = (size_t)photo->channels;
    for (size_t i = 0; strcmp(way, "shuffle") == 0 && i < pixels; i++) {
        size_t k = igi_rng_next(rng) % pixels;
        for (size_t c = 0; c < n; c++) {
            float kept = photo->samples[i * n + c];
            photo->samples[i * n + c] = photo->samples[k * n + c];
            photo->samples[k * n + c] = kept;
        }
    }
    for (size_t i = 0; strcmp(way, "black") == 0 && i < pixels * n; i++)
        if (i % n < n - 1) photo->samples[i] = 0;
    for (size_t y = 0; strcmp(way, "flip") == 0 && y < (size_t)photo->height / 2; y++)
        for (size_t i = 0; i < (size_t)photo->width * n; i++) {
            float *a = photo->samples + y * (size_t)photo->width * n + i,
                  *b = photo->samples + ((size_t)photo->height - 1 - y) * (size_t)photo->width * n +
                       i,
                  kept = *a;
            *a = *b;
            *b = kept;
        }
}

/* `severity` photographs are not what their camera saw: "swap" has them change places with their
 * neighbours in a ring; "shuffle", "flip" and "black" garble them. */
static igi_status corrupt(igi_context *ctx, const chart_change *c, double severity,
                          chart_subject *s)
{
    (void)ctx;
    size_t frames = s->scene->frame_count, count = (size_t)(severity + .5);
    igi_rng rng = chart_stream(s, c->kind->name);
    if (count > frames) return IGI_E_NO_ANSWER;
    size_t first = igi_rng_next(&rng) % frames, step = frames / (count ? count : 1);
    for (size_t k = 0; k < count; k++) {
        size_t f = (first + k * step) % frames, next = (f + step) % frames;
        s->spoilt[f] = true;
        if (strcmp(c->way, "swap") != 0) {
            garble(s->photos[f], c->way, &rng);
        } else if (k + 1 < count) {
            igi_image *kept = s->photos[f];
            s->photos[f] = s->photos[next];
            s->photos[next] = kept;
        }
    }
    return IGI_OK;
}

const chart_perturbation chart_perturb_photos[] = {
    {"clip", true, clip},   {"response", true, bend},     {"vignetting", true, vignette},
    {"noise", true, noise}, {"quantise", true, quantise}, {"broken", true, broken},
    {"glare", true, glare}, {"exposure", true, drift},    {"unit", true, unit},
    {"paste", true, moved}, {"corrupt", true, corrupt},   {NULL, false, NULL}};
