/* SPDX-License-Identifier: Apache-2.0
 *
 * One path (Kajiya 1986): at every vertex a point of each light is weighed, one shadow ray goes to
 * the one chosen in proportion to what it would bring, and one ray goes on where the BRDF sends it.
 * What both ways can find is shared by the balance heuristic (Veach 1997). From the fifth edge on,
 * Russian roulette ends a path with the probability 1 - throughput.
 */
#include "render/path.h"

#include "render/cache.h"

#define FIRST_ROULETTE 5

typedef struct candidate {
    igi_light_sample sample;
    float value[IGI_MAX_BANDS]; /* BRDF cosine times the light's, unoccluded, shared */
    float mean;
} candidate;

/* False when nothing comes from the light that way. */
static bool weigh(const igi_renderer *r, size_t light, const surface *s, float u, float v,
                  candidate *c)
{
    float pdf;
    if (!igi_light_sample_toward(r->lighting, light, s->point, u, v, &c->sample)) return false;
    if (!surface_value(s, r->bands, c->sample.direction, c->value, &pdf)) return false;
    /* A light of no extent (pdf 0) is never met by a ray of the BRDF. */
    float share = c->sample.pdf > 0 && !r->mirrors ? c->sample.pdf / (c->sample.pdf + pdf) : 1;
    c->mean = 0;
    for (int b = 0; b < r->bands; b++) {
        c->value[b] *= c->sample.weight * share * (float)r->lights[light].value[b];
        if (c->sample.tint) c->value[b] *= c->sample.tint[b];
        c->mean += c->value[b];
    }
    return c->mean > 0;
}

/* Adds what the lights send directly, times `throughput`. Every light is weighed, one is asked. */
static uint64_t add_direct(const igi_renderer *r, const surface *s, sampler *points,
                           const float *throughput, float *radiance)
{
    candidate chosen = {.mean = 0}, next;
    float sum = 0, choice, unused;
    sampler_next(points, &choice, &unused);
    for (size_t i = 0; i < igi_lighting_count(r->lighting); i++) {
        float u, v;
        sampler_next(points, &u, &v);
        if (!weigh(r, i, s, u, v, &next)) continue;
        sum += next.mean;
        /* Weighted reservoir of one; the number is used again, rescaled. */
        float keep = next.mean / sum;
        if (choice < keep) {
            chosen = next;
            choice /= keep;
        } else {
            choice = (choice - keep) / (1 - keep);
        }
    }
    if (!(chosen.mean > 0)) return 0;
    if (!igi_light_hidden(r->tracer, s->point, &chosen.sample))
        for (int b = 0; b < r->bands; b++)
            radiance[b] += throughput[b] * chosen.value[b] * (sum / chosen.mean);
    return 1;
}

static void add_sky(const igi_renderer *r, igi_vec origin, igi_vec direction, const igi_hit *hit,
                    float pdf, const float *throughput, float *radiance)
{
    for (size_t i = 0; i < igi_lighting_count(r->lighting); i++) {
        float sky[IGI_MAX_BANDS] = {0}, share = 1;
        igi_light_add_sky(r->lighting, i, direction, sky);
        if (pdf >= 0) share = pdf / (pdf + igi_light_pdf(r->lighting, i, origin, direction, hit));
        for (int b = 0; b < r->bands; b++) radiance[b] += throughput[b] * sky[b] * share;
    }
}

/* Emission at the end of an edge; `pdf` is that of the BRDF at its start, negative: the camera. */
static void add_emission(const igi_renderer *r, igi_vec origin, igi_vec direction,
                         const igi_hit *hit, float pdf, const float *throughput, float *radiance)
{
    float emitted[IGI_MAX_BANDS] = {0}, share = 1;
    if (hit->triangle == IGI_NO_HIT) {
        add_sky(r, origin, direction, hit, pdf, throughput, radiance);
        return;
    }
    int light = igi_lighting_of_triangle(r->lighting, hit->triangle);
    if (light < 0) return;
    igi_lighting_add_emitted(r->lighting, direction, hit, emitted);
    if (pdf >= 0)
        share = pdf / (pdf + igi_light_pdf(r->lighting, (size_t)light, origin, direction, hit));
    for (int b = 0; b < r->bands; b++) radiance[b] += throughput[b] * emitted[b] * share;
}

/* False: the path ends here. */
static bool survive(int bands, sampler *points, float *throughput)
{
    float chance = 0, u, unused;
    for (int b = 0; b < bands; b++) chance = fmaxf(chance, throughput[b]);
    sampler_next(points, &u, &unused);
    if (chance >= 1) return true;
    if (!(u < chance)) return false;
    for (int b = 0; b < bands; b++) throughput[b] /= chance;
    return true;
}

/* Turns the ray where the BRDF sends it; false when that is nowhere. */
static bool go_on(const igi_renderer *r, const surface *s, sampler *points, igi_vec *direction,
                  float *throughput, float *pdf)
{
    float choice, unused, u, v, value[IGI_MAX_BANDS];
    sampler_next(points, &choice, &unused);
    sampler_next(points, &u, &v);
    *direction = surface_sample(s, choice, u, v);
    if (!surface_value(s, r->bands, *direction, value, pdf) || !(*pdf > 0)) return false;
    for (int b = 0; b < r->bands; b++) throughput[b] *= value[b] / *pdf;
    return true;
}

uint64_t trace_path(const igi_renderer *r, igi_vec origin, igi_vec direction, int max_depth,
                    sampler *points, float *radiance, path_parts *parts)
{
    float throughput[IGI_MAX_BANDS], pdf = -1, *first = parts ? parts->direct : radiance;
    igi_vec normal = {0, 0, 0};
    uint64_t rays = 0;
    for (int b = 0; b < r->bands; b++) throughput[b] = 1;
    for (int edge = 1;; edge++) {
        surface s;
        igi_hit hit = edge == 1 ? igi_trace(r->tracer, origin, direction)
                                : igi_trace_off(r->tracer, origin, normal, direction);
        rays++;
        if (edge == 1 || !r->mirrors)
            add_emission(r, origin, direction, &hit, pdf, throughput, edge <= 2 ? first : radiance);
        if (hit.triangle == IGI_NO_HIT || edge >= max_depth) break;
        surface_at(r, &hit, direction, &s);
        if (s.finish->absorbs) break;
        for (int b = 0; b < r->bands && parts && edge == 1; b++) parts->albedo[b] += s.albedo[b];
        if (edge == r->cache_edge) {
            igi_cache_add(r->cache, &s, &hit, throughput, radiance);
            break;
        }
        rays += add_direct(r, &s, points, throughput, edge == 1 ? first : radiance);
        if (r->mirrors ? !surface_mirror(&s, r->bands, &direction, throughput)
                       : !go_on(r, &s, points, &direction, throughput, &pdf))
            break;
        origin = s.point;
        normal = s.normal;
        if (edge >= FIRST_ROULETTE && !survive(r->bands, points, throughput)) break;
    }
    return rays;
}
