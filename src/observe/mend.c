/* SPDX-License-Identifier: Apache-2.0
 *
 * Faults of photographs, mended and told.
 */
#include "observe/faults.h"

#include "observe/glare.h"

#include <math.h>
#include <string.h>

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

void igi_observations_leave_out(igi_observations *o, size_t frame)
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
                          scene->frames[frame].name, hypot(r->offset[0], r->offset[1]),
                          r->offset[0], r->offset[1]));
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

/* Leaves out and scales what the faults ask for, and adds a warning for each. */
static igi_status mend(igi_context *ctx, const igi_scene *scene, const igi_agreement *agreement,
                       const igi_faults *faults, igi_observations *observations)
{
    for (size_t i = 0; i < faults->frame_count; i++) {
        igi_frame_fault f = faults->frames[i];
        if (faults->divided) f.contradicts = false;
        if (f.scale != 1) scale_frame(observations, i, (float)f.scale);
        if (f.contradicts) igi_observations_leave_out(observations, i);
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
        if (f->frames[i].scale != 1 || (f->frames[i].contradicts && !f->divided)) return true;
    return false;
}

/* What a lobe may account for: all but what is plain, what edges say, and a drift of all. */
static bool put_off(igi_faults *f)
{
    bool any = f->divided;
    for (size_t i = 0; i < f->frame_count; i++) {
        igi_frame_fault *one = &f->frames[i];
        bool contradicts = one->contradicts && (f->divided || !one->plainly);
        bool alone = one->scale != 1 && !f->drifts;
        any = any || contradicts || alone;
        if (contradicts) one->contradicts = false;
        if (alone) one->scale = 1;
    }
    f->divided = false;
    return any;
}

/* Veils pass for exposures that drift and for photographs of something else: they go first. Where a
 * photograph was at fault, that of another may be clear only without it. *waits: what lobes may account
 * for was put off; NULL: nothing is to wait. */
static igi_status judge(igi_context *ctx, const igi_scene *scene, igi_observations *observations,
                        igi_agreement **agreement, igi_faults **faults, bool *waits)
{
    igi_status status = IGI_OK;
    igi_glimpses g = {0};
    bool lifted;
    IGI_TRY_GOTO(igi_glimpses_create(ctx, scene, observations, &g));
    IGI_TRY_GOTO(igi_observations_lift_common_veil(ctx, scene, &g, observations, &lifted));
    if (lifted) IGI_TRY_GOTO(look_again(ctx, scene, observations, &g));
    IGI_TRY_GOTO(igi_observations_lift_own_veils(ctx, scene, &g, observations, &lifted));
    if (lifted) IGI_TRY_GOTO(look_again(ctx, scene, observations, &g));
    IGI_TRY_GOTO(igi_observations_tell_uneven_veil(ctx, scene, &g, observations));
    IGI_TRY_GOTO(igi_agreement_create(ctx, scene, &g, agreement));
    IGI_TRY_GOTO(igi_faults_find(ctx, observations, *agreement, faults));
    if (waits) *waits = put_off(*faults);
    IGI_TRY_GOTO(mend(ctx, scene, *agreement, *faults, observations));
    if (!is_mended(*faults)) goto cleanup;
    IGI_TRY_GOTO(look_again(ctx, scene, observations, &g));
    IGI_TRY_GOTO(igi_observations_lift_own_veils(ctx, scene, &g, observations, &lifted));
cleanup:
    igi_glimpses_clear(&g);
    return status;
}

igi_status igi_observations_judge(igi_context *ctx, const igi_scene *scene,
                                  igi_observations *observations, igi_agreement **agreement,
                                  igi_faults **faults)
{
    return judge(ctx, scene, observations, agreement, faults, NULL);
}

igi_status igi_observations_reconcile(igi_context *ctx, const igi_scene *scene, bool lobes_follow,
                                      igi_observations *observations, bool *waits)
{
    igi_agreement *agreement = NULL;
    igi_faults *faults = NULL;
    *waits = false;
    igi_status status = judge(ctx, scene, observations, &agreement, &faults,
                              lobes_follow ? waits : NULL);
    igi_agreement_destroy(agreement);
    igi_faults_destroy(faults);
    return status;
}

/* What edges say was said before. */
static void forget_edges(igi_faults *f)
{
    f->all_off = false;
    for (size_t i = 0; i < f->frame_count; i++) f->frames[i].off = false;
}

igi_status igi_observations_reconcile_rest(igi_context *ctx, const igi_scene *scene,
                                           float *explained, igi_observations *observations,
                                           bool *changed)
{
    igi_status status = IGI_OK;
    igi_agreement *agreement = NULL;
    igi_faults *faults = NULL;
    igi_observations rest = *observations;
    igi_glimpses g = {0};
    bool lifted;
    rest.radiance = explained;
    *changed = false;
    IGI_TRY_GOTO(igi_glimpses_create(ctx, scene, &rest, &g));
    IGI_TRY_GOTO(igi_agreement_create(ctx, scene, &g, &agreement));
    IGI_TRY_GOTO(igi_faults_find(ctx, &rest, agreement, &faults));
    forget_edges(faults);
    IGI_TRY_GOTO(mend(ctx, scene, agreement, faults, observations));
    *changed = is_mended(faults);
    if (!*changed) goto cleanup;
    IGI_TRY_GOTO(look_again(ctx, scene, observations, &g));
    IGI_TRY_GOTO(igi_observations_lift_own_veils(ctx, scene, &g, observations, &lifted));
cleanup:
    igi_glimpses_clear(&g);
    igi_agreement_destroy(agreement);
    igi_faults_destroy(faults);
    return status;
}
