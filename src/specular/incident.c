/* SPDX-License-Identifier: Apache-2.0 */
#include "specular/incident.h"

#include "brdf/brdf.h"

static float lobe_value(const igi_lobe *lobe, int band, igi_vec in, igi_vec out)
{
    float scale, base;
    igi_lobe_terms(lobe->model, lobe->alpha, in, out, &scale, &base);
    return lobe->specular[band] * scale + base;
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

/* One lamp by one sample, weighted against the lobe's own chance to find it (balance heuristic). */
static void add_lamp(const igi_problem *p, const igi_lobe *lobe, size_t light, igi_vec point,
                     igi_vec normal, igi_vec out, igi_rng *rng, float *radiance)
{
    igi_light_sample s;
    float u = igi_rng_float(rng), v = igi_rng_float(rng);
    if (!igi_light_sample_toward(p->lighting, light, point, u, v, &s)) return;
    igi_vec in = igi_to_local(s.direction, normal);
    if (in.z <= 0) return;
    if (igi_light_hidden(p->tracer, point, &s)) return;
    float share = 1;
    if (s.pdf > 0) share = s.pdf / (s.pdf + igi_lobe_pdf(lobe->model, lobe->alpha, in, out));
    for (int b = 0; b < p->bands; b++)
        radiance[b] += lobe_value(lobe, b, in, out) * in.z * s.weight * share *
                       (float)p->lights[light].value[b];
}

/* What the lobe's own sample meets: a lamp, or a surface as the cameras saw it. */
static void add_lobe_ray(const igi_radiance_field *f, const igi_lobe *lobe, igi_vec point,
                         igi_vec normal, igi_vec out, igi_rng *rng, float *lamps, float *surfaces)
{
    const igi_problem *p = f->problem;
    float u = igi_rng_float(rng), v = igi_rng_float(rng);
    igi_vec in = igi_lobe_sample(lobe->model, lobe->alpha, out, u, v);
    float pdf = igi_lobe_pdf(lobe->model, lobe->alpha, in, out);
    if (in.z <= 0 || !(pdf > 0)) return;
    igi_vec direction = igi_to_world(in, normal);
    igi_hit hit = igi_trace(p->tracer, point, direction);
    float met[IGI_MAX_BANDS] = {0}, weight = in.z / pdf, *sum = surfaces;
    if (hit.triangle == IGI_NO_HIT || is_lamp(p, hit.triangle)) {
        sum = lamps;
        igi_lighting_add_emitted(p->lighting, direction, &hit, met);
        int light = hit.triangle == IGI_NO_HIT
                        ? -1
                        : igi_lighting_of_triangle(p->lighting, hit.triangle);
        if (light >= 0)
            weight *= pdf /
                      (pdf + igi_light_pdf(p->lighting, (size_t)light, point, direction, &hit));
    } else {
        const float *total = side_radiance(p, f->total, &hit);
        for (int b = 0; b < p->bands; b++) met[b] = total[b];
    }
    for (int b = 0; b < p->bands; b++) sum[b] += lobe_value(lobe, b, in, out) * weight * met[b];
}

int igi_lobe_radiance(const igi_radiance_field *field, const igi_lobe *lobe, igi_vec point,
                      igi_vec normal, igi_vec out, igi_rng *rng, float *lamps, float *surfaces)
{
    igi_vec local_out = igi_to_local(out, normal);
    if (local_out.z <= 0) return 0;
    size_t lights = igi_lighting_count(field->problem->lighting);
    for (size_t l = 0; l < lights; l++)
        add_lamp(field->problem, lobe, l, point, normal, local_out, rng, lamps);
    add_lobe_ray(field, lobe, point, normal, local_out, rng, lamps, surfaces);
    return (int)lights + 1;
}

int igi_radiance_toward(const igi_radiance_field *field, igi_vec origin, igi_vec direction,
                        const igi_hit *hit, igi_rng *rng, float *radiance)
{
    const igi_problem *p = field->problem;
    if (hit->triangle == IGI_NO_HIT || is_lamp(p, hit->triangle)) return 0;
    const float *base = side_radiance(p, field->lobes ? field->diffuse : field->total, hit);
    for (int b = 0; b < p->bands; b++) radiance[b] += base[b];
    if (!field->lobes) return 0;
    const igi_lobe *lobe = &field->lobes[p->scene->mesh.regions[hit->triangle]];
    if (lobe->model == IGI_LAMBERT) return 0;
    igi_vec normal = igi_tracer_normal(p->tracer, hit->triangle);
    if (hit->back) normal = igi_scale(normal, -1);
    igi_vec point = igi_madd(origin, direction, hit->distance);
    return igi_lobe_radiance(field, lobe, point, normal, igi_scale(direction, -1), rng, radiance,
                             radiance);
}
