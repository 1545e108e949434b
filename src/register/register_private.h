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

/* Where the sites lie on the average; false: there are too few. */
bool pose_units_of(const igi_edge_sites *sites, const igi_camera *camera, pose_units *units);
/* Of where the photograph shows a site from where the camera projects it, across the edge, pixels; NaN:
 * it does not. */
double pose_distance(const igi_edge_site *site, const igi_camera *camera);

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

/* -2 ln likelihood that the sites gain by the one camera over the other; *spread: robust deviation of
 * their distances, in standard deviations, from the latter. */
IGI_MUST_USE igi_status pose_gain(igi_context *ctx, const igi_edge_sites *sites,
                                  const igi_camera *before, const igi_camera *after, double *gain,
                                  double *spread);

/* The edges of each region by the pose that those of the others ask for: -2 ln likelihood gained by it,
 * and by the pose that all ask for; and the same of those edges alone of which the others tell. */
typedef struct pose_prediction {
    double gain, most, told_gain, told_most;
} pose_prediction;
IGI_MUST_USE igi_status pose_predict(igi_context *ctx, const igi_edge_sites *sites,
                                     const igi_camera *before, double spread, double expected_px,
                                     pose_prediction *prediction);

/* The similarity of all cameras that brings the sites of all frames together. */
IGI_MUST_USE igi_status pose_refine_together(igi_context *ctx, const igi_edge_sites *sites,
                                             igi_scene *scene, igi_similarity *similarity);

#endif
