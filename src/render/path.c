/* SPDX-License-Identifier: Apache-2.0
 *
 * One path (Kajiya 1986): at every vertex a point of each light is weighed, one shadow ray goes to
 * the one chosen in proportion to what it would bring, and one ray goes on where the BRDF sends it.
 * What both ways can find is shared by the power heuristic (Veach 1997). From the fifth edge on,
 * Russian roulette ends a path with the probability 1 - throughput.
 *
 * Where a rough radiosity B tells what a vertex sends back, roulette begins at the second edge, in
 * proportion to what the path is expected to bring to the pixel (Vorba and Krivanek 2016), and what
 * it ends is not lost: with the chance q of going on to an estimate X, the path brings B, or
 * B + (X - B)/q (Szirmay-Kalos et al. 2005). The mean is that of X whatever B is.
 */
#include "render/path.h"

#include "render/cache.h"

#define FIRST_ROULETTE 5

/* A path that roulette may end stands for what it is expected to bring, over the pixel, times this. */
#define PERSISTENCE 1.7f
#define LEAST_CHANCE 0.25f
#define LONG_PATH 16 /* edges; from here on it ends by its throughput, too */

typedef struct candidate {
    igi_light_sample sample;
    float value[IGI_MAX_BANDS]; /* BRDF cosine times the light's, unoccluded, shared */
    float mean;
} candidate;

/* The power heuristic for what was sampled with `pdf` and might have been with `other`. */
static float share_of(float pdf, float other)
{
    float ratio = other / pdf;
    return 1 / (1 + ratio * ratio);
}

/* False when nothing comes from the light that way. */
static bool weigh(const igi_renderer *r, size_t light, const surface *s, float u, float v,
                  candidate *c)
{
    float pdf;
    if (!igi_light_sample_toward(r->lighting, light, s->point, u, v, &c->sample)) return false;
    if (!surface_value(s, r->bands, c->sample.direction, c->value, &pdf)) return false;
    /* A light of no extent (pdf 0) is never met by a ray of the BRDF. */
    float share = c->sample.pdf > 0 && !r->mirrors ? share_of(c->sample.pdf, pdf) : 1;
    c->mean = 0;
    for (int b = 0; b < r->bands; b++) {
        c->value[b] *= c->sample.weight * share *
                       igi_light_sample_value(&r->lights[light], &c->sample, b);
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
        if (pdf >= 0) share = share_of(pdf, igi_light_pdf(r->lighting, i, origin, direction, hit));
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
        share = share_of(pdf, igi_light_pdf(r->lighting, (size_t)light, origin, direction, hit));
    for (int b = 0; b < r->bands; b++) radiance[b] += throughput[b] * emitted[b] * share;
}

static float largest(const igi_renderer *r, const float *values)
{
    float most = 0;
    for (int b = 0; b < r->bands; b++) most = fmaxf(most, values[b]);
    return most;
}

/* False: the path ends here. */
static bool survive(const igi_renderer *r, sampler *points, float *throughput)
{
    float chance = largest(r, throughput), u, unused;
    sampler_next(points, &u, &unused);
    if (chance >= 1) return true;
    if (!(u < chance)) return false;
    for (int b = 0; b < r->bands; b++) throughput[b] /= chance;
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

/* A path on its way: where it is, how it goes on, and what it may still bring. */
typedef struct walk {
    igi_vec origin, normal, direction;
    float throughput[IGI_MAX_BANDS], pdf; /* of the direction; negative: the camera's */
    float pixel; /* what the whole path is expected to bring; 0: not known */
    int edge;
    uint64_t rays;
} walk;

/* Roulette where B is known; IGNORES leaves it to that by throughput alone. */
typedef enum verdict { ENDS, GOES_ON, IGNORES } verdict;

static verdict judge(const igi_renderer *r, walk *w, const surface *s, const igi_hit *hit,
                     sampler *points, float *radiance)
{
    float expected[IGI_MAX_BANDS] = {0}, u, unused;
    /* What a lobe sends depends on the viewer, which B does not know. */
    if (!r->expected || (w->pixel > 0 && s->lobe_share > 0)) return IGNORES;
    igi_cache_add(r->expected, s, hit, w->throughput, expected);
    float most = largest(r, expected);
    if (!(w->pixel > 0)) {
        w->pixel = most;
        return most > 0 ? GOES_ON : IGNORES;
    }
    float chance = fminf(1.0f, PERSISTENCE * most / w->pixel);
    if (w->edge >= LONG_PATH) chance = fminf(chance, largest(r, w->throughput));
    chance = fmaxf(chance, LEAST_CHANCE);
    if (chance >= 1) return GOES_ON;
    sampler_next(points, &u, &unused);
    bool survives = u < chance;
    for (int b = 0; b < r->bands; b++) {
        radiance[b] += expected[b] * (survives ? 1 - 1 / chance : 1);
        w->throughput[b] /= chance;
    }
    return survives ? GOES_ON : ENDS;
}

/* From edge number w->edge to the path's end. */
static uint64_t follow(const igi_renderer *r, walk *w, int max_depth, sampler *points,
                       float *radiance, path_parts *parts)
{
    float *first = parts ? parts->direct : radiance;
    for (;; w->edge++) {
        surface s;
        igi_hit hit = w->edge == 1 ? igi_trace(r->tracer, w->origin, w->direction)
                                   : igi_trace_off(r->tracer, w->origin, w->normal, w->direction);
        w->rays++;
        if (w->edge == 1 || !r->mirrors)
            add_emission(r, w->origin, w->direction, &hit, w->pdf, w->throughput,
                         w->edge <= 2 ? first : radiance);
        if (hit.triangle == IGI_NO_HIT || w->edge >= max_depth) break;
        surface_at(r, &hit, w->direction, &s);
        if (s.finish->absorbs) break;
        for (int b = 0; b < r->bands && parts && w->edge == 1; b++) parts->albedo[b] += s.albedo[b];
        if (r->cache_edge && w->edge >= r->cache_edge) {
            igi_cache_add(r->cache, &s, &hit, w->throughput, radiance);
            break;
        }
        verdict told = judge(r, w, &s, &hit, points, radiance);
        if (told == ENDS) break;
        w->rays += add_direct(r, &s, points, w->throughput, w->edge == 1 ? first : radiance);
        if (r->mirrors ? !surface_mirror(&s, r->bands, &w->direction, w->throughput)
                       : !go_on(r, &s, points, &w->direction, w->throughput, &w->pdf))
            break;
        w->origin = s.point;
        w->normal = s.normal;
        if (told == IGNORES && w->edge >= FIRST_ROULETTE && !survive(r, points, w->throughput))
            break;
    }
    return w->rays;
}

uint64_t trace_path(const igi_renderer *r, igi_vec origin, igi_vec direction, int max_depth,
                    sampler *points, float *radiance, path_parts *parts)
{
    walk w = {.origin = origin, .direction = direction, .pdf = -1, .edge = 1};
    for (int b = 0; b < r->bands; b++) w.throughput[b] = 1;
    return follow(r, &w, max_depth, points, radiance, parts);
}

uint64_t trace_irradiance(const igi_renderer *r, igi_vec point, igi_vec normal, int max_depth,
                          sampler *points, float *irradiance)
{
    static const finish white = {.model = IGI_LAMBERT};
    float u, v;
    walk w = {.origin = point, .normal = normal, .edge = 2};
    surface s = {.point = point, .normal = normal, .out = {0, 0, 1}, .finish = &white};
    igi_frame_of(normal, &s.t, &s.b);
    for (int b = 0; b < r->bands; b++) {
        s.albedo[b] = IGI_PIF; /* so that the radiance that leaves it is the irradiance */
        w.throughput[b] = 1;
    }
    w.rays = add_direct(r, &s, points, w.throughput, irradiance);
    if (max_depth < 2) return w.rays;
    for (int b = 0; b < r->bands; b++) w.throughput[b] = IGI_PIF;
    sampler_next(points, &u, &v);
    w.direction = igi_cosine_direction(normal, u, v);
    w.pdf = fmaxf(0.0f, igi_dot(w.direction, normal)) / IGI_PIF;
    return follow(r, &w, max_depth, points, irradiance, NULL);
}
