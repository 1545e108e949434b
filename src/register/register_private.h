/* SPDX-License-Identifier: Apache-2.0
 *
 * Inside src/register.
 */
#ifndef IGI_SRC_REGISTER_PRIVATE_H
#define IGI_SRC_REGISTER_PRIVATE_H

#include "observe/visible.h"

#include <igi/image.h>
#include <igi/register.h>

/* A place where an edge of the mesh was found in the photograph, too. */
typedef struct edge_site {
    igi_vec point;    /* of the nearer surface, metres */
    double seen[2];   /* where the photograph shows it, pixels */
    double normal[2]; /* unit, across the edge */
    double offset;    /* of `seen` from where the mesh has it, along the normal */
    double sigma;     /* of the offset, pixels */
} edge_site;

typedef struct edge_sites {
    edge_site *sites;
    size_t count, capacity;
} edge_sites;

/* Finds edges that lie at most `reach` pixels off. Adds to `sites`. */
IGI_MUST_USE igi_status edge_sites_find(igi_context *ctx, const igi_scene *scene,
                                        const igi_tracer *tracer, const igi_camera *camera,
                                        const igi_image *photo, double reach, edge_sites *sites);

/* Where along a row of brightness y[count], one number a pixel, the step lies that is expected at
 * `expected` (pixels from the row's beginning; pixel 0 covers [0,1)), at most `reach` off; `slope`:
 * columns a row by which the edge leans. False: there is no clear step. */
bool edge_profile_measure(const double *y, int count, double expected, double reach, double slope,
                          double *place, double *sigma);

/* A change of a camera: turned about its centre by a small rotation vector in its own axes, then
 * moved. Both in units that move the image by about a pixel. */
typedef struct pose_units {
    double turn_rad, move_m;
} pose_units;

void pose_change(const igi_camera *camera, const pose_units *units, const double change[6],
                 igi_camera *changed);
/* Moves the camera so that its edges come together, robustly; sigma_px: of the image's place, a
 * typical standard deviation. IGI_E_NO_ANSWER: the sites do not tell. */
IGI_MUST_USE igi_status pose_refine(igi_context *ctx, const edge_sites *sites, igi_camera *camera,
                                    double *sigma_px);
/* Robust root mean square of the sites' distances from where the camera sees them. */
IGI_MUST_USE igi_status pose_residual(igi_context *ctx, const edge_sites *sites,
                                      const igi_camera *camera, double *rms_px);

/* The similarity of all cameras that brings the sites of all frames together. */
IGI_MUST_USE igi_status pose_refine_together(igi_context *ctx, const edge_sites *sites,
                                             igi_scene *scene, igi_similarity *similarity);

#endif
