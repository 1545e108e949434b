/* SPDX-License-Identifier: Apache-2.0
 *
 * Triangles as glTF's buffers.
 */
#include "export/gltf_private.h"

#include <float.h>
#include <math.h>
#include <string.h>

enum { FLOATS = 5126, UINTS = 5125, VERTICES = 34962, INDICES = 34963 };

igi_status igi_glb_full(const igi_glb *g)
{
    return igi_fail(g->ctx, IGI_E_SYSTEM, "scene.glb: memory ran out, or a name is not UTF-8");
}

igi_status igi_glb_add_view(igi_glb *g, size_t size, int target, size_t *offset, int *view)
{
    size_t padded = (size + 3) & ~(size_t)3;
    uint8_t *grown = igi_grow(g->ctx, g->bytes, &g->capacity, g->size + padded, 1);
    if (!grown) return IGI_E_SYSTEM;
    g->bytes = grown;
    memset(g->bytes + g->size, 0, padded);
    *offset = g->size;
    *view = (int)json_array_size(g->views);
    json_t *o = json_pack("{s:i, s:I, s:I}", "buffer", 0, "byteOffset", (json_int_t)g->size,
                          "byteLength", (json_int_t)size);
    if (target) json_object_set_new(o, "target", json_integer(target));
    g->size += padded;
    return json_array_append_new(g->views, o) ? igi_glb_full(g) : IGI_OK;
}

static igi_status add_accessor(igi_glb *g, int view, int type, const char *shape, size_t count,
                               int *accessor)
{
    *accessor = (int)json_array_size(g->accessors);
    json_t *o = json_pack("{s:i, s:i, s:I, s:s}", "bufferView", view, "componentType", type,
                          "count", (json_int_t)count, "type", shape);
    return json_array_append_new(g->accessors, o) ? igi_glb_full(g) : IGI_OK;
}

/* Positions need their bounds. */
static igi_status add_positions(igi_glb *g, const float *points, size_t count, int *accessor)
{
    size_t offset;
    int view;
    float low[3] = {FLT_MAX, FLT_MAX, FLT_MAX}, high[3] = {-FLT_MAX, -FLT_MAX, -FLT_MAX};
    IGI_TRY(igi_glb_add_view(g, count * 3 * sizeof *points, VERTICES, &offset, &view));
    memcpy(g->bytes + offset, points, count * 3 * sizeof *points);
    for (size_t i = 0; i < 3 * count; i++) {
        low[i % 3] = fminf(low[i % 3], points[i]);
        high[i % 3] = fmaxf(high[i % 3], points[i]);
    }
    IGI_TRY(add_accessor(g, view, FLOATS, "VEC3", count, accessor));
    json_t *o = json_array_get(g->accessors, (size_t)*accessor);
    int bad = json_object_set_new(
        o, "min", json_pack("[f,f,f]", (double)low[0], (double)low[1], (double)low[2]));
    bad |= json_object_set_new(
        o, "max", json_pack("[f,f,f]", (double)high[0], (double)high[1], (double)high[2]));
    return bad ? igi_glb_full(g) : IGI_OK;
}

static size_t count_triangles(const igi_mesh *mesh, size_t region)
{
    size_t count = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++) count += mesh->regions[t] == region;
    return count;
}

/* Vertices are shared where there is no texture. */
static igi_status add_shared(igi_glb *g, size_t region, size_t triangles, json_t *primitive)
{
    const igi_mesh *mesh = &g->scene->mesh;
    size_t offset;
    int view, accessor;
    if (g->positions < 0)
        IGI_TRY(add_positions(g, mesh->positions, mesh->vertex_count, &g->positions));
    IGI_TRY(igi_glb_add_view(g, triangles * 3 * sizeof(uint32_t), INDICES, &offset, &view));
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        if (mesh->regions[t] != region) continue;
        memcpy(g->bytes + offset, mesh->triangles + 3 * t, 3 * sizeof(uint32_t));
        offset += 3 * sizeof(uint32_t);
    }
    IGI_TRY(add_accessor(g, view, UINTS, "SCALAR", 3 * triangles, &accessor));
    json_object_set_new(primitive, "indices", json_integer(accessor));
    return json_object_set_new(primitive, "attributes",
                               json_pack("{s:i}", "POSITION", g->positions))
               ? igi_glb_full(g)
               : IGI_OK;
}

/* Texture coordinates belong to corners, so a textured region has vertices of its own. */
static igi_status add_textured(igi_glb *g, size_t region, size_t triangles, json_t *primitive)
{
    const igi_mesh *mesh = &g->scene->mesh;
    igi_status status = IGI_OK;
    float *points = NULL;
    size_t offset, corner = 0;
    int view, position, uv;
    IGI_TRY_GOTO(IGI_ALLOC(g->ctx, triangles * 9, &points));
    IGI_TRY_GOTO(igi_glb_add_view(g, triangles * 6 * sizeof(float), VERTICES, &offset, &view));
    for (size_t i = 0; i < 3 * mesh->triangle_count; i++) {
        if (mesh->regions[i / 3] != region) continue;
        float coordinates[2] = {mesh->uvs[2 * i], 1 - mesh->uvs[2 * i + 1]};
        memcpy(g->bytes + offset, coordinates, sizeof coordinates);
        offset += sizeof coordinates;
        memcpy(points + 3 * corner++, mesh->positions + 3 * (size_t)mesh->triangles[i],
               3 * sizeof(float));
    }
    IGI_TRY_GOTO(add_accessor(g, view, FLOATS, "VEC2", corner, &uv));
    IGI_TRY_GOTO(add_positions(g, points, corner, &position));
    if (json_object_set_new(primitive, "attributes",
                            json_pack("{s:i, s:i}", "POSITION", position, "TEXCOORD_0", uv)))
        IGI_TRY_GOTO(igi_glb_full(g));
cleanup:
    igi_free(points);
    return status;
}

igi_status igi_glb_add_primitive(igi_glb *g, size_t region, bool textured, json_t **primitive)
{
    size_t triangles = count_triangles(&g->scene->mesh, region);
    *primitive = NULL;
    if (triangles == 0) return IGI_OK;
    *primitive = json_object();
    igi_status status = textured ? add_textured(g, region, triangles, *primitive)
                                 : add_shared(g, region, triangles, *primitive);
    if (status == IGI_OK) return IGI_OK;
    json_decref(*primitive);
    *primitive = NULL;
    return status;
}
