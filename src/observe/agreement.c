/* SPDX-License-Identifier: Apache-2.0
 *
 * With v_pf the logarithm of the brightness that photograph f shows of place p,
 *     v_pf = m_p + g_f + error,
 * medians in turn give m and g, so that neither highlights nor a photograph of something else have
 * a say. How much photographs differ about a region when nothing is wrong (gloss, texture, noise)
 * the region itself tells: the median of |error| over all of it. A photograph contradicts the others
 * at a place when it is off by many times that.
 */
#include "observe/agreement.h"

#include "base/order.h"

#include <math.h>
#include <stdlib.h>

#define FEWEST_FRAMES 3
#define ROUNDS 4
#define FEWEST_GLIMPSES 20 /* of a region, for a spread of its own */
#define FEWEST_TO_TELL 5   /* of a region in one photograph, to say something about its gain, */
#define FEWEST_REGIONS 3   /* and of regions that do; of fewer, places are no witnesses apart */
#define LEAST_SPREAD 0.01
#define GAIN_SIGMAS 3.0 /* of its error, or it is none: a mirrored sun is no exposure */
/* Off by more than so many spreads of the region, and by more than this. */
#define CONTRADICTION_SIGMAS 6.0
#define CONTRADICTION 0.3
#define DARK 1.1   /* ln 3 */
#define AGREE 0.65 /* of the others must agree with each other */

/* Places of one region in a photograph. */
typedef struct verdict {
    double places, brighter, darker, dark;
} verdict;

typedef struct session {
    size_t frames, regions;
    const igi_glimpses *g;
    double *middle;        /* [places] m */
    double *gain;          /* [frames] g */
    double *spread;        /* [regions] */
    size_t *by_frame;      /* [frames + 1] */
    uint32_t *of_frame;    /* glimpses sorted by frame */
    double *values;        /* [glimpses] scratch */
    double *off;           /* [glimpses] sorted by frame: from the others' middle */
    double *voices;        /* [glimpses or regions] scratch */
    double (*weighted)[2]; /* [glimpses] */
    verdict *verdicts;     /* [regions] of one photograph */
} session;

/* Of pairs (value, weight). */
static double weighted_median(double (*pairs)[2], size_t count)
{
    double all = 0, below = 0;
    qsort(pairs, count, sizeof *pairs, igi_compare_doubles);
    for (size_t i = 0; i < count; i++) all += pairs[i][1];
    for (size_t i = 0; i < count; i++) {
        below += pairs[i][1];
        if (2 * below >= all) return pairs[i][0];
    }
    return 0;
}

static bool is_shared(const session *s, uint32_t place)
{
    return s->g->begin[place + 1] - s->g->begin[place] >= FEWEST_FRAMES;
}

static double error_of(const session *s, const igi_glimpse *glimpse)
{
    return (double)glimpse->value - s->gain[glimpse->frame] - s->middle[glimpse->place];
}

static void find_middles(session *s)
{
    for (uint32_t p = 0; p < s->g->place_count; p++) {
        size_t n = 0;
        for (size_t i = s->g->begin[p]; i < s->g->begin[p + 1]; i++)
            s->values[n++] = (double)s->g->glimpses[i].value - s->gain[s->g->glimpses[i].frame];
        s->middle[p] = igi_median(s->values, n);
    }
}

/* Robust standard deviation of the errors of each region; of a rare one, that of all. */
static igi_status find_spreads(igi_context *ctx, session *s)
{
    size_t *begin;
    IGI_TRY(IGI_ALLOC(ctx, s->regions + 2, &begin));
    for (int pass = 0; pass < 2; pass++) {
        for (size_t i = 0; i < s->g->count; i++) {
            const igi_glimpse *glimpse = &s->g->glimpses[i];
            uint32_t region = s->g->region[glimpse->place];
            if (!is_shared(s, glimpse->place)) continue;
            if (pass == 0) begin[region + 2]++;
            else s->values[begin[region + 1]++] = fabs(error_of(s, glimpse));
        }
        for (size_t r = 0; pass == 0 && r < s->regions; r++) begin[r + 2] += begin[r + 1];
    }
    for (size_t r = 0; r < s->regions; r++) {
        size_t n = begin[r + 1] - begin[r];
        s->spread[r] = n < FEWEST_GLIMPSES ? -1 : 1.4826 * igi_median(s->values + begin[r], n);
    }
    double typical = 1.4826 * igi_median(s->values, begin[s->regions]);
    for (size_t r = 0; r < s->regions; r++)
        s->spread[r] = fmax(LEAST_SPREAD, s->spread[r] < 0 ? typical : s->spread[r]);
    igi_free(begin);
    return IGI_OK;
}

/* The place's brightness as all photographs but this one have it: with itself among them, the median
 * would hardly move from what it says where three or four see a place. */
static double middle_of_others(const session *s, const igi_glimpse *glimpse, double *values)
{
    size_t n = 0;
    for (size_t i = s->g->begin[glimpse->place]; i < s->g->begin[glimpse->place + 1]; i++) {
        const igi_glimpse *other = &s->g->glimpses[i];
        if (other != glimpse) values[n++] = (double)other->value - s->gain[other->frame];
    }
    return igi_median(values, n);
}

/* Gains, and how well they are known: regions that look alike from everywhere tell most. */
static void find_gain(session *s, size_t frame, igi_frame_agreement *out)
{
    size_t n = 0;
    double weights = 0;
    for (size_t k = s->by_frame[frame]; k < s->by_frame[frame + 1]; k++) {
        const igi_glimpse *glimpse = &s->g->glimpses[s->of_frame[k]];
        if (!is_shared(s, glimpse->place)) continue;
        double spread = s->spread[s->g->region[glimpse->place]];
        s->off[k] = (double)glimpse->value - middle_of_others(s, glimpse, s->values);
        s->weighted[n][0] = s->off[k];
        s->weighted[n++][1] = 1 / (spread * spread);
        weights += 1 / (spread * spread);
    }
    out->places = n;
    if (n == 0) return;
    s->gain[frame] = weighted_median(s->weighted, n);
    out->gain_error = 1.2533 / sqrt(weights);
}

/* What a photograph shows of one region, against the others and its gain: into values. */
static size_t look_at_region(const session *s, size_t frame, uint32_t region, double *values)
{
    size_t n = 0;
    for (size_t k = s->by_frame[frame]; k < s->by_frame[frame + 1]; k++) {
        uint32_t place = s->g->glimpses[s->of_frame[k]].place;
        if (is_shared(s, place) && s->g->region[place] == region)
            values[n++] = s->off[k] - s->gain[frame];
    }
    return n;
}

/* A wrong exposure is the same on every surface. What a surface that shines does to the gain differs
 * from region to region, and is no error of its places alone. */
static void find_gain_error(session *s, size_t frame, igi_frame_agreement *out)
{
    size_t voices = 0;
    if (out->places == 0) return;
    for (uint32_t r = 0; r < s->regions; r++) {
        size_t n = look_at_region(s, frame, r, s->values);
        if (n >= FEWEST_TO_TELL) s->voices[voices++] = fabs(igi_median(s->values, n));
    }
    double scatter = voices > 1 ? 1.4826 * igi_median(s->voices, voices) : 0;
    out->gain_error = fmax(out->gain_error, 1.2533 * scatter / sqrt(fmax(1, (double)voices)));
    if (voices >= FEWEST_REGIONS) return;
    for (size_t i = 0; i < out->places; i++)
        s->voices[i] = fabs(s->weighted[i][0] - s->gain[frame]);
    out->gain_error = fmax(out->gain_error, 1.4826 * igi_median(s->voices, out->places));
}

static igi_status sort_by_frame(igi_context *ctx, session *s)
{
    IGI_TRY(IGI_ALLOC(ctx, s->frames + 2, &s->by_frame));
    IGI_TRY(IGI_ALLOC(ctx, s->g->count, &s->of_frame));
    for (size_t i = 0; i < s->g->count; i++) s->by_frame[s->g->glimpses[i].frame + 2]++;
    for (size_t f = 0; f < s->frames; f++) s->by_frame[f + 2] += s->by_frame[f + 1];
    for (size_t i = 0; i < s->g->count; i++)
        s->of_frame[s->by_frame[s->g->glimpses[i].frame + 1]++] = (uint32_t)i;
    return IGI_OK;
}

static igi_status estimate(igi_context *ctx, session *s, igi_agreement *a)
{
    for (size_t r = 0; r < s->regions; r++) s->spread[r] = 1;
    for (int round = 0; round < ROUNDS; round++) {
        find_middles(s);
        if (round > 0) IGI_TRY(find_spreads(ctx, s));
        for (size_t f = 0; f < s->frames; f++) {
            find_gain(s, f, &a->frames[f]);
            if (round == ROUNDS - 1) find_gain_error(s, f, &a->frames[f]);
        }
    }
    for (size_t f = 0; f < s->frames; f++) {
        a->frames[f].gain = exp(s->gain[f]);
        if (fabs(s->gain[f]) < GAIN_SIGMAS * a->frames[f].gain_error) s->gain[f] = 0;
    }
    find_middles(s);
    return find_spreads(ctx, s);
}

/* By how much a glimpse is off what the others agree about; 0 when it is not, or they do not. */
static double contradiction(const session *s, const igi_glimpse *glimpse)
{
    size_t first = s->g->begin[glimpse->place], n = s->g->begin[glimpse->place + 1] - first;
    double spread = s->spread[s->g->region[glimpse->place]];
    double least = fmax(CONTRADICTION, CONTRADICTION_SIGMAS * fmax(spread, (double)glimpse->error));
    if (!is_shared(s, glimpse->place) || fabs(error_of(s, glimpse)) < least / 2) return 0;
    double middle = middle_of_others(s, glimpse, s->values), agree = 0;
    double off = (double)glimpse->value - s->gain[glimpse->frame] - middle;
    for (size_t k = 0; k + 1 < n; k++) agree += fabs(s->values[k] - middle) < fabs(off) / 2;
    return fabs(off) > least && agree >= AGREE * (double)(n - 1) ? off : 0;
}

static double median_over_frames(session *s, const igi_agreement *a, size_t field)
{
    size_t n = 0;
    for (size_t f = 0; f < s->frames; f++)
        if (a->frames[f].places > 0)
            s->values[n++] = *(const double *)((const char *)&a->frames[f] + field);
    return igi_median(s->values, n);
}

static void judge_regions(session *s, size_t frame)
{
    for (size_t r = 0; r < s->regions; r++) s->verdicts[r] = (verdict){0};
    for (size_t k = s->by_frame[frame]; k < s->by_frame[frame + 1]; k++) {
        const igi_glimpse *glimpse = &s->g->glimpses[s->of_frame[k]];
        verdict *v = &s->verdicts[s->g->region[glimpse->place]];
        double off = contradiction(s, glimpse);
        v->places += is_shared(s, glimpse->place);
        v->brighter += off > 0;
        v->darker += off < 0;
        v->dark += off < -DARK;
    }
}

/* A surface that shines is brighter in the photograph in which it mirrors a lamp or the sun; then
 * the other regions have nothing against the photograph. */
static void judge_frame(const session *s, igi_frame_agreement *out)
{
    verdict all = {0}, most = {0};
    double dark = 0;
    for (size_t r = 0; r < s->regions; r++) {
        const verdict *v = &s->verdicts[r];
        all.places += v->places;
        all.brighter += v->brighter;
        all.darker += v->darker;
        all.dark += v->dark;
        dark = fmax(dark, v->dark);
        if (v->brighter > most.brighter) most = *v;
    }
    double against = all.brighter + all.darker, elsewhere = against - most.brighter - most.darker;
    double rest = fmax(all.places - most.places, 1);
    all.places = fmax(all.places, 1);
    bool shines = elsewhere / rest < against / all.places;
    out->contradictions = shines ? elsewhere : against;
    out->contradicts = out->contradictions / (shines ? rest : all.places);
    out->darker = all.darker / all.places;
    out->dark = (all.dark - dark) / all.places;
}

static double unevenness(const session *s, size_t frame)
{
    size_t n = 0;
    for (size_t k = s->by_frame[frame]; k < s->by_frame[frame + 1]; k++)
        s->values[n++] = (double)s->g->glimpses[s->of_frame[k]].error;
    return igi_median(s->values, n);
}

static void judge(session *s, igi_agreement *a)
{
    for (size_t f = 0; f < s->frames; f++) {
        a->frames[f].uneven = unevenness(s, f);
        judge_regions(s, f);
        judge_frame(s, &a->frames[f]);
    }
    a->typical_share = median_over_frames(s, a, offsetof(igi_frame_agreement, contradicts));
    a->typical_darker = median_over_frames(s, a, offsetof(igi_frame_agreement, darker));
    a->typical_dark = median_over_frames(s, a, offsetof(igi_frame_agreement, dark));
    a->typical_uneven = median_over_frames(s, a, offsetof(igi_frame_agreement, uneven));
}

igi_status igi_agreement_create(igi_context *ctx, const igi_scene *scene,
                                const igi_glimpses *glimpses, igi_agreement **agreement)
{
    igi_status status = IGI_OK;
    igi_agreement *a = NULL;
    session s = {.frames = scene->frame_count, .regions = scene->region_count, .g = glimpses};
    *agreement = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &a));
    a->frame_count = s.frames;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, s.frames, &a->frames));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, s.g->place_count, &s.middle));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, s.frames, &s.gain));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, s.regions, &s.spread));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, s.g->count + s.frames, &s.values));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, s.g->count, &s.off));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, s.g->count + s.regions, &s.voices));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, s.g->count, &s.weighted));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, s.regions, &s.verdicts));
    IGI_TRY_GOTO(sort_by_frame(ctx, &s));
    IGI_TRY_GOTO(estimate(ctx, &s, a));
    judge(&s, a);
    *agreement = a;
    a = NULL;
cleanup:
    igi_free(s.middle);
    igi_free(s.gain);
    igi_free(s.spread);
    igi_free(s.by_frame);
    igi_free(s.of_frame);
    igi_free(s.values);
    igi_free(s.off);
    igi_free(s.voices);
    igi_free(s.weighted);
    igi_free(s.verdicts);
    igi_agreement_destroy(a);
    return status;
}

void igi_agreement_destroy(igi_agreement *agreement)
{
    if (!agreement) return;
    igi_free(agreement->frames);
    igi_free(agreement);
}
