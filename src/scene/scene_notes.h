/* SPDX-License-Identifier: Apache-2.0
 *
 * What reading a scene leaves behind beside the scene: sentences of warning, and which files it read.
 */
#ifndef IGI_SRC_SCENE_SCENE_NOTES_H
#define IGI_SRC_SCENE_SCENE_NOTES_H

#include <igi/scene.h>

/* Keeps the sentence in the scene and hands it to the log. */
IGI_MUST_USE igi_status igi_scene_warn(igi_context *ctx, igi_scene *scene, const char *format, ...)
    IGI_PRINTF(3, 4);
/* Adds to scene->files what was read. */
IGI_MUST_USE igi_status igi_scene_note_file(igi_context *ctx, igi_scene *scene, const char *path);

#endif
