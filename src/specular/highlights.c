/* SPDX-License-Identifier: Apache-2.0
 *
 * Choice: a pixel's score for a roughness is the predicted lobe of the lamps over the diffuse
 * radiance. Pixels are kept at random with a probability that rises with their scores for each of
 * four roughnesses, and a third of them evenly, to pin the diffuse part. Where the region is
 * textured, the chosen pixels are points, and every photograph that shows such a point joins in.
 */
#include "specular/highlights.h"

#include "base/parallel.h"
#include "brdf/brdf.h"
#include "scene/camera.h"

#include <string.h>

#define CANDIDATES 40000 /* pixels of a region to choose from, at most */
#define MAX_LAMP_SAMPLES 256
#define FLAT_SIDES 16     /* a region of more directions is curved */
#define LAMP_POINTS 4     /* places on each lamp that the score looks at */
#define PIECE_PATCHES 6   /* side of a piece of the surface, in patches */
#define SCORE_ALPHA 0.03f /* lobes are scored as broad at least: the lamp's points lie apart */

typedef struct job {
    const igi_radiance_field *field;
    const igi_rows *rows;
    size_t region;
    igi_highlight_options options;
    igi_irradiance_fn irradiance;
    const void *user;
    igi_highlights *out;
    uint32_t *candidates; /* observations */
    size_t candidate_count;
    float (*scores)[4];
    uint64_t *rays;  /* of each task */
    size_t capacity; /* of the arrays of `out` that grow while choosing */
} job;

typedef struct view {
    igi_vec point, normal, out; /* world; out: unit, toward the camera */
    const igi_camera *camera;
    uint32_t pixel;
} view;

static view view_of(const igi_problem *p, size_t observation)
{
    const igi_observations *o = p->observations;
    uint32_t surface = o->surface[observation], triangle = igi_surface_triangle(surface);
    view v;
    v.camera = &p->scene->frames[igi_observation_frame(o, observation)].camera;
    v.pixel = o->pixel[observation];
    v.point = igi_triangle_point(&p->scene->mesh, triangle, o->uv[2 * observation],
                                 o->uv[2 * observation + 1]);
    v.normal = igi_tracer_normal(p->tracer, triangle);
    if (igi_surface_is_back(surface)) v.normal = igi_scale(v.normal, -1);
    v.out = igi_normalize(igi_sub(igi_camera_centre(v.camera), v.point));
    return v;
}

static uint32_t region_of(const igi_problem *p, size_t observation)
{
    return p->scene->mesh.regions[igi_surface_triangle(p->observations->surface[observation])];
}

/* Does the region turn through more directions than a thing of flat sides would? */
static void find_curved(const igi_problem *p, bool *curved)
{
    igi_vec known[FLAT_SIDES];
    for (uint32_t r = 0; r < p->scene->region_count; r++) {
        size_t count = 0;
        for (uint32_t t = 0; t < p->scene->mesh.triangle_count && !curved[r]; t++) {
            if (p->scene->mesh.regions[t] != r) continue;
            igi_vec n = igi_tracer_normal(p->tracer, t);
            size_t k = 0;
            while (k < count && igi_dot(known[k], n) < 0.9999f) k++;
            if (k < count) continue;
            if (count == FLAT_SIDES) curved[r] = true;
            else known[count++] = n;
        }
    }
}

igi_status igi_candidates_create(igi_context *ctx, const igi_problem *problem,
                                 igi_candidates *candidates)
{
    const igi_observations *o = problem->observations;
    size_t regions = problem->scene->region_count, *total = NULL;
    igi_status status = IGI_OK;
    *candidates = (igi_candidates){NULL, NULL, NULL};
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 3 * regions, &total));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions, &candidates->curved));
    find_curved(problem, candidates->curved);
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions + 1, &candidates->begin));
    size_t *stride = total + regions, *seen = stride + regions;
    for (size_t i = 0; i < o->count; i++) total[region_of(problem, i)]++;
    for (size_t r = 0; r < regions; r++) {
        stride[r] = total[r] / CANDIDATES + 1;
        candidates->begin[r + 1] = candidates->begin[r] + (total[r] + stride[r] - 1) / stride[r];
    }
    IGI_TRY_GOTO(IGI_ALLOC(ctx, candidates->begin[regions], &candidates->observation));
    for (size_t i = 0; i < o->count; i++) {
        size_t r = region_of(problem, i), k = seen[r]++;
        if (k % stride[r] == 0)
            candidates->observation[candidates->begin[r] + k / stride[r]] = (uint32_t)i;
    }
cleanup:
    igi_free(total);
    if (status != IGI_OK) igi_candidates_clear(candidates);
    return status;
}

void igi_candidates_clear(igi_candidates *candidates)
{
    igi_free(candidates->begin);
    igi_free(candidates->observation);
    igi_free(candidates->curved);
    *candidates = (igi_candidates){NULL, NULL, NULL};
}

/* The region's candidates, thinned to what is to be scored. */
static igi_status take_candidates(igi_context *ctx, job *j)
{
    const igi_candidates *c = j->options.candidates;
    size_t first = c->begin[j->region], total = c->begin[j->region + 1] - first;
    size_t stride = total / j->options.scored + 1;
    IGI_TRY(IGI_ALLOC(ctx, total / stride + 1, &j->candidates));
    for (size_t i = 0; i < total; i += stride)
        j->candidates[j->candidate_count++] = c->observation[first + i];
    return IGI_ALLOC(ctx, j->candidate_count + 1, &j->scores);
}

static float brightness(const double *value, int bands)
{
    double sum = 0;
    for (int b = 0; b < bands; b++) sum += value[b];
    return (float)(sum / bands);
}

static igi_status score_candidates(igi_context *ctx, void *user, size_t task, int worker)
{
    (void)ctx;
    (void)worker;
    job *j = user;
    const igi_problem *p = j->field->problem;
    size_t end = (task + 1) * 1024 < j->candidate_count ? (task + 1) * 1024 : j->candidate_count;
    float alphas[4];
    for (int a = 0; a < 4; a++) alphas[a] = fmaxf(SCORE_ALPHA, j->options.alphas[a]);
    for (size_t i = task * 1024; i < end; i++) {
        uint32_t side = igi_problem_side_of(p, j->candidates[i]), row = j->rows->row_of[side];
        if (row == IGI_NO_ROW) continue;
        view v = view_of(p, j->candidates[i]);
        igi_vec out = igi_to_local(v.out, v.normal);
        if (out.z <= 0.05f) continue;
        float diffuse = 1e-6f;
        for (int b = 0; b < p->bands; b++)
            diffuse += j->field->total[(size_t)side * (size_t)p->bands + (size_t)b] /
                       (float)p->bands;
        for (size_t l = 0; l < j->rows->lights; l++) {
            float received = j->rows->direct[row * j->rows->lights + l] *
                             brightness(p->lights[l].value, p->bands);
            if (received <= 0) continue;
            igi_light_sample samples[LAMP_POINTS];
            const float start[2] = {0.5f, 0.5f};
            size_t n = igi_light_sample_set(p->lighting, l, v.point, LAMP_POINTS, start, samples);
            for (size_t k = 0; k < n; k++) {
                igi_vec in = igi_to_local(samples[k].direction, v.normal);
                float scale[4], base[4];
                if (in.z <= 0) continue;
                igi_lobe_terms_over(IGI_WARD, alphas, 4, in, out, scale, base);
                for (int a = 0; a < 4; a++)
                    j->scores[i][a] += scale[a] * received / diffuse / (float)n;
            }
        }
    }
    return IGI_OK;
}

static igi_status add_pixel(igi_context *ctx, job *j, size_t group, size_t observation)
{
    igi_highlights *h = j->out;
    size_t capacity = j->capacity;
    uint32_t *grown = igi_grow(ctx, h->group, &capacity, h->count + 1, sizeof *grown);
    if (!grown) return IGI_E_SYSTEM;
    h->group = grown;
    capacity = j->capacity;
    grown = igi_grow(ctx, h->observation, &capacity, h->count + 1, sizeof *grown);
    if (!grown) return IGI_E_SYSTEM;
    h->observation = grown;
    j->capacity = capacity;
    h->group[h->count] = (uint32_t)group;
    h->observation[h->count++] = (uint32_t)observation;
    return IGI_OK;
}

/* Every photograph's pixel at the point that an observation shows. */
static igi_status add_point(igi_context *ctx, job *j, size_t observation)
{
    const igi_problem *p = j->field->problem;
    const igi_observations *o = p->observations;
    view seed = view_of(p, observation);
    size_t group = j->out->groups, before = j->out->count;
    for (size_t f = 0; f < o->frame_count; f++) {
        const igi_camera *camera = &p->scene->frames[f].camera;
        double x, y;
        if (!igi_camera_project(camera, seed.point, &x, &y)) continue;
        if (x < 0 || y < 0 || x >= camera->width || y >= camera->height) continue;
        uint32_t pixel = (uint32_t)y * (uint32_t)camera->width + (uint32_t)x;
        size_t at = igi_observation_at(o, f, pixel);
        if (at == SIZE_MAX) continue;
        view v = view_of(p, at);
        if (region_of(p, at) != j->region) continue;
        float distance = igi_length(igi_sub(v.point, igi_camera_centre(camera)));
        float pixel_m = distance / (float)camera->fl_x / fmaxf(0.1f, igi_dot(v.out, v.normal));
        if (igi_length(igi_sub(v.point, seed.point)) > 1.5f * pixel_m) continue;
        if (igi_dot(v.normal, seed.normal) < 0.99f) continue;
        IGI_TRY(add_pixel(ctx, j, group, at));
    }
    if (j->out->count < before + 2) j->out->count = before; /* one cannot part albedo from lobe */
    else j->out->groups++;
    return IGI_OK;
}

static igi_status choose(igi_context *ctx, job *j)
{
    double sums[4] = {0}, wanted = (double)j->options.pixels;
    size_t frames = j->field->problem->observations->frame_count;
    if (j->options.per_point) /* a third of the photographs show a point, about */
        wanted /= fmin(8, fmax(1, (double)frames / 3));
    for (size_t i = 0; i < j->candidate_count; i++)
        for (int a = 0; a < 4; a++) sums[a] += (double)j->scores[i][a];
    for (size_t i = 0; i < j->candidate_count; i++) {
        double keep = wanted / 3 / (double)j->candidate_count;
        for (int a = 0; a < 4; a++)
            if (sums[a] > 0) keep += wanted / 6 * (double)j->scores[i][a] / sums[a];
        igi_rng rng = igi_rng_make(igi_seed(ctx) + j->region, j->candidates[i]);
        if ((double)igi_rng_float(&rng) >= keep) continue;
        if (j->options.per_point) IGI_TRY(add_point(ctx, j, j->candidates[i]));
        else IGI_TRY(add_pixel(ctx, j, 0, j->candidates[i]));
    }
    if (!j->options.per_point) j->out->groups = 1;
    return IGI_OK;
}

typedef struct place {
    igi_vec point, normal, out;
} place;

/* A place within the pixel: on the tangent plane, or on a curved region on the facet that is there,
 * since a highlight's width is as much the facets' as the lobe's. */
static place footprint_place(const job *j, const view *v, float u, float w)
{
    uint32_t width = (uint32_t)v->camera->width;
    const igi_problem *p = j->field->problem;
    igi_vec centre = igi_camera_centre(v->camera);
    igi_vec d = igi_camera_direction(v->camera, (double)(v->pixel % width) + (double)u,
                                     (double)(v->pixel / width) + (double)w);
    place at = {v->point, v->normal, v->out};
    float slope = igi_dot(d, v->normal);
    if (slope < -1e-3f)
        at.point = igi_madd(centre, d, igi_dot(igi_sub(v->point, centre), v->normal) / slope);
    if (j->options.candidates->curved[j->region]) {
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
    float density = 0;
    for (int a = 0; a < 4; a++)
        density += (float)j->options.lobe_samples / 4 *
                   igi_lobe_pdf(IGI_WARD, j->options.alphas[a], in, out);
    return density;
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
    view v;
    float start[4];
    igi_direction_sample *directions;
    float *incident;
    uint64_t rays;
} pixel_sets;

static void sample_lobes(pixel_sets *s, igi_rng *rng)
{
    const job *j = s->j;
    const igi_problem *p = j->field->problem;
    int half = j->options.lobe_samples / 2;
    float start[2][4]; /* each half has a pattern of its own: their difference tells the noise */
    for (int k = 0; k < 8; k++) start[k / 4][k % 4] = igi_rng_float(rng);
    for (int m = 0; m < j->options.lobe_samples; m++) {
        igi_direction_sample *d = &s->directions[m];
        float x[4];
        pattern_at(start[m / half], m % half, x);
        place at = footprint_place(j, &s->v, x[2], x[3]);
        d->out = at.out;
        if (d->out.z <= 0) continue;
        d->in = igi_lobe_sample(IGI_WARD, j->options.alphas[m % 4], d->out, x[0], x[1]);
        if (d->in.z <= 0) continue;
        igi_vec direction = igi_to_world(d->in, at.normal);
        igi_hit hit = igi_trace(p->tracer, at.point, direction);
        d->weight = d->in.z / lobes_density(j, d->in, d->out);
        s->rays += 1 + (uint64_t)igi_radiance_toward(j->field, at.point, direction, &hit, rng,
                                                     s->incident + m * p->bands);
    }
}

/* Density of all narrow lobes together. */
static float sharp_density(const job *j, igi_vec in, igi_vec out)
{
    float density = 0, each = (float)(j->options.sharp_samples / 2);
    for (int a = 0; a < 2 && each > 0; a++)
        density += each * igi_lobe_pdf(IGI_WARD, j->options.sharp[a], in, out);
    return density;
}

/* The directions from narrow lobes that meet lamps, into directions[first...]. */
static void sample_sharp(pixel_sets *s, int first)
{
    const job *j = s->j;
    const igi_problem *p = j->field->problem;
    for (int m = 0; m < j->options.sharp_samples; m++) {
        igi_direction_sample *d = &s->directions[first + m];
        float x[4];
        pattern_at(s->start, m, x);
        place at = footprint_place(j, &s->v, x[2], x[3]);
        d->out = at.out;
        if (d->out.z <= 0) continue;
        d->in = igi_lobe_sample(IGI_WARD, j->options.sharp[m % 2], d->out, x[0], x[1]);
        if (d->in.z <= 0) continue;
        igi_vec direction = igi_to_world(d->in, at.normal);
        igi_hit hit = igi_trace(p->tracer, at.point, direction);
        s->rays++;
        if (hit.triangle == IGI_NO_HIT || hit.back) continue;
        int light = igi_lighting_of_triangle(p->lighting, hit.triangle);
        if (light < 0) continue;
        /* the density of sample_lamp's: of one of the lamp's triangles */
        float cosine = fabsf(igi_dot(direction, igi_tracer_normal(p->tracer, hit.triangle)));
        float lamp = (float)j->options.lamp_samples * hit.distance * hit.distance /
                     fmaxf(cosine * igi_triangle_area(&p->scene->mesh, hit.triangle), 1e-30f);
        d->weight = d->in.z / (lamp + sharp_density(j, d->in, d->out));
        for (int b = 0; b < p->bands; b++)
            s->incident[(first + m) * p->bands + b] = (float)p->lights[light].value[b];
    }
}

/* The directions of one lamp, into directions[first...]. Some are tested for shadow; where they
 * disagree, an edge of shadow crosses the lamp, and every direction is tested. */
static void sample_lamp(pixel_sets *s, size_t light, int first)
{
    const igi_problem *p = s->j->field->problem;
    igi_light_sample samples[MAX_LAMP_SAMPLES];
    size_t count = igi_light_sample_set(p->lighting, light, s->v.point,
                                        (size_t)s->j->options.lamp_samples, s->start, samples);
    size_t step = count / (size_t)s->j->options.lamp_tests + 1, hidden = 0, tested = 0;
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
              lamp = samples[m].pdf * (float)s->j->options.lamp_samples;
        bool area = p->lights[light].type == IGI_LIGHT_AREA;
        d->weight = d->in.z * samples[m].weight * (area ? lamp / (lamp + narrow) : 1);
        for (int b = 0; b < p->bands; b++)
            s->incident[(first + (int)m) * p->bands + b] = (float)p->lights[light].value[b];
    }
}

/* The piece of the surface at a point: a cell of a coarse grid. */
static uint32_t piece_of(const job *j, igi_vec point)
{
    float side = PIECE_PATCHES * j->field->problem->patches->size_m;
    uint64_t h = (uint64_t)(int64_t)floorf(point.x / side);
    h = igi_hash64(h) ^ (uint64_t)(int64_t)floorf(point.y / side);
    h = igi_hash64(h) ^ (uint64_t)(int64_t)floorf(point.z / side);
    return (uint32_t)igi_hash64(h);
}

static void set_up_pixel(job *j, size_t i, uint64_t *rays)
{
    igi_highlights *h = j->out;
    size_t bands = (size_t)h->bands, observation = h->observation[i];
    const igi_observations *o = j->field->problem->observations;
    igi_rng rng = igi_rng_make(igi_hash64(j->region), observation);
    memcpy(h->radiance + i * bands, o->radiance + observation * bands, bands * sizeof(float));
    j->irradiance(j->user, observation, h->irradiance + i * bands);
    pixel_sets s = {.j = j,
                    .v = view_of(j->field->problem, observation),
                    .directions = h->directions + i * (size_t)h->samples,
                    .incident = h->incident + i * (size_t)h->samples * bands};
    h->piece[i] = piece_of(j, s.v.point);
    for (int k = 0; k < 4; k++) s.start[k] = igi_rng_float(&rng);
    sample_lobes(&s, &rng);
    for (size_t l = 0; l < j->rows->lights; l++)
        sample_lamp(&s, l, j->options.lobe_samples + (int)l * j->options.lamp_samples);
    sample_sharp(&s, h->samples - j->options.sharp_samples);
    *rays += s.rays;
}

static igi_status set_up_pixels(igi_context *ctx, void *user, size_t task, int worker)
{
    (void)worker;
    job *j = user;
    uint64_t rays = 0;
    size_t end = (task + 1) * 16 < j->out->count ? (task + 1) * 16 : j->out->count;
    for (size_t i = task * 16; i < end; i++) set_up_pixel(j, i, &rays);
    igi_count_rays(ctx, rays);
    j->rays[task] = rays;
    return IGI_OK;
}

static igi_status allocate_sets(igi_context *ctx, const job *j)
{
    igi_highlights *h = j->out;
    size_t n = h->count, bands = (size_t)h->bands, samples = (size_t)h->samples;
    IGI_TRY(IGI_ALLOC(ctx, n, &h->piece));
    IGI_TRY(IGI_ALLOC(ctx, n * bands, &h->radiance));
    IGI_TRY(IGI_ALLOC(ctx, n * bands, &h->irradiance));
    IGI_TRY(IGI_ALLOC(ctx, n * samples, &h->directions));
    return IGI_ALLOC(ctx, n * samples * bands, &h->incident);
}

static float pixel_angle(const igi_scene *scene)
{
    double sum = 0;
    for (size_t f = 0; f < scene->frame_count; f++) sum += 1 / scene->frames[f].camera.fl_x;
    return (float)(sum / (double)scene->frame_count);
}

igi_status igi_highlights_create(igi_context *ctx, const igi_radiance_field *field,
                                 const igi_rows *rows, size_t region,
                                 const igi_highlight_options *options, igi_irradiance_fn irradiance,
                                 const void *user, igi_highlights **highlights)
{
    igi_status status = IGI_OK;
    job j = {.field = field,
             .rows = rows,
             .region = region,
             .options = *options,
             .irradiance = irradiance,
             .user = user};
    *highlights = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &j.out));
    j.out->bands = field->problem->bands;
    j.out->lobe_samples = options->lobe_samples;
    j.out->samples = options->lobe_samples + (int)rows->lights * options->lamp_samples +
                     options->sharp_samples;
    j.out->pixel_angle = pixel_angle(field->problem->scene);
    IGI_TRY_GOTO(take_candidates(ctx, &j));
    IGI_TRY_GOTO(igi_parallel_for(ctx, (j.candidate_count + 1023) / 1024, score_candidates, &j));
    IGI_TRY_GOTO(choose(ctx, &j));
    IGI_TRY_GOTO(allocate_sets(ctx, &j));
    size_t tasks = (j.out->count + 15) / 16;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, tasks, &j.rays));
    IGI_TRY_GOTO(igi_parallel_for(ctx, tasks, set_up_pixels, &j));
    for (size_t t = 0; t < tasks; t++) j.out->rays += j.rays[t];
    *highlights = j.out;
    j.out = NULL;
cleanup:
    igi_free(j.candidates);
    igi_free(j.scores);
    igi_free(j.rays);
    igi_highlights_destroy(j.out);
    return status;
}

void igi_highlights_destroy(igi_highlights *highlights)
{
    if (!highlights) return;
    igi_free(highlights->group);
    igi_free(highlights->observation);
    igi_free(highlights->piece);
    igi_free(highlights->radiance);
    igi_free(highlights->irradiance);
    igi_free(highlights->directions);
    igi_free(highlights->incident);
    igi_free(highlights);
}
