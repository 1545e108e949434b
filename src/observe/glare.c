/* SPDX-License-Identifier: Apache-2.0
 *
 * Which veils are clear, and what is left when they are gone.
 */
#include "observe/glare.h"

#include "image/resample.h"

#include <math.h>

/* Of one photograph: less is not worth a word. */
#define OWN_SHARE .02
#define COMMON_SHARE .0015
#define CLEAR_SIGMAS 5.0
/* Of what ten regions say together: so few have Student's tails (5.4 in one of 500 rooms without a veil). */
#define COMMON_SIGMAS 7.0
#define MOST_SHARE .5 /* more is no veil, but another picture */

static bool is_clear(const igi_glare *g, double least, double sigmas)
{
    return g->share > least && g->share < MOST_SHARE && g->share > sigmas * g->sigma;
}

static double lifted(double x, const igi_veil *veil, double mean)
{
    return (x - veil->share * mean) / veil->kept;
}

/* Light of the picture that strays is missing where it belongs; light from beside the picture is not.
 * Exposures differ, too: between the two there is nothing. */
static igi_veil veil_of(const igi_glare *g)
{
    return (igi_veil){g->share, g->gain < 1 - g->share / 2 ? 1 - g->share : 1};
}

static void lift(igi_observations *o, size_t frame, igi_veil v)
{
    size_t bands = (size_t)o->bands;
    double *mean = o->mean + frame * bands;
    for (size_t k = o->frame_begin[frame] * bands; k < o->frame_begin[frame + 1] * bands; k++)
        o->radiance[k] = (float)lifted((double)o->radiance[k], &v, mean[k % bands]);
    for (size_t k = 0; k < o->reading_count; k++)
        for (size_t b = 0; o->readings[k].frame == frame && b < bands; b++) {
            igi_lamp_reading *r = &o->readings[k];
            r->radiance[b] = lifted(r->radiance[b], &v, mean[b]);
            r->error[b] /= v.kept;
            r->highest[b] = (float)lifted((double)r->highest[b], &v, mean[b]);
        }
    for (size_t b = 0; b < bands; b++) mean[b] = lifted(mean[b], &v, mean[b]);
    igi_veil *all = &o->veils[frame];
    all->share += (1 - all->share) * v.share;
    all->kept *= v.kept;
}

void igi_glare_lift_image(const igi_observations *o, size_t frame, igi_image *image)
{
    size_t pixels = (size_t)image->width * (size_t)image->height;
    double mean[IGI_MAX_BANDS] = {0};
    if (o->veils[frame].share == 0) return;
    igi_image_mean(image, o->bands, mean);
    for (size_t i = 0; i < pixels; i++)
        for (int b = 0; b < o->bands; b++) {
            float *x = &image->samples[i * (size_t)image->channels + (size_t)b];
            *x = (float)lifted((double)*x, &o->veils[frame], mean[b]);
        }
}

/* Of all bands together, as glimpses have them. */
static igi_status find_brightness(igi_context *ctx, const igi_observations *o, double **bright)
{
    IGI_TRY(IGI_ALLOC(ctx, o->frame_count, bright));
    for (size_t k = 0; k < o->frame_count * (size_t)o->bands; k++)
        (*bright)[k / (size_t)o->bands] += o->mean[k];
    return IGI_OK;
}

igi_status igi_observations_lift_common_veil(igi_context *ctx, const igi_scene *scene,
                                             const igi_glimpses *glimpses,
                                             igi_observations *observations, bool *lifted)
{
    igi_observations *o = observations;
    double *bright;
    char *sentence;
    igi_glare g;
    *lifted = false;
    IGI_TRY(find_brightness(ctx, o, &bright));
    igi_status status = igi_glare_common(ctx, glimpses, scene->region_count, bright, o->frame_count,
                                         &g);
    igi_free(bright);
    if (status != IGI_OK || !is_clear(&g, COMMON_SHARE, COMMON_SIGMAS)) return status;
    *lifted = true;
    for (size_t f = 0; f < o->frame_count; f++) lift(o, f, veil_of(&g));
    IGI_TRY(
        igi_strprintf(ctx, &sentence,
                      "%.2f %% of the light strayed over the photographs (glare), and was taken "
                      "off again; +- %.2f %% may be left: shade the lens from the lamps",
                      100 * g.share, 100 * g.sigma));
    return igi_add_sentence(ctx, &o->warnings, &o->warning_count, sentence);
}

igi_status igi_observations_tell_uneven_veil(igi_context *ctx, const igi_scene *scene,
                                             const igi_glimpses *glimpses,
                                             igi_observations *observations)
{
    igi_observations *o = observations;
    char *sentence;
    igi_glare g;
    IGI_TRY(igi_glare_common(ctx, glimpses, scene->region_count, NULL, o->frame_count, &g));
    if (!is_clear(&g, COMMON_SHARE, CLEAR_SIGMAS)) return IGI_OK;
    IGI_TRY(igi_strprintf(
        ctx, &sentence,
        "places are brighter in photographs that show something bright near them: %.1f %% of the "
        "light strays around what is bright (glare, a soft lens, a dirty filter); it is not taken "
        "off: shade the lens from the lamps, clean it, stop it down",
        100 * g.share));
    return igi_add_sentence(ctx, &o->warnings, &o->warning_count, sentence);
}

igi_status igi_observations_lift_own_veils(igi_context *ctx, const igi_scene *scene,
                                           const igi_glimpses *glimpses,
                                           igi_observations *observations, bool *lifted)
{
    igi_observations *o = observations;
    igi_status status = IGI_OK;
    igi_glare *glares = NULL;
    double *bright = NULL;
    *lifted = false;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, o->frame_count, &glares));
    IGI_TRY_GOTO(find_brightness(ctx, o, &bright));
    IGI_TRY_GOTO(igi_glare_own(ctx, glimpses, scene->region_count, bright, o->frame_count, glares));
    for (size_t f = 0; f < o->frame_count; f++) {
        char *sentence;
        const igi_glare *g = &glares[f];
        if (!is_clear(g, OWN_SHARE, CLEAR_SIGMAS)) continue;
        *lifted = true;
        lift(o, f, veil_of(g));
        IGI_TRY_GOTO(igi_strprintf(
            ctx, &sentence,
            "image %s: a veil of %.1f %% of its mean brightness lay over it, and was taken off; "
            "+- %.1f %% may be left: light shines into the lens; shade it, or leave the image out",
            scene->frames[f].name, 100 * g->share, 100 * g->sigma));
        IGI_TRY_GOTO(igi_add_sentence(ctx, &o->warnings, &o->warning_count, sentence));
    }
cleanup:
    igi_free(glares);
    igi_free(bright);
    return status;
}
