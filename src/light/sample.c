/* SPDX-License-Identifier: Apache-2.0
 *
 * One sample of one light. Area lights are sampled uniformly over their area, so that the density
 * per solid angle is d^2 / (A cos) whichever triangle a ray has met.
 */
#include "light/lighting.h"

#define ANGLES_AT_ONCE 128

/* Intensity of a spot toward `direction`, for 1 within its beam. */
static float spot_factor(const source *s, igi_vec direction)
{
    float c = igi_dot(direction, s->axis);
    if (c <= s->cos_cutoff) return 0;
    float angle = acosf(fminf(1.0f, c));
    return angle <= s->beam ? 1 : (s->cutoff - angle) / (s->cutoff - s->beam);
}

/* The first of the running sums that is above u of the whole area. */
static size_t find_area(const igi_lighting *l, const source *s, float u)
{
    const float *areas = l->areas + s->first;
    size_t k = (size_t)(u * (float)s->count), found;
    float area = u * s->area;
    found = l->cuts[s->first + (k < s->count ? k : s->count - 1)];
    while (found > 0 && areas[found - 1] > area) found--; /* the product was rounded up */
    while (found + 1 < s->count && areas[found] <= area) found++;
    return found;
}

static bool sample_area(const igi_lighting *l, const source *s, igi_vec point, float u, float v,
                        igi_light_sample *sample)
{
    if (s->count == 0) return false;
    float area = u * s->area;
    size_t found = s->first + find_area(l, s, u);
    const emitter *e = &l->emitters[found];
    /* What is left of u within the triangle is uniform again. */
    float rest = fminf(1.0f, fmaxf(0.0f, 1 - (l->areas[found] - area) / e->area));
    float root = sqrtf(rest);
    igi_vec p = igi_madd(igi_madd(e->corner, e->edge1, root * (1 - v)), e->edge2, root * v);
    igi_vec d = igi_sub(p, point);
    float squared = igi_dot(d, d), distance = sqrtf(squared);
    float facing = -igi_dot(d, e->normal); /* distance times the cosine at the light */
    if (!(facing > 0)) return false;
    sample->direction = igi_scale(d, 1 / distance);
    sample->distance = distance;
    sample->pdf = squared * distance / (facing * s->area);
    sample->weight = igi_light_profile(s->light, facing / distance) / sample->pdf;
    return true;
}

static bool sample_place(igi_vec point, igi_vec place, igi_light_sample *sample)
{
    igi_vec d = igi_sub(place, point);
    float squared = igi_dot(d, d);
    if (!(squared > 0)) return false;
    sample->distance = sqrtf(squared);
    sample->direction = igi_scale(d, 1 / sample->distance);
    sample->pdf = 0;
    sample->weight = 1 / squared;
    return true;
}

bool igi_light_sample_toward(const igi_lighting *lighting, size_t light, igi_vec point, float u,
                             float v, igi_light_sample *sample)
{
    const source *s = &lighting->sources[light];
    sample->tint = NULL;
    switch (s->light->type) {
    case IGI_LIGHT_AREA: return sample_area(lighting, s, point, u, v, sample);
    case IGI_LIGHT_POINT: return sample_place(point, s->position, sample);
    case IGI_LIGHT_SPOT:
        if (!sample_place(point, s->position, sample)) return false;
        sample->weight *= spot_factor(s, igi_scale(sample->direction, -1));
        return sample->weight > 0;
    case IGI_LIGHT_LINE:
        if (!sample_place(point, igi_madd(s->position, s->axis, u), sample)) return false;
        sample->weight *= s->length;
        return true;
    case IGI_LIGHT_DIRECTIONAL:
        *sample = (igi_light_sample){igi_scale(s->axis, -1), INFINITY, 0, 1, NULL};
        return true;
    case IGI_LIGHT_GONIOMETRIC:
        if (!sample_place(point, s->position, sample)) return false;
        sample->weight *= profile_intensity(s->profile, igi_scale(sample->direction, -1));
        return sample->weight > 0;
    case IGI_LIGHT_ENV:
        sample->direction = sky_sample(s->sky, u, v, &sample->pdf);
        sample->distance = INFINITY;
        sample->tint = sky_radiance(s->sky, sample->direction);
        sample->weight = sample->pdf > 0 ? 1 / sample->pdf : 0;
        return sample->pdf > 0;
    default: return false; /* ambient: cosine-distributed rays find it best */
    }
}

float igi_light_pdf(const igi_lighting *lighting, size_t light, igi_vec point, igi_vec direction,
                    const igi_hit *hit)
{
    (void)point;
    const source *s = &lighting->sources[light];
    if (s->sky && hit->triangle == IGI_NO_HIT) return sky_pdf(s->sky, direction);
    if (s->light->type != IGI_LIGHT_AREA || hit->triangle == IGI_NO_HIT || hit->back) return 0;
    if (igi_lighting_of_triangle(lighting, hit->triangle) != (int)light) return 0;
    igi_vec normal = igi_triangle_normal(&lighting->scene->mesh, hit->triangle);
    float cosine = fabsf(igi_dot(direction, normal));
    return hit->distance * hit->distance / fmaxf(cosine * s->area, 1e-30f);
}

/* The solid angles of a light's emitters from `begin` on, so many at a time, and their sums up to
 * each. */
typedef struct angles {
    const igi_lighting *l;
    const source *s;
    igi_vec point;
    size_t begin, count;
    float of[ANGLES_AT_ONCE], sums[ANGLES_AT_ONCE];
} angles;

/* before: the sum of all that come before. Returns the sum with these. */
static float find_angles(angles *a, size_t begin, float before)
{
    size_t left = a->s->count - begin;
    a->begin = begin;
    a->count = left < ANGLES_AT_ONCE ? left : ANGLES_AT_ONCE;
    igi_emitters_angles(a->l, a->s->first + begin, a->count, a->point, a->of);
    for (size_t i = 0; i < a->count; i++) a->sums[i] = before += a->of[i];
    return before;
}

/* The first emitter, not before `from`, up to which the sum is above the target; else the last. */
static size_t find_emitter(angles *a, size_t from, float target)
{
    for (;;) {
        size_t i = from - a->begin, last = a->count - 1;
        while (i < last && a->sums[i] <= target) i++;
        from = a->begin + i;
        if (a->sums[i] > target || from + 1 == a->s->count) return from;
        (void)find_angles(a, ++from, a->sums[i]);
    }
}

static size_t area_sample_set(const igi_lighting *l, const source *s, igi_vec point, size_t count,
                              const float start[2], igi_light_sample *samples)
{
    const emitter *emitters = l->emitters + s->first;
    angles a;
    a.l = l; /* the rest would be cleared in vain */
    a.s = s;
    a.point = point;
    float whole = 0;
    for (size_t i = 0; i < s->count; i += ANGLES_AT_ONCE) whole = find_angles(&a, i, whole);
    if (!(whole > 0)) return 0;
    if (a.begin > 0) (void)find_angles(&a, 0, 0);
    size_t i = 0, made = 0;
    float u = start[0], v = start[1];
    for (size_t k = 0; k < count; k++) {
        i = find_emitter(&a, i, ((float)k + start[0]) / (float)count * whole);
        const emitter *e = &emitters[i];
        float angle = a.of[i - a.begin];
        u += 0.7548776662f;
        v += 0.5698402910f;
        u -= u < 1 ? 0.0f : 1.0f;
        v -= v < 1 ? 0.0f : 1.0f;
        float root = sqrtf(u);
        igi_vec p = igi_madd(igi_madd(e->corner, e->edge1, root * (1 - v)), e->edge2, root * v);
        igi_vec d = igi_sub(p, point);
        float squared = igi_dot(d, d), distance = sqrtf(squared);
        float facing = -igi_dot(d, e->normal);
        if (!(facing > 0) || !(angle > 0)) continue;
        float solid = e->area * facing / (squared * distance); /* were all of it here */
        float weight = solid * whole / (angle * (float)count);
        weight *= igi_light_profile(s->light, facing / distance);
        samples[made++] = (igi_light_sample){igi_scale(d, 1 / distance), distance, 1 / solid,
                                             weight, NULL};
    }
    return made;
}

size_t igi_light_sample_set(const igi_lighting *lighting, size_t light, igi_vec point, size_t count,
                            const float start[2], igi_light_sample *samples)
{
    const source *s = &lighting->sources[light];
    if (s->light->type == IGI_LIGHT_AREA)
        return area_sample_set(lighting, s, point, count, start, samples);
    bool is_extended = s->light->type == IGI_LIGHT_LINE || s->light->type == IGI_LIGHT_ENV;
    if (!is_extended) return igi_light_sample_toward(lighting, light, point, 0, 0, samples) ? 1 : 0;
    size_t made = 0;
    for (size_t k = 0; k < count; k++) {
        float u = ((float)k + start[0]) / (float)count, v = start[1] + (float)k * 0.6180339887f;
        v -= floorf(v);
        if (!igi_light_sample_toward(lighting, light, point, u, v, &samples[made])) continue;
        samples[made++].weight /= (float)count;
    }
    return made;
}

bool igi_light_hidden(const igi_tracer *tracer, igi_vec from, const igi_light_sample *sample)
{
    if (isinf(sample->distance))
        return igi_occluded_toward(tracer, from, sample->direction, INFINITY);
    return igi_occluded(tracer, from, igi_madd(from, sample->direction, sample->distance));
}
