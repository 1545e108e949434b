/* SPDX-License-Identifier: Apache-2.0
 *
 * The whole way: photographs → observations → patches → albedo → materials.
 */
#include "maps/compare.h"
#include "diffuse/methods.h"
#include "diffuse/positions.h"
#include "observe/faults.h"
#include "observe/saturation.h"
#include "recover/choice.h"
#include "recover/doubts.h"
#include "recover/excuse.h"
#include "recover/findings.h"
#include "recover/poses.h"
#include "recover/target.h"
#include "specular/specular.h"
#include "specular/yu99.h"

#include <string.h>

/* Patches are this share of the scene's diagonal: 1-2 % of the room's side (method of choice, by
 * the speed-accuracy chart). */
#define PATCH_SHARE 0.0105f

/* Patches grow with the root of a target above this, up to so many times their size. */
#define FINE_ERROR 0.00125
#define COARSEST 2.0
/* Of a target: what patches so large miss is not in the stated error. */
#define AIM 0.7
/* Photographs are chosen so many times, each with so many times the pixels, before all are read:
 * where surfaces shine, more photographs do not lower the error that is stated without lobes. */
#define ATTEMPTS 2
#define SHARPER 4
/* Above so many times what was wanted, more photographs are not tried: all are read. */
#define HOPELESS 3
/* Solved again without photographs that lobes do not account for so many times. */
#define ROUNDS 2

const char *igi_method_name(igi_method method)
{
    switch (method) {
    case IGI_METHOD_PATCHES: return "patches";
    case IGI_METHOD_GATHER: return "gather";
    case IGI_METHOD_RADIOSITY: return "radiosity";
    case IGI_METHOD_DIRECT: return "direct";
    case IGI_METHOD_YU99: return "yu99";
    }
    return "unknown";
}

bool igi_method_from_name(const char *name, igi_method *method)
{
    for (int m = IGI_METHOD_PATCHES; m <= IGI_METHOD_YU99; m++)
        if (strcmp(name, igi_method_name((igi_method)m)) == 0) {
            *method = (igi_method)m;
            return true;
        }
    return false;
}

void igi_recover_options_init(igi_recover_options *options)
{
    *options = (igi_recover_options){.struct_size = sizeof *options, .model = IGI_ANY_MODEL};
}

static igi_method_fn method_function(igi_method method)
{
    switch (method) {
    case IGI_METHOD_PATCHES: return igi_method_patches;
    case IGI_METHOD_GATHER: return igi_method_gather;
    case IGI_METHOD_RADIOSITY: return igi_method_radiosity;
    case IGI_METHOD_DIRECT: return igi_method_direct;
    case IGI_METHOD_YU99: break; /* finds lobes too: igi_yu99_create */
    }
    return NULL;
}

/* The rays that each region was given by the method, where it keeps its rows. */
static void count_gathered(const igi_problem *p, const igi_rows *rows,
                           igi_region_evidence *evidence)
{
    for (size_t row = 0; rows && row < rows->count; row++)
        evidence[igi_patch_region(p->patches, rows->side[row] >> 1)].gathered_rays +=
            rows->begin[row + 1] - rows->begin[row];
}

/* Maps of what the regions are made of, and what they predict for a few photographs. `known`: the
 * irradiance where it is known already, or NULL. */
static igi_status draw(igi_context *ctx, const igi_problem *problem, const igi_diffuse *diffuse,
                       igi_field *known, igi_recovery *recovery)
{
    igi_status status = IGI_OK;
    igi_field *made = NULL;
    igi_layout *layout = NULL;
    igi_stage_begin(ctx, "maps");
    if (!known) IGI_TRY_GOTO(igi_field_create(ctx, problem, diffuse, &made));
    igi_field *field = known ? known : made;
    IGI_TRY_GOTO(igi_layout_create(ctx, problem->scene, &layout));
    IGI_TRY_GOTO(
        igi_maps_create(ctx, problem, field, layout, recovery->materials, recovery->evidence));
    igi_pattern_settle(diffuse, recovery->materials);
    for (size_t r = 0; r < recovery->materials->count; r++)
        IGI_TRY_GOTO(igi_metal_settle(ctx, problem->bands, &recovery->materials->materials[r]));
    IGI_TRY_GOTO(igi_doubts_add(ctx, problem, field, recovery->materials));
    igi_stage_begin(ctx, "compare");
    IGI_TRY_GOTO(igi_compare(ctx, problem, field, layout, recovery));
cleanup:
    igi_layout_destroy(layout);
    igi_field_destroy(made);
    return status;
}

/* What is solved for from the observations. */
typedef struct solution {
    igi_problem *problem;
    igi_positions *positions; /* NULL: no light asks */
    igi_diffuse *diffuse;
    igi_specular *specular; /* NULL: nobody looked for lobes */
    igi_lobe_view lobes;
} solution;

static void clear_solution(solution *s)
{
    igi_specular_destroy(s->specular);
    igi_diffuse_destroy(s->diffuse);
    igi_problem_destroy(s->problem);
    igi_positions_destroy(s->positions);
    *s = (solution){.problem = NULL};
}

static bool looks_for_lobes(const igi_recover_options *o)
{
    return o->method == IGI_METHOD_PATCHES && o->model != IGI_LAMBERT;
}

/* What the diffuse solution may state as its error, and what it does. */
typedef struct aim {
    double limit, stated;
} aim;

/* Where what is stated is above the limit there are no lobes. */
static igi_status solve(igi_context *ctx, const igi_recover_options *o, solution *s, aim *wanted)
{
    igi_problem *problem = s->problem;
    IGI_TRY(igi_positions_refine(ctx, problem, &s->positions));
    problem->positions = s->positions;
    IGI_TRY(igi_diffuse_create(ctx, problem, &s->diffuse));
    if (o->method == IGI_METHOD_YU99)
        IGI_TRY(igi_yu99_create(ctx, problem, s->diffuse, &s->specular));
    else IGI_TRY(method_function(o->method)(ctx, problem, s->diffuse));
    wanted->stated = igi_stated_error(problem, s->diffuse);
    if (wanted->stated > wanted->limit) return IGI_OK;
    if (looks_for_lobes(o)) IGI_TRY(igi_specular_create(ctx, problem, s->diffuse, &s->specular));
    if (!s->specular) return IGI_OK;
    s->lobes = igi_specular_view(s->specular, s->diffuse);
    problem->lobes = &s->lobes;
    return IGI_OK;
}

static igi_status make_recovery(igi_context *ctx, const solution *s, igi_poses *poses,
                                igi_recovery *r)
{
    size_t regions = s->problem->scene->region_count;
    IGI_TRY(igi_materials_of(ctx, s->problem, s->diffuse, s->specular, &r->materials));
    IGI_TRY(igi_positions_explain(ctx, s->positions, &r->materials->warnings,
                                  &r->materials->warning_count));
    IGI_TRY(IGI_ALLOC(ctx, regions, &r->evidence));
    if (s->specular && s->specular->evidence)
        memcpy(r->evidence, s->specular->evidence, regions * sizeof *r->evidence);
    count_gathered(s->problem, s->diffuse->rows, r->evidence);
    IGI_TRY(draw(ctx, s->problem, s->diffuse, s->specular ? s->specular->irradiance : NULL, r));
    if (poses) r->registered = poses->registered;
    if (poses) poses->registered = NULL;
    return IGI_OK;
}

/* One recovery, from observing on. *recovery stays NULL where the stated error of the diffuse
 * solution is above its limit. Photographs that lobes do not account for are left out, or scaled, and all
 * is solved again. */
static igi_status recover_from(igi_context *ctx, const igi_scene *scene, const igi_tracer *tracer,
                               const igi_recover_options *o, aim *wanted, igi_recovery **recovery)
{
    igi_status status = IGI_OK;
    igi_observations *observations = NULL;
    igi_poses *poses = NULL;
    igi_patches *patches = NULL;
    solution s = {.problem = NULL};
    igi_recovery *r = NULL;
    bool again;
    igi_stage_begin(ctx, "observe");
    IGI_TRY_GOTO(igi_observe(ctx, scene, tracer, 0, &observations));
    IGI_TRY_GOTO(igi_poses_mend(ctx, scene, tracer, o->registering, &observations, &poses));
    if (poses) scene = &poses->scene;
    igi_stage_begin(ctx, "agreement");
    IGI_TRY_GOTO(igi_observations_reconcile(ctx, scene, looks_for_lobes(o), observations, &again));
    size_t said = observations->warning_count;
    IGI_TRY_GOTO(igi_observations_unclip(ctx, scene, observations));
    bool clipped = observations->warning_count > said;
    igi_stage_begin(ctx, "patches");
    IGI_TRY_GOTO(igi_patches_create(ctx, &scene->mesh, (float)o->patch_m, &patches));
    for (int round = 0; round == 0 || again; round++) {
        clear_solution(&s);
        IGI_TRY_GOTO(igi_problem_create(ctx, scene, tracer, observations, patches, o, &s.problem));
        IGI_TRY_GOTO(solve(ctx, o, &s, wanted));
        if (wanted->stated > wanted->limit) goto cleanup;
        if (!again || round == ROUNDS) break;
        IGI_TRY_GOTO(igi_excuse_photographs(ctx, s.problem, s.diffuse, observations, &again));
        if (again && clipped) clipped = !igi_observations_retract_clipped(observations, said);
    }
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &r));
    IGI_TRY_GOTO(make_recovery(ctx, &s, poses, r));
    *recovery = r;
    r = NULL;
cleanup:
    igi_recovery_destroy(r);
    clear_solution(&s);
    igi_patches_destroy(patches);
    igi_observations_destroy(observations);
    igi_poses_destroy(poses);
    return status;
}

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
                                   const igi_tracer *tracer, const igi_recover_options *options,
                                   igi_recovery **recovery)
{
    igi_recover_options coarse = *options, *o = &coarse;
    igi_need need = {o->target_error, 1, o->model != IGI_LAMBERT};
    o->target_error *= AIM;
    aim wanted = {.limit = o->target_error};
    for (int attempt = 0; attempt < ATTEMPTS; attempt++, need.sharpness *= SHARPER) {
        igi_choice *choice;
        igi_recovery *r = NULL;
        igi_stage_begin(ctx, "choose views");
        IGI_TRY(igi_choice_make(ctx, scene, tracer, &need, &choice));
        bool all = choice->scene.frame_count == 0 || (choice->left_out == 0 && choice->reduce == 1);
        igi_status status = all ? IGI_OK
                                : recover_from(ctx, &choice->scene, tracer, o, &wanted, &r);
        bool failed = status == IGI_E_DATA || status == IGI_E_NO_ANSWER;
        if (r) status = note_choice(ctx, scene, choice, r);
        igi_choice_destroy(choice);
        if (r && status == IGI_OK) *recovery = r;
        else igi_recovery_destroy(r);
        if (all || r || (status != IGI_OK && !failed)) return status;
        if (!failed && wanted.stated > HOPELESS * wanted.limit) break; /* it shines */
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
    aim all = {.limit = HUGE_VAL};
    if (!(o.patch_m > 0)) o.patch_m = patch_for(tracer, o.target_error);
    if (o.method == IGI_METHOD_PATCHES && o.target_error > 0)
        IGI_TRY_GOTO(recover_from_few(ctx, scene, tracer, &o, recovery));
    if (!*recovery) IGI_TRY_GOTO(recover_from(ctx, scene, tracer, &o, &all, recovery));
    IGI_TRY_GOTO(igi_target_judge(ctx, o.target_error, (*recovery)->materials));
cleanup:
    igi_stage_begin(ctx, NULL);
    igi_tracer_destroy(tracer);
    return status;
}

void igi_recovery_destroy(igi_recovery *recovery)
{
    if (!recovery) return;
    igi_materials_destroy(recovery->materials);
    igi_free(recovery->evidence);
    igi_free(recovery->read);
    igi_registered_destroy(recovery->registered);
    for (size_t i = 0; i < recovery->comparison_count; i++) {
        igi_free(recovery->comparisons[i].frame);
        igi_image_destroy(recovery->comparisons[i].photo);
        igi_image_destroy(recovery->comparisons[i].prediction);
        igi_image_destroy(recovery->comparisons[i].albedo);
    }
    igi_free(recovery->comparisons);
    igi_free(recovery);
}
