/* SPDX-License-Identifier: Apache-2.0 */
#include "specular/incident.h"

#include "brdf/brdf.h"

#define NOTHING 1e-5f /* sr^-1: what reflects so little of a lamp needs no shadow */

/* f_s of the lobe for each band; returns the largest. */
static float lobe_values(const igi_lobe *lobe, int bands, igi_vec in, igi_vec out, float *values)
{
    float scale, base, largest = 0;
    igi_lobe_terms(lobe->model, lobe->alpha, in, out, &scale, &base);
    for (int b = 0; b < bands; b++) {
        values[b] = lobe->specular[b] * scale + base;
        largest = fmaxf(largest, values[b]);
    }
    return largest;
}

static const float *side_radiance(const igi_problem *p, const float *radiance, const igi_hit *hit)
{
    uint32_t side = igi_side_at(p->patches, hit->triangle, hit->u, hit->v, hit->back);
    return radiance + (size_t)side * (size_t)p->bands;
}

static bool is_lamp(const igi_problem *p, uint32_t triangle)
{
    return p->scene->regions[p->scene->mesh.regions[triangle]].emitter;
}

/* One lamp by one sample, weighted against the lobe's own chance to find it (balance heuristic).
 * Returns the rays it cost. */
static int add_lamp(const igi_problem *p, const igi_lobe *lobe, size_t light, igi_vec point,
                    igi_vec normal, igi_vec out, igi_rng *rng, float *radiance)
{
    igi_light_sample s;
    float u = igi_rng_float(rng), v = igi_rng_float(rng);
    if (!igi_light_sample_toward(p->lighting, light, point, u, v, &s)) return 0;
    igi_vec in = igi_to_local(s.direction, normal);
    float values[IGI_MAX_BANDS], share = 1;
    if (in.z <= 0) return 0;
    if (lobe_values(lobe, p->bands, in, out, values) < NOTHING) return 0;
    if (igi_light_hidden(p->tracer, point, &s)) return 1;
    if (s.pdf > 0) share = s.pdf / (s.pdf + igi_lobe_pdf(lobe->model, lobe->alpha, in, out));
    for (int b = 0; b < p->bands; b++)
        radiance[b] += values[b] * in.z * s.weight * share *
                       igi_light_sample_value(&p->lights[light], &s, b);
    return 1;
}

/* A place and a direction in which light leaves it. */
typedef struct exit_ray {
    igi_vec point, normal, out; /* out in the frame of the normal */
} exit_ray;

static int lobe_radiance(const igi_radiance_field *f, const igi_lobe *lobe, const exit_ray *e,
                         bool deep, igi_rng *rng, float *lamps, float *surfaces);

/* What leaves `hit` back along `direction`: diffuse part and lobe, else as cameras saw it. */
static int add_met(const igi_radiance_field *f, igi_vec origin, igi_vec direction,
                   const igi_hit *hit, bool by_lobe, igi_rng *rng, float *radiance)
{
    const igi_problem *p = f->problem;
    const float *base = side_radiance(p, by_lobe && f->lobes ? f->diffuse : f->total, hit);
    for (int b = 0; b < p->bands; b++) radiance[b] += base[b];
    if (!by_lobe || !f->lobes) return 0;
    const igi_lobe *lobe = &f->lobes[p->scene->mesh.regions[hit->triangle]];
    if (lobe->model == IGI_LAMBERT) return 0;
    igi_vec normal = igi_tracer_normal(p->tracer, hit->triangle);
    if (hit->back) normal = igi_scale(normal, -1);
    exit_ray e = {igi_madd(origin, direction, hit->distance), normal,
                  igi_to_local(igi_scale(direction, -1), normal)};
    return lobe_radiance(f, lobe, &e, false, rng, radiance, radiance);
}

/* What the lobe's own sample meets: a lamp, or a surface. */
static int add_lobe_ray(const igi_radiance_field *f, const igi_lobe *lobe, const exit_ray *e,
                        bool deep, igi_rng *rng, float *lamps, float *surfaces)
{
    const igi_problem *p = f->problem;
    float u = igi_rng_float(rng), v = igi_rng_float(rng);
    igi_vec in = igi_lobe_sample(lobe->model, lobe->alpha, e->out, u, v);
    float met[IGI_MAX_BANDS] = {0}, scale, base, *sum = surfaces;
    if (in.z <= 0) return 0;
    igi_lobe_ratios(lobe->model, lobe->alpha, in, e->out, &scale, &base);
    igi_vec direction = igi_to_world(in, e->normal);
    igi_hit hit = igi_trace(p->tracer, e->point, direction);
    int rays = 1;
    if (hit.triangle == IGI_NO_HIT || is_lamp(p, hit.triangle)) {
        float pdf = igi_lobe_pdf(lobe->model, lobe->alpha, in, e->out);
        if (lamps) sum = lamps;
        igi_lighting_add_met(p->lighting, e->point, direction, &hit, pdf, lamps ? 1 : INFINITY,
                             met);
    } else {
        rays += add_met(f, e->point, direction, &hit, deep, rng, met);
    }
    for (int b = 0; b < p->bands; b++) sum[b] += (lobe->specular[b] * scale + base) * in.z * met[b];
    return rays;
}

/* deep: what the lobe mirrors has its own lobe toward it, not toward the cameras. */
static int lobe_radiance(const igi_radiance_field *f, const igi_lobe *lobe, const exit_ray *e,
                         bool deep, igi_rng *rng, float *lamps, float *surfaces)
{
    if (e->out.z <= 0) return 0;
    size_t lights = lamps ? igi_lighting_count(f->problem->lighting) : 0;
    int rays = 0;
    for (size_t l = 0; l < lights; l++)
        rays += add_lamp(f->problem, lobe, l, e->point, e->normal, e->out, rng, lamps);
    return rays + add_lobe_ray(f, lobe, e, deep, rng, lamps, surfaces);
}

int igi_lobe_radiance(const igi_radiance_field *field, const igi_lobe *lobe, igi_vec point,
                      igi_vec normal, igi_vec out, igi_rng *rng, float *lamps, float *surfaces)
{
    exit_ray e = {point, normal, igi_to_local(out, normal)};
    return lobe_radiance(field, lobe, &e, lamps != NULL, rng, lamps, surfaces);
}

int igi_radiance_toward(const igi_radiance_field *field, igi_vec origin, igi_vec direction,
                        const igi_hit *hit, igi_rng *rng, float *radiance)
{
    if (hit->triangle == IGI_NO_HIT || is_lamp(field->problem, hit->triangle)) return 0;
    return add_met(field, origin, direction, hit, true, rng, radiance);
}
