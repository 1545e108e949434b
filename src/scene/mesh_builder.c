/* SPDX-License-Identifier: Apache-2.0 */
#include "scene/mesh_builder.h"

#include "scene/json.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

#define MAX_REGIONS ((size_t)65536)

igi_mesh_builder igi_mesh_builder_make(igi_context *ctx, const char *file)
{
    igi_mesh_builder builder = {.ctx = ctx, .file = file};
    return builder;
}

void igi_mesh_builder_clear(igi_mesh_builder *b)
{
    for (size_t i = 0; i < b->region_count; i++) igi_free(b->regions[i]);
    igi_free(b->positions);
    igi_free(b->uvs);
    igi_free(b->faces);
    igi_free(b->regions);
    igi_free(b->slots);
    *b = igi_mesh_builder_make(b->ctx, b->file);
}

igi_status igi_mesh_builder_fail(const igi_mesh_builder *b, uint32_t line, const char *format, ...)
{
    char what[512], place[16] = "";
    va_list args;
    va_start(args, format);
    vsnprintf(what, sizeof what, format, args);
    va_end(args);
    if (line) snprintf(place, sizeof place, "%u:", (unsigned)line);
    return igi_fail(b->ctx, IGI_E_DATA, "%s:%s %s", b->file, place, what);
}

/* Room for one more element of `size` bytes. */
static igi_status grow_one(igi_context *ctx, void **array, size_t *capacity, size_t count,
                           size_t size)
{
    if (*array && count < *capacity) return IGI_OK;
    void *grown = igi_grow(ctx, *array, capacity, count + 1, size);
    if (!grown) return IGI_E_SYSTEM;
    *array = grown;
    return IGI_OK;
}

static igi_status add_floats(igi_context *ctx, float **array, size_t *capacity, size_t *count,
                             const double *values, size_t width)
{
    void *grown = *array;
    IGI_TRY(grow_one(ctx, &grown, capacity, *count, width * sizeof **array));
    *array = grown;
    for (size_t k = 0; k < width; k++) (*array)[*count * width + k] = (float)values[k];
    ++*count;
    return IGI_OK;
}

igi_status igi_mesh_builder_vertex(igi_mesh_builder *b, const double p[3], uint32_t line)
{
    for (int k = 0; k < 3; k++)
        if (!(fabs(p[k]) < 1e30)) /* so that products of three coordinates stay finite in double */
            return igi_mesh_builder_fail(b, line,
                                         "a coordinate is not a finite number; mend the mesh");
    if (b->vertex_count >= IGI_NO_UV - 1)
        return igi_mesh_builder_fail(b, line, "too many vertices");
    return add_floats(b->ctx, &b->positions, &b->vertex_capacity, &b->vertex_count, p, 3);
}

igi_status igi_mesh_builder_uv(igi_mesh_builder *b, const double uv[2], uint32_t line)
{
    if (!(fabs(uv[0]) < 1e30 && fabs(uv[1]) < 1e30))
        return igi_mesh_builder_fail(b, line,
                                     "a texture coordinate is not a finite number; mend the mesh");
    if (b->uv_count >= IGI_NO_UV - 1)
        return igi_mesh_builder_fail(b, line, "too many texture coordinates");
    return add_floats(b->ctx, &b->uvs, &b->uv_capacity, &b->uv_count, uv, 2);
}

igi_status igi_mesh_builder_face(igi_mesh_builder *b, const igi_face *face)
{
    if (b->face_count >= UINT32_MAX - 1)
        return igi_mesh_builder_fail(b, face->line, "too many triangles");
    void *grown = b->faces;
    IGI_TRY(grow_one(b->ctx, &grown, &b->face_capacity, b->face_count, sizeof *b->faces));
    b->faces = grown;
    b->faces[b->face_count++] = *face;
    return IGI_OK;
}

/* FNV-1a */
static uint32_t hash_name(const char *name, size_t length)
{
    uint32_t hash = 2166136261u;
    for (size_t i = 0; i < length; i++) hash = (hash ^ (unsigned char)name[i]) * 16777619u;
    return hash;
}

static uint32_t *find_slot(const igi_mesh_builder *b, const char *name, size_t length)
{
    size_t i = hash_name(name, length) & (b->slot_count - 1);
    for (; b->slots[i]; i = (i + 1) & (b->slot_count - 1)) {
        const char *other = b->regions[b->slots[i] - 1];
        if (strncmp(other, name, length) == 0 && other[length] == 0) break;
    }
    return &b->slots[i];
}

/* Keeps at least half of the slots free. */
static igi_status grow_slots(igi_mesh_builder *b)
{
    if (b->slot_count >= 2 * (b->region_count + 1)) return IGI_OK;
    size_t count = b->slot_count ? 2 * b->slot_count : 64;
    uint32_t *slots;
    IGI_TRY(IGI_ALLOC(b->ctx, count, &slots));
    igi_free(b->slots);
    b->slots = slots;
    b->slot_count = count;
    for (size_t i = 0; i < b->region_count; i++)
        *find_slot(b, b->regions[i], strlen(b->regions[i])) = (uint32_t)i + 1;
    return IGI_OK;
}

igi_status igi_mesh_builder_region(igi_mesh_builder *b, const char *name, size_t length,
                                   uint32_t line, uint32_t *region)
{
    IGI_TRY(grow_slots(b));
    uint32_t *slot = find_slot(b, name, length);
    if (*slot) {
        *region = *slot - 1;
        return IGI_OK;
    }
    if (b->region_count == MAX_REGIONS)
        return igi_mesh_builder_fail(b, line, "more than %zu materials; join some of them",
                                     MAX_REGIONS);
    void *grown = b->regions;
    IGI_TRY(grow_one(b->ctx, &grown, &b->region_capacity, b->region_count, sizeof *b->regions));
    b->regions = grown;
    char *copy;
    IGI_TRY(IGI_ALLOC(b->ctx, length + 1, &copy));
    memcpy(copy, name, length);
    if (strlen(copy) != length || !igi_is_utf8(copy)) {
        igi_free(copy);
        return igi_mesh_builder_fail(b, line, "a material's name is not UTF-8; rename it");
    }
    b->regions[b->region_count++] = copy;
    *slot = (uint32_t)b->region_count;
    *region = *slot - 1;
    return IGI_OK;
}
