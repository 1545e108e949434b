/* SPDX-License-Identifier: Apache-2.0
 *
 * Inside src/register.
 */
#ifndef IGI_SRC_REGISTER_PRIVATE_H
#define IGI_SRC_REGISTER_PRIVATE_H

#include "lens/photographs.h"
#include "observe/alignment.h"
#include "observe/edge_sites.h"

#include <igi/image.h>
#include <igi/register.h>

/* A change of a camera: turned about its centre by a small rotation vector in its own axes, then
 * moved. Both in units that move the image by about a pixel. */
typedef struct pose_units {
    double turn_rad, move_m;
} pose_units;

/* Fewer sites leave a camera where it was. */
#define POSE_FEWEST_SITES 12

/* The same for all cameras at once, about a point. */
typedef struct shared_units {
    pose_units pose;
    igi_vec pivot;
} shared_units;

/* Turn, move, and the logarithm of the scale, about the pivot. */
void similarity_of(const shared_units *units, const double change[7], igi_similarity *similarity);
void similarity_move(const igi_similarity *similarity, igi_camera *camera);
/* `similarity`, then `then`, in place of the former. */
void similarity_compose(const igi_similarity *then, igi_similarity *similarity);
/* Columns and rows added to the principal point; pixels by which the picture's corner moves out. */
void lens_change(const double change[3], igi_camera *camera);

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

/* What is moved: one camera (six numbers), all by a similarity (seven), or all by their lens (three). */
typedef enum pose_kind { POSE_OF_ONE, POSE_OF_ALL, POSE_OF_LENS } pose_kind;

typedef struct pose_shared {
    pose_kind kind;
    double change[7];
    igi_similarity similarity; /* of POSE_OF_ALL */
    double criterion;          /* Bayes' */
} pose_shared;

/* The change of all cameras that brings the sites of all frames together. */
IGI_MUST_USE igi_status pose_refine_shared(igi_context *ctx, const igi_edge_sites *sites,
                                           const igi_scene *scene, pose_kind kind,
                                           pose_shared *shared);

/* The criterion of cameras that move each by itself. */
IGI_MUST_USE igi_status pose_criterion_each(igi_context *ctx, const igi_edge_sites *sites,
                                            const igi_scene *scene, double *criterion);

/* ---- the parts of igi_register ---- */

/* A camera before, and what its edges say (judge.c). */
typedef struct camera_evidence {
    igi_camera start;
    igi_edge_sites sites; /* as found from there */
    double spread;        /* of their distances once it is moved, standard deviations */
    double gain, most;    /* pose_prediction */
} camera_evidence;

typedef struct register_job {
    igi_scene *scene;
    const igi_tracer *tracer;
    const igi_photographs *photographs;
    const igi_register_options *options;
    const bool *which; /* [frame_count] the cameras that may move; NULL: all */
    igi_registered *out;
    igi_edge_sites *sites; /* [frame_count] for what is done together */
    igi_camera *given;     /* [frame_count] */
    bool measured;
    igi_registration *registrations; /* [frame_count] */
    igi_alignment alignment;
    camera_evidence *evidence; /* [frame_count] */
} register_job;

IGI_MUST_USE igi_status register_load(igi_context *ctx, const register_job *job, size_t frame,
                                      igi_image **photo);
IGI_MUST_USE igi_status register_find_sites(igi_context *ctx, const register_job *job,
                                            const igi_camera *camera, const igi_image *photo,
                                            double reach, igi_edge_sites *sites);
/* All cameras by one similarity: they share an error. */
IGI_MUST_USE igi_status register_together(igi_context *ctx, register_job *job);
/* What all pictures share, where they do. */
IGI_MUST_USE igi_status register_shared(igi_context *ctx, register_job *job);
/* One camera; a task of igi_parallel_for. */
IGI_MUST_USE igi_status register_frame(igi_context *ctx, void *job, size_t frame, int worker);
/* Is it the mesh that is off, rather than cameras? Then they stay where they were. */
IGI_MUST_USE igi_status register_judge(igi_context *ctx, register_job *job);

#endif
