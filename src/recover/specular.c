/* SPDX-License-Identifier: Apache-2.0 */
#include "recover/specular.h"

#include "base/parallel.h"
#include "brdf/brdf.h"
#include "recover/field.h"
#include "recover/methods.h"
#include "scene/camera.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define ROUNDS 2
#define SIDES_A_TASK 64
#define SEEN_SAMPLES 8      /* photographs' pixels of a side whose lobe is taken out */
#define RECEIVED_SAMPLES 16 /* rays of a row that look for lobes */

typedef struct job {
    const igi_problem *problem;
    const igi_radiance_field *field;
    const igi_rows *rows;
    const igi_lobe *lobes;
    igi_correction *correction;
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
    float sum[IGI_MAX_BANDS] = {0};
    uint64_t rays = 0;
    for (int k = 0; k < SEEN_SAMPLES; k++) {
        size_t at = (size_t)(((double)k + (double)igi_rng_float(rng)) / SEEN_SAMPLES * (double)n);
        size_t i = p->order[p->site_begin[side] + at];
        uint32_t triangle = igi_surface_triangle(o->surface[i]);
        igi_vec point = igi_triangle_point(&p->scene->mesh, triangle, o->uv[2 * i], o->uv[2 * i + 1]);
        igi_vec normal = igi_tracer_normal(p->tracer, triangle);
        if (side & 1) normal = igi_scale(normal, -1);
        igi_vec eye = igi_camera_centre(&p->scene->frames[igi_observation_frame(o, i)].camera);
        rays += (uint64_t)igi_lobe_radiance(j->field, lobe, point, normal,
                                            igi_normalize(igi_sub(eye, point)), rng, sum);
    }
    for (size_t b = 0; b < bands; b++)
        j->correction->seen[side * bands + b] = sum[b] / (float)SEEN_SAMPLES;
    return rays;
}

/* Irradiance of a row by the lobes of what its rays meet. */
static uint64_t received_part(const job *j, size_t row, igi_rng *rng)
{
    const igi_problem *p = j->problem;
    uint32_t side = j->rows->side[row];
    size_t bands = (size_t)p->bands;
    float sum[IGI_MAX_BANDS] = {0};
    uint64_t rays = 0;
    float start[2] = {igi_rng_float(rng), igi_rng_float(rng)};
    for (int k = 0; k < RECEIVED_SAMPLES; k++) {
        uint32_t triangle;
        float u, v, x = start[0] + (float)k * 0.7548776662f, y = start[1] + (float)k * 0.5698402910f;
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
        rays += (uint64_t)igi_lobe_radiance(j->field, lobe, igi_madd(point, direction, hit.distance),
                                            met, igi_scale(direction, -1), rng, sum);
    }
    for (size_t b = 0; b < bands; b++)
        j->correction->received[row * bands + b] = sum[b] * IGI_PIF / (float)RECEIVED_SAMPLES;
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
        if (igi_problem_seen_count(j->problem, side) > 0 && lobe_of_side(j, side)->model != IGI_LAMBERT)
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

static igi_status fit_region(igi_context *ctx, const igi_radiance_field *field,
                             const igi_diffuse *diffuse, const igi_field *irradiance,
                             igi_specular *s, size_t region)
{
    const igi_problem *p = field->problem;
    igi_highlights *h = NULL;
    igi_status status = IGI_OK;
    igi_highlight_options options = {.pixels = 2000, .lobe_samples = 48, .lamp_samples = 128,
                                     .lamp_tests = 8,
                                     .alphas = {0.03f, 0.08f, 0.18f, 0.4f},
                                     .per_point = p->scene->regions[region].textured == IGI_YES};
    igi_lobe_estimate *e = &s->estimates[region];
    if (s->lobes[region].model != IGI_LAMBERT) {
        float a = s->lobes[region].alpha;
        for (int k = 0; k < 3; k++) options.alphas[k] = a * (k == 0 ? 0.6f : k == 1 ? 1.0f : 1.7f);
        options.alphas[3] = fmaxf(0.4f, a);
    }
    irradiance_source source = {p, irradiance};
    IGI_TRY_GOTO(igi_highlights_create(ctx, field, diffuse->rows, region, &options, irradiance_at,
                                       &source, &h));
    IGI_TRY_GOTO(igi_lobe_fit(ctx, h, IGI_WARD, e));
    if (getenv("DUMP") && !strcmp(getenv("DUMP"), p->scene->regions[region].name)) {
      double al[1] = {atof(getenv("DA"))}; igi_lobe_table t; (void)!igi_lobe_table_create(ctx, h, IGI_WARD, al, 1, &t);
      { FILE*g=fopen("/tmp/try/samples.txt","w"); for(size_t i=0;i<h->count;i++) { if (h->observation[i]!=9876 && h->observation[i]!=744300) continue; for(int m=0;m<h->samples;m++){ igi_direction_sample d=h->directions[i*(size_t)h->samples+(size_t)m]; float sc=0,bb=0; if(d.weight>0) igi_lobe_terms(IGI_WARD,.15f,d.in,d.out,&sc,&bb); fprintf(g,"%zu %d %g %g %g %g\n",i,m,(double)d.weight,(double)h->incident[(i*(size_t)h->samples+(size_t)m)*3],(double)sc,(double)d.in.z);} } fclose(g);}
      FILE*fp=fopen("/tmp/try/dump.txt","w"); for(size_t i=0;i<h->count;i++){ igi_vec o = h->directions[i*h->samples].out; fprintf(fp,"%u %u %g %g %g %g %g %g %g %g %g %g\n",h->group[i],h->observation[i],h->radiance[3*i],h->radiance[3*i+1],h->radiance[3*i+2],h->irradiance[3*i],h->irradiance[3*i+1],h->irradiance[3*i+2],t.scale[3*i],t.scale[3*i+1],t.scale[3*i+2],o.z);} fclose(fp);
    }
    if (getenv("VV")) {
      igi_lobe_estimate g, ph; (void)!igi_lobe_fit(ctx, h, IGI_GGX, &g); (void)!igi_lobe_fit(ctx,h,IGI_PHONG,&ph);
      printf("%-14s n %zu groups %zu ward rs %.4f a %.4f noise %.3f chi %.1f plain %.1f of %.0f | ggx rs %.4f a %.4f chi %.1f pl %.1f | phong %.4f %.4f %.1f pl %.1f\n", p->scene->regions[region].name, h->count, h->groups, e->specular, e->alpha, e->noise, e->misfit, e->plain_misfit, e->residuals,
        g.specular, g.alpha, g.misfit, g.plain_misfit, ph.specular, ph.alpha, ph.misfit, ph.plain_misfit);
    }
cleanup:
    igi_highlights_destroy(h);
    return status;
}

static void take_lobe(igi_lobe *lobe, igi_lobe_estimate *e, int bands)
{
    bool found = e->plain_misfit - e->misfit > 50 && e->misfit < 0.98*e->plain_misfit && e->specular > 1e-3;
    if (!found) e->model = IGI_LAMBERT;
    lobe->model = e->model;
    lobe->alpha = (float)e->alpha;
    for (int b = 0; b < bands; b++) lobe->specular[b] = found ? (float)e->specular : 0;
}

static void set_total(const igi_problem *p, const igi_diffuse *d, const igi_correction *c, float *total)
{
    size_t n = 2 * p->patches->count * (size_t)p->bands;
    for (size_t k = 0; k < n; k++) total[k] = d->radiance[k] + c->seen[k];
}

igi_status igi_specular_create(igi_context *ctx, const igi_problem *problem, igi_diffuse *diffuse,
                               igi_specular **specular)
{
    igi_status status = IGI_OK;
    igi_specular *s = NULL;
    float *total = NULL;
    igi_field *irradiance = NULL;
    size_t regions = problem->scene->region_count, sides = 2 * problem->patches->count;
    size_t bands = (size_t)problem->bands;
    *specular = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &s));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions, &s->estimates));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions, &s->lobes));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, sides * bands, &s->correction.seen));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, diffuse->rows->count * bands, &s->correction.received));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, sides * bands, &total));
    igi_radiance_field field = {problem, diffuse->radiance, total, s->lobes};
    for (int round = 0; round < (getenv("SR")?atoi(getenv("SR")):ROUNDS); round++) {
        igi_stage_begin(ctx, "lobes");
        set_total(problem, diffuse, &s->correction, total);
        IGI_TRY_GOTO(igi_field_create(ctx, problem, diffuse, &irradiance));
        for (size_t r = 0; r < regions; r++) {
            if (problem->scene->regions[r].emitter || !diffuse->determined[r]) continue;
            IGI_TRY_GOTO(fit_region(ctx, &field, diffuse, irradiance, s, r));
        }
        for (size_t r = 0; r < regions; r++) take_lobe(&s->lobes[r], &s->estimates[r], problem->bands);
        igi_field_destroy(irradiance);
        irradiance = NULL;
        igi_stage_begin(ctx, "correct");
        job j = {problem, &field, diffuse->rows, s->lobes, &s->correction, (uint64_t)round};
        size_t tasks = (diffuse->rows->count + SIDES_A_TASK - 1) / SIDES_A_TASK;
        memset(s->correction.seen, 0, sides * bands * sizeof(float));
        IGI_TRY_GOTO(igi_parallel_for(ctx, tasks, correct_rows, &j));
        IGI_TRY_GOTO(igi_patches_solve(ctx, problem, &s->correction, diffuse));
    }
    *specular = s;
    s = NULL;
cleanup:
    igi_field_destroy(irradiance);
    igi_free(total);
    igi_specular_destroy(s);
    return status;
}

void igi_specular_destroy(igi_specular *specular)
{
    if (!specular) return;
    igi_free(specular->estimates);
    igi_free(specular->lobes);
    igi_free(specular->correction.seen);
    igi_free(specular->correction.received);
    igi_free(specular);
}
