/* SPDX-License-Identifier: Apache-2.0
 *
 * Rays against the scene's triangles, by Embree.
 */
#ifndef IGI_SRC_TRACE_TRACE_H
#define IGI_SRC_TRACE_TRACE_H

#include "base/context.h"
#include "base/vec.h"

#include <igi/scene.h>

typedef struct igi_tracer igi_tracer;

/* Builds the acceleration structure. The mesh must outlive the tracer. A built tracer is
 * read-only: every thread may use it at once. */
IGI_MUST_USE igi_status igi_tracer_create(igi_context *ctx, const igi_mesh *mesh,
                                          igi_tracer **tracer);
void igi_tracer_destroy(igi_tracer *tracer);

#define IGI_NO_HIT UINT32_MAX

typedef struct igi_hit {
    uint32_t triangle; /* IGI_NO_HIT: the ray left the scene */
    float u, v;        /* barycentric: p = (1-u-v) p0 + u p1 + v p2 */
    float distance;    /* metres, the direction being a unit vector */
    bool back;         /* the ray met the back (clockwise) side */
} igi_hit;

/* The nearest hit farther than igi_tracer_epsilon from the origin. Counting rays is the caller's
 * (igi_count_rays, once a task). */
igi_hit igi_trace(const igi_tracer *tracer, igi_vec origin, igi_vec direction);

/* From a point of a surface into the side of `normal`: the ray starts a hair off the surface and
 * misses nothing, however near. (igi_trace loses what is nearer than its epsilon: 1e-4 of all light
 * in a cube, at its edges, which a room of albedo .99 makes one per cent.) */
igi_hit igi_trace_off(const igi_tracer *tracer, igi_vec point, igi_vec normal, igi_vec direction);

#define IGI_TRACE_BUNDLE 8
/* The same for `count` <= IGI_TRACE_BUNDLE rays from one point at once: quicker for rays that stay
 * together, like those of neighbouring pixels. */
void igi_trace_bundle(const igi_tracer *tracer, igi_vec origin, const igi_vec *directions,
                      int count, igi_hit *hits);

/* Is anything between the two points, ends excluded? */
bool igi_occluded(const igi_tracer *tracer, igi_vec from, igi_vec to);
/* Is anything in this direction, at any distance up to `limit` metres (INFINITY: all)? */
bool igi_occluded_toward(const igi_tracer *tracer, igi_vec from, igi_vec direction, float limit);

/* Geometry of the mesh under the tracer. */
igi_vec igi_triangle_point(const igi_mesh *mesh, uint32_t triangle, float u, float v);
/* Unit, on the front side; zero for a triangle without area. */
igi_vec igi_triangle_normal(const igi_mesh *mesh, uint32_t triangle);
/* The same, computed once for all triangles. */
igi_vec igi_tracer_normal(const igi_tracer *tracer, uint32_t triangle);
float igi_triangle_area(const igi_mesh *mesh, uint32_t triangle);
/* Texture coordinates there; the mesh must have them. */
void igi_triangle_uv(const igi_mesh *mesh, uint32_t triangle, float u, float v, float uv[2]);

/* Diagonal of the bounding box, metres, and the box itself. */
float igi_tracer_size(const igi_tracer *tracer, igi_vec *low, igi_vec *high);
/* The offset that keeps a ray off the surface it starts from: 2e-5 of the scene's size. */
float igi_tracer_epsilon(const igi_tracer *tracer);

#endif
