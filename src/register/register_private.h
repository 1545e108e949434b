/* SPDX-License-Identifier: Apache-2.0
 *
 * Inside src/register.
 */
#ifndef IGI_SRC_REGISTER_PRIVATE_H
#define IGI_SRC_REGISTER_PRIVATE_H

#include "observe/edge_sites.h"

#include <igi/image.h>
#include <igi/register.h>

/* A change of a camera: turned about its centre by a small rotation vector in its own axes, then
 * moved. Both in units that move the image by about a pixel. */
typedef struct pose_units {
    double turn_rad, move_m;
} pose_units;

void pose_change(const igi_camera *camera, const pose_units *units, const double change[6],
                 igi_camera *changed);
/* Moves the camera so that its edges come together, robustly; expected_px: by how much each of the
 * six numbers is expected to move the picture, before edges tell; sigma_px: of the image's place, a
 * typical standard deviation. IGI_E_NO_ANSWER: the sites do not tell. */
IGI_MUST_USE igi_status pose_refine(igi_context *ctx, const igi_edge_sites *sites,
                                    double expected_px, igi_camera *camera, double *sigma_px);
/* Robust root mean square of the sites' distances from where the camera sees them. */
IGI_MUST_USE igi_status pose_residual(igi_context *ctx, const igi_edge_sites *sites,
                                      const igi_camera *camera, double *rms_px);

/* -2 ln likelihood that the sites gain by the one camera over the other. */
IGI_MUST_USE igi_status pose_gain(igi_context *ctx, const igi_edge_sites *sites,
                                  const igi_camera *before, const igi_camera *after, double *gain);

/* The similarity of all cameras that brings the sites of all frames together. */
IGI_MUST_USE igi_status pose_refine_together(igi_context *ctx, const igi_edge_sites *sites,
                                             igi_scene *scene, igi_similarity *similarity);

#endif
