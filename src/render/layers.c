/* SPDX-License-Identifier: Apache-2.0
 *
 * A progressive frame. Passes are independent pictures; the mean of n of them has 1/n of the mean of
 * their variances. It goes on while sum sigma > target * sum L over the pixels, so that dark pixels,
 * whose relative noise means little, do not decide.
 */
#include "render/layers.h"

#include "base/order.h"
#include "base/rng.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#define MOST_PASSES 4096

static igi_status create(igi_context *ctx, const igi_camera *camera, bool apart, layered_frame *f)
{
    for (int k = 0; k < (apart ? LAYERS : LAYER_DIRECT); k++)
        IGI_TRY(igi_image_create(ctx, camera->width, camera->height, f->bands, &f->layers[k]));
    return IGI_OK;
}

void layered_frame_clear(layered_frame *f)
{
    for (int k = 0; k < LAYERS; k++) {
        igi_image_destroy(f->layers[k]);
        f->layers[k] = NULL;
    }
}

static size_t values_of(const layered_frame *f)
{
    const igi_image *picture = f->layers[LAYER_PICTURE];
    return (size_t)picture->width * (size_t)picture->height * (size_t)f->bands;
}

static igi_status render_pass(igi_context *ctx, const igi_renderer *renderer,
                              const igi_camera *camera, uint64_t key,
                              const igi_render_options *options, layered_frame *f)
{
    bool apart = f->layers[LAYER_DIRECT] != NULL;
    igi_layers layers = {.pictures = &f->layers[LAYER_PICTURE],
                         .variances = &f->layers[LAYER_VARIANCE],
                         .direct = apart ? &f->layers[LAYER_DIRECT] : NULL,
                         .albedos = apart ? &f->layers[LAYER_ALBEDO] : NULL};
    return igi_renderer_frames(ctx, renderer, camera, 1, options, key, &layers);
}

/* The mean of `n` passes so far and one more. */
static void add_pass(layered_frame *f, const layered_frame *next, int n)
{
    size_t count = values_of(f);
    float before = (float)n / (float)(n + 1), now = 1 / (float)(n + 1);
    for (int k = 0; k < LAYERS; k++) {
        float a = k == LAYER_VARIANCE ? before * before : before;
        float b = k == LAYER_VARIANCE ? now * now : now;
        for (size_t i = 0; f->layers[k] && i < count; i++)
            f->layers[k]->samples[i] = a * f->layers[k]->samples[i] +
                                       b * next->layers[k]->samples[i];
    }
}

static double noise_of(const layered_frame *f)
{
    double sigma = 0, radiance = 0;
    size_t count = values_of(f);
    for (size_t i = 0; i < count; i++) {
        sigma += sqrt((double)f->layers[LAYER_VARIANCE]->samples[i]);
        radiance += (double)f->layers[LAYER_PICTURE]->samples[i];
    }
    return radiance > 0 ? sigma / radiance : 0;
}

igi_status layered_frame_render(igi_context *ctx, const igi_renderer *renderer,
                                const igi_camera *camera, uint64_t key,
                                const igi_render_options *options, double target, bool apart,
                                int bands, layered_frame *f)
{
    igi_status status = IGI_OK;
    layered_frame next = {.bands = bands};
    igi_render_options pass = *options;
    *f = (layered_frame){.bands = bands};
    if (target > 0 && pass.samples < 16) pass.samples = 16; /* or the variance is not known */
    IGI_TRY_GOTO(create(ctx, camera, apart, f));
    IGI_TRY_GOTO(render_pass(ctx, renderer, camera, key, &pass, f));
    f->samples = pass.samples;
    f->noise = noise_of(f);
    if (target > 0) IGI_TRY_GOTO(create(ctx, camera, apart, &next));
    for (int n = 1; target > 0 && f->noise > target && n < MOST_PASSES; n++) {
        IGI_TRY_GOTO(
            render_pass(ctx, renderer, camera, key ^ igi_hash64((uint64_t)n), &pass, &next));
        add_pass(f, &next, n);
        f->samples += pass.samples;
        f->noise = noise_of(f);
    }
cleanup:
    layered_frame_clear(&next);
    if (status != IGI_OK) layered_frame_clear(f);
    return status;
}

igi_status layered_frame_join(igi_context *ctx, const layered_frame *f, igi_image **joined)
{
    /* "indirect" is what the picture has beside "direct". */
    static const char *const names[] = {"albedo", "direct", "indirect", "variance"};
    static const int from[] = {LAYER_ALBEDO, LAYER_DIRECT, LAYER_PICTURE, LAYER_VARIANCE};
    const igi_image *like = f->layers[LAYER_PICTURE];
    int bands = f->bands, channels = 4 * bands;
    if (channels > IGI_MAX_BANDS)
        return igi_fail(ctx, IGI_E_USAGE, "layers: of %d bands there are more than one file holds",
                        bands);
    IGI_TRY(igi_image_create(ctx, like->width, like->height, channels, joined));
    size_t pixels = (size_t)like->width * (size_t)like->height;
    for (int c = 0; c < channels; c++) {
        int k = c / bands, b = c % bands;
        const float *source = f->layers[from[k]]->samples + b;
        const float *direct = f->layers[LAYER_DIRECT]->samples + b;
        snprintf((*joined)->names[c], IGI_CHANNEL_NAME_SIZE, "%s.%s", names[k], like->names[b]);
        for (size_t i = 0; i < pixels; i++) {
            size_t at = i * (size_t)bands;
            (*joined)->samples[i * (size_t)channels + (size_t)c] = source[at] -
                                                                   (k == 2 ? direct[at] : 0);
        }
    }
    return IGI_OK;
}

igi_status layered_frame_exposure(igi_context *ctx, const layered_frame *f, float *exposure)
{
    const igi_image *picture = f->layers[LAYER_PICTURE];
    size_t pixels = (size_t)picture->width * (size_t)picture->height;
    float *means;
    IGI_TRY(IGI_ALLOC(ctx, pixels, &means));
    for (size_t i = 0; i < pixels; i++)
        for (int b = 0; b < f->bands; b++)
            means[i] += picture->samples[i * (size_t)f->bands + (size_t)b] / (float)f->bands;
    qsort(means, pixels, sizeof *means, igi_compare_floats);
    float white = means[pixels * 95 / 100];
    *exposure = white > 0 ? 0.8f / white : 1;
    igi_free(means);
    return IGI_OK;
}
