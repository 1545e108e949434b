/* SPDX-License-Identifier: Apache-2.0
 *
 * What can be known of the photographs from their headers alone.
 */
#ifndef IGI_SRC_SCENE_PHOTOS_H
#define IGI_SRC_SCENE_PHOTOS_H

#include "scene/file_text.h"

#include <igi/scene.h>

/* They are there, each once, of their camera's size, and all of one number of bands, which becomes
 * the scene's. `cameras` is the file that names them, for the sentence. */
IGI_MUST_USE igi_status igi_photos_check(igi_context *ctx, igi_scene *scene, const char *cameras);

#endif
