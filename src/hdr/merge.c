/* SPDX-License-Identifier: Apache-2.0
 *
 * Merging: each photograph i measures the radiance as x_i / h_i, x by the response, h the exposure.
 *
 * With photons, read-out and codes as sources of noise, var x = k x + (s x'(z))^2: 1/k electrons at
 * full scale, s the noise in codes, x' the slope of the response. The best estimate weights by
 * w_i = h_i^2 / var x_i (for photons alone: the sum of all x over the sum of all h; Hanji et al.
 * 2020). Taking var from the noisy sample itself would bias the result low. So the photographs come
 * from the longest to the shortest, and each sample's weight follows from what the longer ones
 * said. Near saturation the weight fades out instead of ending, so that noise does not decide.
 *
 * A pixel costs its result alone: the radiance's place holds sum w x/h, the variance's sum w.
 */
#include "base/context.h"
#include "hdr/sight.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* Of the highest code: where weights begin to fade, and where they are gone. The shoulder of a
 * fitted response is the least known part of it. */
#define FADE_FROM .88
#define FADE_TO .98
#define FITTED_FADE_FROM .6
#define FITTED_FADE_TO .92
/* Where a longer exposure has spoken, samples below this many codes above the lowest known one
 * are not worth their bias. */
#define FLOOR_CODES (10. / 256)
/* What tells a thing that moved from noise and a rough response: exposures of at least .04 that differ by
 * a third (more where the response was fitted to the same pictures) and by six standard deviations. */
#define MOVED_LEAST .04f
#define MOVED_SHARE .33f
#define FITTED_MOVED_SHARE .6f
#define MOVED_SIGMAS 6.0
/* Its mark in the channel "saturated". */
#define MOVED_MARK .5f

void igi_merge_options_init(igi_merge_options *options)
{
    memset(options, 0, sizeof *options);
    options->struct_size = sizeof *options;
    options->align = options->refine = true;
}

void igi_merged_destroy(igi_merged *merged)
{
    if (!merged) return;
    igi_image_destroy(merged->image);
    igi_response_destroy(merged->response);
    igi_free(merged->frames);
    igi_free(merged->warning);
    igi_free(merged);
}

/* The noise model, tabulated over log2 of the exposure: by the float's upper bits, 64 steps an
 * octave. */
static size_t noise_index(float x)
{
    uint32_t bits;
    const uint32_t first = (127u - NOISE_OCTAVES) << 23;
    if (!(x > 0)) return 0;
    memcpy(&bits, &x, sizeof bits);
    if (bits <= first) return 0;
    size_t index = (bits - first) >> 17;
    return index < NOISE_SIZE ? index : NOISE_SIZE - 1;
}

static void tabulate_noise(const igi_response *response, int channel, const noise_model *model,
                           float table[NOISE_SIZE])
{
    int levels = response->levels, z = response->low[channel];
    const float *curve = response->exposure + (size_t)channel * (size_t)levels;
    for (int i = 0; i < NOISE_SIZE; i++) {
        double x = ldexp(1 + (i % 64 + .5) / 64, i / 64 - NOISE_OCTAVES);
        while (z + 2 < levels && (double)curve[z + 1] < x) z++;
        int z0 = z > 0 ? z - 1 : 0, z1 = z + 2 < levels ? z + 2 : levels - 1;
        double slope = ((double)curve[z1] - (double)curve[z0]) / (z1 - z0);
        double codes = model->read_noise * slope;
        table[i] = (float)(fmax(x, 0) / model->full_well_e + codes * codes + 1e-16);
    }
}

igi_status igi_accumulator_prepare(igi_context *ctx, const igi_photo *shape,
                                   const igi_response *response, const noise_model *model,
                                   accumulator *acc)
{
    int levels = response->levels;
    double from = model->fitted ? FITTED_FADE_FROM : FADE_FROM;
    double to = model->fitted ? FITTED_FADE_TO : FADE_TO;
    acc->channels = shape->channels;
    acc->fitted = model->fitted;
    IGI_TRY(
        igi_image_create(ctx, shape->width, shape->height, 2 * shape->channels + 1, &acc->image));
    IGI_TRY(IGI_ALLOC(ctx, (size_t)levels, &acc->fade));
    for (int z = 0; z < levels; z++) {
        double at = (double)z / (levels - 1);
        acc->fade[z] = (float)fmin(1, fmax(0, (to - at) / (to - from)));
    }
    for (int c = 0; c < shape->channels; c++) {
        tabulate_noise(response, c, model, acc->noise[c]);
        int floor_code = response->low[c] + (int)(FLOOR_CODES * levels);
        /* A linear response has no unknown toe: there only the noise at black matters. */
        if (response->low[c] == 0) floor_code = (int)ceil(2 * model->read_noise);
        if (floor_code > levels - 1) floor_code = levels - 1;
        acc->floor[c] = response->exposure[(size_t)c * (size_t)levels + (size_t)floor_code];
    }
    return IGI_OK;
}

void igi_accumulator_free(accumulator *acc)
{
    igi_image_destroy(acc->image);
    igi_free(acc->fade);
}

/* Squared residuals in units of their variance, counted in a histogram of their logarithm. */
static void note_residual(accumulator *acc, double u)
{
    int bin = (int)(8 * log2(fmax(u, 1e-12))) + RESIDUAL_BINS / 2;
    acc->residuals[bin < 0 ? 0 : bin >= RESIDUAL_BINS ? RESIDUAL_BINS - 1 : bin]++;
}

static float joint_fade(const accumulator *acc, const sight *s, bool linear)
{
    float fade = 1;
    /* A developed raw pixel mixes its sensor's channels: one clipped spoils all. */
    for (int c = 0; linear && c < acc->channels; c++)
        if (s->fade[c] < fade) fade = s->fade[c];
    return fade;
}

static void predict(const accumulator *acc, float h, const float *pixel, sight *s)
{
    for (int c = 0; c < acc->channels; c++) {
        float weight = pixel[2 * acc->channels - c];
        s->known[c] = weight > 0;
        s->predicted[c] = s->known[c] ? pixel[c] / weight * h : s->x[c];
    }
}

/* Something moved: where both are well exposed, the photograph shows clearly else than the longer
 * ones. They count, being the surer; the pixel is marked. */
static bool has_moved(const accumulator *acc, const sight *s, double h, const float *pixel)
{
    float share = acc->fitted ? FITTED_MOVED_SHARE : MOVED_SHARE;
    for (int c = 0; c < acc->channels; c++) {
        float x = s->x[c], predicted = s->predicted[c];
        float high = x > predicted ? x : predicted, off = fabsf(x - predicted);
        if (high < MOVED_LEAST || off < share * high) continue;
        if (s->between && predicted >= s->low[c] && predicted <= s->high[c])
            continue; /* an edge between pixels */
        if (!s->known[c] || s->fade[c] < 1) continue;
        double weight = (double)pixel[2 * acc->channels - c];
        double variance = (double)acc->noise[c][noise_index(predicted)] + h * h / weight;
        if ((double)(off * off) > MOVED_SIGMAS * MOVED_SIGMAS * variance) return true;
    }
    return false;
}

static void add_pixel(accumulator *acc, const sight *s, float joint, float h, float *pixel,
                      bool sample_residual)
{
    for (int c = 0; c < acc->channels; c++) {
        float *sum = &pixel[c], *weight = &pixel[2 * acc->channels - c];
        float fade = s->fade[c];
        if (joint < fade) fade = joint;
        if (!(fade > 0)) {
            acc->saturated++;
            continue;
        }
        if (s->known[c] && s->predicted[c] < acc->floor[c]) continue;
        float w = acc->weight[c][noise_index(s->predicted[c])];
        if (sample_residual && s->known[c] && fade >= 1) {
            double d = (double)((s->x[c] - s->predicted[c]) / h);
            note_residual(acc, d * d / (1 / (double)w + 1 / (double)*weight));
        }
        *sum += w * fade * s->x[c] / h;
        *weight += w * fade;
    }
}

/* Of so many pixels one tells of the scatter. */
#define RESIDUAL_STEP 29

void igi_accumulator_add(accumulator *acc, const igi_photo *photo, const igi_response *response,
                         double h, const igi_shift *shift)
{
    size_t channels = (size_t)acc->channels, stride = 2 * channels + 1;
    for (size_t c = 0; c < channels; c++)
        for (int i = 0; i < NOISE_SIZE; i++)
            acc->weight[c][i] = (float)(h * h / (double)acc->noise[c][i]);
    acc->saturated = acc->samples = acc->moved = 0;
    bool whole = igi_shift_is_whole(shift);
    sight s = {.between = !whole};
    const igi_motion motion = igi_motion_of(photo, shift);
    for (int y = 0; y < acc->image->height; y++)
        for (int x = 0; x < acc->image->width; x++) {
            if (!(whole ? igi_sight_look(acc, &motion, response, x, y, &s)
                        : igi_sight_look_between(acc, &motion, response, x, y, &s)))
                continue;
            size_t to = (size_t)y * (size_t)acc->image->width + (size_t)x;
            float *pixel = acc->image->samples + to * stride;
            predict(acc, (float)h, pixel, &s);
            acc->samples += channels;
            if (has_moved(acc, &s, h, pixel)) {
                pixel[channels] = MOVED_MARK;
                acc->moved++;
                if (!acc->fitted) continue; /* a rough curve marks more than what moved */
            }
            add_pixel(acc, &s, joint_fade(acc, &s, photo->linear), (float)h, pixel,
                      to % RESIDUAL_STEP == 0);
        }
}

/* The median of a squared standard normal is .4549. */
static double measured_scatter(const accumulator *acc)
{
    uint64_t total = 0, sum = 0;
    for (int i = 0; i < RESIDUAL_BINS; i++) total += acc->residuals[i];
    if (total < 1000) return 1;
    for (int i = 0; i < RESIDUAL_BINS; i++) {
        sum += acc->residuals[i];
        if (sum >= total / 2) return sqrt(exp2((i + .5 - RESIDUAL_BINS / 2) / 8) / .4549);
    }
    return 1;
}

/* Without so many of a float's 23 bits: they are noise, more than half of the file, and most of the time
 * that compressing it takes. A radiance keeps what a half float has, .05 %, a tenth of what photons leave
 * of the best pixels; a variance, which is never known to that, 3 %. */
#define RADIANCE_BITS 13
#define VARIANCE_BITS 19
static float rounded(float x, int dropped)
{
    uint32_t bits;
    memcpy(&bits, &x, sizeof bits);
    bits = (bits + (1u << (dropped - 1))) & ~((1u << dropped) - 1);
    memcpy(&x, &bits, sizeof bits);
    return x;
}

/* Where nothing was below saturation, the shortest exposure's full scale is a lower bound. */
double igi_accumulator_finish(accumulator *acc, double shortest_h, bool noise_is_known)
{
    igi_image *image = acc->image;
    size_t count = (size_t)image->width * (size_t)image->height;
    size_t channels = (size_t)acc->channels, stride = 2 * channels + 1;
    double scatter = measured_scatter(acc);
    double scale = noise_is_known ? 1 : scatter * scatter;
    for (float *pixel = image->samples; count--; pixel += stride) {
        for (size_t c = 0; c < channels; c++) {
            float *variance = &pixel[channels + 1 + (channels - 1 - c)];
            if (*variance > 0) {
                pixel[c] = rounded(pixel[c] / *variance, RADIANCE_BITS);
                *variance = rounded((float)(scale / (double)*variance), VARIANCE_BITS);
            } else {
                pixel[c] = (float)(1 / shortest_h);
                *variance = rounded(pixel[c] * pixel[c], VARIANCE_BITS);
                pixel[channels] = 1;
            }
        }
    }
    snprintf(image->names[channels], IGI_CHANNEL_NAME_SIZE, "saturated");
    for (size_t c = 0; c < channels; c++) {
        const char *name = channels == 1 ? "Y" : &"R\0G\0B"[2 * c];
        snprintf(image->names[c], IGI_CHANNEL_NAME_SIZE, "%s", name);
        snprintf(image->names[2 * channels - c], IGI_CHANNEL_NAME_SIZE, "variance.%s", name);
    }
    return scatter;
}
