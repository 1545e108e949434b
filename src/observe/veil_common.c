/* SPDX-License-Identifier: Apache-2.0
 *
 * The share that all photographs have: with means over the photographs of a place,
 *     (B_pf - B_p) / B_p = s (M_f - M_p) / B_p,
 * a line through the origin, steep where the scene is dark. B_p is the mean over all photographs, this
 * one too: then noise in the denominator cancels to the second order, where a mean of the others passes
 * for a veil, being low by chance where it weighs most.
 *
 * Gloss imitates a veil (dark surfaces that shine toward cameras which look at the lamp), and exposures
 * that drift do. So each region is one voice, as sure as its photographs agree; what regions differ by
 * beyond that makes all of them less sure (DerSimonian and Laird 1986); and photographs are left out in
 * turn for what regions have in common.
 */
#include "observe/glare.h"

#include "base/order.h"

#include <math.h>

#define FEWEST_FRAMES 4 /* of a region, to have a voice, and of all */
#define FEWEST_VOICES 3

typedef struct cell {
    double xx, xy;
} cell;

typedef struct voice {
    double share, variance; /* of the share, by the scatter of photographs */
    double weight;
    cell sum;
    const cell *frames;
} voice;

typedef struct session {
    size_t frames, regions, count; /* of voices */
    const double *bright;          /* [frames] M; NULL: the glow around each place is its M */
    cell *cells;                   /* [regions][frames] */
    voice *voices;                 /* [regions] */
    double *scratch;
} session;

static double light_of(const session *s, const igi_glimpse *g)
{
    return s->bright ? s->bright[g->frame] : (double)g->glow;
}

static void add_place(session *s, const igi_glimpses *g, size_t place)
{
    size_t begin = g->begin[place], n = g->begin[place + 1] - begin;
    double b = 0, m = 0;
    if (n < 2) return;
    for (size_t i = begin; i < begin + n; i++) {
        b += exp((double)g->glimpses[i].value) / (double)n;
        m += light_of(s, &g->glimpses[i]) / (double)n;
    }
    for (size_t i = begin; i < begin + n; i++) {
        size_t frame = g->glimpses[i].frame;
        cell *c = &s->cells[g->region[place] * s->frames + frame];
        double x = (light_of(s, &g->glimpses[i]) - m) / b,
               y = exp((double)g->glimpses[i].value) / b - 1;
        c->xx += x * x;
        c->xy += x * y;
    }
}

/* What a region says, and how its photographs scatter about that: photographs are clusters. */
static bool hear(const cell *cells, size_t frames, voice *v)
{
    size_t used = 0;
    double square = 0;
    *v = (voice){.frames = cells};
    for (size_t f = 0; f < frames; f++) {
        v->sum.xx += cells[f].xx;
        v->sum.xy += cells[f].xy;
        used += cells[f].xx > 0;
    }
    if (used < FEWEST_FRAMES) return false;
    v->share = v->sum.xy / v->sum.xx;
    for (size_t f = 0; f < frames; f++) {
        double off = cells[f].xy - v->share * cells[f].xx;
        square += off * off;
    }
    v->variance = square / (v->sum.xx * v->sum.xx) * (double)used / (double)(used - 1);
    return true;
}

/* By few photographs a scatter may come out small by chance: none is surer than what it has seen and
 * the usual scatter make it. */
static void hold_variances(session *s)
{
    for (size_t i = 0; i < s->count; i++)
        s->scratch[i] = s->voices[i].variance * s->voices[i].sum.xx;
    double usual = igi_median(s->scratch, s->count);
    for (size_t i = 0; i < s->count; i++)
        s->voices[i].variance = fmax(s->voices[i].variance, usual / s->voices[i].sum.xx);
}

static double between_regions(const session *s)
{
    double w = 0, ww = 0, mean = 0, q = 0;
    for (size_t i = 0; i < s->count; i++) {
        double weight = 1 / s->voices[i].variance;
        w += weight;
        ww += weight * weight;
        mean += weight * s->voices[i].share;
    }
    mean /= w;
    for (size_t i = 0; i < s->count; i++) {
        double off = s->voices[i].share - mean;
        q += off * off / s->voices[i].variance;
    }
    return fmax(0, (q - (double)(s->count - 1)) / (w - ww / w));
}

/* Without one photograph; SIZE_MAX: with all. */
static double mean_without(const session *s, size_t frame)
{
    double sum = 0, weights = 0;
    for (size_t i = 0; i < s->count; i++) {
        const voice *v = &s->voices[i];
        cell c = v->sum;
        if (frame != SIZE_MAX) c.xx -= v->frames[frame].xx, c.xy -= v->frames[frame].xy;
        if (!(c.xx > 0)) continue;
        double weight = v->weight * c.xx / v->sum.xx;
        sum += weight * c.xy / c.xx;
        weights += weight;
    }
    return weights > 0 ? sum / weights : 0;
}

static igi_glare estimate(session *s)
{
    double weights = 0, between, jackknife = 0;
    if (s->count < FEWEST_VOICES || s->frames < FEWEST_FRAMES)
        return (igi_glare){0, (double)INFINITY, 1};
    hold_variances(s);
    between = between_regions(s);
    for (size_t i = 0; i < s->count; i++) {
        s->voices[i].weight = 1 / (s->voices[i].variance + between);
        weights += s->voices[i].weight;
    }
    double share = mean_without(s, SIZE_MAX), n = (double)s->frames;
    for (size_t f = 0; f < s->frames; f++) {
        double off = mean_without(s, f) - share;
        jackknife += (n - 1) / n * off * off;
    }
    return (igi_glare){share, sqrt(fmax(jackknife, 1 / weights)), 1 - share};
}

igi_status igi_glare_common(igi_context *ctx, const igi_glimpses *glimpses, size_t regions,
                            const double *bright, size_t frames, igi_glare *glare)
{
    igi_status status = IGI_OK;
    session s = {.frames = frames, .regions = regions, .bright = bright};
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions * frames, &s.cells));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions, &s.voices));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions, &s.scratch));
    for (size_t p = 0; p < glimpses->place_count; p++) add_place(&s, glimpses, p);
    for (size_t r = 0; r < regions; r++)
        s.count += hear(s.cells + r * frames, frames, &s.voices[s.count]);
    *glare = estimate(&s);
cleanup:
    igi_free(s.cells);
    igi_free(s.voices);
    igi_free(s.scratch);
    return status;
}
