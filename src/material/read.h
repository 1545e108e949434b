/* SPDX-License-Identifier: Apache-2.0
 *
 * What the readers of materials.json, truth.json and of edits share.
 */
#ifndef IGI_SRC_MATERIAL_READ_H
#define IGI_SRC_MATERIAL_READ_H

#include "material/material.h"

#include <jansson.h>

typedef struct igi_material_reader {
    igi_context *ctx;
    const char *path;   /* of the file, for sentences */
    const char *folder; /* of the maps */
    igi_materials *materials;
} igi_material_reader;

/* IGI_E_DATA: the key of that owner must be what was expected. */
igi_status igi_read_wrong(const igi_material_reader *r, const char *owner, const char *key,
                          const char *expected);
/* Absent leaves *x; null is "not known": infinity. */
IGI_MUST_USE igi_status igi_read_number(const igi_material_reader *r, const char *owner,
                                        const json_t *o, const char *key, double *x);
/* `count` numbers, or one for all. Absent or null leaves x and *present is false. */
IGI_MUST_USE igi_status igi_read_numbers(const igi_material_reader *r, const char *owner,
                                         const json_t *o, const char *key, int count, double *x,
                                         bool *present);
/* Model, specular, alpha. */
IGI_MUST_USE igi_status igi_read_lobe(const igi_material_reader *r, const json_t *o,
                                      igi_material *m);
/* The index of that region, or -1. */
int igi_material_named(const igi_materials *materials, const char *name);

/* An image in the folder: the bands, and A where `extra` is 1. */
IGI_MUST_USE igi_status igi_read_map(const igi_material_reader *r, const char *file, int extra,
                                     igi_image **map);
/* uncertainty/NAME.exr lies beside albedo/NAME.exr; a truth has none. */
IGI_MUST_USE igi_status igi_read_map_std(const igi_material_reader *r, const char *albedo_map,
                                         igi_material *m);
/* A region without texture has a map too, to be looked at; materials.json does not name it. */
IGI_MUST_USE igi_status igi_read_plain_map(const igi_material_reader *r, igi_material *m);

#endif
