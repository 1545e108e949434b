/* SPDX-License-Identifier: Apache-2.0
 *
 * Meshes out of files: the readers fill a builder, the builder checks and becomes the scene's mesh.
 */
#ifndef IGI_SRC_SCENE_MESH_BUILDER_H
#define IGI_SRC_SCENE_MESH_BUILDER_H

#include "scene/file_text.h"

#include <igi/scene.h>

#define IGI_NO_UV UINT32_MAX

typedef struct igi_face {
    uint32_t vertex[3];
    uint32_t uv[3]; /* IGI_NO_UV: none */
    uint32_t region;
    uint32_t line; /* 0: not from a text */
} igi_face;

typedef struct igi_mesh_builder {
    igi_context *ctx;
    const char *file;
    float *positions; /* [vertex_count][3] */
    size_t vertex_count, vertex_capacity;
    float *uvs; /* [uv_count][2] */
    size_t uv_count, uv_capacity;
    igi_face *faces;
    size_t face_count, face_capacity;
    char **regions;
    size_t region_count, region_capacity;
    uint32_t *slots; /* open addressing: number of a region + 1, or 0 */
    size_t slot_count;
} igi_mesh_builder;

igi_mesh_builder igi_mesh_builder_make(igi_context *ctx, const char *file);
void igi_mesh_builder_clear(igi_mesh_builder *builder);

/* IGI_E_DATA with FILE:LINE: (or FILE:, where line is 0) in front of the sentence. */
igi_status igi_mesh_builder_fail(const igi_mesh_builder *builder, uint32_t line, const char *format,
                                 ...) IGI_PRINTF(3, 4);

/* `line` (0: none) is for the sentence. */
IGI_MUST_USE igi_status igi_mesh_builder_vertex(igi_mesh_builder *builder, const double p[3],
                                                uint32_t line);
IGI_MUST_USE igi_status igi_mesh_builder_uv(igi_mesh_builder *builder, const double uv[2],
                                            uint32_t line);
/* Indices are checked at the end, when all vertices are there. */
IGI_MUST_USE igi_status igi_mesh_builder_face(igi_mesh_builder *builder, const igi_face *face);
/* The number of the region of that name (need not end with a NUL), made if need be. */
IGI_MUST_USE igi_status igi_mesh_builder_region(igi_mesh_builder *builder, const char *name,
                                                size_t length, uint32_t line, uint32_t *region);

/* The readers. */
IGI_MUST_USE igi_status igi_obj_read(igi_mesh_builder *builder, const igi_text *text);
/* Of any format that Assimp knows. What it does, it does in a child process: of damaged PLY files
 * Assimp 5.2 crashes on one in twenty and never comes back from one in ten. */
IGI_MUST_USE igi_status igi_assimp_read(igi_mesh_builder *builder);
/* What the child does; for child.c. */
IGI_MUST_USE igi_status igi_assimp_import(igi_mesh_builder *builder);

#endif
