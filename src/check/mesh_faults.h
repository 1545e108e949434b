/* SPDX-License-Identifier: Apache-2.0 */
#ifndef IGI_SRC_CHECK_MESH_FAULTS_H
#define IGI_SRC_CHECK_MESH_FAULTS_H

#include "base/context.h"

#include <igi/scene.h>

typedef struct igi_mesh_faults {
    size_t doubled; /* triangles that lie exactly on another one */
    size_t flipped; /* edges whose two triangles of one region face opposite ways */
    size_t first_doubled, first_flipped; /* a triangle of each; SIZE_MAX: none */
} igi_mesh_faults;

/* Corners that are nearer than a millionth of the mesh's size are one. */
IGI_MUST_USE igi_status igi_mesh_faults_find(igi_context *ctx, const igi_mesh *mesh,
                                             igi_mesh_faults *faults);

#endif
