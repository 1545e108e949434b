/* SPDX-License-Identifier: Apache-2.0
 *
 * The picture of a small lamp: the share of each pixel that it covers.
 */
#ifndef IGI_SRC_OBSERVE_LAMP_PICTURE_H
#define IGI_SRC_OBSERVE_LAMP_PICTURE_H

#include "trace/trace.h"

#define IGI_LAMP_MARGIN 1 /* pixels around it that its light may reach, by lens and filter */
#define IGI_LAMP_MOST 48  /* pixels across: a larger lamp has some that show it alone */
#define IGI_LAMP_WINDOW (IGI_LAMP_MOST + 2 * IGI_LAMP_MARGIN + 2)

typedef struct igi_lamp_picture {
    int window[2][2]; /* first and end columns, rows, of it and its margin */
    double area_px;
    double profile; /* mean over it: how many times its light's value it shows */
    double covered[IGI_LAMP_WINDOW][IGI_LAMP_WINDOW]; /* [row][column] of the window: 0..1 */
} igi_lamp_picture;

/* Of a lamp of the mesh. False where it is hidden in part, reaches beyond the border, or is too large. */
bool igi_lamp_picture_find(const igi_scene *scene, const igi_tracer *tracer,
                           const igi_camera *camera, const igi_light *light,
                           igi_lamp_picture *picture);

#endif
