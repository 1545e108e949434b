/* SPDX-License-Identifier: Apache-2.0
 *
 * From pixels to rays and back.
 */
#ifndef IGI_SRC_SCENE_CAMERA_H
#define IGI_SRC_SCENE_CAMERA_H

#include "base/vec.h"

#include <igi/scene.h>

igi_vec igi_camera_centre(const igi_camera *camera);

/* Unit direction, in the world, of the ray through image point (x,y); a pixel's centre is at
 * (column + .5, row + .5). Distortion is undone. */
igi_vec igi_camera_direction(const igi_camera *camera, double x, double y);

/* The image point of a world point; false when it is not in front of the camera. The point may lie
 * outside the image. */
bool igi_camera_project(const igi_camera *camera, igi_vec point, double *x, double *y);

#endif
