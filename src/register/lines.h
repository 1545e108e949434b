/* SPDX-License-Identifier: Apache-2.0
 *
 * Edges near where they are: distances are linear in a motion of six numbers, a camera's or a thing's,
 *     d_i(x) = d_i(0) + J_i x.
 */
#ifndef IGI_SRC_REGISTER_LINES_H
#define IGI_SRC_REGISTER_LINES_H

#include "register/register_private.h"

#define MOTION_NUMBERS 6
#define NO_REGION UINT32_MAX

typedef struct edge_line {
    double d, jacobian[MOTION_NUMBERS], weight; /* of a site */
    uint32_t region;
} edge_line;

typedef struct edge_lines {
    edge_line *lines; /* room for as many as are added */
    size_t count;
    double as_one;      /* so many sites count as one */
    double expected_px; /* of each number, before edges tell */
} edge_lines;

/* A thing's motion about a point, in units that move its picture by about a pixel. */
typedef struct thing_units {
    igi_vec centre;
    double turn_rad, move_m;
} thing_units;

/* Adds the sites as the camera moves; unit: weighted distance that is usual. False: none tells. */
bool lines_of_camera(const igi_edge_sites *sites, const igi_camera *camera, double unit,
                     edge_lines *lines);
/* Adds the sites of a region as it moves before the camera. */
void lines_of_thing(const igi_edge_sites *sites, uint32_t region, const igi_camera *camera,
                    double unit, const thing_units *units, edge_lines *lines);

typedef struct motion {
    double x[MOTION_NUMBERS], covariance[MOTION_NUMBERS * MOTION_NUMBERS];
} motion;

/* The motion that brings the edges together, robustly; without those of a region, or NO_REGION. */
bool lines_solve(const edge_lines *lines, uint32_t without, motion *m);
/* Squared distance lost by it, those of outliers cut. */
double line_gain(const edge_line *line, const double x[MOTION_NUMBERS]);

#endif
