/* SPDX-License-Identifier: Apache-2.0
 *
 * Of a place that several photographs show, the others tell the brightness M (their median), and
 * photograph f shows
 *     B = s M + o:
 * s its gain, which bright places tell, o its veil, which dark ones do. A glossy surface that shines
 * toward one camera looks like a veil on that surface; so every region has one voice, the median of
 * its dark places, and the lower quartile of the regions' voices counts: a veil spares none.
 */
#include "observe/glare.h"

#include "observe/glimpses.h"

#include "base/order.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FEWEST_FRAMES 3
#define FEWEST_PLACES 5  /* of a region, to have a voice */
#define FEWEST_REGIONS 3 /* with one */
#define ROUNDS 5
#define CLEAR_SHARE .05 /* glossy rooms and coarse photographs reach .03 without a veil */
#define CLEAR_SIGMAS 4.0

typedef struct view {
    double b, m; /* this photograph's brightness, the others' */
    uint32_t region;
} view;

typedef struct session {
    igi_glimpses g;
    size_t regions;
    view *views;    /* [glimpses] of one frame */
    double *values; /* [glimpses], */
    double *voices; /* [regions] scratch */
} session;

static double quantile(double *values, size_t count, double share)
{
    if (count == 0) return 0;
    qsort(values, count, sizeof *values, igi_compare_doubles);
    return values[(size_t)(share * (double)count)];
}

static double median(double *values, size_t count)
{
    return quantile(values, count, .5);
}

static int by_region(const void *a, const void *b)
{
    const view *x = a, *y = b;
    if (x->region != y->region) return x->region < y->region ? -1 : 1;
    if (x->m != y->m) return x->m < y->m ? -1 : 1;
    return (x->b > y->b) - (x->b < y->b);
}

/* What the frame and the others show of the places that enough of them see. */
static size_t collect(session *s, uint32_t frame)
{
    const igi_glimpses *g = &s->g;
    size_t count = 0;
    for (size_t p = 0; p < g->place_count; p++) {
        size_t others = 0;
        const igi_glimpse *own = NULL;
        for (size_t i = g->begin[p]; i < g->begin[p + 1]; i++) {
            if (g->glimpses[i].frame == frame) own = &g->glimpses[i];
            else s->values[others++] = exp((double)g->glimpses[i].value);
        }
        if (!own || others + 1 < FEWEST_FRAMES) continue;
        s->views[count++] = (view){exp((double)own->value), median(s->values, others),
                                   g->region[p]};
    }
    qsort(s->views, count, sizeof *s->views, by_region);
    return count;
}

/* One voice a region, in s->voices. */
static size_t hear_regions(session *s, size_t count, double dark, double gain)
{
    size_t voices = 0;
    for (size_t i = 0; i < count;) {
        size_t n = 0, end = i;
        for (; end < count && s->views[end].region == s->views[i].region; end++)
            if (s->views[end].m <= dark) s->values[n++] = s->views[end].b - gain * s->views[end].m;
        if (n >= FEWEST_PLACES) s->voices[voices++] = median(s->values, n);
        i = end;
    }
    return voices;
}

static void estimate(session *s, size_t count, igi_glare *glare)
{
    double mean = 0, gain = 1, veil = 0, dark;
    size_t voices = 0;
    *glare = (igi_glare){0, (double)INFINITY};
    for (size_t i = 0; i < count; i++) {
        s->values[i] = s->views[i].m;
        mean += s->views[i].b / (double)count;
    }
    dark = median(s->values, count);
    for (int round = 0; round < ROUNDS; round++) {
        size_t n = 0;
        for (size_t i = 0; i < count; i++)
            if (s->views[i].m > dark) s->values[n++] = (s->views[i].b - veil) / s->views[i].m;
        gain = median(s->values, n);
        voices = hear_regions(s, count, dark, gain);
        if (voices < FEWEST_REGIONS) return;
        veil = quantile(s->voices, voices, .25);
    }
    for (size_t i = 0; i < voices; i++) s->voices[i] = fabs(s->voices[i] - veil);
    glare->share = veil / mean;
    glare->sigma = 1.4826 * median(s->voices, voices) / sqrt((double)voices) / mean;
}

igi_status igi_glare_estimate(igi_context *ctx, const igi_scene *scene,
                              const igi_observations *observations, igi_glare *glares)
{
    igi_status status = IGI_OK;
    session s = {.regions = scene->region_count};
    IGI_TRY_GOTO(igi_glimpses_create(ctx, scene, observations, &s.g));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, s.g.count + 1, &s.views));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, s.g.count + 1, &s.values));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, s.regions, &s.voices));
    for (size_t f = 0; f < observations->frame_count; f++)
        estimate(&s, collect(&s, (uint32_t)f), &glares[f]);
cleanup:
    igi_glimpses_clear(&s.g);
    igi_free(s.views);
    igi_free(s.values);
    igi_free(s.voices);
    return status;
}

igi_status igi_observations_warn_of_glare(igi_context *ctx, const igi_scene *scene,
                                          igi_observations *observations)
{
    igi_observations *o = observations;
    igi_status status = IGI_OK;
    igi_glare *glares;
    IGI_TRY(IGI_ALLOC(ctx, o->frame_count, &glares));
    IGI_TRY_GOTO(igi_glare_estimate(ctx, scene, o, glares));
    for (size_t f = 0; f < o->frame_count; f++) {
        char *sentence;
        const igi_glare *g = &glares[f];
        if (!(g->share > CLEAR_SHARE && g->share > CLEAR_SIGMAS * g->sigma)) continue;
        IGI_TRY_GOTO(
            igi_strprintf(ctx, &sentence,
                          "image %s: a veil of %.1f +- %.1f %% of its mean brightness lies "
                          "over it: light shines into the lens; shade the lens, or leave "
                          "the image out",
                          scene->frames[f].name, 100 * g->share, 100 * g->sigma));
        IGI_TRY_GOTO(igi_add_sentence(ctx, &o->warnings, &o->warning_count, sentence));
    }
cleanup:
    igi_free(glares);
    return status;
}
