/* SPDX-License-Identifier: Apache-2.0
 *
 * Registration: how far the edges of a photograph lie from the edges of the mesh.
 */
#ifndef IGI_SRC_OBSERVE_EDGES_H
#define IGI_SRC_OBSERVE_EDGES_H

#include "observe/edge_sites.h"

typedef struct igi_registration {
    size_t edges;     /* places where an edge of the photograph was found beside one of the mesh */
    double offset[2]; /* of the photograph from the mesh in the picture's middle, columns and rows,
                         pixels; 0 without edges */
    double offset_error; /* one standard deviation of either */
    double magnified;    /* by how much the photograph is too large, and is turned against the */
    double turned;       /* mesh, in pixels at the picture's corner */
    double corner_error; /* one standard deviation of either */
    double shift, shift_error; /* root mean square over the picture of what all four do */
    double
        residual; /* robust standard deviation of the edges from their places after that, pixels */
} igi_registration;

/* From some of the edges beside which the photograph shows two surfaces alone and their brightness
 * differs clearly. */
IGI_MUST_USE igi_status igi_registration_measure(igi_context *ctx, const igi_scene *scene,
                                                 const igi_tracer *tracer, const igi_camera *camera,
                                                 const igi_image *image, const igi_visible *visible,
                                                 igi_registration *registration);

#endif
