/* SPDX-License-Identifier: Apache-2.0
 *
 * Places where an edge of the mesh was found in a photograph, too.
 */
#ifndef IGI_SRC_OBSERVE_EDGE_SITES_H
#define IGI_SRC_OBSERVE_EDGE_SITES_H

#include "observe/visible.h"

#include <igi/image.h>

typedef struct igi_edge_site {
    igi_vec point;    /* of the nearer surface, metres, */
    uint32_t region;  /* and its region */
    double seen[2];   /* where the photograph shows it, pixels */
    double normal[2]; /* unit, across the edge */
    double offset;    /* of `seen` from where the mesh has it, along the normal */
    double sigma;     /* of the offset, pixels */
    bool corner;      /* two surfaces meet there at less than a half turn (IGI_CORNER_ERROR) */
} igi_edge_site;

typedef struct igi_edge_sites {
    igi_edge_site *sites; /* igi_free frees them */
    size_t count, capacity;
    int step; /* every so many rows and columns of the photograph were looked along */
} igi_edge_sites;

/* Sites along an edge share the errors of what lies beside it: over this share of the picture's
 * height, they are one. */
#define IGI_SITES_AS_ONE .1
/* Beside the noise: meshes are not that exact, and shading is not that linear. pixels */
#define IGI_SITE_ERROR .05
/* Light falls off into a corner, and shadows lie in it: such an edge may be seen off by a pixel as a whole,
 * where the camera is right. This is for the question whether it is; one that is off is placed by its
 * corners, too. */
#define IGI_CORNER_ERROR .4

typedef struct igi_edge_search {
    const igi_scene *scene;
    const igi_tracer *tracer;
    const igi_camera *camera;
    const igi_image *photo;
    const igi_visible *visible; /* what the camera sees */
    double reach;               /* edges lie at most so far off, pixels */
    size_t enough;              /* sites: with more, not every row is looked along */
} igi_edge_search;

/* In place of what `sites` holds. */
IGI_MUST_USE igi_status igi_edge_sites_find(igi_context *ctx, const igi_edge_search *search,
                                            igi_edge_sites *sites);

/* Where along a row of brightness y[count], one number a pixel, the step lies that is expected at
 * `expected` (pixels from the row's beginning; pixel 0 covers [0,1)), at most `reach` off; `slope`:
 * columns a row by which the edge leans. False: there is no clear step. */
bool igi_edge_profile_measure(const double *y, int count, double expected, double reach,
                              double slope, double *place, double *sigma);

#endif
