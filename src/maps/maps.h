/* SPDX-License-Identifier: Apache-2.0
 *
 * Albedo maps: the ratio of what leaves and what arrives, texel by texel.
 */
#ifndef IGI_SRC_MAPS_MAPS_H
#define IGI_SRC_MAPS_MAPS_H

#include "diffuse/field.h"

/* Where each triangle of the scene lies in its region's map: the mesh's texture coordinates, or an
 * atlas' where the region has none that are usable. */
typedef struct igi_layout {
    const igi_scene *scene;
    float *uvs; /* [triangles][3][2], origin at the bottom left */
} igi_layout;

IGI_MUST_USE igi_status igi_layout_create(igi_context *ctx, const igi_scene *scene,
                                          igi_layout **layout);
void igi_layout_destroy(igi_layout *layout);

/* The place in the map, in texels of a map of `size` x `size`: x to the right, y down, the middle of
 * the first texel at (0.5, 0.5); within [0, size). Coordinates that leave the square repeat. */
void igi_layout_place(const igi_layout *layout, uint32_t triangle, float u, float v, int size,
                      float *x, float *y);

/* Gives every region whose albedo is determined its map, map_std and `textured`; a textured one gets
 * the area mean of its map as albedo. `evidence` (of each region; may be NULL) learns why. */
IGI_MUST_USE igi_status igi_maps_create(igi_context *ctx, const igi_problem *problem,
                                        igi_field *field, const igi_layout *layout,
                                        igi_materials *materials, igi_region_evidence *evidence);

/* Bilinear look-up of the first `bands` channels at a place in texels. */
void igi_map_at(const igi_image *map, int bands, bool wraps, float x, float y, float *albedo);

#endif
