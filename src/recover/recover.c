/* SPDX-License-Identifier: Apache-2.0
 *
 * From all photographs, or from as few as the target error asks for.
 */
#include "diffuse/methods.h"
#include "recover/choice.h"
#include "recover/once.h"
#include "recover/target.h"

/* Patches are this share of the scene's diagonal: 1-2 % of the room's side (method of choice, by
 * the speed-accuracy chart). */
#define PATCH_SHARE 0.0105f

/* Patches grow with the root of a target above this, up to so many times their size. */
#define FINE_ERROR 0.00125
#define COARSEST 2.0
/* Photographs are chosen so many times, each with so many times the pixels, before all are read:
 * where surfaces shine, more photographs do not lower the error that is stated without lobes. */
#define ATTEMPTS 2
#define SHARPER 4
/* Above so many times what was wanted, more photographs are not tried: all are read. */
#define HOPELESS 3

static double patch_for(const igi_tracer *tracer, double target_error)
{
    return (double)(PATCH_SHARE * igi_tracer_size(tracer, NULL, NULL)) *
           fmin(fmax(1, sqrt(target_error / FINE_ERROR)), COARSEST);
}

/* Takes over what the choice knows. */
static igi_status note_choice(igi_context *ctx, const igi_scene *scene, igi_choice *choice,
                              igi_recovery *r)
{
    char *sentence;
    r->read = choice->read;
    choice->read = NULL;
    IGI_TRY(igi_choice_sentence(ctx, choice, scene, &sentence));
    return igi_add_sentence(ctx, &r->materials->warnings, &r->materials->warning_count, sentence);
}

/* From as few photographs as the target seems to need; from more where the result's own error bars
 * disagree, or what was chosen does not suffice. *recovery stays NULL where all are needed. */
static igi_status recover_from_few(igi_context *ctx, const igi_scene *scene,
                                   const igi_tracer *tracer, const igi_recover_options *o,
                                   bool *shines, igi_recovery **recovery)
{
    igi_need need = {o->target_error, 1, o->model != IGI_LAMBERT};
    igi_aim wanted = {.limit = o->target_error};
    for (int attempt = 0; attempt < ATTEMPTS; attempt++, need.sharpness *= SHARPER) {
        igi_choice *choice;
        igi_recovery *r = NULL;
        igi_stage_begin(ctx, "choose views");
        IGI_TRY(igi_choice_make(ctx, scene, tracer, &need, &choice));
        bool all = choice->scene.frame_count == 0 || (choice->left_out == 0 && choice->reduce == 1);
        igi_status status = all ? IGI_OK
                                : igi_recover_once(ctx, &choice->scene, tracer, o, &wanted, &r);
        bool failed = status == IGI_E_DATA || status == IGI_E_NO_ANSWER;
        if (r) status = note_choice(ctx, scene, choice, r);
        igi_choice_destroy(choice);
        if (r && status == IGI_OK) *recovery = r;
        else igi_recovery_destroy(r);
        if (all || r || (status != IGI_OK && !failed)) return status;
        if (!failed && wanted.stated > HOPELESS * wanted.limit) { /* it shines */
            *shines = true;
            break;
        }
    }
    return IGI_OK;
}

igi_status igi_recover(igi_context *ctx, const igi_scene *scene, const igi_recover_options *options,
                       igi_recovery **recovery)
{
    igi_status status = IGI_OK;
    igi_recover_options o;
    igi_tracer *tracer = NULL;
    *recovery = NULL;
    igi_recover_options_init(&o);
    if (options) o = *options;
    igi_stage_begin(ctx, "observe");
    IGI_TRY_GOTO(igi_tracer_create(ctx, &scene->mesh, &tracer));
    igi_aim all = {.limit = HUGE_VAL};
    bool shines = false;
    if (!(o.patch_m > 0)) o.patch_m = patch_for(tracer, o.target_error);
    if (o.method == IGI_METHOD_PATCHES && o.target_error > 0)
        IGI_TRY_GOTO(recover_from_few(ctx, scene, tracer, &o, &shines, recovery));
    if (shines && o.rays == 0) o.rays = igi_patches_rays(o.target_error);
    if (!*recovery) IGI_TRY_GOTO(igi_recover_once(ctx, scene, tracer, &o, &all, recovery));
    IGI_TRY_GOTO(igi_target_judge(ctx, o.target_error, (*recovery)->materials));
cleanup:
    igi_stage_begin(ctx, NULL);
    igi_tracer_destroy(tracer);
    return status;
}
