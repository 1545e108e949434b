/* SPDX-License-Identifier: Apache-2.0 */
#ifndef IGI_SRC_SCENE_MESH_H
#define IGI_SRC_SCENE_MESH_H

#include "base/box.h"

#include <igi/scene.h>

/* Reads the file into scene->mesh and scene->regions (in the order in which triangles name them).
 * Triangles without area are left out, with a warning. */
IGI_MUST_USE igi_status igi_mesh_load(igi_context *ctx, igi_scene *scene, const char *path);

/* Around what triangles use: a vertex without a triangle is nowhere. */
igi_box igi_mesh_box(const igi_mesh *mesh);

#endif
