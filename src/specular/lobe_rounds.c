/* SPDX-License-Identifier: Apache-2.0 */
#include "specular/lobe_rounds.h"

#include "specular/effort.h"
#include "specular/lobe_choice.h"

#include <math.h>

/* Candidates of which each step chooses its pixels, at most. */
#define GLANCE_SCORED 4000
#define SEARCH_SCORED 20000
#define REFINE_SCORED 100000
#define DOUBT_SCORED 8000
#define SEARCHED 1200
#define FEWEST_SEARCHED 400
#define FEWEST_FITTED 500
#define FEW_PIXELS 1000  /* to tell models apart; */
#define MOST_PIXELS 4000 /* more, until independent noise leaves no more of rho_s open */
#define QUIET 0.006
#define MOST_LAMP_POINTS 96
#define LAMP_POINTS_ALPHA 5 /* so many times the reciprocal of alpha */

typedef struct irradiance_source {
    const igi_problem *problem;
    const igi_field *field;
} irradiance_source;

static void irradiance_at(const void *user, size_t observation, float *irradiance)
{
    const irradiance_source *s = user;
    const igi_observations *o = s->problem->observations;
    igi_field_irradiance(s->field, o->surface[observation], o->uv[2 * observation],
                         o->uv[2 * observation + 1], irradiance);
}

/* So many, less where less is asked for. */
static size_t by_effort(const igi_lobe_round *s, size_t usual)
{
    return (size_t)((double)usual * igi_lobe_effort(s->field->problem->options));
}

static bool is_per_point(const igi_problem *p, size_t region)
{
    return p->scene->regions[region].textured == IGI_YES;
}

static igi_highlight_source source_of(const igi_lobe_round *s, const irradiance_source *irradiance)
{
    return (igi_highlight_source){s->field, s->diffuse->rows, &s->candidates, irradiance_at,
                                  irradiance};
}

static igi_status score_pixels(igi_context *ctx, const igi_lobe_round *s, size_t region,
                               size_t scored, const float alphas[4], igi_highlight_scores *scores)
{
    irradiance_source irradiance = {s->field->problem, s->irradiance};
    igi_highlight_source source = source_of(s, &irradiance);
    return igi_highlight_scores_create(ctx, &source, region, scored, alphas, scores);
}

static igi_status choose_highlights(igi_context *ctx, const igi_lobe_round *s,
                                    const igi_highlight_scores *scores,
                                    igi_highlight_options options, const igi_highlights *fewer,
                                    igi_highlights **h)
{
    irradiance_source irradiance = {s->field->problem, s->irradiance};
    igi_highlight_source source = source_of(s, &irradiance);
    options.per_point = is_per_point(s->field->problem, scores->region);
    IGI_TRY(igi_highlights_create(ctx, &source, scores, &options, fewer, h));
    s->specular->evidence[scores->region].lobe_rays += (*h)->rays;
    return IGI_OK;
}

/* Highlights by scores of their own. */
static igi_status find_highlights(igi_context *ctx, const igi_lobe_round *s, size_t region,
                                  size_t scored, const igi_highlight_options *options,
                                  igi_highlights **h)
{
    igi_highlight_scores scores;
    IGI_TRY(score_pixels(ctx, s, region, scored, options->alphas, &scores));
    igi_status status = choose_highlights(ctx, s, &scores, *options, NULL, h);
    igi_highlight_scores_clear(&scores);
    return status;
}

static void record(const igi_lobe_round *s, size_t region, const char *look,
                   const igi_lobe_estimate *e)
{
    igi_region_evidence *evidence = &s->specular->evidence[region];
    if (evidence->count == IGI_EVIDENCE_ROOM) return;
    evidence->tried[evidence->count++] = (igi_model_evidence){
        .model = e->model,
        .look = look,
        .gain = e->residuals > 0 ? e->plain_deviance - e->deviance : (double)NAN,
        .residuals = e->residuals,
        .noise = e->noise,
        .plain_noise = e->plain_noise,
        .specular = e->specular,
        .specular_std = e->specular_std,
        .alpha = e->alpha,
        .at_bound = e->at_bound,
        .coloured = e->colour.found,
        .colour_gain = e->colour.gain};
}

/* A first look with few pixels: is there a lobe at all? A later model is asked where the first sees
 * none: ward's lobe, as strong from everywhere, is no hint of ggx's, which grows at grazing angles. */
static igi_status glance_at_region(igi_context *ctx, const igi_lobe_round *s, size_t region,
                                   const igi_highlight_options *options, const igi_model *models,
                                   size_t count)
{
    igi_highlights *h = NULL;
    igi_lobe_estimate *e = &s->specular->estimates[region], seen;
    IGI_TRY(find_highlights(ctx, s, region, GLANCE_SCORED, options, &h));
    igi_status status = IGI_OK;
    for (size_t i = 0; i < count && status == IGI_OK; i++) {
        status = igi_lobe_glance(ctx, h, models[i], e);
        seen = *e;
        seen.at_bound = false; /* a glance does not look for that */
        if (status == IGI_OK) record(s, region, "glance", &seen);
        if (igi_lobe_is_hinted(e)) break;
    }
    igi_highlights_destroy(h);
    return status;
}

/* The best of the given models on these highlights. */
static igi_status fit_region(igi_context *ctx, const igi_lobe_round *s, size_t region,
                             const igi_highlights *h, const igi_model *models, size_t count)
{
    igi_lobe_estimate *best = &s->specular->estimates[region], found[3];
    for (size_t i = 0; i < count; i++) {
        double start = best->model == IGI_LAMBERT ? 0 : best->alpha;
        /* a Phong lobe of the same width has twice the alpha: cos^n of twice the angle */
        if (best->model == IGI_WARD && models[i] == IGI_PHONG) start = 2 * best->alpha;
        IGI_TRY(igi_lobe_fit(ctx, h, models[i], start, &found[i]));
        record(s, region, best->model == IGI_LAMBERT ? "search" : "refine", &found[i]);
    }
    igi_lobe_choose(found, count, best);
    return IGI_OK;
}

/* All models that can be told apart; the one that the user asks for comes first. */
static void order_models(const igi_problem *p, igi_model models[3])
{
    static const igi_model all[3] = {IGI_WARD, IGI_GGX, IGI_PHONG};
    size_t n = 0;
    int asked = p->options->model;
    if (asked != IGI_ANY_MODEL) models[n++] = (igi_model)asked;
    for (size_t i = 0; i < 3; i++)
        if ((int)all[i] != asked) models[n++] = all[i];
}

/* A closer look everywhere: where is the lobe? */
static igi_status search_region(igi_context *ctx, const igi_lobe_round *s, size_t region,
                                igi_highlight_options options, const igi_model *models,
                                size_t count)
{
    igi_highlights *h = NULL;
    options.pixels = FEWEST_SEARCHED + by_effort(s, SEARCHED - FEWEST_SEARCHED);
    options.lobe_samples = 32;
    options.lamp_samples = 64;
    options.sharp_samples = 16;
    s->specular->estimates[region].model = IGI_LAMBERT; /* the hint is no start */
    IGI_TRY(find_highlights(ctx, s, region, SEARCH_SCORED, &options, &h));
    igi_status status = fit_region(ctx, s, region, h, models, count);
    igi_highlights_destroy(h);
    return status;
}

igi_status igi_lobes_search(igi_context *ctx, const igi_lobe_round *s)
{
    const igi_problem *p = s->field->problem;
    const igi_highlight_options options = {.pixels = 300,
                                           .lobe_samples = 16,
                                           .lamp_samples = 32,
                                           .lamp_tests = 4,
                                           .sharp_samples = 8,
                                           .sharp = {0.006f, 0.02f},
                                           .alphas = {0.03f, 0.08f, 0.18f, 0.4f}};
    igi_model models[3];
    order_models(p, models);
    /* Phong's lobe is like enough to Ward's to be found by it. */
    size_t allowed = p->options->model == IGI_ANY_MODEL ? 2 : 1;
    for (size_t r = 0; r < p->scene->region_count; r++) {
        if (p->scene->regions[r].emitter || !s->diffuse->determined[r]) continue;
        if (p->observations->scarce[r]) continue; /* its neighbours' light would pass for a lobe */
        igi_lobe_estimate *e = &s->specular->estimates[r];
        IGI_TRY(glance_at_region(ctx, s, r, &options, models, allowed));
        if (igi_lobe_is_hinted(e)) IGI_TRY(search_region(ctx, s, r, options, models, allowed));
        igi_lobe_take(e, p->bands, &s->specular->lobes[r]);
        IGI_TRY(igi_progress(ctx, (double)(r + 1) / (double)p->scene->region_count));
    }
    return IGI_OK;
}

/* How many pixels make what independent noise leaves of rho_s small enough: it falls with their
 * root. What is left then are errors that more pixels share. */
static size_t enough_pixels(const igi_lobe_round *s, size_t tried, const igi_lobe_estimate *e)
{
    double effort = igi_lobe_effort(s->field->problem->options);
    double rest = e->specular > 0 ? e->noise_std / e->specular / QUIET : HUGE_VAL;
    return (size_t)(effort * fmin(MOST_PIXELS, (double)tried * rest * rest));
}

/* As many places on a lamp as a lobe so broad can tell apart. */
static int lamp_points(float alpha)
{
    return (int)fminf(MOST_LAMP_POINTS, fmaxf(MOST_LAMP_POINTS / 2, LAMP_POINTS_ALPHA / alpha));
}

static bool is_surrounded(const igi_problem *p)
{
    for (size_t l = 0; l < p->light_count; l++)
        if (p->lights[l].type == IGI_LIGHT_ENV) return true;
    return false;
}

/* First which model, then how much of it, by the same pixels and more. */
static igi_status refine_region(igi_context *ctx, const igi_lobe_round *s, size_t r)
{
    const igi_problem *p = s->field->problem;
    igi_status status = IGI_OK;
    igi_model models[3];
    bool asked = p->options->model != IGI_ANY_MODEL;
    float a = s->specular->lobes[r].alpha;
    const size_t least = FEWEST_FITTED + by_effort(s, FEW_PIXELS - FEWEST_FITTED);
    igi_highlight_options options = {.pixels = least,
                                     .lobe_samples = 64,
                                     .lamp_samples = lamp_points(a),
                                     .lamp_tests = 8,
                                     .sharp_samples = a < IGI_SHARP_ALPHA ? 32 : 0,
                                     .sharp = {0.7f * a, 1.5f * a},
                                     .alphas = {0.6f * a, a, 1.7f * a, fmaxf(0.4f, a)}};
    igi_lobe_estimate *e = &s->specular->estimates[r], before = *e, first;
    igi_highlight_scores scores;
    igi_highlights *few = NULL, *more = NULL;
    if (is_surrounded(p)) { /* windows' edges in a narrow lobe: noise of S draws alpha down */
        options.lobe_samples = 256;
        options.lamp_samples = 192;
    }
    order_models(p, models);
    IGI_TRY(score_pixels(ctx, s, r, by_effort(s, REFINE_SCORED), options.alphas, &scores));
    IGI_TRY_GOTO(choose_highlights(ctx, s, &scores, options, NULL, &few));
    IGI_TRY_GOTO(fit_region(ctx, s, r, few, models, 3));
    first = *e;
    const igi_model chosen = asked ? models[0] : first.model;
    if (asked) *e = before;
    options.pixels = asked ? by_effort(s, MOST_PIXELS) : enough_pixels(s, least, e);
    if (options.pixels > least) {
        IGI_TRY_GOTO(choose_highlights(ctx, s, &scores, options, few, &more));
        IGI_TRY_GOTO(fit_region(ctx, s, r, more, &chosen, 1));
    }
    e->rival = first.model != chosen ? first.model : IGI_LAMBERT;
    e->alike = asked ? first.alike : IGI_LAMBERT;
    e->alike_alpha = first.alike_alpha;
    e->broader = IGI_LAMBERT;
    if (!asked) igi_lobe_allow_for_broader(e, &first);
cleanup:
    igi_highlights_destroy(few);
    igi_highlights_destroy(more);
    igi_highlight_scores_clear(&scores);
    return status;
}

igi_status igi_lobes_refine(igi_context *ctx, const igi_lobe_round *s)
{
    const igi_problem *p = s->field->problem;
    for (size_t r = 0; r < p->scene->region_count; r++) {
        if (s->specular->lobes[r].model == IGI_LAMBERT) continue;
        IGI_TRY(refine_region(ctx, s, r));
        igi_lobe_estimate *e = &s->specular->estimates[r];
        if (isfinite(e->alpha_std) && e->alpha + e->alpha_std > IGI_FIT_ALPHA_HIGH)
            e->at_bound = true; /* as far as anyone can tell */
        igi_lobe_take(&s->specular->estimates[r], p->bands, &s->specular->lobes[r]);
        IGI_TRY(igi_progress(ctx, (double)(r + 1) / (double)p->scene->region_count));
    }
    return IGI_OK;
}

igi_status igi_lobes_doubt(igi_context *ctx, const igi_lobe_round *s)
{
    const igi_problem *p = s->field->problem;
    const igi_highlight_options options = {.pixels = 600,
                                           .lobe_samples = 16,
                                           .lamp_samples = 32,
                                           .lamp_tests = 4,
                                           .alphas = {0.03f, 0.08f, 0.18f, 0.4f}};
    for (size_t r = 0; r < p->scene->region_count; r++) {
        if (p->scene->regions[r].emitter || !s->diffuse->determined[r]) continue;
        if (s->specular->lobes[r].model != IGI_LAMBERT) continue;
        igi_highlights *h = NULL;
        IGI_TRY(find_highlights(ctx, s, r, DOUBT_SCORED, &options, &h));
        igi_status status = igi_lobe_doubt_create(ctx, h, &s->specular->doubts[r]);
        igi_highlights_destroy(h);
        IGI_TRY(status);
    }
    return IGI_OK;
}
