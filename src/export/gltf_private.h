/* SPDX-License-Identifier: Apache-2.0
 *
 * A binary glTF in the making: shared by gltf.c and gltf_mesh.c.
 */
#ifndef IGI_SRC_EXPORT_GLTF_PRIVATE_H
#define IGI_SRC_EXPORT_GLTF_PRIVATE_H

#include "export/export_private.h"

#include <jansson.h>

typedef struct igi_glb {
    igi_context *ctx;
    const igi_materials *materials;
    const igi_scene *scene;
    uint8_t *bytes; /* the binary chunk */
    size_t size, capacity;
    json_t *views, *accessors, *meshes, *nodes, *material_list, *textures, *images, *lights;
    json_t *children; /* of the root node */
    int positions;    /* accessor of all vertices; -1 until it is needed */
} igi_glb;

/* The failure of anything that builds JSON. */
igi_status igi_glb_full(const igi_glb *glb);

/* Room for `size` bytes, aligned to four, and a buffer view of it (target 0: none). */
IGI_MUST_USE igi_status igi_glb_add_view(igi_glb *glb, size_t size, int target, size_t *offset,
                                         int *view);

/* The region's triangles as a primitive, with texture coordinates if it is textured; *primitive
 * is NULL when it has none. */
IGI_MUST_USE igi_status igi_glb_add_primitive(igi_glb *glb, size_t region, bool textured,
                                              json_t **primitive);

#endif
