/* SPDX-License-Identifier: Apache-2.0
 *
 * A light's strength in lumens, candela or lux, and its colour by temperature or spectrum.
 */
#ifndef IGI_SRC_SCENE_LIGHT_UNITS_H
#define IGI_SRC_SCENE_LIGHT_UNITS_H

#include "scene/json.h"

#include <igi/scene.h>

#define IGI_LIGHT_UNIT_KEYS 8

/* The keys that a kind of light may have in place of its value, NULLs behind the last. */
const char *const *igi_light_unit_keys(igi_light_type type);

/* Fills light->value when the object says its strength photometrically, and says so in light->known;
 * `value_key` may not be there beside it. Kind and places of the light must be there. */
IGI_MUST_USE igi_status igi_light_read_units(igi_context *ctx, const igi_json *at,
                                             const igi_scene *scene, const char *value_key,
                                             igi_light *light);

/* A volume that emits "emission", W m^-3 sr^-1, and lets its own light pass, as the lamp that its
 * surface is: light->value becomes radiance. The region must be closed. */
IGI_MUST_USE igi_status igi_light_spread_volume(igi_context *ctx, const igi_json *at,
                                                const igi_scene *scene, igi_light *light);

#endif
