/* SPDX-License-Identifier: Apache-2.0
 *
 * The parts of scene.json that describe lights and regions.
 */
#ifndef IGI_SRC_SCENE_PARTS_H
#define IGI_SRC_SCENE_PARTS_H

#include "scene/json.h"

#include <igi/scene.h>

/* Reads an array of lights; scene->regions and scene->bands must be there. *lights is NULL or the
 * caller's, also after a failure. */
IGI_MUST_USE igi_status igi_lights_read(igi_context *ctx, const igi_json *array,
                                        const igi_scene *scene, igi_light **lights, size_t *count);

/* Sets what "regions" says of the mesh's regions. */
IGI_MUST_USE igi_status igi_regions_read(igi_context *ctx, const igi_json *object,
                                         igi_scene *scene);

#endif
