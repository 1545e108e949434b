/* SPDX-License-Identifier: Apache-2.0
 *
 * One sample of one light in proportion to what each piece of it gives to a surface. Beside a window
 * most of the light comes from its nearest corner: points chosen evenly over its area would find
 * that corner once in a while, with a weight of a hundred, and a visible share taken from such
 * points is biased. Here a triangle is chosen by its closed-form irradiance; a near one is sampled
 * evenly over its solid angle (Arvo 1995), so that only the cosine is left to vary.
 */
#include "light/lighting.h"

/* From here on (squared distance over area) a triangle's points weigh alike within a few per cent. */
#define NEAR_AREAS 30

typedef struct dvec {
    double x, y, z;
} dvec;

static double dot(dvec a, dvec b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}

static dvec cross(dvec a, dvec b)
{
    return (dvec){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}

static dvec combine(double p, dvec a, double q, dvec b)
{
    return (dvec){p * a.x + q * b.x, p * a.y + q * b.y, p * a.z + q * b.z};
}

static dvec unit(dvec a)
{
    double length = sqrt(dot(a, a));
    return length > 0 ? combine(1 / length, a, 0, a) : a;
}

static dvec toward(igi_vec corner, igi_vec point)
{
    return unit((dvec){(double)corner.x - (double)point.x, (double)corner.y - (double)point.y,
                       (double)corner.z - (double)point.z});
}

/* The dihedral angle at `a` between the planes through b and through c. */
static double angle_at(dvec a, dvec b, dvec c)
{
    dvec m = cross(a, b), n = cross(a, c), k = cross(m, n);
    return atan2(sqrt(dot(k, k)), dot(m, n));
}

/* A direction spread evenly over the triangle's solid angle; returns that angle, 0: degenerate. */
static double sample_solid_angle(const emitter *e, igi_vec point, double u, double v, dvec *d)
{
    dvec a = toward(e->corner, point), b = toward(igi_add(e->corner, e->edge1), point);
    dvec c = toward(igi_add(e->corner, e->edge2), point);
    double alpha = angle_at(a, b, c);
    double area = alpha + angle_at(b, c, a) + angle_at(c, a, b) - IGI_PI;
    if (!(area > 1e-7)) return 0;
    /* the part of u of the area lies between a, b and a point of the arc from a to c */
    double sine = sin(u * area - alpha), cosine = cos(u * area - alpha);
    double p = cosine - cos(alpha), q = sine + sin(alpha) * dot(a, b);
    double below = (q * sine + p * cosine) * sin(alpha);
    if (below == 0) return 0;
    double x = ((q * cosine - p * sine) * cos(alpha) - q) / below;
    x = fmin(1, fmax(-1, x));
    dvec side = unit(combine(1, c, -dot(a, c), a));
    dvec arc = combine(x, a, sqrt(1 - x * x), side);
    double z = 1 - v * (1 - dot(arc, b));
    *d = combine(z, b, sqrt(fmax(0, 1 - z * z)), unit(combine(1, arc, -dot(arc, b), b)));
    return area;
}

/* A point of the triangle; returns the solid angle it stands for, were it the only one. */
static float sample_emitter(const emitter *e, igi_vec point, float u, float v, igi_light_sample *s)
{
    igi_vec centre = igi_sub(e->centre, point);
    if (igi_dot(centre, centre) < NEAR_AREAS * e->area) {
        dvec d = {0, 0, 0};
        double angle = sample_solid_angle(e, point, (double)u, (double)v, &d);
        s->direction = igi_v((float)d.x, (float)d.y, (float)d.z);
        float facing = igi_dot(s->direction, e->normal);
        if (!(angle > 0) || !(facing < 0)) return 0;
        s->distance = igi_dot(igi_sub(e->corner, point), e->normal) / facing;
        return (float)angle;
    }
    float root = sqrtf(u);
    igi_vec at = igi_madd(igi_madd(e->corner, e->edge1, root * (1 - v)), e->edge2, root * v);
    igi_vec d = igi_sub(at, point);
    float squared = igi_dot(d, d), facing = -igi_dot(d, e->normal);
    if (!(facing > 0)) return 0;
    s->distance = sqrtf(squared);
    s->direction = igi_scale(d, 1 / s->distance);
    return e->area * facing / (squared * s->distance);
}

/* Of an environment, what the sample itself carries: no closed form knows what it would give. */
static float sample_sky(const igi_lighting *lighting, size_t light, igi_vec point, igi_vec normal,
                        float u, float v, igi_light_sample *sample)
{
    float share[IGI_MAX_BANDS], mean = 0;
    if (!igi_light_sample_toward(lighting, light, point, u, v, sample)) sample->weight = 0;
    float cosine = sample->weight > 0 ? igi_dot(sample->direction, normal) : 0;
    if (!(cosine > 0)) {
        sample->weight = 0;
        return 0;
    }
    igi_band_shares(lighting, light, share);
    for (int b = 0; b < lighting->bands; b++) mean += sample->tint[b] * share[b];
    sample->weight *= mean;
    return cosine * sample->weight;
}

float igi_light_sample_facing(const igi_lighting *lighting, size_t light, igi_vec point,
                              igi_vec normal, float u, float v, igi_light_sample *sample)
{
    const source *s = &lighting->sources[light];
    float weights[MANY_EMITTERS];
    *sample = (igi_light_sample){.weight = 0};
    if (s->light->type == IGI_LIGHT_ENV)
        return sample_sky(lighting, light, point, normal, u, v, sample);
    if (s->light->type != IGI_LIGHT_AREA || s->count > MANY_EMITTERS) {
        float open = igi_light_irradiance(lighting, NULL, light, point, normal, 1, 0);
        if (!(open > 0) || !igi_light_sample_toward(lighting, light, point, u, v, sample))
            sample->weight = 0;
        return fmaxf(0.0f, open);
    }
    const emitter *emitters = lighting->emitters + s->first;
    float sum = igi_emitters_weigh(lighting, s, point, normal, weights);
    if (!(sum > 0)) return 0;
    float target = u * sum, below = 0;
    size_t i = 0;
    while (below + weights[i] <= target && i + 1 < s->count) below += weights[i++];
    if (!(weights[i] > 0)) return sum;
    float rest = fminf(fmaxf(0.0f, (target - below) / weights[i]), 0.99999994f);
    float angle = sample_emitter(&emitters[i], point, rest, v, sample);
    sample->weight = angle * sum / weights[i];
    sample->pdf = sample->weight > 0 ? 1 / sample->weight : 0;
    if (angle > 0)
        sample->weight *= igi_light_profile(s->light,
                                            -igi_dot(sample->direction, emitters[i].normal));
    return sum;
}
