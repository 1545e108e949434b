/* SPDX-License-Identifier: Apache-2.0
 *
 * A camera of a COLMAP model without its images.
 */
#ifndef IGI_SRC_SCENE_COLMAP_CAMERA_H
#define IGI_SRC_SCENE_COLMAP_CAMERA_H

#include "base/context.h"

#include <igi/scene.h>

/* The first camera of a cameras.txt or cameras.bin; it has no pose. */
IGI_MUST_USE igi_status igi_colmap_read_camera(igi_context *ctx, const char *path,
                                               igi_camera *camera);

#endif
