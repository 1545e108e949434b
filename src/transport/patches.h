/* SPDX-License-Identifier: Apache-2.0
 *
 * Patches: the mesh cut into pieces of about one size, each with two sides.
 *
 * A large triangle is cut by a lattice in its barycentric coordinates, so that the patch under a
 * hit is an index computed from (triangle, u, v), and no texture coordinates are needed. Triangles
 * smaller than a patch are gathered into one when they are of one region, near, and face alike.
 */
#ifndef IGI_SRC_TRANSPORT_PATCHES_H
#define IGI_SRC_TRANSPORT_PATCHES_H

#include "base/rng.h"
#include "trace/trace.h"

typedef struct igi_triangle_lattice {
    uint32_t first;  /* its first patch */
    uint16_t nu, nv; /* cells along the two edges from `corner`; 1 x 1: the whole triangle */
    uint8_t corner;  /* 0..2: the vertex whose angle is largest, where u and v start */
} igi_triangle_lattice;

typedef struct igi_patches {
    const igi_mesh *mesh;
    float size_m; /* the side that was aimed at */
    size_t count; /* patches; some cells beyond a triangle's long edge are empty */
    igi_triangle_lattice *lattices; /* [triangle_count] */
    uint32_t *triangle;             /* [count] the triangle, or the first of the gathered ones */
    uint32_t *next; /* [triangle_count] the next of the gathered ones, or IGI_NO_HIT */
    float *area;    /* [count] m^2 */
} igi_patches;

/* size_m: side of a patch in metres, > 0. */
IGI_MUST_USE igi_status igi_patches_create(igi_context *ctx, const igi_mesh *mesh, float size_m,
                                           igi_patches **patches);
void igi_patches_destroy(igi_patches *patches);

/* The patch that holds a point. A side of a patch is numbered 2 patch + (back ? 1 : 0). */
uint32_t igi_patch_at(const igi_patches *patches, uint32_t triangle, float u, float v);

/* Where in its cell of the triangle's lattice a point lies, 0..1 along both edges; and back: the
 * point of a patch there, moved into the triangle if need be. The patch must not be a gathered one. */
void igi_patch_place(const igi_patches *patches, uint32_t triangle, float u, float v, float *s,
                     float *t);
void igi_patch_point(const igi_patches *patches, uint32_t patch, float s, float t, float *u,
                     float *v);

static inline uint32_t igi_side_at(const igi_patches *patches, uint32_t triangle, float u, float v,
                                   bool back)
{
    return 2 * igi_patch_at(patches, triangle, u, v) + (back ? 1u : 0u);
}

static inline uint32_t igi_patch_region(const igi_patches *patches, uint32_t patch)
{
    return patches->mesh->regions[patches->triangle[patch]];
}

/* A point of the patch, uniform in its area. */
void igi_patch_sample(const igi_patches *patches, uint32_t patch, igi_rng *rng, uint32_t *triangle,
                      float *u, float *v);

#endif
