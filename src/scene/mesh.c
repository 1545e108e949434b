/* SPDX-License-Identifier: Apache-2.0 */
#include "scene/mesh.h"

#include "scene/mesh_builder.h"
#include "scene/scene_notes.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

#define MAX_MESH_BYTES ((size_t)2 << 30)
#define FARTHEST 2000.0f /* from the origin, in sizes of the mesh */

static igi_status check_indices(const igi_mesh_builder *b)
{
    for (size_t i = 0; i < b->face_count; i++) {
        const igi_face *f = &b->faces[i];
        if (f->region >= b->region_count)
            return igi_fail(b->ctx, IGI_E_INTERNAL, "%s: a face without a region", b->file);
        for (int k = 0; k < 3; k++) {
            if (f->vertex[k] >= b->vertex_count)
                return igi_mesh_builder_fail(b, f->line,
                                             "a face names vertex %u, but there are only %zu",
                                             (unsigned)f->vertex[k] + 1, b->vertex_count);
            if (f->uv[k] != IGI_NO_UV && f->uv[k] >= b->uv_count)
                return igi_mesh_builder_fail(
                    b, f->line, "a face names texture coordinate %u, but there are only %zu",
                    (unsigned)f->uv[k] + 1, b->uv_count);
        }
    }
    return IGI_OK;
}

/* Twice the area of a triangle; *longest: the square of its longest side. */
static double double_area(const float *positions, const uint32_t *vertex, double *longest_side)
{
    double e[3][3], longest = 0;
    for (int k = 0; k < 3; k++) {
        const float *p = positions + 3 * (size_t)vertex[k];
        const float *q = positions + 3 * (size_t)vertex[(k + 1) % 3];
        double squared = 0;
        for (int i = 0; i < 3; i++) {
            e[k][i] = (double)q[i] - (double)p[i];
            squared += e[k][i] * e[k][i];
        }
        longest = fmax(longest, squared);
    }
    double c[3] = {e[0][1] * e[1][2] - e[0][2] * e[1][1], e[0][2] * e[1][0] - e[0][0] * e[1][2],
                   e[0][0] * e[1][1] - e[0][1] * e[1][0]};
    *longest_side = longest;
    return sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]);
}

/* No area as far as floats can tell: lower than 1e-7 of its longest side. */
static bool has_area(const igi_mesh_builder *b, const igi_face *f)
{
    double longest, area = double_area(b->positions, f->vertex, &longest);
    return area > 1e-7 * longest;
}

static igi_status drop_degenerate(igi_mesh_builder *b, igi_scene *scene)
{
    size_t kept = 0, dropped = 0;
    uint32_t first_line = 0;
    for (size_t i = 0; i < b->face_count; i++) {
        if (has_area(b, &b->faces[i])) b->faces[kept++] = b->faces[i];
        else if (dropped++ == 0) first_line = b->faces[i].line;
    }
    b->face_count = kept;
    if (kept == 0)
        return igi_mesh_builder_fail(b, 0,
                                     dropped ? "no triangle has any area; mend the mesh"
                                             : "no triangles; the mesh needs faces");
    if (dropped == 0) return IGI_OK;
    char place[32] = "";
    if (first_line) snprintf(place, sizeof place, ":%u", (unsigned)first_line);
    return igi_scene_warn(b->ctx, scene, "%s%s: %zu triangle%s without area left out%s", b->file,
                          place, dropped, dropped == 1 ? "" : "s",
                          dropped > 1 && first_line ? ", this the first" : "");
}

static void take_uvs(const igi_mesh_builder *b, igi_scene *scene, size_t triangle)
{
    const igi_face *f = &b->faces[triangle];
    igi_region *region = &scene->regions[scene->mesh.regions[triangle]];
    float(*uv)[2] = (float(*)[2])(scene->mesh.uvs + 6 * triangle);
    bool all = true;
    for (int k = 0; k < 3; k++) {
        if (f->uv[k] == IGI_NO_UV) all = false;
        else memcpy(uv[k], b->uvs + 2 * (size_t)f->uv[k], sizeof uv[k]);
    }
    if (!all) region->has_uvs = false;
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 2; i++) /* a rounded 0 or 1 is inside */
            if (uv[k][i] < -1e-4f || uv[k][i] > 1.0001f) region->uvs_wrap = true;
}

/* A triangle whose texture coordinates are collapsed to a line or a point has one colour along it: that is
 * a texture as well, as long as most of the region's area has more. */
static igi_status check_uvs(const igi_mesh_builder *b, igi_scene *scene)
{
    const igi_mesh *mesh = &scene->mesh;
    double *spread; /* [regions] area whose coordinates are spread out, less that of the others */
    IGI_TRY(IGI_ALLOC(b->ctx, scene->region_count, &spread));
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        double side, area = double_area(mesh->positions, mesh->triangles + 3 * t, &side);
        const float *uv = mesh->uvs + 6 * t;
        float uv_area = (uv[2] - uv[0]) * (uv[5] - uv[1]) - (uv[3] - uv[1]) * (uv[4] - uv[0]);
        spread[mesh->regions[t]] += uv_area != 0 ? area : -area;
    }
    for (size_t r = 0; r < scene->region_count; r++) scene->regions[r].has_uvs &= spread[r] > 0;
    igi_free(spread);
    return IGI_OK;
}

/* Regions in the order in which triangles name them; those without a triangle vanish. */
static igi_status take_regions(igi_mesh_builder *b, igi_scene *scene)
{
    uint32_t *number;
    IGI_TRY(IGI_ALLOC(b->ctx, b->region_count, &number));
    igi_status status = IGI_OK;
    IGI_TRY_GOTO(IGI_ALLOC(b->ctx, b->region_count, &scene->regions));
    for (size_t i = 0; i < b->face_count; i++) {
        uint32_t region = b->faces[i].region;
        if (number[region] == 0) {
            scene->regions[scene->region_count] = (igi_region){
                .name = b->regions[region], .textured = IGI_AUTO, .has_uvs = b->uv_count > 0};
            b->regions[region] = NULL;
            number[region] = (uint32_t)++scene->region_count;
        }
        scene->mesh.regions[i] = number[region] - 1;
    }
cleanup:
    igi_free(number);
    return status;
}

igi_box igi_mesh_box(const igi_mesh *mesh)
{
    igi_box box = igi_box_empty();
    for (size_t i = 0; i < 3 * mesh->triangle_count; i++)
        igi_box_add(&box, igi_v_of(mesh->positions + 3 * (size_t)mesh->triangles[i]));
    return box;
}

static float largest(igi_vec v)
{
    return fmaxf(v.x, fmaxf(v.y, v.z));
}

/* Coordinates are kept in 32 bits: far from the origin, as surveys have them, too coarse for a room. */
static igi_status check_place(igi_mesh_builder *b, const igi_mesh *mesh)
{
    igi_box box = igi_mesh_box(mesh);
    float far = fmaxf(largest(box.high), largest(igi_scale(box.low, -1)));
    float size = largest(igi_box_sides(&box));
    if (far < FARTHEST * size) return IGI_OK;
    return igi_mesh_builder_fail(
        b, 0,
        "the mesh is %.3g m large and lies %.3g m from the origin, too far "
        "for 32-bit coordinates; take (%.0f, %.0f, %.0f) from the places of "
        "mesh, cameras and lights",
        (double)size, (double)far, (double)box.low.x, (double)box.low.y, (double)box.low.z);
}

static igi_status make_mesh(igi_mesh_builder *b, igi_scene *scene)
{
    IGI_TRY(check_indices(b));
    IGI_TRY(drop_degenerate(b, scene));
    igi_mesh *mesh = &scene->mesh;
    mesh->vertex_count = b->vertex_count;
    mesh->positions = b->positions;
    b->positions = NULL;
    mesh->triangle_count = b->face_count;
    IGI_TRY(IGI_ALLOC(b->ctx, 3 * b->face_count, &mesh->triangles));
    IGI_TRY(IGI_ALLOC(b->ctx, b->face_count, &mesh->regions));
    if (b->uv_count) IGI_TRY(IGI_ALLOC(b->ctx, 6 * b->face_count, &mesh->uvs));
    IGI_TRY(take_regions(b, scene));
    for (size_t i = 0; i < b->face_count; i++) {
        memcpy(mesh->triangles + 3 * i, b->faces[i].vertex, sizeof b->faces[i].vertex);
        if (mesh->uvs) take_uvs(b, scene, i);
    }
    IGI_TRY(check_place(b, mesh));
    return mesh->uvs ? check_uvs(b, scene) : IGI_OK;
}

igi_status igi_mesh_load(igi_context *ctx, igi_scene *scene, const char *path)
{
    igi_mesh_builder builder = igi_mesh_builder_make(ctx, path);
    igi_text text = {0};
    igi_status status = IGI_OK;
    if (igi_ends_with(path, ".obj")) {
        IGI_TRY_GOTO(igi_text_load(ctx, path, MAX_MESH_BYTES, &text));
        IGI_TRY_GOTO(igi_obj_read(&builder, &text));
    } else {
        IGI_TRY_GOTO(igi_assimp_read(&builder));
    }
    status = make_mesh(&builder, scene);
cleanup:
    igi_free(text.bytes);
    igi_mesh_builder_clear(&builder);
    return status;
}
