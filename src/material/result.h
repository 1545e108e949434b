/* SPDX-License-Identifier: Apache-2.0
 *
 * What relighting and export start from.
 */
#ifndef IGI_SRC_MATERIAL_RESULT_H
#define IGI_SRC_MATERIAL_RESULT_H

#include "base/context.h"

#include <igi/material.h>

/* The mesh and the materials of a folder that recovery wrote, or of a scene's truth: one material a
 * region, in the scene's order; emitters are marked, area lights name the scene's regions. The scene
 * has neither lights nor frames. */
IGI_MUST_USE igi_status igi_result_load(igi_context *ctx, const char *folder, igi_scene **scene,
                                        igi_materials **materials);

/* The cameras that it was recovered from, where they still lie where manifest.json says, or beside a
 * truth; else *path is NULL. */
IGI_MUST_USE igi_status igi_result_cameras(igi_context *ctx, const char *folder, char **path);

/* Adds the mesh of a file, in the scene's coordinates, to both; what its regions are made of stands in
 * the MTL of an OBJ (insert.c), else they are grey. */
IGI_MUST_USE igi_status igi_result_insert(igi_context *ctx, igi_scene *scene,
                                          igi_materials *materials, const char *path);
/* Changes materials as a file says: { "regions": { NAME: .. } } with any of materials.json's keys
 * "model", "albedo", "albedo_map", "specular", "specular_rgb" and "alpha". */
IGI_MUST_USE igi_status igi_materials_edit(igi_context *ctx, igi_materials *materials,
                                           const char *path);

#endif
