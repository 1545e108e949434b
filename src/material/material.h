/* SPDX-License-Identifier: Apache-2.0
 *
 * What the files of src/material share.
 */
#ifndef IGI_SRC_MATERIAL_MATERIAL_H
#define IGI_SRC_MATERIAL_MATERIAL_H

#include "base/context.h"

#include <igi/material.h>

/* How scene.json and materials.json call a kind of light and its value. */
const char *igi_light_type_name(igi_light_type type);
bool igi_light_type_from_name(const char *name, igi_light_type *type);
/* "radiance", "intensity", "irradiance" or "scale". */
const char *igi_light_value_key(igi_light_type type);
/* A light as materials.json has it, its value in watts; `std` may be NULL. NULL: no memory, or a name
 * that is not UTF-8. */
struct json_t;
struct json_t *igi_light_json(const igi_light *light, const double *std, int bands,
                              const igi_scene *scene);

/* A file name for a region: what is unfit (separators, control characters, a leading dot, %) is
 * written %XX, so that two regions never share a file. Names beyond 160 bytes are cut and end in
 * a hash. *name is the caller's. */
IGI_MUST_USE igi_status igi_region_file_name(igi_context *ctx, const char *region, char **name);

/* Frees what a material holds, not itself. */
void igi_material_clear(igi_material *material);

#endif
