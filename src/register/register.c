/* SPDX-License-Identifier: Apache-2.0
 *
 * What all cameras share first, then each by itself; then whether the mesh is to blame.
 */
#include "register/register.h"

#include "base/context.h"
#include "base/order.h"
#include "base/parallel.h"
#include "observe/agreement.h"
#include "register/register_private.h"

#include <math.h>
#include <string.h>

void igi_register_options_init(igi_register_options *options)
{
    *options = (igi_register_options){
        .struct_size = sizeof *options, .search_px = 4, .compare = true};
}

/* Where the typical camera moved by so much, all were off; one whose edges then lie so many times as far
 * off as the typical photograph's, and so far, pixels, is off still. In rooms where none was off, one
 * photograph of ten has such edges. */
#define WERE_OFF_PX .5
#define FARTHER 2.0
#define FAR_PX .15

static igi_status find_unsettled(igi_context *ctx, const register_job *j)
{
    igi_registered *r = j->out;
    bool moved_alike = r->world || r->lens || j->options->together; /* those of few edges, too */
    size_t known = 0;
    double *moved, *after;
    IGI_TRY(IGI_ALLOC(ctx, 2 * r->frame_count, &moved));
    after = moved + r->frame_count;
    for (size_t i = 0; i < r->frame_count; i++) {
        if (isnan(r->frames[i].after_px)) continue;
        moved[known] = r->frames[i].moved_px;
        after[known++] = r->frames[i].after_px;
    }
    if (known > 0 && igi_median(moved, known) > WERE_OFF_PX) {
        double far = fmax(FAR_PX, FARTHER * igi_median(after, known));
        for (size_t i = 0; i < r->frame_count; i++)
            if (r->frames[i].after_px > far || (isnan(r->frames[i].after_px) && !moved_alike))
                r->frames[i].unsettled = true;
    }
    igi_free(moved);
    return IGI_OK;
}

static igi_status sum_up(igi_context *ctx, igi_registered *r)
{
    double before = 0, after = 0;
    size_t known = 0;
    for (size_t i = 0; i < r->frame_count; i++) {
        if (isnan(r->frames[i].after_px)) continue;
        before += r->frames[i].before_px * r->frames[i].before_px;
        after += r->frames[i].after_px * r->frames[i].after_px;
        known++;
    }
    if (known == 0)
        return igi_fail(ctx, IGI_E_NO_ANSWER,
                        "no photograph shows enough edges of the mesh; bring the cameras nearer "
                        "first (--points), or widen --search");
    r->before_px = sqrt(before / (double)known);
    r->after_px = sqrt(after / (double)known);
    return IGI_OK;
}

/* Root mean square of ln gain. */
static double spread_of_gains(const igi_agreement *a)
{
    double sum = 0, count = 0;
    for (size_t i = 0; i < a->frame_count; i++) {
        if (!a->frames[i].places) continue;
        sum += log(a->frames[i].gain) * log(a->frames[i].gain);
        count++;
    }
    return count > 0 ? sqrt(sum / count) : 0;
}

/* Reads the photographs once more, with the cameras as they now are. */
static igi_status compare_photographs(igi_context *ctx, const igi_scene *scene,
                                      const igi_tracer *tracer, igi_registered *r)
{
    igi_status status = IGI_OK;
    igi_observations *observations = NULL;
    igi_agreement *agreement = NULL;
    igi_glimpses glimpses = {0};
    IGI_TRY_GOTO(igi_observe(ctx, scene, tracer, 0, &observations));
    IGI_TRY_GOTO(igi_glimpses_create(ctx, scene, observations, &glimpses));
    IGI_TRY_GOTO(igi_agreement_create(ctx, scene, &glimpses, &agreement));
    r->gain_spread = spread_of_gains(agreement);
    r->contradicts = agreement->typical_share;
    for (size_t i = 0; i < r->frame_count; i++) {
        r->frames[i].gain = agreement->frames[i].gain;
        r->frames[i].gain_sigma = agreement->frames[i].gain_error;
    }
cleanup:
    igi_agreement_destroy(agreement);
    igi_glimpses_clear(&glimpses);
    igi_observations_destroy(observations);
    return status;
}

static igi_status prepare(igi_context *ctx, const igi_register_start *start, register_job *j)
{
    size_t count = j->scene->frame_count;
    IGI_TRY(IGI_ALLOC(ctx, count, &j->given));
    IGI_TRY(IGI_ALLOC(ctx, count, &j->registrations));
    IGI_TRY(IGI_ALLOC(ctx, count, &j->evidence));
    for (size_t i = 0; i < count; i++) {
        j->given[i] = j->scene->frames[i].camera;
        IGI_TRY(igi_strdup(ctx, j->scene->frames[i].name, &j->out->frames[i].image));
    }
    j->which = start->which;
    if (!start->registrations || j->options->together) return IGI_OK;
    j->measured = true;
    memcpy(j->registrations, start->registrations, count * sizeof *j->registrations);
    return igi_alignment_judge(ctx, j->registrations, count, &j->alignment);
}

static void clear(register_job *j)
{
    for (size_t i = 0; j->evidence && i < j->scene->frame_count; i++)
        igi_free(j->evidence[i].sites.sites);
    igi_free(j->given);
    igi_free(j->registrations);
    igi_free(j->evidence);
}

static igi_status run(igi_context *ctx, const igi_register_start *start, register_job *j)
{
    IGI_TRY(prepare(ctx, start, j));
    if (j->options->together) IGI_TRY(register_together(ctx, j));
    IGI_TRY(register_shared(ctx, j));
    IGI_TRY(igi_parallel_for(ctx, j->scene->frame_count, register_frame, j));
    IGI_TRY(register_judge(ctx, j));
    IGI_TRY(sum_up(ctx, j->out));
    if (!j->which && !j->out->mesh_is_off) IGI_TRY(find_unsettled(ctx, j));
    return j->options->compare ? compare_photographs(ctx, j->scene, j->tracer, j->out) : IGI_OK;
}

igi_status igi_register_from(igi_context *ctx, igi_scene *scene, const igi_register_start *start,
                             const igi_register_options *options, igi_registered **registered)
{
    igi_status status = IGI_OK;
    igi_photographs *photographs = NULL;
    igi_registered *r = NULL;
    register_job j = {.scene = scene, .tracer = start->tracer, .options = options};
    *registered = NULL;
    igi_stage_begin(ctx, "register");
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &r));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, scene->frame_count, &r->frames));
    r->frame_count = scene->frame_count;
    r->together.scale = 1;
    for (int i = 0; i < 3; i++) r->together.rotation[i][i] = 1;
    IGI_TRY_GOTO(igi_photographs_open(ctx, scene, &photographs));
    j.photographs = photographs;
    j.out = r;
    IGI_TRY_GOTO(run(ctx, start, &j));
    *registered = r;
    r = NULL;
cleanup:
    igi_stage_begin(ctx, NULL);
    clear(&j);
    igi_registered_destroy(r);
    igi_photographs_close(photographs);
    return status;
}

igi_status igi_register(igi_context *ctx, igi_scene *scene, const igi_register_options *options,
                        igi_registered **registered)
{
    igi_register_options o;
    igi_tracer *tracer;
    *registered = NULL;
    igi_register_options_init(&o);
    if (options) o = *options;
    igi_stage_begin(ctx, "register");
    IGI_TRY(igi_tracer_create(ctx, &scene->mesh, &tracer));
    igi_register_start start = {.tracer = tracer};
    igi_status status = igi_register_from(ctx, scene, &start, &o, registered);
    igi_tracer_destroy(tracer);
    return status;
}

void igi_registered_destroy(igi_registered *registered)
{
    if (!registered) return;
    for (size_t i = 0; registered->frames && i < registered->frame_count; i++)
        igi_free(registered->frames[i].image);
    igi_free(registered->frames);
    igi_free(registered);
}
