/* SPDX-License-Identifier: Apache-2.0
 *
 * Irradiance at a point by one light of value 1. What arrives when nothing is in between has a
 * closed form (emitters.c for triangles). Shadow rays tell what of it
 * arrives, with the closed form as control variate: E = mean(f v) + b (E_open - mean f), f the
 * estimate of E_open at a point of the light, v its visibility. The best b is the visible fraction
 * sum(f v) / sum f; taken from the same points it biases (a per cent at 16 rays), so each half of
 * the points takes it from the other half. E is exact where nothing is in between.
 * Lights of very many triangles are sampled by area alone.
 */
#include "light/lighting.h"

#define SKY_RAYS 4 /* to an environment, for one that another light would get */

/* The R2 sequence (Roberts 2018), shifted by the key (Cranley and Patterson 1976). */
typedef struct pattern {
    float u, v;
} pattern;

static pattern pattern_start(uint64_t key)
{
    uint64_t h = igi_hash64(key);
    return (pattern){igi_u32_to_float((uint32_t)h), igi_u32_to_float((uint32_t)(h >> 32))};
}

static void pattern_next(pattern *p)
{
    p->u += 0.7548776662466927f;
    p->v += 0.5698402909980532f;
    if (p->u >= 1) p->u -= 1;
    if (p->v >= 1) p->v -= 1;
}

/* Irradiance by what of the emitter lies around `p`, were all of it there; 0 behind either. */
static float kernel(const source *s, const emitter *e, igi_vec p, igi_vec point, igi_vec normal)
{
    igi_vec d = igi_sub(p, point);
    float squared = igi_dot(d, d);
    float at_point = igi_dot(d, normal), at_light = -igi_dot(d, e->normal);
    if (!(at_point > 0 && at_light > 0)) return 0;
    return at_point * at_light / (squared * squared) * e->area *
           igi_light_profile(s->light, at_light / sqrtf(squared));
}

/* Sums over every second ray. */
typedef struct half {
    float open, seen;
    int rays;
} half;

static void half_add(half *h, float open, bool seen)
{
    h->open += open;
    h->seen += seen ? open : 0;
    h->rays++;
}

static float combine(const half halves[2], float open)
{
    float sum = 0, visible[2];
    for (int h = 0; h < 2; h++) {
        const half *other = halves[1 - h].open > 0 ? &halves[1 - h] : &halves[h];
        visible[h] = other->open > 0 ? other->seen / other->open : 1;
    }
    if (halves[1].rays == 0) return open * visible[0];
    for (int h = 0; h < 2; h++) {
        float n = (float)halves[h].rays;
        sum += halves[h].seen / n + visible[h] * (open - halves[h].open / n);
    }
    return fmaxf(0.0f, 0.5f * sum);
}

static igi_vec point_on(const emitter *e, pattern p)
{
    float root = sqrtf(p.u);
    return igi_madd(igi_madd(e->corner, e->edge1, root * (1 - p.v)), e->edge2, root * p.v);
}

/* Emitters are chosen in proportion to their weight, systematically (one uniform offset). */
static float seen_irradiance(const igi_lighting *l, const source *s, const float *weights,
                             float sum, const igi_tracer *tracer, igi_vec point, igi_vec normal,
                             int rays, uint64_t key)
{
    const emitter *emitters = l->emitters + s->first;
    half halves[2] = {{0, 0, 0}, {0, 0, 0}};
    pattern patterns[2] = {pattern_start(3 * key), pattern_start(3 * key + 1)};
    float below = 0, step = sum / (float)rays;
    float target = step * igi_u32_to_float((uint32_t)igi_hash64(3 * key + 2));
    size_t i = 0;
    for (int k = 0; k < rays; k++, target += step) {
        while (below + weights[i] <= target && below + weights[i] < sum) below += weights[i++];
        igi_vec at = point_on(&emitters[i], patterns[k % 2]);
        pattern_next(&patterns[k % 2]);
        float open = kernel(s, &emitters[i], at, point, normal);
        if (open > 0) open *= sum / weights[i];
        half_add(&halves[k % 2], open, open > 0 && !igi_occluded(tracer, point, at));
    }
    return combine(halves, sum);
}

static float area_by_samples(const igi_lighting *l, size_t light, const igi_tracer *tracer,
                             igi_vec point, igi_vec normal, int rays, uint64_t key)
{
    float sum = 0;
    pattern p = pattern_start(key);
    for (int k = 0; k < rays; k++) {
        igi_light_sample s;
        float u = p.u, v = p.v;
        pattern_next(&p);
        if (!igi_light_sample_toward(l, light, point, u, v, &s)) continue;
        float cosine = igi_dot(s.direction, normal);
        if (!(cosine > 0)) continue;
        if (!tracer || !igi_occluded(tracer, point, igi_madd(point, s.direction, s.distance)))
            sum += cosine * s.weight;
    }
    return sum / (float)rays;
}

static float area_irradiance(const igi_lighting *l, size_t light, const igi_tracer *tracer,
                             igi_vec point, igi_vec normal, int rays, uint64_t key)
{
    const source *s = &l->sources[light];
    if (s->count > MANY_EMITTERS)
        return area_by_samples(l, light, tracer, point, normal, rays, key);
    float weights[MANY_EMITTERS];
    float sum = igi_emitters_weigh(l, s, point, normal, weights);
    if (!(sum > 0)) return 0;
    if (!tracer) return sum;
    return seen_irradiance(l, s, weights, sum, tracer, point, normal, rays, key);
}

/* The part of a line light above the horizon of `point`; t runs along the light in metres from the
 * foot of the perpendicular h. */
typedef struct segment {
    igi_vec h, axis; /* axis: unit */
    float t0, t1;
} segment;

static segment visible_segment(const source *s, igi_vec point, igi_vec normal)
{
    igi_vec from = igi_sub(s->position, point), axis = igi_scale(s->axis, 1 / s->length);
    float t0 = igi_dot(from, axis), t1 = t0 + s->length;
    igi_vec h = igi_madd(from, axis, -t0);
    float height = igi_dot(normal, h), slope = igi_dot(normal, axis);
    if (slope > 0) t0 = fmaxf(t0, -height / slope);
    else if (slope < 0) t1 = fminf(t1, -height / slope);
    else if (height <= 0) t1 = t0;
    return (segment){h, axis, t0, t1};
}

/* E = int n.r/|r|^3 dt with r = h + t a; the primitive is (n.h t/h^2 - n.a) / |r|. */
static float segment_irradiance(const segment *s, igi_vec normal)
{
    double h2 = (double)igi_dot(s->h, s->h), t0 = (double)s->t0, t1 = (double)s->t1;
    if (!(t1 > t0) || !(h2 > 0)) return 0;
    double r0 = sqrt(h2 + t0 * t0), r1 = sqrt(h2 + t1 * t1);
    return (float)((double)igi_dot(normal, s->h) / h2 * (t1 / r1 - t0 / r0) -
                   (double)igi_dot(normal, s->axis) * (1 / r1 - 1 / r0));
}

static float line_irradiance(const source *s, const igi_tracer *tracer, igi_vec point,
                             igi_vec normal, int rays, uint64_t key)
{
    if (!(s->length > 0)) return 0;
    segment part = visible_segment(s, point, normal);
    float open = segment_irradiance(&part, normal), length = part.t1 - part.t0;
    if (!(open > 0) || !tracer) return fmaxf(0.0f, open);
    half halves[2] = {{0, 0, 0}, {0, 0, 0}};
    pattern shift = pattern_start(key);
    for (int k = 0; k < rays; k++) {
        int n = (rays + 1 - k % 2) / 2; /* each half covers the whole length */
        float t = part.t0 + length * ((float)(k / 2) + (k % 2 ? shift.u : shift.v)) / (float)n;
        igi_vec d = igi_madd(part.h, part.axis, t);
        float squared = igi_dot(d, d), f = igi_dot(d, normal) / (squared * sqrtf(squared));
        f = fmaxf(0.0f, f * length);
        half_add(&halves[k % 2], f, f > 0 && !igi_occluded(tracer, point, igi_add(point, d)));
    }
    return combine(halves, open);
}

static float ambient_irradiance(const igi_tracer *tracer, igi_vec point, igi_vec normal, int rays,
                                uint64_t key)
{
    if (!tracer) return IGI_PIF;
    int open = 0;
    pattern p = pattern_start(key);
    for (int k = 0; k < rays; k++) {
        igi_vec d = igi_cosine_direction(normal, p.u, p.v);
        pattern_next(&p);
        open += !igi_occluded_toward(tracer, point, d, INFINITY);
    }
    return IGI_PIF * (float)open / (float)rays;
}

static float one_ray(const igi_lighting *l, size_t light, const igi_tracer *tracer, igi_vec point,
                     igi_vec normal)
{
    igi_light_sample s;
    if (!igi_light_sample_toward(l, light, point, 0.5f, 0.5f, &s)) return 0;
    float cosine = igi_dot(s.direction, normal);
    if (!(cosine > 0)) return 0;
    if (!tracer) return cosine * s.weight;
    return igi_light_hidden(tracer, point, &s) ? 0 : cosine * s.weight;
}

void igi_band_shares(const igi_lighting *l, size_t light, float *share)
{
    const double *value = l->sources[light].light->value;
    double sum = 0;
    for (int b = 0; b < l->bands; b++) sum += value[b];
    for (int b = 0; b < l->bands; b++)
        share[b] = sum > 0 ? (float)(value[b] / sum) : 1 / (float)l->bands;
}

static float sky_irradiance(const igi_lighting *l, size_t light, const igi_tracer *tracer,
                            igi_vec point, igi_vec normal, int rays, uint64_t key)
{
    float sum = 0, share[IGI_MAX_BANDS];
    pattern p = pattern_start(key);
    igi_band_shares(l, light, share);
    rays *= SKY_RAYS;
    for (int k = 0; k < rays; k++) {
        igi_light_sample s;
        bool shines = igi_light_sample_toward(l, light, point, p.u, p.v, &s);
        pattern_next(&p);
        float cosine = shines ? igi_dot(s.direction, normal) : 0, mean = 0;
        if (!(cosine > 0)) continue;
        if (tracer && igi_occluded_toward(tracer, point, s.direction, INFINITY)) continue;
        for (int b = 0; b < l->bands; b++) mean += s.tint[b] * share[b];
        sum += cosine * s.weight * mean;
    }
    return sum / (float)rays;
}

float igi_light_irradiance(const igi_lighting *lighting, const igi_tracer *tracer, size_t light,
                           igi_vec point, igi_vec normal, int rays, uint64_t key)
{
    const source *s = &lighting->sources[light];
    if (rays < 1) rays = 1;
    switch (s->light->type) {
    case IGI_LIGHT_AREA: return area_irradiance(lighting, light, tracer, point, normal, rays, key);
    case IGI_LIGHT_LINE: return line_irradiance(s, tracer, point, normal, rays, key);
    case IGI_LIGHT_AMBIENT: return ambient_irradiance(tracer, point, normal, rays, key);
    case IGI_LIGHT_ENV: return sky_irradiance(lighting, light, tracer, point, normal, rays, key);
    default: return one_ray(lighting, light, tracer, point, normal);
    }
}
