/* SPDX-License-Identifier: Apache-2.0
 *
 * Cameras out of files. Frames come with the images' paths; whether the images are there is not
 * looked at, except to complete a name without an ending.
 */
#ifndef IGI_SRC_SCENE_FRAME_H
#define IGI_SRC_SCENE_FRAME_H

#include "scene/file_text.h"

#include <igi/scene.h>

/* Rotation columns of camera_to_world made exactly orthonormal. False when they are not finite, or
 * farther from a uniformly scaled rotation than rounding explains. */
bool igi_frame_orthonormalize(igi_camera *camera);

/* What is wrong with the intrinsics, or NULL. */
const char *igi_camera_fault(const igi_camera *camera);

/* The image that `name` means: itself, or with .exr appended, or with .exr in place of its ending;
 * the first that exists, else itself. */
IGI_MUST_USE igi_status igi_image_path(igi_context *ctx, const char *folder, const char *name,
                                       char **path);

/* The readers; what they leave after a failure, the caller destroys. */
IGI_MUST_USE igi_status igi_transforms_read(igi_context *ctx, const char *path, igi_frame **frames,
                                            size_t *count);
IGI_MUST_USE igi_status igi_colmap_read(igi_context *ctx, const char *folder, igi_frame **frames,
                                        size_t *count);

#endif
