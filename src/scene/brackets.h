/* SPDX-License-Identifier: Apache-2.0
 *
 * brackets.json: which exposures make which image (include/FORMATS.md).
 */
#ifndef IGI_SRC_SCENE_BRACKETS_H
#define IGI_SRC_SCENE_BRACKETS_H

#include "scene/json.h"

#include <igi/scene.h>

/* Gives every frame of the scene its exposures, and notes their files in scene->files. The files
 * exist, each belongs to one frame, and all state the same (an f-number or none, an ISO or none),
 * so that all images share one unit. */
IGI_MUST_USE igi_status igi_brackets_read(igi_context *ctx, const char *path, igi_scene *scene);

#endif
