/* SPDX-License-Identifier: Apache-2.0
 *
 * Registration: how far the edges of a photograph lie from the edges of the mesh.
 */
#ifndef IGI_SRC_OBSERVE_EDGES_H
#define IGI_SRC_OBSERVE_EDGES_H

#include "observe/visible.h"

#include <igi/image.h>

typedef struct igi_registration {
    size_t edges; /* places where an edge of the photograph was found beside one of the mesh */
    double
        offset[2]; /* of the photograph from the mesh, columns and rows, pixels; 0 without edges */
    double offset_error; /* one standard deviation of either */
    double residual;     /* median distance of an edge from its place after that shift, pixels; of a
                        perfect camera about .2, from pixels being squares */
} igi_registration;

/* Edges between two regions, with a few pixels of one on either side, whose brightness differs
 * clearly. `bands` channels of the image count. */
IGI_MUST_USE igi_status igi_registration_measure(igi_context *ctx, const igi_scene *scene,
                                                 const igi_image *image, const igi_visible *visible,
                                                 double pixel_rad, igi_registration *registration);

#endif
