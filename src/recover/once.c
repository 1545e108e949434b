/* SPDX-License-Identifier: Apache-2.0
 *
 * One recovery of a set of photographs: photographs → observations → patches → albedo → materials.
 */
#include "recover/once.h"

#include "diffuse/methods.h"
#include "diffuse/positions.h"
#include "maps/compare.h"
#include "observe/faults.h"
#include "observe/saturation.h"
#include "recover/doubts.h"
#include "recover/excuse.h"
#include "recover/findings.h"
#include "recover/poses.h"
#include "specular/specular.h"
#include "specular/yu99.h"

#include <string.h>

/* Solved again without photographs that lobes do not account for so many times. */
#define ROUNDS 2

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

/* Where what is stated is above the limit there are no lobes. */
static igi_status solve(igi_context *ctx, const igi_recover_options *o, solution *s,
                        igi_aim *wanted)
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

igi_status igi_recover_once(igi_context *ctx, const igi_scene *scene, const igi_tracer *tracer,
                            const igi_recover_options *o, igi_aim *wanted, igi_recovery **recovery)
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
