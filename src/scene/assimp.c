/* SPDX-License-Identifier: Apache-2.0
 *
 * PLY, glTF and the many others, by Assimp. Its materials are our regions; the transforms of its
 * nodes are baked. Triangles keep the order of the file. Coordinates are taken as they stand in the
 * file: cameras and lights are expected in the same axes. Runs in a process of its own (child.c).
 */
#include "scene/mesh_builder.h"

#include <assimp/cimport.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>
#include <stdio.h>
#include <string.h>

#define MAX_NODE_DEPTH 256

typedef struct node_place {
    double m[3][4];
} node_place;

static node_place concatenate(const node_place *outer, const struct aiMatrix4x4 *t)
{
    const double inner[4][4] = {{(double)t->a1, (double)t->a2, (double)t->a3, (double)t->a4},
                                {(double)t->b1, (double)t->b2, (double)t->b3, (double)t->b4},
                                {(double)t->c1, (double)t->c2, (double)t->c3, (double)t->c4},
                                {0, 0, 0, 1}};
    node_place result = {{{0}}};
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 4; j++)
            for (int k = 0; k < 4; k++) {
                double outer_ik = outer->m[i][k];
                result.m[i][j] += outer_ik * inner[k][j];
            }
    return result;
}

static igi_status region_of(igi_mesh_builder *b, const struct aiScene *from, unsigned material,
                            uint32_t *region)
{
    struct aiString name = {.length = 0};
    if (material < from->mNumMaterials)
        (void)aiGetMaterialString(from->mMaterials[material], AI_MATKEY_NAME, &name);
    if (strcmp(name.data, AI_DEFAULT_MATERIAL_NAME) == 0 ||
        (!name.data[0] && from->mNumMaterials < 2))
        strcpy(name.data, "default");
    if (!name.data[0]) /* nameless ones stay apart */
        snprintf(name.data, sizeof name.data, "material%u", material);
    return igi_mesh_builder_region(b, name.data, strlen(name.data), 0, region);
}

static igi_status add_vertices(igi_mesh_builder *b, const struct aiMesh *mesh,
                               const node_place *place)
{
    for (unsigned i = 0; i < mesh->mNumVertices; i++) {
        const double p[4] = {(double)mesh->mVertices[i].x, (double)mesh->mVertices[i].y,
                             (double)mesh->mVertices[i].z, 1};
        double world[3] = {0, 0, 0};
        for (int r = 0; r < 3; r++)
            for (int k = 0; k < 4; k++) world[r] += place->m[r][k] * p[k];
        IGI_TRY(igi_mesh_builder_vertex(b, world, 0));
        if (!mesh->mTextureCoords[0]) continue;
        const double uv[2] = {(double)mesh->mTextureCoords[0][i].x,
                              (double)mesh->mTextureCoords[0][i].y};
        IGI_TRY(igi_mesh_builder_uv(b, uv, 0));
    }
    return IGI_OK;
}

static igi_status add_mesh(igi_mesh_builder *b, const struct aiScene *from, unsigned number,
                           const node_place *place)
{
    const struct aiMesh *mesh = from->mMeshes[number];
    uint32_t first = (uint32_t)b->vertex_count, first_uv = (uint32_t)b->uv_count, region;
    IGI_TRY(region_of(b, from, mesh->mMaterialIndex, &region));
    IGI_TRY(add_vertices(b, mesh, place));
    const double(*m)[4] = place->m;
    bool mirrored = m[0][0] * (m[1][1] * m[2][2] - m[1][2] * m[2][1]) -
                        m[0][1] * (m[1][0] * m[2][2] - m[1][2] * m[2][0]) +
                        m[0][2] * (m[1][0] * m[2][1] - m[1][1] * m[2][0]) <
                    0;
    for (unsigned i = 0; i < mesh->mNumFaces; i++) {
        if (mesh->mFaces[i].mNumIndices != 3) continue; /* points and lines */
        igi_face face = {.region = region};
        for (int k = 0; k < 3; k++) {
            /* A mirroring transform turns fronts into backs; keep them fronts. */
            uint32_t corner = mesh->mFaces[i].mIndices[mirrored ? 2 - k : k];
            if (corner >= mesh->mNumVertices)
                return igi_fail(b->ctx, IGI_E_DATA, "%s: a face names a vertex that is not there",
                                b->file);
            face.vertex[k] = first + corner;
            face.uv[k] = mesh->mTextureCoords[0] ? first_uv + corner : IGI_NO_UV;
        }
        IGI_TRY(igi_mesh_builder_face(b, &face));
    }
    return IGI_OK;
}

/* Assimp builds a tree, so the recursion ends; its depth is the file's affair and is limited. */
static igi_status add_node(igi_mesh_builder *b, const struct aiScene *from,
                           const struct aiNode *node, const node_place *outer, int depth)
{
    if (depth > MAX_NODE_DEPTH)
        return igi_fail(b->ctx, IGI_E_DATA, "%s: nodes nested deeper than %d; flatten them",
                        b->file, MAX_NODE_DEPTH);
    node_place place = concatenate(outer, &node->mTransformation);
    for (unsigned i = 0; i < node->mNumMeshes; i++)
        IGI_TRY(add_mesh(b, from, node->mMeshes[i], &place));
    for (unsigned i = 0; i < node->mNumChildren; i++)
        IGI_TRY(add_node(b, from, node->mChildren[i], &place, depth + 1));
    return IGI_OK;
}

igi_status igi_assimp_import(igi_mesh_builder *builder)
{
    const struct aiScene *from = aiImportFile(builder->file, aiProcess_Triangulate |
                                                                 aiProcess_ValidateDataStructure);
    if (!from || !from->mRootNode) {
        igi_status status = igi_fail(builder->ctx, IGI_E_DATA, "%s: no readable mesh: %s",
                                     builder->file, aiGetErrorString());
        aiReleaseImport(from);
        return status;
    }
    const node_place identity = {{{1, 0, 0, 0}, {0, 1, 0, 0}, {0, 0, 1, 0}}};
    igi_status status = add_node(builder, from, from->mRootNode, &identity, 0);
    aiReleaseImport(from);
    return status;
}
