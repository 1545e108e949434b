/* SPDX-License-Identifier: Apache-2.0 */
#include "specular/specular.h"

#include "diffuse/field.h"
#include "diffuse/methods.h"
#include "specular/correction.h"
#include "specular/effort.h"

#include <math.h>
#include <string.h>

/* What a lobe must gain in -2 ln likelihood: in all, and of every residual; less once the other
 * lobes' light is out of the way. On surfaces without a lobe, errors of the irradiance feign up to
 * .03 of a residual at first; the faintest true lobe of the cubical room gains .2, then .05. */
#define MIN_GAIN 20
#define SEARCH_SHARE 0.04
#define KEEP_SHARE 0.04
#define MIN_SIGMAS 4
#define HINT_SHARE 0.03
#define HINT_NOISE 0.2
#define SHARP_SHARE 0.01
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
#define MIRRORED 0.02       /* what is mirrored is known no better (scripts/random_rooms) */

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

/* What a round of fitting needs. */
typedef struct stage {
    const igi_radiance_field *field;
    const igi_diffuse *diffuse;
    igi_field *irradiance;
    igi_specular *specular;
    igi_candidates candidates;
} stage;

/* So many, less where less is asked for. */
static size_t by_effort(const stage *s, size_t usual)
{
    return (size_t)((double)usual * igi_lobe_effort(s->field->problem->options));
}

static bool is_per_point(const igi_problem *p, size_t region)
{
    return p->scene->regions[region].textured == IGI_YES;
}

/* A later model must be better by more than the noise of such differences, which for sharp lobes is
 * that of S: a share of all that the lobe explains; and a lobe that ran into
 * an end of what is looked for is none. */
static bool is_better(const igi_lobe_estimate *later, const igi_lobe_estimate *best)
{
    if (later->at_bound != best->at_bound) return best->at_bound;
    double margin = igi_lobe_margin(later);
    if (best->alpha < (double)IGI_SHARP_ALPHA)
        margin += SHARP_SHARE * fmax(0, best->plain_deviance - best->deviance);
    return later->deviance < best->deviance - margin;
}

static igi_highlight_source source_of(const stage *s, const irradiance_source *irradiance)
{
    return (igi_highlight_source){s->field, s->diffuse->rows, &s->candidates, irradiance_at,
                                  irradiance};
}

static igi_status score_pixels(igi_context *ctx, const stage *s, size_t region, size_t scored,
                               const float alphas[4], igi_highlight_scores *scores)
{
    irradiance_source irradiance = {s->field->problem, s->irradiance};
    igi_highlight_source source = source_of(s, &irradiance);
    return igi_highlight_scores_create(ctx, &source, region, scored, alphas, scores);
}

static igi_status choose_highlights(igi_context *ctx, const stage *s,
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
static igi_status find_highlights(igi_context *ctx, const stage *s, size_t region, size_t scored,
                                  const igi_highlight_options *options, igi_highlights **h)
{
    igi_highlight_scores scores;
    IGI_TRY(score_pixels(ctx, s, region, scored, options->alphas, &scores));
    igi_status status = choose_highlights(ctx, s, &scores, *options, NULL, h);
    igi_highlight_scores_clear(&scores);
    return status;
}

static void record(const stage *s, size_t region, const char *look, const igi_lobe_estimate *e)
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

/* A first look with few pixels: is there a lobe at all? */
static igi_status glance_at_region(igi_context *ctx, const stage *s, size_t region,
                                   const igi_highlight_options *options, igi_model model)
{
    igi_highlights *h = NULL;
    IGI_TRY(find_highlights(ctx, s, region, GLANCE_SCORED, options, &h));
    igi_status status = igi_lobe_glance(ctx, h, model, &s->specular->estimates[region]);
    igi_lobe_estimate seen = s->specular->estimates[region];
    seen.at_bound = false; /* a glance does not look for that */
    if (status == IGI_OK) record(s, region, "glance", &seen);
    igi_highlights_destroy(h);
    return status;
}

/* The family that fits best beside the chosen one, unless it fits worse by more than the margin. */
static void find_alike(const igi_lobe_estimate *found, size_t count, igi_lobe_estimate *best)
{
    double least = best->deviance + igi_lobe_margin(best);
    for (size_t i = 0; i < count; i++) {
        if (found[i].model == best->model || found[i].at_bound || found[i].deviance > least)
            continue;
        least = found[i].deviance;
        best->alike = found[i].model;
        best->alike_alpha = found[i].alpha;
    }
}

/* The best of the given models on these highlights. */
static igi_status fit_region(igi_context *ctx, const stage *s, size_t region,
                             const igi_highlights *h, const igi_model *models, size_t count)
{
    igi_lobe_estimate *best = &s->specular->estimates[region], all[3], broad = {.at_bound = false};
    igi_model before = best->model;
    double near_alpha = best->alpha;
    for (size_t i = 0; i < count; i++) {
        double start = before == IGI_LAMBERT ? 0 : near_alpha;
        /* a Phong lobe of the same width has twice the alpha: cos^n of twice the angle */
        if (before == IGI_WARD && models[i] == IGI_PHONG) start = 2 * near_alpha;
        igi_lobe_estimate *found = &all[i];
        IGI_TRY(igi_lobe_fit(ctx, h, models[i], start, found));
        record(s, region, before == IGI_LAMBERT ? "search" : "refine", found);
        if (i == 0 || is_better(found, best)) *best = *found;
        if (found->at_bound && (!broad.at_bound || found->deviance < broad.deviance))
            broad = *found;
    }
    find_alike(all, count, best);
    if (broad.at_bound && !best->at_bound &&
        best->deviance > broad.deviance - igi_lobe_margin(best)) {
        best->broader = broad.model;
        best->broader_specular = broad.specular;
        best->broader_alpha = broad.alpha;
    }
    return IGI_OK;
}

/* A family that fits as well leaves open what it says otherwise. */
static void allow_for_broader(igi_lobe_estimate *e, const igi_lobe_estimate *first)
{
    e->broader = first->broader;
    if (e->broader == IGI_LAMBERT) return;
    e->specular_std = hypot(e->specular_std, first->broader_specular - e->specular);
    e->alpha_std = hypot(e->alpha_std, first->broader_alpha - e->alpha);
}

/* Is the lobe asked for? It must gain far more likelihood than chance gives (BIC), more than errors
 * of the irradiance could feign (a share of every residual), and have a width of its own. */
static bool is_earned(const igi_lobe_estimate *e, double share)
{
    double gain = e->plain_deviance - e->deviance;
    return gain > MIN_GAIN + 2 * log(fmax(e->residuals, 1)) && gain > share * e->residuals &&
           !e->at_bound && e->specular > MIN_SIGMAS * e->noise_std;
}

/* Is it worth a closer look? */
static bool is_hinted(const igi_lobe_estimate *e)
{
    if (e->plain_noise > HINT_NOISE) return true; /* no diffuse surface looks like this */
    return e->plain_deviance - e->deviance > HINT_SHARE * e->residuals;
}

static void take_lobe(igi_lobe *lobe, igi_lobe_estimate *e, double share, int bands)
{
    bool earned = is_earned(e, share);
    if (!earned) e->model = IGI_LAMBERT;
    lobe->model = e->model;
    lobe->alpha = (float)e->alpha;
    for (int b = 0; b < bands; b++)
        lobe->specular[b] = earned ? (float)igi_lobe_coefficient(e, b) : 0;
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
static igi_status search_region(igi_context *ctx, const stage *s, size_t region,
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

/* First a search everywhere with few pixels; what the cameras saw stands for what leaves. */
static igi_status search_lobes(igi_context *ctx, stage *s)
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
        IGI_TRY(glance_at_region(ctx, s, r, &options, models[0]));
        if (is_hinted(e)) IGI_TRY(search_region(ctx, s, r, options, models, allowed));
        take_lobe(&s->specular->lobes[r], e, SEARCH_SHARE, p->bands);
        IGI_TRY(igi_progress(ctx, (double)(r + 1) / (double)p->scene->region_count));
    }
    return IGI_OK;
}

/* How many pixels make what independent noise leaves of rho_s small enough: it falls with their
 * root. What is left then are errors that more pixels share. */
static size_t enough_pixels(const stage *s, size_t tried, const igi_lobe_estimate *e)
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
static igi_status refine_region(igi_context *ctx, const stage *s, size_t r)
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
    if (!asked) allow_for_broader(e, &first);
cleanup:
    igi_highlights_destroy(few);
    igi_highlights_destroy(more);
    igi_highlight_scores_clear(&scores);
    return status;
}

/* Then, where one was found, with directions about it. */
static igi_status refine_lobes(igi_context *ctx, stage *s)
{
    const igi_problem *p = s->field->problem;
    for (size_t r = 0; r < p->scene->region_count; r++) {
        if (s->specular->lobes[r].model == IGI_LAMBERT) continue;
        IGI_TRY(refine_region(ctx, s, r));
        take_lobe(&s->specular->lobes[r], &s->specular->estimates[r], KEEP_SHARE, p->bands);
        IGI_TRY(igi_progress(ctx, (double)(r + 1) / (double)p->scene->region_count));
    }
    return IGI_OK;
}

/* What may have been overlooked where no lobe was found. */
static igi_status doubt_regions(igi_context *ctx, const stage *s)
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

static bool any_lobe(const igi_specular *s, size_t regions)
{
    for (size_t r = 0; r < regions; r++)
        if (s->lobes[r].model != IGI_LAMBERT) return true;
    return false;
}

static void set_total(const igi_problem *p, const igi_diffuse *d, const igi_correction *c,
                      float *total)
{
    size_t n = 2 * p->patches->count * (size_t)p->bands;
    for (size_t k = 0; k < n; k++) total[k] = d->radiance[k] + c->seen[k];
}

/* Search, correct, refine, correct: the corrections after the first change less than the noise. */
static igi_status run(igi_context *ctx, const igi_problem *p, igi_diffuse *diffuse, igi_specular *s,
                      float *total)
{
    igi_status status = IGI_OK;
    igi_radiance_field field = {p, diffuse->radiance, total, NULL};
    stage st = {&field, diffuse, NULL, s, {NULL, NULL, NULL}};
    IGI_TRY_GOTO(igi_candidates_create(ctx, p, &st.candidates));
    for (uint64_t round = 0; round < 2; round++) {
        igi_stage_begin(ctx, round == 0 ? "search lobes" : "refine lobes");
        set_total(p, diffuse, &s->correction, total);
        IGI_TRY_GOTO(igi_field_create(ctx, p, diffuse, &st.irradiance));
        IGI_TRY_GOTO(round == 0 ? search_lobes(ctx, &st) : refine_lobes(ctx, &st));
        bool none = round == 0 && !any_lobe(s, p->scene->region_count);
        if (none || round == 1) IGI_TRY_GOTO(doubt_regions(ctx, &st));
        if (none) {
            s->irradiance = st.irradiance; /* nothing will change it */
            st.irradiance = NULL;
            break;
        }
        igi_field_destroy(st.irradiance);
        st.irradiance = NULL;
        igi_stage_begin(ctx, "correct");
        field.lobes = s->lobes;
        IGI_TRY_GOTO(igi_correction_find(ctx, &field, diffuse, round, &s->correction));
        IGI_TRY_GOTO(igi_patches_solve(ctx, p, &s->correction, diffuse));
    }
cleanup:
    igi_candidates_clear(&st.candidates);
    igi_field_destroy(st.irradiance);
    return status;
}

/* Adds to the standard deviations of albedos what is not known of lobes: theirs where one was found
 * (alpha moves a lobe's light about, rho_s says how much it is), the doubt elsewhere. */
static igi_status widen_albedos(igi_context *ctx, const igi_problem *p, igi_diffuse *d,
                                const igi_specular *s)
{
    size_t regions = p->scene->region_count, bands = (size_t)p->bands;
    double(*lobe)[IGI_MAX_BANDS] = NULL, (*received)[IGI_MAX_BANDS] = NULL;
    igi_status status = IGI_OK;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions, &lobe));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions, &received));
    for (size_t i = 0; i < d->rows->seen_count; i++) {
        uint32_t side = d->rows->side[i];
        size_t r = igi_patch_region(p->patches, side >> 1);
        float direct[IGI_MAX_BANDS], indirect[IGI_MAX_BANDS];
        double area = (double)p->patches->area[side >> 1];
        igi_row_direct(d->rows, i, p->lights, p->bands, direct);
        igi_row_indirect(d->rows, i, d->radiance, p->bands, indirect);
        for (size_t b = 0; b < bands && igi_problem_seen_count(p, side) > 0; b++) {
            lobe[r][b] += area * IGI_PI * (double)s->correction.seen[side * bands + b];
            received[r][b] += area * ((double)direct[b] + (double)indirect[b]);
        }
    }
    for (size_t r = 0; r < regions; r++) {
        const igi_lobe_estimate *e = &s->estimates[r];
        double *std = d->albedo_std[r];
        bool found = s->lobes[r].model != IGI_LAMBERT && e->specular > 0;
        for (size_t b = 0; b < bands && received[r][b] > 0; b++) {
            double known = found ? hypot(igi_lobe_coefficient_std(e, (int)b) /
                                             igi_lobe_coefficient(e, (int)b),
                                         MIRRORED)
                                 : 0;
            std[b] = hypot(std[b], found ? lobe[r][b] / received[r][b] * fmin(1, known)
                                         : s->doubts[r].share[b] * d->albedo[r][b]);
        }
    }
cleanup:
    igi_free(lobe);
    igi_free(received);
    return status;
}

igi_status igi_specular_create(igi_context *ctx, const igi_problem *problem, igi_diffuse *diffuse,
                               igi_specular **specular)
{
    igi_status status = IGI_OK;
    igi_specular *s = NULL;
    float *total = NULL;
    size_t regions = problem->scene->region_count, sides = 2 * problem->patches->count;
    size_t bands = (size_t)problem->bands;
    *specular = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &s));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions, &s->estimates));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions, &s->doubts));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions, &s->evidence));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions, &s->lobes));
    IGI_TRY_GOTO(igi_correction_create(ctx, problem, diffuse->rows, &s->correction));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, sides * bands, &total));
    IGI_TRY_GOTO(run(ctx, problem, diffuse, s, total));
    IGI_TRY_GOTO(widen_albedos(ctx, problem, diffuse, s));
    *specular = s;
    s = NULL;
cleanup:
    igi_free(total);
    igi_specular_destroy(s);
    return status;
}

igi_lobe_view igi_specular_view(const igi_specular *specular, const igi_diffuse *diffuse)
{
    return (igi_lobe_view){diffuse->rows, specular->lobes, &specular->correction};
}

void igi_specular_destroy(igi_specular *specular)
{
    if (!specular) return;
    igi_field_destroy(specular->irradiance);
    igi_free(specular->estimates);
    igi_free(specular->doubts);
    igi_free(specular->evidence);
    igi_free(specular->lobes);
    igi_correction_clear(&specular->correction);
    igi_free(specular);
}
