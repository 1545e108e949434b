/* SPDX-License-Identifier: Apache-2.0
 *
 * The whole way: photographs → observations → patches → albedo → materials.
 */
#include "maps/compare.h"
#include "diffuse/methods.h"
#include "observe/faults.h"
#include "observe/saturation.h"
#include "recover/choice.h"
#include "recover/doubts.h"
#include "recover/poses.h"
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

/* No dielectric mirrors more of light that falls on it at right angles (diamond .17, rutile .2); metals
 * do, and nothing comes back from inside of them. */
#define METAL_SPECULAR 0.25

/* rho_s of plastic and varnish; less goes without saying. */
#define WORTH_A_WORD 0.03

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

/* Share of each region's area that photographs show, and how many photographs show it. */
static igi_status measure_coverage(igi_context *ctx, const igi_problem *p, igi_materials *m)
{
    size_t regions = p->scene->region_count;
    double *area;
    IGI_TRY(IGI_ALLOC(ctx, regions, &area));
    for (uint32_t patch = 0; patch < p->patches->count; patch++) {
        if (p->patches->triangle[patch] == IGI_NO_HIT) continue;
        uint32_t r = igi_patch_region(p->patches, patch);
        double a = (double)p->patches->area[patch];
        area[r] += a;
        if (igi_problem_seen_count(p, 2 * patch) + igi_problem_seen_count(p, 2 * patch + 1) > 0)
            m->materials[r].observed += a;
    }
    for (size_t r = 0; r < regions; r++)
        if (area[r] > 0) m->materials[r].observed /= area[r];
    igi_free(area);
    const igi_observations *o = p->observations;
    bool *shown;
    IGI_TRY(IGI_ALLOC(ctx, regions, &shown));
    for (size_t f = 0; f < o->frame_count; f++) {
        memset(shown, 0, regions * sizeof *shown);
        for (size_t i = o->frame_begin[f]; i < o->frame_begin[f + 1]; i++)
            shown[p->scene->mesh.regions[igi_surface_triangle(o->surface[i])]] = true;
        for (size_t r = 0; r < regions; r++) m->materials[r].views += shown[r];
    }
    igi_free(shown);
    return IGI_OK;
}

static igi_status make_material(igi_context *ctx, const igi_problem *p, const igi_diffuse *d,
                                size_t region, igi_material *m)
{
    const igi_region *r = &p->scene->regions[region];
    IGI_TRY(igi_strdup(ctx, r->name, &m->region));
    m->emitter = r->emitter;
    m->model = IGI_LAMBERT;
    m->determined = d->determined[region];
    for (int b = 0; b < p->bands; b++) {
        m->albedo[b] = d->albedo[region][b];
        m->albedo_std[b] = d->albedo_std[region][b];
    }
    if (r->emitter || m->determined) return IGI_OK;
    char *sentence;
    IGI_TRY(
        igi_strprintf(ctx, &sentence,
                      "no photograph determines it: the albedo is a guess from the other regions; "
                      "add a photograph that shows it"));
    return igi_add_sentence(ctx, &m->warnings, &m->warning_count, sentence);
}

/* A lobe that was overlooked is at most so strong; worth a word where that is as much as varnish. */
static igi_status set_bound(igi_context *ctx, const igi_lobe_doubt *doubt, int bands,
                            igi_material *m)
{
    double bound = doubt->bound;
    for (int b = 0; b < bands; b++) bound = fmin(bound, fmax(0, 1 - m->albedo[b]));
    m->specular_std = bound / IGI_BOUND_SIGMAS;
    if (bound < WORTH_A_WORD) return IGI_OK;
    char *sentence;
    IGI_TRY(igi_strprintf(ctx, &sentence,
                          "no view sees a highlight: specular is a bound, not an estimate: at most "
                          "%.2g for alpha up to %g; add a photograph of a lamp mirrored in it",
                          bound, (double)IGI_BOUND_ALPHA));
    return igi_add_sentence(ctx, &m->warnings, &m->warning_count, sentence);
}

static igi_status set_lobe(igi_context *ctx, const igi_lobe_estimate *e, int bands, igi_material *m)
{
    m->model = e->model;
    m->specular = e->specular;
    m->specular_std = e->specular_std;
    m->alpha = e->alpha;
    m->alpha_std = e->alpha_std;
    for (int b = 0; b < bands; b++) m->specular_rgb[b] = e->specular;
    char *sentence;
    if (e->alpha < (double)IGI_SHARP_ALPHA && e->alpha < IGI_BOUND_SIGMAS * e->alpha_std) {
        IGI_TRY(igi_strprintf(
            ctx, &sentence,
            "its highlight is sharper than the photographs resolve: alpha is a bound, "
            "not an estimate: at most %.2g",
            e->alpha + IGI_BOUND_SIGMAS * e->alpha_std));
        IGI_TRY(igi_add_sentence(ctx, &m->warnings, &m->warning_count, sentence));
    }
    if (e->broader != IGI_LAMBERT) {
        IGI_TRY(igi_strprintf(
            ctx, &sentence,
            "its highlights are too broad to tell lobes' families apart: %s's, with "
            "alpha above %g, may fit as well: specular and alpha are those of %s's",
            igi_model_name(e->broader), IGI_FIT_ALPHA_HIGH, igi_model_name(e->model)));
        IGI_TRY(igi_add_sentence(ctx, &m->warnings, &m->warning_count, sentence));
    }
    if (e->rival == IGI_LAMBERT) return IGI_OK;
    IGI_TRY(igi_strprintf(ctx, &sentence,
                          "its highlights have the shape of %s's lobe rather than %s's, which was "
                          "asked for: specular and alpha are those of the wrong family; use "
                          "--model auto",
                          igi_model_name(e->rival), igi_model_name(e->model)));
    return igi_add_sentence(ctx, &m->warnings, &m->warning_count, sentence);
}

/* A metal's diffuse part must be asked for: where its standard deviation allows for none, there is none. */
static igi_status drop_metals_diffuse(igi_context *ctx, int bands, igi_material *m)
{
    double most = 0;
    if (m->model == IGI_LAMBERT || m->specular < METAL_SPECULAR || m->textured) return IGI_OK;
    for (int b = 0; b < bands; b++) {
        if (m->albedo[b] > IGI_BOUND_SIGMAS * m->albedo_std[b]) return IGI_OK;
        most = fmax(most,
                    fmin(1 - m->specular, m->albedo[b] + IGI_BOUND_SIGMAS * m->albedo_std[b]));
    }
    for (int b = 0; b < bands; b++) m->albedo[b] = 0;
    char *sentence;
    IGI_TRY(igi_strprintf(ctx, &sentence,
                          "it mirrors as much as metals alone do, and what is seen beside its lobe "
                          "leaves open whether there is a diffuse part (at most %.2g): none is "
                          "assumed",
                          fmax(0, most)));
    return igi_add_sentence(ctx, &m->warnings, &m->warning_count, sentence);
}

static igi_status make_materials(igi_context *ctx, const igi_problem *p, const igi_diffuse *d,
                                 const igi_specular *s, igi_materials **materials)
{
    igi_status status = IGI_OK;
    igi_materials *m = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &m));
    IGI_TRY_GOTO(igi_strdup(ctx, p->scene->name, &m->scene));
    m->bands = p->bands;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, p->scene->region_count, &m->materials));
    m->count = p->scene->region_count;
    for (size_t r = 0; r < m->count; r++)
        IGI_TRY_GOTO(make_material(ctx, p, d, r, &m->materials[r]));
    for (size_t r = 0; s && r < m->count; r++) {
        igi_material *one = &m->materials[r];
        if (one->emitter) continue;
        if (s->estimates[r].model != IGI_LAMBERT)
            IGI_TRY_GOTO(set_lobe(ctx, &s->estimates[r], p->bands, one));
        else if (s->doubts && one->determined)
            IGI_TRY_GOTO(set_bound(ctx, &s->doubts[r], p->bands, one));
    }
    IGI_TRY_GOTO(measure_coverage(ctx, p, m));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, p->scene->light_count, &m->lights));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, p->scene->light_count, &m->light_std));
    m->light_count = p->scene->light_count;
    for (size_t k = 0; k < p->light_count; k++) {
        size_t l = p->light_of[k];
        if (k > 0 && p->light_of[k - 1] == l) continue; /* another band of an environment */
        bool split = p->scene->lights[l].type == IGI_LIGHT_ENV;
        m->lights[l] = split ? p->scene->lights[l] : p->lights[k];
        m->lights[l].file = NULL;
        if (p->lights[k].file) IGI_TRY_GOTO(igi_strdup(ctx, p->lights[k].file, &m->lights[l].file));
        memcpy(m->light_std[l], p->light_std[k], sizeof m->light_std[l]);
    }
    for (size_t i = 0; i < p->observations->warning_count; i++) {
        char *sentence;
        IGI_TRY_GOTO(igi_strdup(ctx, p->observations->warnings[i], &sentence));
        IGI_TRY_GOTO(igi_add_sentence(ctx, &m->warnings, &m->warning_count, sentence));
    }
    for (size_t i = 0; i < d->warning_count; i++) {
        char *sentence;
        IGI_TRY_GOTO(igi_strdup(ctx, d->warnings[i], &sentence));
        IGI_TRY_GOTO(igi_add_sentence(ctx, &m->warnings, &m->warning_count, sentence));
    }
    *materials = m;
    m = NULL;
cleanup:
    igi_materials_destroy(m);
    return status;
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
    for (size_t r = 0; r < recovery->materials->count; r++)
        IGI_TRY_GOTO(drop_metals_diffuse(ctx, problem->bands, &recovery->materials->materials[r]));
    IGI_TRY_GOTO(igi_doubts_add(ctx, problem, field, recovery->materials));
    igi_stage_begin(ctx, "compare");
    IGI_TRY_GOTO(igi_compare(ctx, problem, field, layout, recovery));
cleanup:
    igi_layout_destroy(layout);
    igi_field_destroy(made);
    return status;
}

/* One recovery, from observing on. *recovery stays NULL where the stated error of the diffuse
 * solution is above `limit`. */
static igi_status recover_from(igi_context *ctx, const igi_scene *scene, const igi_tracer *tracer,
                               const igi_recover_options *o, double limit, igi_recovery **recovery)
{
    igi_status status = IGI_OK;
    igi_observations *observations = NULL;
    igi_poses *poses = NULL;
    igi_patches *patches = NULL;
    igi_problem *problem = NULL;
    igi_diffuse *diffuse = NULL;
    igi_specular *specular = NULL;
    igi_recovery *r = NULL;
    igi_stage_begin(ctx, "observe");
    IGI_TRY_GOTO(igi_observe(ctx, scene, tracer, 0, &observations));
    IGI_TRY_GOTO(igi_poses_mend(ctx, scene, tracer, o->registering, &observations, &poses));
    if (poses) scene = &poses->scene;
    igi_stage_begin(ctx, "agreement");
    IGI_TRY_GOTO(igi_observations_reconcile(ctx, scene, observations));
    IGI_TRY_GOTO(igi_observations_unclip(ctx, scene, observations));
    igi_stage_begin(ctx, "patches");
    IGI_TRY_GOTO(igi_patches_create(ctx, &scene->mesh, (float)o->patch_m, &patches));
    IGI_TRY_GOTO(igi_problem_create(ctx, scene, tracer, observations, patches, o, &problem));
    IGI_TRY_GOTO(igi_diffuse_create(ctx, problem, &diffuse));
    if (o->method == IGI_METHOD_YU99)
        IGI_TRY_GOTO(igi_yu99_create(ctx, problem, diffuse, &specular));
    else IGI_TRY_GOTO(method_function(o->method)(ctx, problem, diffuse));
    if (igi_stated_error(problem, diffuse) > limit) goto cleanup;
    if (o->method == IGI_METHOD_PATCHES && o->model != IGI_LAMBERT)
        IGI_TRY_GOTO(igi_specular_create(ctx, problem, diffuse, &specular));
    igi_lobe_view view;
    if (specular) view = igi_specular_view(specular, diffuse);
    if (specular) problem->lobes = &view;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &r));
    IGI_TRY_GOTO(make_materials(ctx, problem, diffuse, specular, &r->materials));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, scene->region_count, &r->evidence));
    if (specular && specular->evidence)
        memcpy(r->evidence, specular->evidence, scene->region_count * sizeof *r->evidence);
    count_gathered(problem, diffuse->rows, r->evidence);
    IGI_TRY_GOTO(draw(ctx, problem, diffuse, specular ? specular->irradiance : NULL, r));
    if (poses) r->registered = poses->registered;
    if (poses) poses->registered = NULL;
    *recovery = r;
    r = NULL;
cleanup:
    igi_recovery_destroy(r);
    igi_specular_destroy(specular);
    igi_diffuse_destroy(diffuse);
    igi_problem_destroy(problem);
    igi_patches_destroy(patches);
    igi_observations_destroy(observations);
    igi_poses_destroy(poses);
    return status;
}

static double standard_patch(const igi_tracer *tracer)
{
    return (double)(PATCH_SHARE * igi_tracer_size(tracer, NULL, NULL));
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
    if (!(o->patch_m > 0))
        o->patch_m = standard_patch(tracer) *
                     fmin(fmax(1, sqrt(options->target_error / FINE_ERROR)), COARSEST);
    for (int attempt = 0; attempt < ATTEMPTS; attempt++, need.sharpness *= SHARPER) {
        igi_choice *choice;
        igi_recovery *r = NULL;
        igi_stage_begin(ctx, "choose views");
        IGI_TRY(igi_choice_make(ctx, scene, tracer, &need, &choice));
        bool all = choice->scene.frame_count == 0 || (choice->left_out == 0 && choice->reduce == 1);
        igi_status status = all ? IGI_OK
                                : recover_from(ctx, &choice->scene, tracer, o, o->target_error, &r);
        bool failed = status == IGI_E_DATA || status == IGI_E_NO_ANSWER;
        if (r) status = note_choice(ctx, scene, choice, r);
        igi_choice_destroy(choice);
        if (r && status == IGI_OK) *recovery = r;
        else igi_recovery_destroy(r);
        if (all || r || (status != IGI_OK && !failed)) return status;
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
    if (o.method == IGI_METHOD_PATCHES && o.target_error > 0)
        IGI_TRY_GOTO(recover_from_few(ctx, scene, tracer, &o, recovery));
    if (!(o.patch_m > 0)) o.patch_m = standard_patch(tracer);
    if (!*recovery) IGI_TRY_GOTO(recover_from(ctx, scene, tracer, &o, HUGE_VAL, recovery));
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
