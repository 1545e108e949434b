/* SPDX-License-Identifier: Apache-2.0 */
#include "image/resample.h"

#include <math.h>
#include <string.h>

/* What one line of pixels becomes: result[i] = sum of weights over a run of the source. */
typedef struct axis {
    int *first, *count; /* [to] */
    float *weights;     /* [to][most] */
    int most;
} axis;

static void destroy_axis(axis *a)
{
    igi_free(a->first);
    igi_free(a->count);
    igi_free(a->weights);
}

static void weigh_area(axis *a, int i, double low, double high, int from)
{
    int first = (int)floor(low), last = (int)ceil(high) - 1;
    if (last > from - 1) last = from - 1;
    if (first > last) first = last;
    a->first[i] = first;
    a->count[i] = last - first + 1;
    for (int k = first; k <= last; k++) {
        double covered = fmin(high, k + 1) - fmax(low, k);
        a->weights[(size_t)i * (size_t)a->most + (size_t)(k - first)] = (float)(covered /
                                                                                (high - low));
    }
}

static void weigh_linear(axis *a, int i, double centre, int from)
{
    double at = fmin(fmax(centre - .5, 0), from - 1);
    int first = (int)at;
    float share = (float)(at - first), *w = a->weights + (size_t)i * (size_t)a->most;
    a->first[i] = first;
    a->count[i] = first + 1 < from ? 2 : 1;
    w[0] = a->count[i] == 2 ? 1 - share : 1;
    if (a->count[i] == 2) w[1] = share;
}

static igi_status make_axis(igi_context *ctx, int from, int to, axis *a)
{
    double scale = (double)from / to;
    a->most = (int)ceil(scale) + 2;
    IGI_TRY(IGI_ALLOC(ctx, (size_t)to, &a->first));
    IGI_TRY(IGI_ALLOC(ctx, (size_t)to, &a->count));
    IGI_TRY(IGI_ALLOC(ctx, (size_t)to * (size_t)a->most, &a->weights));
    for (int i = 0; i < to; i++) {
        if (scale > 1) weigh_area(a, i, i * scale, (i + 1) * scale, from);
        else weigh_linear(a, i, (i + .5) * scale, from);
    }
    return IGI_OK;
}

/* Along x when step is one pixel, along y when it is one row. */
static void apply(const axis *a, int to, const float *source, size_t source_step, float *target,
                  size_t target_step, size_t block)
{
    for (int i = 0; i < to; i++, target += target_step) {
        const float *w = a->weights + (size_t)i * (size_t)a->most;
        const float *s = source + (size_t)a->first[i] * source_step;
        for (int k = 0; k < a->count[i]; k++, s += source_step)
            for (size_t c = 0; c < block; c++) target[c] += w[k] * s[c];
    }
}

igi_status igi_image_resample(igi_context *ctx, const igi_image *image, int width, int height,
                              igi_image **result)
{
    igi_status status = IGI_OK;
    igi_image *wide = NULL;
    axis x = {0}, y = {0};
    size_t channels = (size_t)image->channels;
    *result = NULL;
    IGI_TRY_GOTO(make_axis(ctx, image->width, width, &x));
    IGI_TRY_GOTO(make_axis(ctx, image->height, height, &y));
    IGI_TRY_GOTO(igi_image_create(ctx, width, image->height, image->channels, &wide));
    IGI_TRY_GOTO(igi_image_create(ctx, width, height, image->channels, result));
    memcpy((*result)->names, image->names, sizeof image->names);
    (*result)->deviation = image->deviation;
    for (int row = 0; row < image->height; row++)
        apply(&x, width, image->samples + (size_t)row * (size_t)image->width * channels, channels,
              wide->samples + (size_t)row * (size_t)width * channels, channels, channels);
    size_t line = (size_t)width * channels;
    apply(&y, height, wide->samples, line, (*result)->samples, line, line);
cleanup:
    destroy_axis(&x);
    destroy_axis(&y);
    igi_image_destroy(wide);
    return status;
}

igi_status igi_image_reduce(igi_context *ctx, const igi_image *image, int side, igi_image **small)
{
    int longest = image->width > image->height ? image->width : image->height;
    double scale = longest > side ? (double)side / longest : 1;
    int width = (int)fmax(1, floor(image->width * scale + .5));
    int height = (int)fmax(1, floor(image->height * scale + .5));
    return igi_image_resample(ctx, image, width, height, small);
}

double igi_image_mean(const igi_image *image, int bands, double *mean)
{
    double counts[IGI_MAX_BANDS] = {0}, all = 0;
    size_t pixels = (size_t)image->width * (size_t)image->height;
    for (size_t i = 0; i < pixels; i++)
        for (int b = 0; b < bands; b++) {
            float x = image->samples[i * (size_t)image->channels + (size_t)b];
            if (!isfinite(x)) continue;
            mean[b] += (double)x;
            counts[b]++;
        }
    for (int b = 0; b < bands; b++) {
        mean[b] /= fmax(counts[b], 1);
        all += mean[b] / bands;
    }
    return all;
}
