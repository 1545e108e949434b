/* SPDX-License-Identifier: Apache-2.0
 *
 * A pixel's directions: to surfaces by lobes, to lamps by their points and by narrow lobes, and to what
 * is around the scene by both. Each has a place of its own within the pixel.
 */
#include "specular/highlights_private.h"

#include "brdf/brdf.h"
#include "scene/camera.h"

#define MAX_LAMP_SAMPLES 256

/* A pixel on the surface: rays through it are corner + u across + w down. */
typedef struct footprint {
    igi_vec corner, across, down, centre;
    igi_vec tangent, bitangent; /* of the pixel's normal */
    float offset;               /* of the tangent plane from the camera, along the normal */
} footprint;

typedef struct pixel_sets {
    const igi_highlight_task *j;
    igi_pixel_view v;
    footprint print;
    float start[4];
    igi_direction_sample *directions;
    float *incident;
    uint64_t rays;
} pixel_sets;

static footprint footprint_of(const igi_pixel_view *v)
{
    uint32_t width = (uint32_t)v->camera->width;
    double x = v->pixel % width, y = v->pixel / width;
    footprint f = {.centre = igi_camera_centre(v->camera)};
    igi_vec corners[3], middle = igi_camera_direction(v->camera, x + 0.5, y + 0.5);
    for (int k = 0; k < 3; k++) { /* up to one plane: a pinhole's picture is even there */
        corners[k] = igi_camera_direction(v->camera, x + (k == 1), y + (k == 2));
        corners[k] = igi_scale(corners[k], 1 / igi_dot(corners[k], middle));
    }
    f.corner = corners[0];
    f.across = igi_sub(corners[1], corners[0]);
    f.down = igi_sub(corners[2], corners[0]);
    f.offset = igi_dot(igi_sub(v->point, f.centre), v->normal);
    igi_frame_of(v->normal, &f.tangent, &f.bitangent);
    return f;
}

typedef struct place {
    igi_vec point, normal, tangent, bitangent;
    igi_vec out; /* toward the camera, in this frame */
} place;

static igi_vec to_place(const place *at, igi_vec d)
{
    return igi_v(igi_dot(d, at->tangent), igi_dot(d, at->bitangent), igi_dot(d, at->normal));
}

static igi_vec from_place(const place *at, igi_vec d)
{
    return igi_madd(igi_madd(igi_scale(at->normal, d.z), at->tangent, d.x), at->bitangent, d.y);
}

/* A place within the pixel: on the tangent plane, or on a curved region on the facet that is there,
 * since a highlight's width is as much the facets' as the lobe's. */
static place footprint_place(const pixel_sets *s, float u, float w)
{
    const footprint *f = &s->print;
    const igi_problem *p = s->j->problem;
    place at = {.point = s->v.point,
                .normal = s->v.normal,
                .tangent = f->tangent,
                .bitangent = f->bitangent};
    igi_vec d = igi_normalize(igi_madd(igi_madd(f->corner, f->across, u), f->down, w));
    float slope = igi_dot(d, at.normal);
    bool met = slope < -1e-3f;
    if (met) at.point = igi_madd(f->centre, d, f->offset / slope);
    if (s->j->source->candidates->curved[s->j->region]) {
        igi_hit hit = igi_trace(p->tracer, f->centre, d);
        if (hit.triangle != IGI_NO_HIT && p->scene->mesh.regions[hit.triangle] == s->j->region) {
            at.point = igi_madd(f->centre, d, hit.distance);
            at.normal = igi_tracer_normal(p->tracer, hit.triangle);
            if (hit.back) at.normal = igi_scale(at.normal, -1);
            igi_frame_of(at.normal, &at.tangent, &at.bitangent);
            met = true;
        }
    }
    at.out = to_place(&at, met ? igi_scale(d, -1) : s->v.out);
    return at;
}

/* Density of all lobes together at direction `in`. */
static float lobes_density(const igi_highlight_task *j, igi_vec in, igi_vec out)
{
    return (float)j->options->lobe_samples / 4 * igi_ward_pdf_sum(j->options->alphas, 4, in, out);
}

/* Of all samples of environments. */
static float around_density(const igi_highlight_task *j, igi_vec direction)
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

static void sample_lobes(pixel_sets *s, igi_rng *rng)
{
    const igi_highlight_task *j = s->j;
    const igi_problem *p = j->problem;
    int half = j->options->lobe_samples / 2;
    float start[2][4]; /* each half has a pattern of its own: their difference tells the noise */
    for (int k = 0; k < 8; k++) start[k / 4][k % 4] = igi_rng_float(rng);
    for (int m = 0; m < j->options->lobe_samples; m++) {
        igi_direction_sample *d = &s->directions[m];
        float x[4];
        pattern_at(start[m / half], m % half, x);
        place at = footprint_place(s, x[2], x[3]);
        d->out = at.out;
        if (d->out.z <= 0) continue;
        d->in = igi_lobe_sample(IGI_WARD, j->options->alphas[m % 4], d->out, x[0], x[1]);
        if (d->in.z <= 0) continue;
        igi_vec direction = from_place(&at, d->in);
        igi_hit hit = igi_trace(p->tracer, at.point, direction);
        float density = lobes_density(j, d->in, d->out), *light = s->incident + m * p->bands;
        d->weight = d->in.z / density;
        s->rays++;
        if (hit.triangle == IGI_NO_HIT) {
            d->around = 1 + m / half;
            igi_lighting_add_emitted(p->lighting, direction, &hit, light);
            d->weight = d->in.z / (density + around_density(j, direction));
        } else {
            d->patches = hit.distance / p->patches->size_m;
            s->rays += (uint64_t)igi_radiance_toward(j->source->field, at.point, direction, &hit,
                                                     rng, light);
        }
    }
}

/* Density of all narrow lobes together. */
static float sharp_density(const igi_highlight_task *j, igi_vec in, igi_vec out)
{
    float each = (float)(j->options->sharp_samples / 2);
    return each > 0 ? each * igi_ward_pdf_sum(j->options->sharp, 2, in, out) : 0;
}

/* The directions from narrow lobes that meet lamps, into directions[first...]. */
static void sample_sharp(pixel_sets *s, int first)
{
    const igi_highlight_task *j = s->j;
    const igi_problem *p = j->problem;
    for (int m = 0; m < j->options->sharp_samples; m++) {
        igi_direction_sample *d = &s->directions[first + m];
        float x[4];
        pattern_at(s->start, m, x);
        place at = footprint_place(s, x[2], x[3]);
        d->out = at.out;
        if (d->out.z <= 0) continue;
        d->in = igi_lobe_sample(IGI_WARD, j->options->sharp[m % 2], d->out, x[0], x[1]);
        if (d->in.z <= 0) continue;
        igi_vec direction = from_place(&at, d->in);
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
        igi_lighting_add_emitted(p->lighting, direction, &hit,
                                 s->incident + (first + m) * p->bands);
    }
}

/* The directions of one environment: each carries all that is around the scene. */
static void sample_around(pixel_sets *s, size_t light, int first, igi_rng *rng)
{
    static const igi_hit nothing = {.triangle = IGI_NO_HIT};
    const igi_highlight_task *j = s->j;
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
        place at = footprint_place(s, x[2], x[3]);
        d->out = at.out;
        d->in = to_place(&at, samples[m].direction);
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
        place at = footprint_place(s, x[2], x[3]);
        d->out = at.out;
        /* toward the same point of the lamp from this place of the pixel */
        igi_vec direction = samples[m].direction;
        if (!isinf(samples[m].distance))
            direction = igi_normalize(
                igi_sub(igi_madd(s->v.point, direction, samples[m].distance), at.point));
        d->in = to_place(&at, direction);
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

uint64_t igi_highlight_directions(const igi_highlight_task *task, const igi_pixel_view *view,
                                  igi_rng *rng, igi_direction_sample *directions, float *incident)
{
    const igi_highlight_options *o = task->options;
    size_t lights = task->source->rows->lights;
    pixel_sets s = {.j = task,
                    .v = *view,
                    .print = footprint_of(view),
                    .directions = directions,
                    .incident = incident};
    for (int k = 0; k < 4; k++) s.start[k] = igi_rng_float(rng);
    sample_lobes(&s, rng);
    for (size_t l = 0; l < lights; l++) {
        int first = o->lobe_samples + (int)l * o->lamp_samples;
        if (task->problem->lights[l].type == IGI_LIGHT_ENV) sample_around(&s, l, first, rng);
        else sample_lamp(&s, l, first);
    }
    sample_sharp(&s, o->lobe_samples + (int)lights * o->lamp_samples);
    return s.rays;
}
