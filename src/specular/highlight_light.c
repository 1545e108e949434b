/* SPDX-License-Identifier: Apache-2.0
 *
 * The light that reaches the chosen pixels: each pixel's directions and what arrives along them.
 */
#include "specular/highlights_private.h"

#include "base/parallel.h"
#include "brdf/brdf.h"
#include "scene/camera.h"

#include <string.h>

#define MAX_LAMP_SAMPLES 256
#define PIECE_PATCHES 6 /* side of a piece of the surface, in patches */
#define PIXELS_A_TASK 16
#define UNKNOWN UINT32_MAX

typedef struct job {
    const igi_problem *problem;
    const igi_highlight_source *source;
    const igi_highlight_options *options;
    size_t region;
    const igi_highlights *fewer;
    uint32_t *known; /* [count] the same pixel among the fewer ones; UNKNOWN: not there */
    igi_highlights *out;
    uint64_t *rays; /* of each task */
} job;

typedef struct place {
    igi_vec point, normal, out;
} place;

/* A place within the pixel: on the tangent plane, or on a curved region on the facet that is there,
 * since a highlight's width is as much the facets' as the lobe's. */
static place footprint_place(const job *j, const igi_pixel_view *v, float u, float w)
{
    uint32_t width = (uint32_t)v->camera->width;
    const igi_problem *p = j->problem;
    igi_vec centre = igi_camera_centre(v->camera);
    igi_vec d = igi_camera_direction(v->camera, (double)(v->pixel % width) + (double)u,
                                     (double)(v->pixel / width) + (double)w);
    place at = {v->point, v->normal, v->out};
    float slope = igi_dot(d, v->normal);
    if (slope < -1e-3f)
        at.point = igi_madd(centre, d, igi_dot(igi_sub(v->point, centre), v->normal) / slope);
    if (j->source->candidates->curved[j->region]) {
        igi_hit hit = igi_trace(p->tracer, centre, d);
        if (hit.triangle != IGI_NO_HIT && p->scene->mesh.regions[hit.triangle] == j->region) {
            at.point = igi_madd(centre, d, hit.distance);
            at.normal = igi_tracer_normal(p->tracer, hit.triangle);
            if (hit.back) at.normal = igi_scale(at.normal, -1);
        }
    }
    at.out = igi_to_local(igi_normalize(igi_sub(centre, at.point)), at.normal);
    return at;
}

/* Density of all lobes together at direction `in`. */
static float lobes_density(const job *j, igi_vec in, igi_vec out)
{
    return (float)j->options->lobe_samples / 4 * igi_ward_pdf_sum(j->options->alphas, 4, in, out);
}

/* Of all samples of environments. */
static float around_density(const job *j, igi_vec direction)
{
    static const igi_hit nothing = {.triangle = IGI_NO_HIT};
    const igi_lighting *l = j->problem->lighting;
    float density = 0;
    for (size_t k = 0; k < igi_lighting_count(l); k++)
        density += igi_light_pdf(l, k, igi_v(0, 0, 0), direction, &nothing);
    return (float)j->options->lamp_samples * density;
}

/* Additive recurrences (Roberts 2018): of the plastic number for a direction, of square roots for
 * the place in the pixel. */
static void pattern_at(const float start[4], int m, float x[4])
{
    static const float steps[4] = {0.7548776662f, 0.5698402910f, 0.4142135624f, 0.7320508076f};
    for (int k = 0; k < 4; k++) {
        float at = start[k] + (float)m * steps[k];
        x[k] = fminf(at - floorf(at), 0.99999994f);
    }
}

typedef struct pixel_sets {
    const job *j;
    igi_pixel_view v;
    float start[4];
    igi_direction_sample *directions;
    float *incident;
    uint64_t rays;
} pixel_sets;

static void sample_lobes(pixel_sets *s, igi_rng *rng)
{
    const job *j = s->j;
    const igi_problem *p = j->problem;
    int half = j->options->lobe_samples / 2;
    float start[2][4]; /* each half has a pattern of its own: their difference tells the noise */
    for (int k = 0; k < 8; k++) start[k / 4][k % 4] = igi_rng_float(rng);
    for (int m = 0; m < j->options->lobe_samples; m++) {
        igi_direction_sample *d = &s->directions[m];
        float x[4];
        pattern_at(start[m / half], m % half, x);
        place at = footprint_place(j, &s->v, x[2], x[3]);
        d->out = at.out;
        if (d->out.z <= 0) continue;
        d->in = igi_lobe_sample(IGI_WARD, j->options->alphas[m % 4], d->out, x[0], x[1]);
        if (d->in.z <= 0) continue;
        igi_vec direction = igi_to_world(d->in, at.normal);
        igi_hit hit = igi_trace(p->tracer, at.point, direction);
        float density = lobes_density(j, d->in, d->out), *light = s->incident + m * p->bands;
        d->weight = d->in.z / density;
        s->rays++;
        if (hit.triangle == IGI_NO_HIT) {
            d->around = 1 + m / half;
            igi_lighting_add_emitted(p->lighting, direction, &hit, light);
            d->weight = d->in.z / (density + around_density(j, direction));
        } else {
            s->rays += (uint64_t)igi_radiance_toward(j->source->field, at.point, direction, &hit,
                                                     rng, light);
        }
    }
}

/* Density of all narrow lobes together. */
static float sharp_density(const job *j, igi_vec in, igi_vec out)
{
    float each = (float)(j->options->sharp_samples / 2);
    return each > 0 ? each * igi_ward_pdf_sum(j->options->sharp, 2, in, out) : 0;
}

/* The directions from narrow lobes that meet lamps, into directions[first...]. */
static void sample_sharp(pixel_sets *s, int first)
{
    const job *j = s->j;
    const igi_problem *p = j->problem;
    for (int m = 0; m < j->options->sharp_samples; m++) {
        igi_direction_sample *d = &s->directions[first + m];
        float x[4];
        pattern_at(s->start, m, x);
        place at = footprint_place(j, &s->v, x[2], x[3]);
        d->out = at.out;
        if (d->out.z <= 0) continue;
        d->in = igi_lobe_sample(IGI_WARD, j->options->sharp[m % 2], d->out, x[0], x[1]);
        if (d->in.z <= 0) continue;
        igi_vec direction = igi_to_world(d->in, at.normal);
        igi_hit hit = igi_trace(p->tracer, at.point, direction);
        s->rays++;
        if (hit.triangle == IGI_NO_HIT || hit.back) continue;
        int light = igi_lighting_of_triangle(p->lighting, hit.triangle);
        if (light < 0) continue;
        /* the density of sample_lamp's: of one of the lamp's triangles */
        float cosine = fabsf(igi_dot(direction, igi_tracer_normal(p->tracer, hit.triangle)));
        float lamp = (float)j->options->lamp_samples * hit.distance * hit.distance /
                     fmaxf(cosine * igi_triangle_area(&p->scene->mesh, hit.triangle), 1e-30f);
        d->weight = d->in.z / (lamp + sharp_density(j, d->in, d->out));
        for (int b = 0; b < p->bands; b++)
            s->incident[(first + m) * p->bands + b] = (float)p->lights[light].value[b];
    }
}

/* The directions of one environment: each carries all that is around the scene. */
static void sample_around(pixel_sets *s, size_t light, int first, igi_rng *rng)
{
    static const igi_hit nothing = {.triangle = IGI_NO_HIT};
    const job *j = s->j;
    const igi_problem *p = j->problem;
    igi_light_sample samples[MAX_LAMP_SAMPLES];
    float start[4]; /* neither environments of one band each nor halves share their directions */
    size_t count = 0, half = (size_t)j->options->lamp_samples / 2;
    for (int k = 0; k < 2; k++) {
        for (int i = 0; i < 4; i++) start[i] = igi_rng_float(rng);
        count += igi_light_sample_set(p->lighting, light, s->v.point, half, start, samples + count);
    }
    for (size_t m = 0; m < count; m++) {
        igi_direction_sample *d = &s->directions[first + (int)m];
        float x[4];
        pattern_at(start, (int)m, x);
        place at = footprint_place(j, &s->v, x[2], x[3]);
        d->out = at.out;
        d->in = igi_to_local(samples[m].direction, at.normal);
        if (d->in.z <= 0 || d->out.z <= 0) continue;
        s->rays++;
        if (igi_light_hidden(p->tracer, at.point, &samples[m])) continue;
        d->around = 1 + (2 * m >= count);
        d->weight = d->in.z /
                    (lobes_density(j, d->in, d->out) + around_density(j, samples[m].direction));
        igi_lighting_add_emitted(p->lighting, samples[m].direction, &nothing,
                                 s->incident + (first + (int)m) * p->bands);
    }
}

/* The directions of one lamp, into directions[first...]. Some are tested for shadow; where they
 * disagree, an edge of shadow crosses the lamp, and every direction is tested. */
static void sample_lamp(pixel_sets *s, size_t light, int first)
{
    const igi_problem *p = s->j->problem;
    igi_light_sample samples[MAX_LAMP_SAMPLES];
    size_t count = igi_light_sample_set(p->lighting, light, s->v.point,
                                        (size_t)s->j->options->lamp_samples, s->start, samples);
    size_t step = count / (size_t)s->j->options->lamp_tests + 1, hidden = 0, tested = 0;
    for (size_t m = 0; m < count; m += step) {
        hidden += igi_light_hidden(p->tracer, s->v.point, &samples[m]);
        tested++;
    }
    s->rays += tested;
    if (hidden == tested) return;
    for (size_t m = 0; m < count; m++) {
        igi_direction_sample *d = &s->directions[first + (int)m];
        float x[4];
        if (hidden > 0) {
            s->rays++;
            if (igi_light_hidden(p->tracer, s->v.point, &samples[m])) continue;
        }
        pattern_at(s->start, (int)m, x);
        place at = footprint_place(s->j, &s->v, x[2], x[3]);
        d->out = at.out;
        /* toward the same point of the lamp from this place of the pixel */
        igi_vec direction = samples[m].direction;
        if (!isinf(samples[m].distance))
            direction = igi_normalize(
                igi_sub(igi_madd(s->v.point, direction, samples[m].distance), at.point));
        d->in = igi_to_local(direction, at.normal);
        if (d->in.z <= 0 || d->out.z <= 0) continue;
        float narrow = sharp_density(s->j, d->in, d->out),
              lamp = samples[m].pdf * (float)s->j->options->lamp_samples;
        bool area = p->lights[light].type == IGI_LIGHT_AREA;
        d->weight = d->in.z * samples[m].weight * (area ? lamp / (lamp + narrow) : 1);
        for (int b = 0; b < p->bands; b++)
            s->incident[(first + (int)m) * p->bands + b] = igi_light_sample_value(&p->lights[light],
                                                                                  &samples[m], b);
    }
}

/* The piece of the surface at a point: a cell of a coarse grid. */
static uint32_t piece_of(const job *j, igi_vec point)
{
    float side = PIECE_PATCHES * j->problem->patches->size_m;
    uint64_t h = (uint64_t)(int64_t)floorf(point.x / side);
    h = igi_hash64(h) ^ (uint64_t)(int64_t)floorf(point.y / side);
    h = igi_hash64(h) ^ (uint64_t)(int64_t)floorf(point.z / side);
    return (uint32_t)igi_hash64(h);
}

/* Takes over what is known of the pixel. */
static void copy_pixel(const igi_highlights *from, size_t k, igi_highlights *to, size_t i)
{
    size_t bands = (size_t)to->bands, samples = (size_t)to->samples;
    to->piece[i] = from->piece[k];
    memcpy(to->radiance + i * bands, from->radiance + k * bands, bands * sizeof(float));
    memcpy(to->irradiance + i * bands, from->irradiance + k * bands, bands * sizeof(float));
    memcpy(to->directions + i * samples, from->directions + k * samples,
           samples * sizeof *to->directions);
    memcpy(to->incident + i * samples * bands, from->incident + k * samples * bands,
           samples * bands * sizeof(float));
}

static uint64_t light_pixel(const job *j, size_t i)
{
    igi_highlights *h = j->out;
    size_t bands = (size_t)h->bands, observation = h->observation[i];
    const igi_observations *o = j->problem->observations;
    igi_rng rng = igi_rng_make(igi_hash64(j->region), observation);
    memcpy(h->radiance + i * bands, o->radiance + observation * bands, bands * sizeof(float));
    j->source->irradiance(j->source->user, observation, h->irradiance + i * bands);
    pixel_sets s = {.j = j,
                    .v = igi_pixel_view_of(j->problem, observation),
                    .directions = h->directions + i * (size_t)h->samples,
                    .incident = h->incident + i * (size_t)h->samples * bands};
    h->piece[i] = piece_of(j, s.v.point);
    for (int k = 0; k < 4; k++) s.start[k] = igi_rng_float(&rng);
    sample_lobes(&s, &rng);
    for (size_t l = 0; l < j->source->rows->lights; l++) {
        int first = j->options->lobe_samples + (int)l * j->options->lamp_samples;
        if (j->problem->lights[l].type == IGI_LIGHT_ENV) sample_around(&s, l, first, &rng);
        else sample_lamp(&s, l, first);
    }
    sample_sharp(&s, h->samples - j->options->sharp_samples);
    return s.rays;
}

static igi_status light_pixels(igi_context *ctx, void *user, size_t task, int worker)
{
    (void)worker;
    const job *j = user;
    uint64_t rays = 0;
    size_t end = (task + 1) * PIXELS_A_TASK;
    if (end > j->out->count) end = j->out->count;
    for (size_t i = task * PIXELS_A_TASK; i < end; i++) {
        if (j->known[i] != UNKNOWN) copy_pixel(j->fewer, j->known[i], j->out, i);
        else rays += light_pixel(j, i);
    }
    igi_count_rays(ctx, rays);
    j->rays[task] = rays;
    return IGI_OK;
}

/* Both are chosen in the same order, so that the fewer ones are met one after the other. */
static void find_known(const igi_highlights *fewer, const igi_highlights *h, uint32_t *known)
{
    size_t next = 0;
    bool alike = fewer && fewer->samples == h->samples && fewer->lobe_samples == h->lobe_samples;
    for (size_t i = 0; i < h->count; i++) {
        bool met = alike && next < fewer->count && fewer->observation[next] == h->observation[i];
        known[i] = met ? (uint32_t)next++ : UNKNOWN;
    }
}

igi_status igi_highlights_light(igi_context *ctx, const igi_highlight_source *source, size_t region,
                                const igi_highlight_options *options, const igi_highlights *fewer,
                                igi_highlights *out)
{
    igi_status status = IGI_OK;
    size_t n = out->count, bands = (size_t)out->bands, samples = (size_t)out->samples;
    size_t tasks = (n + PIXELS_A_TASK - 1) / PIXELS_A_TASK;
    job j = {source->field->problem, source, options, region, fewer, NULL, out, NULL};
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n, &out->piece));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n * bands, &out->radiance));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n * bands, &out->irradiance));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n * samples, &out->directions));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n * samples * bands, &out->incident));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n, &j.known));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, tasks, &j.rays));
    find_known(fewer, out, j.known);
    IGI_TRY_GOTO(igi_parallel_for(ctx, tasks, light_pixels, &j));
    for (size_t t = 0; t < tasks; t++) out->rays += j.rays[t];
cleanup:
    igi_free(j.known);
    igi_free(j.rays);
    return status;
}
