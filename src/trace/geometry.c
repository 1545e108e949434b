/* SPDX-License-Identifier: Apache-2.0
 *
 * Points, normals and areas on triangles.
 */
#include "trace/trace.h"

static igi_vec corner(const igi_mesh *mesh, uint32_t triangle, int k)
{
    return igi_v_of(mesh->positions +
                    3 * (size_t)mesh->triangles[3 * (size_t)triangle + (size_t)k]);
}

static igi_vec doubled_normal(const igi_mesh *mesh, uint32_t triangle)
{
    igi_vec a = corner(mesh, triangle, 0);
    return igi_cross(igi_sub(corner(mesh, triangle, 1), a), igi_sub(corner(mesh, triangle, 2), a));
}

igi_vec igi_triangle_point(const igi_mesh *mesh, uint32_t triangle, float u, float v)
{
    igi_vec p = igi_scale(corner(mesh, triangle, 0), 1 - u - v);
    p = igi_madd(p, corner(mesh, triangle, 1), u);
    return igi_madd(p, corner(mesh, triangle, 2), v);
}

igi_vec igi_triangle_normal(const igi_mesh *mesh, uint32_t triangle)
{
    return igi_normalize(doubled_normal(mesh, triangle));
}

float igi_triangle_area(const igi_mesh *mesh, uint32_t triangle)
{
    return 0.5f * igi_length(doubled_normal(mesh, triangle));
}

void igi_triangle_uv(const igi_mesh *mesh, uint32_t triangle, float u, float v, float uv[2])
{
    const float *t = mesh->uvs + 6 * (size_t)triangle;
    for (int k = 0; k < 2; k++) uv[k] = (1 - u - v) * t[k] + u * t[2 + k] + v * t[4 + k];
}
