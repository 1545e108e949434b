/* SPDX-License-Identifier: Apache-2.0 */
#include "check/judge.h"
#include "check/sketch.h"

#include "material/material.h"
#include "observe/saturation.h"

static igi_status name_regions(igi_context *ctx, const igi_scene *scene, igi_check *check)
{
    IGI_TRY(IGI_ALLOC(ctx, scene->region_count, &check->regions));
    check->region_count = scene->region_count;
    for (size_t r = 0; r < scene->region_count; r++) {
        check->regions[r].emitter = scene->regions[r].emitter;
        IGI_TRY(igi_strdup(ctx, scene->regions[r].name, &check->regions[r].name));
    }
    return IGI_OK;
}

static igi_status describe_lights(igi_context *ctx, const igi_scene *scene, igi_check *check)
{
    IGI_TRY(IGI_ALLOC(ctx, scene->light_count, &check->lights));
    check->light_count = scene->light_count;
    for (size_t l = 0; l < scene->light_count; l++) {
        const igi_light *light = &scene->lights[l];
        bool is_area = light->type == IGI_LIGHT_AREA;
        check->lights[l].type = light->type;
        check->lights[l].known = light->known;
        check->lights[l].seen = is_area && check->regions[light->region].observed > 0;
        const char *name = is_area ? scene->regions[light->region].name
                                   : igi_light_type_name(light->type);
        IGI_TRY(igi_strdup(ctx, name, &check->lights[l].name));
    }
    return IGI_OK;
}

static igi_status describe_photos(const igi_case *c)
{
    const igi_observations *o = c->survey->observations;
    igi_check *check = c->check;
    IGI_TRY(IGI_ALLOC(c->ctx, c->scene->frame_count, &check->photos));
    check->photo_count = c->scene->frame_count;
    for (size_t f = 0; f < check->photo_count; f++) {
        const igi_frame_agreement *a = &c->agreement->frames[f];
        const igi_registration *r = &o->registrations[f];
        check->photos[f] = (igi_photo_check){.gain = a->gain,
                                             .gain_error = a->gain_error,
                                             .contradicts = a->contradicts,
                                             .saturated = o->saturated[f],
                                             .edges = r->edges,
                                             .offset = {r->offset[0], r->offset[1]},
                                             .offset_error = r->offset_error,
                                             .left_out = c->faults->frames[f].contradicts &&
                                                         !c->faults->divided,
                                             .scaled = c->faults->frames[f].scale != 1};
        IGI_TRY(igi_strdup(c->ctx, c->scene->frames[f].name, &check->photos[f].name));
    }
    return IGI_OK;
}

/* With the photographs as recovery would use them; with a folder, a page too. */
static igi_status judge(igi_context *ctx, const igi_scene *scene, const igi_tracer *tracer,
                        igi_observations *o, const char *folder, igi_check *check)
{
    igi_status status = IGI_OK;
    igi_survey survey = {0};
    igi_agreement *agreement = NULL;
    igi_faults *faults = NULL;
    igi_stage_begin(ctx, "agreement");
    IGI_TRY_GOTO(igi_observations_unclip(ctx, scene, o));
    IGI_TRY_GOTO(igi_observations_judge(ctx, scene, o, &agreement, &faults));
    IGI_TRY_GOTO(igi_copy_sentences(ctx, scene->warnings, scene->warning_count, &check->warnings,
                                    &check->warning_count));
    IGI_TRY_GOTO(igi_copy_sentences(ctx, o->warnings, o->warning_count, &check->warnings,
                                    &check->warning_count));
    igi_stage_begin(ctx, "survey");
    IGI_TRY_GOTO(igi_survey_create(ctx, scene, tracer, o, &survey));
    IGI_TRY_GOTO(name_regions(ctx, scene, check));
    IGI_TRY_GOTO(igi_survey_regions(ctx, &survey, check));
    IGI_TRY_GOTO(igi_survey_views(ctx, &survey, check));
    IGI_TRY_GOTO(describe_lights(ctx, scene, check));
    igi_case c = {ctx, scene, &survey, agreement, faults, check};
    IGI_TRY_GOTO(describe_photos(&c));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, IGI_ASSUMPTIONS, &check->assumptions));
    igi_stage_begin(ctx, "judge");
    IGI_TRY_GOTO(igi_judge_photographs(&c));
    IGI_TRY_GOTO(igi_judge_mesh(&c));
    IGI_TRY_GOTO(igi_judge_light(&c));
    IGI_TRY_GOTO(igi_judge_coverage(&c));
    if (folder) IGI_TRY_GOTO(igi_sketch_save(&c, folder));
cleanup:
    igi_survey_clear(&survey);
    igi_agreement_destroy(agreement);
    igi_faults_destroy(faults);
    return status;
}

igi_status igi_check_scene(igi_context *ctx, const igi_scene *scene, igi_check **check)
{
    return igi_check_page(ctx, scene, NULL, check);
}

igi_status igi_check_page(igi_context *ctx, const igi_scene *scene, const char *folder,
                          igi_check **check)
{
    igi_status status = IGI_OK;
    igi_check *made = NULL;
    igi_tracer *tracer = NULL;
    igi_observations *o = NULL;
    *check = NULL;
    igi_stage_begin(ctx, "observe");
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &made));
    IGI_TRY_GOTO(igi_tracer_create(ctx, &scene->mesh, &tracer));
    IGI_TRY_GOTO(igi_observe_with_previews(ctx, scene, tracer, folder ? IGI_SNAPSHOT_SIDE : 0, &o));
    IGI_TRY_GOTO(judge(ctx, scene, tracer, o, folder, made));
    *check = made;
    made = NULL;
cleanup:
    igi_stage_begin(ctx, NULL);
    igi_check_destroy(made);
    igi_observations_destroy(o);
    igi_tracer_destroy(tracer);
    return status;
}

void igi_check_destroy(igi_check *check)
{
    if (!check) return;
    for (size_t i = 0; i < check->assumption_count; i++) {
        igi_free(check->assumptions[i].finding);
        igi_free(check->assumptions[i].remedy);
    }
    for (size_t i = 0; i < check->region_count; i++) igi_free(check->regions[i].name);
    for (size_t i = 0; i < check->light_count; i++) igi_free(check->lights[i].name);
    for (size_t i = 0; i < check->photo_count; i++) igi_free(check->photos[i].name);
    for (size_t i = 0; i < check->warning_count; i++) igi_free(check->warnings[i]);
    igi_free(check->assumptions);
    igi_free(check->regions);
    igi_free(check->lights);
    igi_free(check->photos);
    igi_free(check->warnings);
    igi_free(check);
}
