/* SPDX-License-Identifier: Apache-2.0
 *
 * The limits come from rooms whose photographs are right: from four where gains differ by less than
 * 1 %, a mirror has 10 % of a photograph's places contradict the others, and edges lie at most
 * 1.4 +- .2 pixels off, .4 in the typical photograph (shadows that look like edges); and from eighty
 * random ones of small photographs and surfaces that shine (scripts/random_rooms), where gains differ
 * by up to 6 %, and up to 8 % of the places are darker than elsewhere: those of one region, in which the
 * other photographs show a lamp mirrored. What is before the lens is darker on several, and much.
 */
#include "observe/faults.h"

#include "observe/alignment.h"

#include "base/order.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CONTRADICTS 0.2
#define PLAINLY 0.5
#define DARKER 0.1
#define DARK 0.015
#define DIVIDED 0.34 /* of all photographs */
#define GAIN 0.08    /* of one photograph, and so many spreads of all, */
#define GAIN_SPREADS 6.0
#define GAIN_SIGMAS 6.0
#define GAIN_MOST 2.1    /* ln 8: whatever it shows, it is not the room */
#define UNEVEN 0.08      /* nor is what varies so much over places that vary little: */
#define UNEVEN_TIMES 3.0 /* the pixels of a garbled file */
#define DRIFT 0.02       /* of all, */
#define DRIFT_SIGMAS 4.0 /* and so many errors of a gain */
#define FEWEST_PLACES 20
#define FEWEST_CONTRADICTIONS 8
#define ALL_OFF_PX 0.6
#define KNOWN_PX 0.3 /* error of an offset that counts for all */

static double offset_of(const igi_registration *r)
{
    return hypot(r->offset[0], r->offset[1]);
}

static igi_status find_offsets(igi_context *ctx, const igi_observations *o, igi_faults *f)
{
    size_t n = 0;
    double *offsets;
    if (!o->registrations) return IGI_OK;
    IGI_TRY(IGI_ALLOC(ctx, f->frame_count, &offsets));
    for (size_t i = 0; i < f->frame_count; i++) {
        const igi_registration *r = &o->registrations[i];
        if (r->edges == 0 || f->frames[i].contradicts) continue;
        if (r->offset_error < KNOWN_PX) offsets[n++] = offset_of(r);
        f->frames[i].off = igi_registration_is_off(r);
    }
    if (n > 0) f->offset_px = igi_median(offsets, n);
    igi_free(offsets);
    igi_alignment all;
    IGI_TRY(igi_alignment_judge(ctx, o->registrations, f->frame_count, &all));
    f->all_off = all.all_off && f->offset_px > ALL_OFF_PX;
    return IGI_OK;
}

static void find_contradictions(const igi_agreement *a, igi_faults *f)
{
    for (size_t i = 0; i < f->frame_count; i++) {
        const igi_frame_agreement *frame = &a->frames[i];
        f->frames[i].scale = 1;
        if (frame->places < FEWEST_PLACES) continue;
        double darker = frame->darker * (double)frame->places;
        bool differs = frame->contradictions >= FEWEST_CONTRADICTIONS &&
                       frame->contradicts > CONTRADICTS + 2 * a->typical_share;
        bool is_dark = darker >= FEWEST_CONTRADICTIONS &&
                       (frame->darker > DARKER + 3 * a->typical_darker ||
                        frame->dark > DARK + 3 * a->typical_dark);
        bool is_other = fabs(log(frame->gain)) > GAIN_MOST ||
                        frame->uneven > fmax(UNEVEN, UNEVEN_TIMES * a->typical_uneven);
        f->frames[i].contradicts = differs || is_dark || is_other;
        f->frames[i].plainly = is_other || (differs && frame->contradicts > PLAINLY);
        f->contradicting += f->frames[i].contradicts;
    }
    f->divided = (double)f->contradicting > DIVIDED * (double)f->frame_count;
}

static bool counts(const igi_agreement *a, const igi_faults *f, size_t frame)
{
    return a->frames[frame].places >= FEWEST_PLACES && !f->frames[frame].contradicts;
}

static igi_status find_drift(igi_context *ctx, const igi_agreement *a, igi_faults *f)
{
    size_t n = 0;
    double *values, error;
    IGI_TRY(IGI_ALLOC(ctx, f->frame_count, &values));
    for (size_t i = 0; i < f->frame_count; i++)
        if (counts(a, f, i)) values[n++] = fabs(log(a->frames[i].gain));
    f->gain_spread = n > 0 ? 1.4826 * igi_median(values, n) : 0;
    n = 0;
    for (size_t i = 0; i < f->frame_count; i++)
        if (counts(a, f, i)) values[n++] = a->frames[i].gain_error;
    error = n > 0 ? igi_median(values, n) : 0;
    f->drifts = n > 1 && f->gain_spread > DRIFT && f->gain_spread > DRIFT_SIGMAS * error;
    igi_free(values);
    return IGI_OK;
}

/* Where all drift, the median photograph is as wrong as any: their mean is the scale. */
static double common_gain(const igi_agreement *a, const igi_faults *f)
{
    double sum = 0, n = 0;
    for (size_t i = 0; i < f->frame_count; i++) {
        if (!counts(a, f, i)) continue;
        sum += log(a->frames[i].gain);
        n++;
    }
    return f->drifts && n > 0 ? exp(sum / n) : 1;
}

static igi_status find_gains(igi_context *ctx, const igi_agreement *a, igi_faults *f)
{
    IGI_TRY(find_drift(ctx, a, f));
    double common = common_gain(a, f);
    for (size_t i = 0; i < f->frame_count; i++) {
        const igi_frame_agreement *frame = &a->frames[i];
        double gain = fabs(log(frame->gain));
        bool is_alone = gain > GAIN && gain > GAIN_SPREADS * f->gain_spread &&
                        gain > GAIN_SIGMAS * frame->gain_error;
        if (counts(a, f, i) && (is_alone || f->drifts)) f->frames[i].scale = common / frame->gain;
    }
    return IGI_OK;
}

igi_status igi_faults_find(igi_context *ctx, const igi_observations *observations,
                           const igi_agreement *agreement, igi_faults **faults)
{
    igi_status status = IGI_OK;
    igi_faults *f = NULL;
    *faults = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &f));
    f->frame_count = agreement->frame_count;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, f->frame_count, &f->frames));
    find_contradictions(agreement, f);
    if (!f->divided) IGI_TRY_GOTO(find_gains(ctx, agreement, f));
    IGI_TRY_GOTO(find_offsets(ctx, observations, f));
    *faults = f;
    f = NULL;
cleanup:
    igi_faults_destroy(f);
    return status;
}

void igi_faults_destroy(igi_faults *faults)
{
    if (!faults) return;
    igi_free(faults->frames);
    igi_free(faults);
}
