/* SPDX-License-Identifier: Apache-2.0
 *
 * The lights of a scene, ready to be sampled.
 */
#ifndef IGI_SRC_LIGHT_LIGHT_H
#define IGI_SRC_LIGHT_LIGHT_H

#include "base/rng.h"
#include "trace/trace.h"

typedef struct igi_lighting igi_lighting;

/* Prepares the lights for sampling. An emitter region that `lights` leaves out is dark. Scene and
 * lights must outlive the result. A prepared lighting is read-only. */
IGI_MUST_USE igi_status igi_lighting_create(igi_context *ctx, const igi_scene *scene,
                                            const igi_light *lights, size_t light_count,
                                            igi_lighting **lighting);
void igi_lighting_destroy(igi_lighting *lighting);

size_t igi_lighting_count(const igi_lighting *lighting); /* lights, as given */

/* One sample of one light as seen from `point`. */
typedef struct igi_light_sample {
    igi_vec direction; /* unit, from the point toward the light */
    float distance;    /* metres; INFINITY for a light without a place */
    float pdf;         /* per solid angle; 0 for a light of no extent (point, spot, directional) */
    float weight;      /* radiance over pdf, or irradiance at normal incidence for a light of no
                          extent, is weight times igi_light_sample_value */
    const float *tint; /* [bands], a factor of each band beside the value (env); NULL: 1 */
} igi_light_sample;

/* What is to be multiplied by a sample's weight: the light's value, and the sample's tint. */
static inline float igi_light_sample_value(const igi_light *light, const igi_light_sample *sample,
                                           int band)
{
    return (float)light->value[band] * (sample->tint ? sample->tint[band] : 1);
}

/* Samples light number `light` from (u,v) in the unit square. false: it cannot shine there. */
bool igi_light_sample_toward(const igi_lighting *lighting, size_t light, igi_vec point, float u,
                             float v, igi_light_sample *sample);
/* Is anything between `from` and the place, or along the direction, that was sampled from it? */
bool igi_light_hidden(const igi_tracer *tracer, igi_vec from, const igi_light_sample *sample);

/* `count` samples of one light together, spread over what of it faces the point, in proportion to
 * the solid angle of each piece: sum over them of weight * value * f estimates the integral of
 * radiance * f over directions. `start` in the unit square shifts the pattern. Returns how many were
 * made: one for a light of no extent, none when it cannot shine there. */
size_t igi_light_sample_set(const igi_lighting *lighting, size_t light, igi_vec point, size_t count,
                            const float start[2], igi_light_sample *samples);
/* The density with which igi_light_sample_toward would choose the direction that met `hit`. */
float igi_light_pdf(const igi_lighting *lighting, size_t light, igi_vec point, igi_vec direction,
                    const igi_hit *hit);

/* A sample of one light in proportion to what it gives to a surface at `point` facing `normal`; its
 * weight is 0 when it carries nothing. Returns the irradiance for a value of 1, as if nothing were
 * in between (of an env light: an estimate). */
float igi_light_sample_facing(const igi_lighting *lighting, size_t light, igi_vec point,
                              igi_vec normal, float u, float v, igi_light_sample *sample);

/* An area light lies within this ball; returns its radius. */
float igi_light_ball(const igi_lighting *lighting, size_t light, igi_vec *middle);
/* Index of the light that the triangle belongs to, or -1. */
int igi_lighting_of_triangle(const igi_lighting *lighting, uint32_t triangle);
/* What a ray meets: radiance per band of an area light's front at `hit`, or of the sky when the ray
 * left the scene; adds to radiance[bands]. */
void igi_lighting_add_emitted(const igi_lighting *lighting, igi_vec direction, const igi_hit *hit,
                              float *radiance);
/* The same where `count` samples of each light look for its light too: of what the ray found, with
 * this density, its share by the balance heuristic. What has no samples, as ambient light, is left
 * whole; it alone with a count of INFINITY. */
void igi_lighting_add_met(const igi_lighting *lighting, igi_vec point, igi_vec direction,
                          const igi_hit *hit, float density, float count, float *radiance);
/* The part of the emitted light by one light, env or ambient, of a ray that left the scene; else nothing. */
void igi_light_add_sky(const igi_lighting *lighting, size_t light, igi_vec direction,
                       float *radiance);

/* Irradiance at `point` (on the side of `normal`) by light number `light` for a value of 1 in a
 * band, W m^-2 per unit of value: closed form for what is unoccluded, times the visible fraction
 * found with `rays` shadow rays whose pattern is keyed by `key`. Without a tracer (NULL): as if
 * nothing were in between. Of an env light: the mean over bands of its image, weighted by
 * the light's values (alike when they are 0), by samples of it. */
float igi_light_irradiance(const igi_lighting *lighting, const igi_tracer *tracer, size_t light,
                           igi_vec point, igi_vec normal, int rays, uint64_t key);

#endif
