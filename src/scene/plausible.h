/* SPDX-License-Identifier: Apache-2.0
 *
 * Scenes that can be read and cannot be meant.
 */
#ifndef IGI_SRC_SCENE_PLAUSIBLE_H
#define IGI_SRC_SCENE_PLAUSIBLE_H

#include <igi/scene.h>

/* Warns of units that differ, and of a scene without light. */
IGI_MUST_USE igi_status igi_scene_check_plausible(igi_context *ctx, igi_scene *scene);

#endif
