/* SPDX-License-Identifier: Apache-2.0
 *
 * What rays meet of the lights.
 */
#include "light/lighting.h"

static void add(const igi_lighting *l, const source *s, const float *tint, float *radiance)
{
    for (int b = 0; b < l->bands; b++)
        radiance[b] += (float)s->light->value[b] * (tint ? tint[b] : 1);
}

static void add_lamp(const igi_lighting *l, const source *s, igi_vec direction, uint32_t triangle,
                     float *radiance)
{
    float cosine = 1;
    if (s->light->profile > 0)
        cosine = fabsf(igi_dot(direction, igi_triangle_normal(&l->scene->mesh, triangle)));
    float share = igi_light_profile(s->light, cosine);
    for (int b = 0; b < l->bands; b++) radiance[b] += (float)s->light->value[b] * share;
}

void igi_light_add_sky(const igi_lighting *lighting, size_t light, igi_vec direction,
                       float *radiance)
{
    const source *s = &lighting->sources[light];
    if (s->light->type == IGI_LIGHT_AMBIENT) add(lighting, s, NULL, radiance);
    if (s->sky) add(lighting, s, sky_radiance(s->sky, direction), radiance);
}

void igi_lighting_add_met(const igi_lighting *lighting, igi_vec point, igi_vec direction,
                          const igi_hit *hit, float density, float count, float *radiance)
{
    size_t first = 0, end = lighting->count;
    if (hit->triangle != IGI_NO_HIT) {
        int light = igi_lighting_of_triangle(lighting, hit->triangle);
        if (light < 0) return;
        first = (size_t)light;
        end = first + 1;
    }
    for (size_t l = first; l < end; l++) {
        float met[IGI_MAX_BANDS] = {0}, pdf = igi_light_pdf(lighting, l, point, direction, hit);
        if (hit->triangle == IGI_NO_HIT) igi_light_add_sky(lighting, l, direction, met);
        else igi_lighting_add_emitted(lighting, direction, hit, met);
        float share = pdf > 0 ? density / (density + count * pdf) : 1;
        for (int b = 0; b < lighting->bands; b++) radiance[b] += share * met[b];
    }
}

void igi_lighting_add_emitted(const igi_lighting *lighting, igi_vec direction, const igi_hit *hit,
                              float *radiance)
{
    if (hit->triangle != IGI_NO_HIT) {
        int i = igi_lighting_of_triangle(lighting, hit->triangle);
        if (i >= 0 && !hit->back)
            add_lamp(lighting, &lighting->sources[i], direction, hit->triangle, radiance);
        return;
    }
    for (size_t i = 0; i < lighting->count; i++)
        igi_light_add_sky(lighting, i, direction, radiance);
}
