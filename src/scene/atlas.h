/* SPDX-License-Identifier: Apache-2.0
 *
 * Texture coordinates for a region whose mesh has no usable ones.
 */
#ifndef IGI_SRC_SCENE_ATLAS_H
#define IGI_SRC_SCENE_ATLAS_H

#include "base/context.h"

#include <igi/scene.h>

typedef struct igi_atlas {
    size_t count;        /* triangles of the region */
    uint32_t *triangles; /* [count] in the mesh, rising */
    float *uvs;          /* [count][3][2] in [0,1], origin at the bottom left */
    float uv_per_m;      /* the one scale of all charts */
} igi_atlas;

/* Cuts the region into charts (connected triangles that face nearly alike, flattened onto the plane
 * of the first), and packs them into the unit square without overlap, all at one scale. The same
 * mesh gives the same atlas. */
IGI_MUST_USE igi_status igi_atlas_create(igi_context *ctx, const igi_mesh *mesh, uint32_t region,
                                         igi_atlas **atlas);
void igi_atlas_destroy(igi_atlas *atlas);

/* The same, written over the region's part of uvs[triangle_count][3][2] of the mesh. */
IGI_MUST_USE igi_status igi_atlas_fill(igi_context *ctx, const igi_mesh *mesh, uint32_t region,
                                       float *uvs);

#endif
