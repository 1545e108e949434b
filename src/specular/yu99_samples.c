/* SPDX-License-Identifier: Apache-2.0
 *
 * Sample points and their links.
 *
 * Prediction of highlights: the lobe of a middling roughness that the lamps would make at a pixel,
 * plus what a mirror would show there, over what the pixel shows.
 *
 * Links: directions drawn from lobes of four roughnesses, from the cosine and from the lamps. What
 * surfaces send (with Delta S, see recover/incident.h) is weighted against the first two alone, what
 * lamps send against all three (balance heuristic; Veach 1997), so that one set serves for every
 * roughness and for the irradiance.
 */
#include "specular/yu99.h"

#include "base/parallel.h"
#include "base/rng.h"
#include "brdf/brdf.h"
#include "scene/camera.h"
#include "transport/mesh_elements.h"

#include <stdlib.h>
#include <string.h>

#define CANDIDATES 4000
#define LOBE_LINKS 96 /* a multiple of the number of roughnesses */
#define COSINE_LINKS 64
#define LAMP_LINKS 16 /* to each lamp */
#define SHADOW_RAYS 8
#define PREDICTED_ALPHA 0.15f
#define POINTS_A_TASK 8

static const float alphas[4] = {0.04f, 0.1f, 0.2f, 0.4f};

typedef struct candidate {
    uint32_t observation;
    float score;
} candidate;

typedef struct job {
    const igi_radiance_field *field;
    size_t points; /* how many are wanted */
    igi_yu99_samples *out;
    candidate *candidates;
    size_t candidate_count;
    size_t lights;
} job;

typedef struct view {
    igi_vec point, normal, out; /* out: in the frame of the normal */
} view;

static view view_of(const igi_problem *p, size_t i)
{
    const igi_observations *o = p->observations;
    uint32_t triangle = igi_surface_triangle(o->surface[i]);
    view v = {igi_triangle_point(&p->scene->mesh, triangle, o->uv[2 * i], o->uv[2 * i + 1]),
              igi_tracer_normal(p->tracer, triangle),
              {0, 0, 1}};
    if (igi_surface_is_back(o->surface[i])) v.normal = igi_scale(v.normal, -1);
    igi_vec eye = igi_camera_centre(&p->scene->frames[igi_observation_frame(o, i)].camera);
    v.out = igi_to_local(igi_normalize(igi_sub(eye, v.point)), v.normal);
    return v;
}

static float brightness(const float *radiance, int bands)
{
    float sum = 0;
    for (int b = 0; b < bands; b++) sum += radiance[b];
    return sum / (float)bands;
}

static float predict(const job *j, size_t observation, igi_rng *rng)
{
    const igi_problem *p = j->field->problem;
    view v = view_of(p, observation);
    float mirrored[IGI_MAX_BANDS] = {0}, lamps = 0, scale, base;
    if (v.out.z <= 0.05f) return 0;
    igi_vec mirror = igi_to_world(igi_v(-v.out.x, -v.out.y, v.out.z), v.normal);
    igi_hit hit = igi_trace(p->tracer, v.point, mirror);
    /* as the cameras saw it: the same pixels are chosen whatever the lobes are */
    igi_radiance_field seen_field = {p, j->field->total, j->field->total, NULL};
    (void)igi_radiance_toward(&seen_field, v.point, mirror, &hit, rng, mirrored);
    for (size_t l = 0; l < j->lights; l++)
        for (int k = 0; k < 4; k++) {
            igi_light_sample s;
            float x = igi_rng_float(rng), y = igi_rng_float(rng);
            if (!igi_light_sample_toward(p->lighting, l, v.point, x, y, &s)) continue;
            igi_vec in = igi_to_local(s.direction, v.normal);
            if (in.z <= 0 || igi_light_hidden(p->tracer, v.point, &s)) continue;
            igi_lobe_terms(IGI_WARD, PREDICTED_ALPHA, in, v.out, &scale, &base);
            float value = 0;
            for (int b = 0; b < p->bands; b++)
                value += igi_light_sample_value(&p->lights[l], &s, b) / (float)p->bands;
            lamps += scale * in.z * s.weight * value / 4;
        }
    float seen = brightness(p->observations->radiance + observation * (size_t)p->bands, p->bands);
    return (lamps + brightness(mirrored, p->bands)) / fmaxf(seen, 1e-20f);
}

static igi_status score(igi_context *ctx, void *user, size_t i, int worker)
{
    (void)worker;
    job *j = user;
    igi_rng rng = igi_rng_make(igi_seed(ctx), j->candidates[i].observation);
    j->candidates[i].score = predict(j, j->candidates[i].observation, &rng);
    igi_count_rays(ctx, 1 + 4 * j->lights);
    return IGI_OK;
}

static int by_score(const void *a, const void *b)
{
    const candidate *x = a, *y = b;
    if (x->score != y->score) return x->score > y->score ? -1 : 1;
    return x->observation < y->observation ? -1 : x->observation > y->observation;
}

/* Pixels of the region, thinned evenly, the most promising first. */
static igi_status find_promising(igi_context *ctx, job *j, uint32_t region)
{
    const igi_problem *p = j->field->problem;
    const igi_observations *o = p->observations;
    size_t total = 0, met = 0;
    for (size_t i = 0; i < o->count; i++)
        total += p->scene->mesh.regions[igi_surface_triangle(o->surface[i])] == region;
    size_t stride = total / CANDIDATES + 1;
    IGI_TRY(IGI_ALLOC(ctx, total / stride + 1, &j->candidates));
    for (size_t i = 0; i < o->count; i++) {
        if (p->scene->mesh.regions[igi_surface_triangle(o->surface[i])] != region) continue;
        if (met++ % stride == 0) j->candidates[j->candidate_count++].observation = (uint32_t)i;
    }
    IGI_TRY(igi_parallel_for(ctx, j->candidate_count, score, j));
    qsort(j->candidates, j->candidate_count, sizeof *j->candidates, by_score);
    return IGI_OK;
}

/* Of the sorted candidates the first half of the points, the others evenly from what is left. */
static void choose_promising(job *j)
{
    size_t n = j->candidate_count, first = j->points / 2, rest = j->points - first;
    for (size_t k = 0; k < rest && n > j->points; k++)
        j->candidates[first + k] = j->candidates[first + k * (n - first) / rest];
    j->out->count = n < j->points ? n : j->points;
}

static double seen_area(const igi_problem *p, uint32_t side, uint32_t region)
{
    if (igi_problem_seen_count(p, side) == 0) return 0;
    if (igi_patch_region(p->patches, side >> 1) != region) return 0;
    return (double)p->patches->area[side >> 1];
}

/* Pixels spread evenly over the area of the region that photographs show. */
static igi_status choose_evenly(igi_context *ctx, job *j, uint32_t region)
{
    const igi_problem *p = j->field->problem;
    double total = 0, passed = 0;
    uint32_t sides = 2 * (uint32_t)p->patches->count;
    IGI_TRY(IGI_ALLOC(ctx, j->points, &j->candidates));
    for (uint32_t side = 0; side < sides; side++) total += seen_area(p, side, region);
    for (uint32_t side = 0; side < sides; side++) {
        passed += seen_area(p, side, region);
        while (j->out->count < j->points &&
               ((double)j->out->count + 0.5) * total < passed * (double)j->points) {
            uint64_t any = igi_hash64(igi_seed(ctx) ^ igi_hash64(j->out->count));
            size_t at = p->site_begin[side] + (size_t)(any % igi_problem_seen_count(p, side));
            j->candidates[j->out->count++].observation = p->order[at];
        }
    }
    return IGI_OK;
}

/* Density of directions, but for the lamps' own. */
static float density(igi_vec in, igi_vec out)
{
    float sum = COSINE_LINKS * in.z / IGI_PIF;
    for (int a = 0; a < 4; a++) sum += LOBE_LINKS / 4 * igi_lobe_pdf(IGI_WARD, alphas[a], in, out);
    return sum;
}

/* One direction; adds to the irradiance what a surface sends along it. */
static void link_along(const job *j, const view *v, igi_vec in, igi_rng *rng, igi_yu99_link *link,
                       float *irradiance)
{
    const igi_problem *p = j->field->problem;
    link->in = in;
    if (in.z <= 0) return;
    igi_vec direction = igi_to_world(in, v->normal);
    igi_hit hit = igi_trace(p->tracer, v->point, direction);
    float own = density(in, v->out);
    link->weight = in.z / own;
    (void)igi_radiance_toward(j->field, v->point, direction, &hit, rng, link->incident);
    for (int b = 0; b < p->bands; b++) irradiance[b] += link->weight * link->incident[b];
    igi_lighting_add_met(p->lighting, v->point, direction, &hit, own, LAMP_LINKS, link->incident);
}

static void link_to_lamp(const job *j, const view *v, size_t light, igi_rng *rng,
                         igi_yu99_link *link)
{
    const igi_problem *p = j->field->problem;
    igi_light_sample s;
    float x = igi_rng_float(rng), y = igi_rng_float(rng);
    if (!igi_light_sample_toward(p->lighting, light, v->point, x, y, &s)) return;
    igi_vec in = igi_to_local(s.direction, v->normal);
    if (in.z <= 0 || igi_light_hidden(p->tracer, v->point, &s)) return;
    link->in = in;
    bool extended = s.pdf > 0;
    link->weight = in.z / (extended ? density(in, v->out) + LAMP_LINKS * s.pdf : LAMP_LINKS);
    for (int b = 0; b < p->bands; b++)
        link->incident[b] = s.weight * (extended ? s.pdf : 1) *
                            igi_light_sample_value(&p->lights[light], &s, b);
}

static void set_up_point(const job *j, size_t i, uint64_t seed)
{
    igi_yu99_samples *s = j->out;
    const igi_problem *p = j->field->problem;
    size_t bands = (size_t)s->bands, observation = j->candidates[i].observation;
    igi_yu99_link *link = s->link + i * s->links;
    float *irradiance = s->irradiance + i * bands;
    igi_rng rng = igi_rng_make(seed, observation);
    view v = view_of(p, observation);
    s->out[i] = v.out;
    memcpy(s->radiance + i * bands, p->observations->radiance + observation * bands,
           bands * sizeof(float));
    if (v.out.z <= 0) return;
    double shift[2] = {(double)igi_rng_float(&rng), (double)igi_rng_float(&rng)}, at[2];
    for (int k = 0; k < LOBE_LINKS + COSINE_LINKS; k++) {
        igi_kronecker(shift, k < LOBE_LINKS ? k / 4 : k, 2, at);
        float x = (float)at[0], y = (float)at[1];
        igi_vec in = k < LOBE_LINKS ? igi_lobe_sample(IGI_WARD, alphas[k % 4], v.out, x, y)
                                    : igi_cosine_direction(igi_v(0, 0, 1), x, y);
        link_along(j, &v, in, &rng, link++, irradiance);
    }
    for (size_t l = 0; l < j->lights; l++) {
        float received = igi_light_irradiance(p->lighting, p->tracer, l, v.point, v.normal,
                                              SHADOW_RAYS, observation * j->lights + l);
        for (size_t b = 0; b < bands; b++) irradiance[b] += received * (float)p->lights[l].value[b];
        for (int k = 0; k < LAMP_LINKS; k++) link_to_lamp(j, &v, l, &rng, link++);
    }
}

static igi_status set_up_points(igi_context *ctx, void *user, size_t task, int worker)
{
    (void)worker;
    job *j = user;
    size_t end = (task + 1) * POINTS_A_TASK;
    if (end > j->out->count) end = j->out->count;
    for (size_t i = task * POINTS_A_TASK; i < end; i++) set_up_point(j, i, igi_seed(ctx) + 1);
    igi_count_rays(ctx, (end - task * POINTS_A_TASK) * j->out->links);
    return IGI_OK;
}

igi_status igi_yu99_samples_create(igi_context *ctx, const igi_radiance_field *field,
                                   uint32_t region, size_t points, bool predicted,
                                   igi_yu99_samples **samples)
{
    igi_status status = IGI_OK;
    size_t bands = (size_t)field->problem->bands;
    job j = {
        .field = field, .points = points, .lights = igi_lighting_count(field->problem->lighting)};
    *samples = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &j.out));
    j.out->bands = field->problem->bands;
    j.out->links = LOBE_LINKS + COSINE_LINKS + LAMP_LINKS * j.lights;
    if (predicted) {
        IGI_TRY_GOTO(find_promising(ctx, &j, region));
        choose_promising(&j);
    } else {
        IGI_TRY_GOTO(choose_evenly(ctx, &j, region));
    }
    IGI_TRY_GOTO(IGI_ALLOC(ctx, j.out->count, &j.out->out));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, j.out->count * bands, &j.out->radiance));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, j.out->count * bands, &j.out->irradiance));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, j.out->count * j.out->links, &j.out->link));
    IGI_TRY_GOTO(igi_parallel_for(ctx, (j.out->count + POINTS_A_TASK - 1) / POINTS_A_TASK,
                                  set_up_points, &j));
    *samples = j.out;
    j.out = NULL;
cleanup:
    igi_free(j.candidates);
    igi_yu99_samples_destroy(j.out);
    return status;
}

void igi_yu99_samples_destroy(igi_yu99_samples *samples)
{
    if (!samples) return;
    igi_free(samples->out);
    igi_free(samples->radiance);
    igi_free(samples->irradiance);
    igi_free(samples->link);
    igi_free(samples);
}
