/* SPDX-License-Identifier: Apache-2.0
 *
 * Polygons into triangles.
 */
#ifndef IGI_SRC_SCENE_POLYGON_H
#define IGI_SRC_SCENE_POLYGON_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

/* Cutting ears takes the cube of the corners, at worst. */
#define IGI_POLYGON_MAX 64

/* True: it is convex, so a fan will do. False: triangles[count - 2] (numbers of corners) are it.
 * 3 <= count <= IGI_POLYGON_MAX; the fronts of the triangles are the polygon's. */
bool igi_polygon_split(const double (*points)[3], size_t count, uint32_t (*triangles)[3]);

#endif
