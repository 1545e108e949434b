/* SPDX-License-Identifier: Apache-2.0
 *
 * Inside the renderer: surfaces, sample points and one path.
 */
#ifndef IGI_SRC_RENDER_PATH_H
#define IGI_SRC_RENDER_PATH_H

#include "base/rng.h"
#include "light/light.h"
#include "render/render.h"

/* A material as paths need it. */
typedef struct finish {
    bool absorbs; /* an emitter reflects nothing */
    igi_model model;
    float alpha;
    float albedo[IGI_MAX_BANDS], specular[IGI_MAX_BANDS];
    float specular_mean;
    const igi_image *map;           /* NULL: albedo holds; */
    float map_scale[IGI_MAX_BANDS]; /* else the map times this */
    bool repeat;
} finish;

typedef struct igi_cache igi_cache;

struct igi_renderer {
    const igi_scene *scene;
    int bands;
    finish *finishes; /* [region_count] */
    igi_vec *normals; /* [triangle_count] */
    igi_tracer *tracer;
    const igi_light *lights;
    igi_lighting *lighting;
    igi_cache *cache; /* NULL, or what paths end with at their edge number cache_edge */
    int cache_edge;
    igi_cache *expected; /* NULL, or about what paths find: roulette ends them with it */
    bool is_variant;     /* scene, tracer and normals are another renderer's */
    bool
        mirrors; /* paths go on in the mirror direction alone, and lamps are found by shadow rays */
};

/* A point of a surface with its reflectance, seen along `out`. */
typedef struct surface {
    igi_vec point, normal, t, b; /* normal on the side of out */
    igi_vec out;                 /* in the local frame */
    const finish *finish;
    float albedo[IGI_MAX_BANDS];
    float lobe_share; /* how often the lobe is sampled rather than the diffuse part */
} surface;

/* rho_d at a point of a region with this finish. */
void surface_albedo(const igi_renderer *r, const finish *f, uint32_t triangle, float u, float v,
                    float *albedo);
void surface_at(const igi_renderer *r, const igi_hit *hit, igi_vec direction, surface *s);
/* BRDF times cosine per band for a direction of the world, and its density; false: all zero. */
bool surface_value(const surface *s, int bands, igi_vec direction, float *value, float *pdf);
igi_vec surface_sample(const surface *s, float choice, float u, float v);

/* Turns a direction of the world into that of its mirror image, and multiplies throughput[bands] by
 * what the lobe would send there were it infinitely narrow; false when there is no lobe. */
bool surface_mirror(const surface *s, int bands, igi_vec *direction, float *throughput);

/* Sample points, stratified over `batch` samples of a pixel, a power of two. */
typedef struct sampler {
    uint64_t key;   /* of the batch */
    uint32_t index; /* within the batch */
    uint32_t mask;  /* batch - 1 */
    uint32_t dimension;
} sampler;

void sampler_next(sampler *s, float *u, float *v);

/* Apart from the rest: light that has met one surface at most, and the albedo of the first. */
typedef struct path_parts {
    float direct[IGI_MAX_BANDS], albedo[IGI_MAX_BANDS];
} path_parts;

/* Adds the radiance that arrives along the ray to radiance[bands]; returns the rays it took. With
 * `parts` (may be NULL) its direct light is added there instead. */
uint64_t trace_path(const igi_renderer *r, igi_vec origin, igi_vec direction, int max_depth,
                    sampler *s, float *radiance, path_parts *parts);
/* Adds an estimate of the irradiance of the side of `normal` at a point of no surface; returns the
 * rays it took. */
uint64_t trace_irradiance(const igi_renderer *r, igi_vec point, igi_vec normal, int max_depth,
                          sampler *s, float *irradiance);

#endif
