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
#include "observe/glare.h"

#include "base/order.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define CONTRADICTS 0.2
#define DARKER 0.1
#define DARK 0.015
#define DIVIDED 0.34 /* of all photographs */
#define GAIN 0.08    /* of one photograph, and so many spreads of all, */
#define GAIN_SPREADS 6.0
#define GAIN_SIGMAS 6.0
#define GAIN_MOST 2.1    /* ln 8: whatever it shows, it is not the room */
#define DRIFT 0.02       /* of all, */
#define DRIFT_SIGMAS 4.0 /* and so many errors of a gain */
#define FEWEST_PLACES 20
#define FEWEST_CONTRADICTIONS 8
#define OFF_PX 1.0
#define OFF_SIGMAS 4.0
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
        f->frames[i].off = offset_of(r) > OFF_PX + OFF_SIGMAS * r->offset_error;
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
        f->frames[i].contradicts = differs || is_dark || fabs(log(frame->gain)) > GAIN_MOST;
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

static void scale_frame(igi_observations *o, size_t frame, float factor)
{
    size_t bands = (size_t)o->bands;
    for (size_t k = o->frame_begin[frame] * bands; k < o->frame_begin[frame + 1] * bands; k++)
        o->radiance[k] *= factor;
    for (size_t b = 0; b < bands; b++) o->mean[frame * bands + b] *= (double)factor;
    for (size_t k = 0; k < o->reading_count; k++)
        for (size_t b = 0; o->readings[k].frame == frame && b < bands; b++) {
            o->readings[k].radiance[b] *= (double)factor;
            o->readings[k].error[b] *= (double)factor;
            o->readings[k].highest[b] *= factor;
        }
}

static void leave_out(igi_observations *o, size_t frame)
{
    size_t first = o->frame_begin[frame], next = o->frame_begin[frame + 1], n = next - first;
    size_t rest = o->count - next, bands = (size_t)o->bands;
    memmove(o->surface + first, o->surface + next, rest * sizeof *o->surface);
    memmove(o->pixel + first, o->pixel + next, rest * sizeof *o->pixel);
    memmove(o->uv + 2 * first, o->uv + 2 * next, 2 * rest * sizeof *o->uv);
    memmove(o->radiance + first * bands, o->radiance + next * bands,
            rest * bands * sizeof *o->radiance);
    for (size_t f = frame + 1; f <= o->frame_count; f++) o->frame_begin[f] -= n;
    o->count -= n;
    for (size_t k = 0; k < o->reading_count; k++)
        if (o->readings[k].frame == frame) o->readings[k].error[0] = HUGE_VAL;
}

static igi_status warn_of_frame(igi_context *ctx, const igi_scene *scene,
                                const igi_frame_agreement *a, const igi_frame_fault *f,
                                size_t frame, igi_observations *o)
{
    char *sentence;
    const char *name = scene->frames[frame].name;
    if (f->contradicts)
        IGI_TRY(igi_strprintf(ctx, &sentence,
                              "image %s: contradicts the other photographs at %.0f %% "
                              "of the places they share, and was left out; is it of this scene, "
                              "from its camera's place, and whole?",
                              name, fmax(1, 100 * a->contradicts)));
    else
        IGI_TRY(igi_strprintf(ctx, &sentence,
                              "image %s: %.3g times as bright as the others show the same places; "
                              "it was scaled to them; check its exposure",
                              name, a->gain));
    return igi_add_sentence(ctx, &o->warnings, &o->warning_count, sentence);
}

static igi_status warn_of_offset(igi_context *ctx, const igi_scene *scene, size_t frame,
                                 igi_observations *o)
{
    char *sentence;
    const igi_registration *r = &o->registrations[frame];
    IGI_TRY(igi_strprintf(ctx, &sentence,
                          "image %s: its edges lie %.1f pixels off the mesh's (%+.1f columns, "
                          "%+.1f rows); register its camera again",
                          scene->frames[frame].name, offset_of(r), r->offset[0], r->offset[1]));
    return igi_add_sentence(ctx, &o->warnings, &o->warning_count, sentence);
}

static igi_status warn_of_all(igi_context *ctx, const igi_faults *f, igi_observations *o)
{
    char *sentence;
    if (f->divided) {
        IGI_TRY(igi_strprintf(ctx, &sentence,
                              "%zu of %zu photographs contradict the others; all were used; check "
                              "that cameras, mesh and photographs belong together, and that "
                              "nothing moved",
                              f->contradicting, f->frame_count));
        IGI_TRY(igi_add_sentence(ctx, &o->warnings, &o->warning_count, sentence));
    }
    if (f->drifts) {
        IGI_TRY(igi_strprintf(ctx, &sentence,
                              "the exposures of the photographs drift by %.1f %%; each was scaled "
                              "to the others; lock exposure and white balance",
                              100 * f->gain_spread));
        IGI_TRY(igi_add_sentence(ctx, &o->warnings, &o->warning_count, sentence));
    }
    if (!f->all_off) return IGI_OK;
    IGI_TRY(igi_strprintf(ctx, &sentence,
                          "the photographs' edges lie %.1f pixels off the mesh's; register the "
                          "cameras again (igi register), or mend the mesh",
                          f->offset_px));
    return igi_add_sentence(ctx, &o->warnings, &o->warning_count, sentence);
}

igi_status igi_observations_mend(igi_context *ctx, const igi_scene *scene,
                                 const igi_agreement *agreement, const igi_faults *faults,
                                 igi_observations *observations)
{
    for (size_t i = 0; i < faults->frame_count; i++) {
        igi_frame_fault f = faults->frames[i];
        if (faults->divided) f.contradicts = false;
        if (f.scale != 1) scale_frame(observations, i, (float)f.scale);
        if (f.contradicts) leave_out(observations, i);
        if (f.contradicts || (f.scale != 1 && !faults->drifts))
            IGI_TRY(warn_of_frame(ctx, scene, &agreement->frames[i], &f, i, observations));
        if (f.off && !faults->all_off) IGI_TRY(warn_of_offset(ctx, scene, i, observations));
    }
    return warn_of_all(ctx, faults, observations);
}

static igi_status look_again(igi_context *ctx, const igi_scene *scene, const igi_observations *o,
                             igi_glimpses *g)
{
    igi_glimpses_clear(g);
    return igi_glimpses_create(ctx, scene, o, g);
}

static bool is_mended(const igi_faults *f)
{
    for (size_t i = 0; i < f->frame_count; i++)
        if (f->frames[i].scale != 1 || f->frames[i].contradicts) return true;
    return false;
}

/* A veil over all photographs looks like exposures that drift, and goes first; one photograph's own is
 * told from its exposure after that. */
igi_status igi_observations_judge(igi_context *ctx, const igi_scene *scene,
                                  igi_observations *observations, igi_agreement **agreement,
                                  igi_faults **faults)
{
    igi_status status = IGI_OK;
    igi_glimpses g = {0};
    bool lifted;
    IGI_TRY_GOTO(igi_glimpses_create(ctx, scene, observations, &g));
    IGI_TRY_GOTO(igi_observations_lift_common_veil(ctx, scene, &g, observations, &lifted));
    if (lifted) IGI_TRY_GOTO(look_again(ctx, scene, observations, &g));
    IGI_TRY_GOTO(igi_agreement_create(ctx, scene, &g, agreement));
    IGI_TRY_GOTO(igi_faults_find(ctx, observations, *agreement, faults));
    IGI_TRY_GOTO(igi_observations_mend(ctx, scene, *agreement, *faults, observations));
    if (is_mended(*faults)) IGI_TRY_GOTO(look_again(ctx, scene, observations, &g));
    IGI_TRY_GOTO(igi_observations_lift_own_veils(ctx, scene, &g, observations));
cleanup:
    igi_glimpses_clear(&g);
    return status;
}

igi_status igi_observations_reconcile(igi_context *ctx, const igi_scene *scene,
                                      igi_observations *observations)
{
    igi_agreement *agreement = NULL;
    igi_faults *faults = NULL;
    igi_status status = igi_observations_judge(ctx, scene, observations, &agreement, &faults);
    igi_agreement_destroy(agreement);
    igi_faults_destroy(faults);
    return status;
}
