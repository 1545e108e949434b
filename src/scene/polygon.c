/* SPDX-License-Identifier: Apache-2.0
 *
 * Polygons into triangles: convex ones as a fan around their first corner, others (a floor in the
 * shape of an L, a wall around a door) by cutting off ears, as Meisters' theorem allows.
 */
#include "scene/polygon.h"

#include <math.h>

/* Along the two axes in which the polygon's shadow is largest, so that its area is positive. */
static double project(const double (*p)[3], size_t count, double (*flat)[2])
{
    double normal[3] = {0, 0, 0}; /* Newell's: right for corners that are not quite in a plane */
    for (size_t i = 0; i < count; i++) {
        const double *a = p[i], *b = p[(i + 1) % count];
        for (int k = 0; k < 3; k++) {
            int l = (k + 1) % 3, m = (k + 2) % 3;
            normal[k] += (a[l] - b[l]) * (a[m] + b[m] - 2 * p[0][m]);
        }
    }
    int k = 0;
    if (fabs(normal[1]) > fabs(normal[k])) k = 1;
    if (fabs(normal[2]) > fabs(normal[k])) k = 2;
    int x = (k + 1) % 3, y = (k + 2) % 3;
    for (size_t i = 0; i < count; i++) {
        flat[i][0] = p[i][normal[k] < 0 ? y : x];
        flat[i][1] = p[i][normal[k] < 0 ? x : y];
    }
    return .5 * fabs(normal[k]);
}

/* Twice the area of a triangle, positive if it turns left. */
static double turn(const double a[2], const double b[2], const double c[2])
{
    return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

static bool is_ear(const double (*flat)[2], const uint32_t *left, size_t count, size_t i)
{
    uint32_t at[3] = {left[(i + count - 1) % count], left[i], left[(i + 1) % count]};
    const double *a = flat[at[0]], *b = flat[at[1]], *c = flat[at[2]];
    if (!(turn(a, b, c) > 0)) return false;
    for (size_t k = 0; k < count; k++) {
        const double *p = flat[left[k]];
        if (left[k] == at[0] || left[k] == at[1] || left[k] == at[2]) continue;
        if (turn(a, b, p) >= 0 && turn(b, c, p) >= 0 && turn(c, a, p) >= 0 &&
            !(p[0] == a[0] && p[1] == a[1]) && !(p[0] == c[0] && p[1] == c[1]))
            return false;
    }
    return true;
}

static void cut_ears(const double (*flat)[2], size_t count, uint32_t (*triangles)[3])
{
    uint32_t left[IGI_POLYGON_MAX];
    for (size_t i = 0; i < count; i++) left[i] = (uint32_t)i;
    for (size_t cut = 0; count >= 3; cut++) {
        size_t i = 0;
        while (i < count && !is_ear(flat, left, count, i)) i++;
        if (i == count) i = 1; /* crosses itself, or is a line: any will do */
        triangles[cut][0] = left[(i + count - 1) % count];
        triangles[cut][1] = left[i];
        triangles[cut][2] = left[(i + 1) % count];
        for (count--; i < count; i++) left[i] = left[i + 1];
    }
}

bool igi_polygon_split(const double (*points)[3], size_t count, uint32_t (*triangles)[3])
{
    double flat[IGI_POLYGON_MAX][2];
    double slack = 1e-6 * project(points, count, flat); /* of coordinates with six digits */
    bool convex = true;
    for (size_t i = 0; i < count && convex; i++)
        convex = turn(flat[i], flat[(i + 1) % count], flat[(i + 2) % count]) >= -slack;
    if (!convex) cut_ears((const double(*)[2])flat, count, triangles);
    return convex;
}
