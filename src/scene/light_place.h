/* SPDX-License-Identifier: Apache-2.0
 *
 * Where a light of scene.json stands, how well that is known, and which way it shines.
 */
#ifndef IGI_SRC_SCENE_LIGHT_PLACE_H
#define IGI_SRC_SCENE_LIGHT_PLACE_H

#include "scene/json.h"

#include <igi/scene.h>

/* What a kind of light has of it, to be added up. */
typedef enum igi_light_place_key {
    IGI_PLACE_POSITION = 1,
    IGI_PLACE_FROM_TO = 2,
    IGI_PLACE_DIRECTION = 4,
    IGI_PLACE_CONE = 8
} igi_light_place_key;

#define IGI_LIGHT_PLACE_KEYS 7

/* The keys of these, into names[IGI_LIGHT_PLACE_KEYS]; how many there are. */
size_t igi_light_place_keys(unsigned keys, const char **names);

/* Reads them: position or ends, position_std, unit direction, half angles in degrees. */
IGI_MUST_USE igi_status igi_light_read_place(igi_context *ctx, const igi_json *at, unsigned keys,
                                             igi_light *light);

#endif
