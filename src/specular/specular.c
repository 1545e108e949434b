/* SPDX-License-Identifier: Apache-2.0 */
#include "specular/specular.h"

#include "base/parallel.h"
#include "diffuse/field.h"
#include "diffuse/methods.h"
#include "scene/camera.h"

#include <math.h>
#include <string.h>

#define SIDES_A_TASK 64
/* What a lobe must gain in -2 ln likelihood: in all, and of every residual; less once the other
 * lobes' light is out of the way. On surfaces without a lobe, errors of the irradiance feign up to
 * .03 of a residual at first; the faintest true lobe of the cubical room gains .2, then .05. */
#define MIN_GAIN 20
#define SEARCH_SHARE 0.04
#define KEEP_SHARE 0.04
#define MIN_SIGMAS 4
#define HINT_SHARE 0.03
#define HINT_NOISE 0.2
#define MODEL_GAIN 10
#define MODEL_SHARE 0.02
#define SEEN_SAMPLES 40000 /* photographs' pixels of a region whose lobe is taken out, about */
#define LEAST_RECEIVED 2   /* rays of a row that look for lobes: half of those it gathers with */
#define MOST_RECEIVED 512

typedef struct job {
    const igi_problem *problem;
    const igi_radiance_field *field;
    const igi_rows *rows;
    const igi_lobe *lobes;
    igi_correction *correction;
    const size_t *sides; /* [regions] seen sides */
    uint64_t round;
} job;

static const igi_lobe *lobe_of_side(const job *j, uint32_t side)
{
    return &j->lobes[igi_patch_region(j->problem->patches, side >> 1)];
}

/* The lobe's mean part of what the photographs show of a side, from some of its pixels. */
static uint64_t seen_part(const job *j, uint32_t side, igi_rng *rng)
{
    const igi_problem *p = j->problem;
    const igi_observations *o = p->observations;
    const igi_lobe *lobe = lobe_of_side(j, side);
    size_t n = igi_problem_seen_count(p, side), bands = (size_t)p->bands;
    float lamps[IGI_MAX_BANDS] = {0}, surfaces[IGI_MAX_BANDS] = {0};
    uint64_t rays = 0;
    int samples = (int)(SEEN_SAMPLES / j->sides[igi_patch_region(p->patches, side >> 1)]);
    samples = samples < 12 ? 12 : samples > 64 ? 64 : samples;
    for (int k = 0; k < samples; k++) {
        size_t at = (size_t)(((double)k + (double)igi_rng_float(rng)) / samples * (double)n);
        size_t i = p->order[p->site_begin[side] + at];
        uint32_t triangle = igi_surface_triangle(o->surface[i]);
        igi_vec point = igi_triangle_point(&p->scene->mesh, triangle, o->uv[2 * i],
                                           o->uv[2 * i + 1]);
        igi_vec normal = igi_tracer_normal(p->tracer, triangle);
        if (side & 1) normal = igi_scale(normal, -1);
        igi_vec eye = igi_camera_centre(&p->scene->frames[igi_observation_frame(o, i)].camera);
        rays += (uint64_t)igi_lobe_radiance(j->field, lobe, point, normal,
                                            igi_normalize(igi_sub(eye, point)), rng, lamps,
                                            surfaces);
    }
    for (size_t b = 0; b < bands; b++) {
        j->correction->surfaces[side * bands + b] = surfaces[b] / (float)samples;
        j->correction->seen[side * bands + b] = (lamps[b] + surfaces[b]) / (float)samples;
    }
    return rays;
}

/* Irradiance of a row by the lobes of what its rays meet. */
static uint64_t received_part(const job *j, size_t row, igi_rng *rng)
{
    const igi_problem *p = j->problem;
    uint32_t side = j->rows->side[row];
    size_t bands = (size_t)p->bands, half = (j->rows->begin[row + 1] - j->rows->begin[row]) / 2;
    int samples = half < LEAST_RECEIVED  ? LEAST_RECEIVED
                  : half > MOST_RECEIVED ? MOST_RECEIVED
                                         : (int)half;
    float sum[IGI_MAX_BANDS] = {0};
    uint64_t rays = 0;
    float start[2] = {igi_rng_float(rng), igi_rng_float(rng)};
    for (int k = 0; k < samples; k++) {
        uint32_t triangle;
        float u, v, x = start[0] + (float)k * 0.7548776662f,
                    y = start[1] + (float)k * 0.5698402910f;
        igi_patch_sample(p->patches, side >> 1, rng, &triangle, &u, &v);
        igi_vec point = igi_triangle_point(&p->scene->mesh, triangle, u, v);
        igi_vec normal = igi_tracer_normal(p->tracer, triangle);
        if (side & 1) normal = igi_scale(normal, -1);
        igi_vec direction = igi_cosine_direction(normal, x - floorf(x), y - floorf(y));
        igi_hit hit = igi_trace(p->tracer, point, direction);
        rays++;
        if (hit.triangle == IGI_NO_HIT) continue;
        const igi_lobe *lobe = &j->lobes[p->scene->mesh.regions[hit.triangle]];
        if (lobe->model == IGI_LAMBERT) continue;
        igi_vec met = igi_tracer_normal(p->tracer, hit.triangle);
        if (hit.back) met = igi_scale(met, -1);
        rays += (uint64_t)igi_lobe_radiance(j->field, lobe,
                                            igi_madd(point, direction, hit.distance), met,
                                            igi_scale(direction, -1), rng, sum, sum);
    }
    for (size_t b = 0; b < bands; b++)
        j->correction->received[row * bands + b] = sum[b] * IGI_PIF / (float)samples;
    return rays;
}

static igi_status correct_rows(igi_context *ctx, void *user, size_t task, int worker)
{
    (void)worker;
    const job *j = user;
    uint64_t rays = 0;
    size_t end = (task + 1) * SIDES_A_TASK;
    if (end > j->rows->count) end = j->rows->count;
    for (size_t row = task * SIDES_A_TASK; row < end; row++) {
        igi_rng rng = igi_rng_make(igi_seed(ctx) + 0x51ec + j->round, row);
        uint32_t side = j->rows->side[row];
        if (igi_problem_seen_count(j->problem, side) > 0 &&
            lobe_of_side(j, side)->model != IGI_LAMBERT)
            rays += seen_part(j, side, &rng);
        rays += received_part(j, row, &rng);
    }
    igi_count_rays(ctx, rays);
    return IGI_OK;
}

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

static bool is_per_point(const igi_problem *p, size_t region)
{
    return p->scene->regions[region].textured == IGI_YES;
}

/* A later model must be better by more than the noise of such differences; and a lobe that ran into
 * an end of what is looked for is none. */
static bool is_better(const igi_lobe_estimate *later, const igi_lobe_estimate *best)
{
    if (later->at_bound != best->at_bound) return best->at_bound;
    return later->deviance < best->deviance - MODEL_GAIN - MODEL_SHARE * later->residuals;
}

static igi_status choose_highlights(igi_context *ctx, const stage *s, size_t region,
                                    igi_highlight_options options, igi_highlights **h)
{
    irradiance_source source = {s->field->problem, s->irradiance};
    options.per_point = is_per_point(s->field->problem, region);
    options.candidates = &s->candidates;
    return igi_highlights_create(ctx, s->field, s->diffuse->rows, region, &options, irradiance_at,
                                 &source, h);
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
        .at_bound = e->at_bound};
}

/* A first look with few pixels: is there a lobe at all? */
static igi_status glance_at_region(igi_context *ctx, const stage *s, size_t region,
                                   igi_highlight_options options, igi_model model)
{
    igi_highlights *h = NULL;
    IGI_TRY(choose_highlights(ctx, s, region, options, &h));
    igi_status status = igi_lobe_glance(ctx, h, model, &s->specular->estimates[region]);
    igi_lobe_estimate seen = s->specular->estimates[region];
    seen.at_bound = false; /* a glance does not look for that */
    if (status == IGI_OK) record(s, region, "glance", &seen);
    igi_highlights_destroy(h);
    return status;
}

/* The best of the given models on one choice of highlights. */
static igi_status fit_region(igi_context *ctx, const stage *s, size_t region,
                             igi_highlight_options options, const igi_model *models, size_t count)
{
    igi_highlights *h = NULL;
    igi_status status = IGI_OK;
    igi_lobe_estimate *best = &s->specular->estimates[region], found;
    igi_model before = best->model;
    double near_alpha = best->alpha;
    IGI_TRY_GOTO(choose_highlights(ctx, s, region, options, &h));
    for (size_t i = 0; i < count; i++) {
        double start = before == IGI_LAMBERT ? 0 : near_alpha;
        /* a Phong lobe of the same width has twice the alpha: cos^n of twice the angle */
        if (before == IGI_WARD && models[i] == IGI_PHONG) start = 2 * near_alpha;
        IGI_TRY_GOTO(igi_lobe_fit(ctx, h, models[i], start, &found));
        record(s, region, before == IGI_LAMBERT ? "search" : "refine", &found);
        if (i == 0 || is_better(&found, best)) *best = found;
    }
cleanup:
    igi_highlights_destroy(h);
    return status;
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
    for (int b = 0; b < bands; b++) lobe->specular[b] = earned ? (float)e->specular : 0;
}

/* The models that the user allows: one, or all that can be told apart. */
static size_t allowed_models(const igi_problem *p, igi_model models[3])
{
    if (p->options->model != IGI_ANY_MODEL) {
        models[0] = (igi_model)p->options->model;
        return 1;
    }
    models[0] = IGI_WARD;
    models[1] = IGI_GGX;
    models[2] = IGI_PHONG;
    return 3;
}

/* First a search everywhere with few pixels; what the cameras saw stands for what leaves. */
static igi_status search_lobes(igi_context *ctx, stage *s)
{
    const igi_problem *p = s->field->problem;
    igi_highlight_options options = {.scored = 4000,
                                     .pixels = 300,
                                     .lobe_samples = 16,
                                     .lamp_samples = 32,
                                     .lamp_tests = 4,
                                     .alphas = {0.03f, 0.08f, 0.18f, 0.4f}};
    igi_model models[3];
    size_t allowed = allowed_models(p, models);
    if (allowed > 2) allowed = 2; /* Phong's lobe is like enough to Ward's to be found by it */
    for (size_t r = 0; r < p->scene->region_count; r++) {
        if (p->scene->regions[r].emitter || !s->diffuse->determined[r]) continue;
        if (p->observations->scarce[r]) continue; /* its neighbours' light would pass for a lobe */
        igi_lobe_estimate *e = &s->specular->estimates[r];
        IGI_TRY(glance_at_region(ctx, s, r, options, models[0]));
        if (is_hinted(e)) {
            igi_highlight_options closer = options;
            closer.scored = 20000;
            closer.pixels = 1200;
            closer.lobe_samples = 32;
            closer.lamp_samples = 64;
            e->model = IGI_LAMBERT; /* the hint is no start: look everywhere again */
            IGI_TRY(fit_region(ctx, s, r, closer, models, allowed));
        }
        take_lobe(&s->specular->lobes[r], e, SEARCH_SHARE, p->bands);
        IGI_TRY(igi_progress(ctx, (double)(r + 1) / (double)p->scene->region_count));
    }
    return IGI_OK;
}

/* Then, where one was found, with directions about it: first which model, then how much of it. */
static igi_status refine_lobes(igi_context *ctx, stage *s)
{
    const igi_problem *p = s->field->problem;
    igi_model models[3];
    size_t allowed = allowed_models(p, models);
    for (size_t r = 0; r < p->scene->region_count; r++) {
        if (s->specular->lobes[r].model == IGI_LAMBERT) continue;
        float a = s->specular->lobes[r].alpha;
        igi_highlight_options options = {.scored = 40000,
                                         .pixels = 1000,
                                         .lobe_samples = 64,
                                         .lamp_samples = 64,
                                         .lamp_tests = 8,
                                         .alphas = {0.6f * a, a, 1.7f * a, fmaxf(0.4f, a)}};
        if (allowed > 1) IGI_TRY(fit_region(ctx, s, r, options, models, allowed));
        const igi_model chosen = s->specular->estimates[r].model;
        options.pixels = 4000;
        options.lamp_samples = 96;
        IGI_TRY(fit_region(ctx, s, r, options, &chosen, 1));
        take_lobe(&s->specular->lobes[r], &s->specular->estimates[r], KEEP_SHARE, p->bands);
        IGI_TRY(igi_progress(ctx, (double)(r + 1) / (double)p->scene->region_count));
    }
    return IGI_OK;
}

/* What may have been overlooked where no lobe was found. */
static igi_status doubt_regions(igi_context *ctx, const stage *s)
{
    const igi_problem *p = s->field->problem;
    const igi_highlight_options options = {.scored = 8000,
                                           .pixels = 600,
                                           .lobe_samples = 16,
                                           .lamp_samples = 32,
                                           .lamp_tests = 4,
                                           .alphas = {0.03f, 0.08f, 0.18f, 0.4f}};
    for (size_t r = 0; r < p->scene->region_count; r++) {
        if (p->scene->regions[r].emitter || !s->diffuse->determined[r]) continue;
        if (s->specular->lobes[r].model != IGI_LAMBERT) continue;
        igi_highlights *h = NULL;
        IGI_TRY(choose_highlights(ctx, s, r, options, &h));
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

/* Takes the present lobes' light out of the diffuse half, which is solved again. */
static igi_status correct(igi_context *ctx, const igi_radiance_field *field, igi_diffuse *diffuse,
                          igi_specular *s, uint64_t round)
{
    const igi_problem *p = field->problem;
    igi_status status = IGI_OK;
    size_t *sides = NULL, count = diffuse->rows->count;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, p->scene->region_count, &sides));
    for (size_t i = 0; i < diffuse->rows->seen_count; i++)
        sides[igi_patch_region(p->patches, diffuse->rows->side[i] >> 1)]++;
    job j = {p, field, diffuse->rows, s->lobes, &s->correction, sides, round};
    size_t size = 2 * p->patches->count * (size_t)p->bands * sizeof(float);
    memset(s->correction.seen, 0, size);
    memset(s->correction.surfaces, 0, size);
    IGI_TRY_GOTO(
        igi_parallel_for(ctx, (count + SIDES_A_TASK - 1) / SIDES_A_TASK, correct_rows, &j));
    IGI_TRY_GOTO(igi_patches_solve(ctx, p, &s->correction, diffuse));
cleanup:
    igi_free(sides);
    return status;
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
        IGI_TRY_GOTO(correct(ctx, &field, diffuse, s, round));
    }
cleanup:
    igi_candidates_clear(&st.candidates);
    igi_field_destroy(st.irradiance);
    return status;
}

/* Adds to the standard deviations of albedos what is not known of lobes: theirs where one was found,
 * the doubt elsewhere. */
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
        double known = found ? hypot(e->specular_std / e->specular, e->alpha_std / e->alpha) : 0;
        for (size_t b = 0; b < bands && received[r][b] > 0; b++)
            std[b] = hypot(std[b], found ? lobe[r][b] / received[r][b] * fmin(1, known)
                                         : s->doubts[r].share[b] * d->albedo[r][b]);
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
    IGI_TRY_GOTO(IGI_ALLOC(ctx, sides * bands, &s->correction.seen));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, sides * bands, &s->correction.surfaces));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, diffuse->rows->count * bands, &s->correction.received));
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
    return (igi_lobe_view){diffuse->rows, specular->lobes, specular->correction.seen,
                           specular->correction.surfaces};
}

void igi_specular_destroy(igi_specular *specular)
{
    if (!specular) return;
    igi_field_destroy(specular->irradiance);
    igi_free(specular->estimates);
    igi_free(specular->doubts);
    igi_free(specular->evidence);
    igi_free(specular->lobes);
    igi_free(specular->correction.seen);
    igi_free(specular->correction.surfaces);
    igi_free(specular->correction.received);
    igi_free(specular);
}
