/* SPDX-License-Identifier: Apache-2.0
 *
 * Pictures of the mesh, for the page: what each pixel shows, once, and then in any colours.
 */
#ifndef IGI_SRC_CHECK_VIEW_H
#define IGI_SRC_CHECK_VIEW_H

#include "check/survey.h"

/* Through a photograph's camera; or from a place; or of the whole room from outside, in parallel. */
typedef struct igi_view {
    const igi_survey *survey;
    int width, height;        /* pixels */
    int fine;                 /* rays along either side of a pixel */
    const igi_camera *camera; /* NULL: the vectors below */
    bool parallel;
    igi_vec eye, forward, right, up; /* right and up reach from the middle to the picture's edges */
    bool *cut;     /* [2 patches] sides that rays pass through; NULL: none. The caller's */
    igi_hit *hits; /* [height rays][width rays] */
    bool *lines;   /* likewise: an edge of the mesh */
} igi_view;

/* Which axis is up, by the cameras' own; unit. */
igi_vec igi_survey_up(const igi_survey *survey);
/* Sides from which one sees out of the scene and that no photograph shows: the room's outside. None
 * when the scene is open. */
IGI_MUST_USE igi_status igi_survey_outside(igi_context *ctx, const igi_survey *survey, bool **cut);

/* Sets up a view; igi_view_look fills it. Parallel: along `forward`, all that is photographed. */
void igi_view_of_camera(const igi_survey *survey, const igi_camera *camera, int width,
                        igi_view *view);
void igi_view_from(const igi_survey *survey, igi_vec eye, igi_vec target, int width,
                   igi_view *view);
void igi_view_outside(const igi_survey *survey, igi_vec forward, int width, igi_view *view);
IGI_MUST_USE igi_status igi_view_look(igi_context *ctx, igi_view *view);
void igi_view_clear(igi_view *view);

/* Of the ray in the middle of a pixel; triangle IGI_NO_HIT: nothing. */
const igi_hit *igi_view_hit(const igi_view *view, int x, int y);
/* Where it looks from; of a parallel view: a place far in front. */
igi_vec igi_view_eye(const igi_view *view);
/* Where a point lies in the picture, pixels; false: behind it. */
bool igi_view_project(const igi_view *view, igi_vec point, double *x, double *y);

/* Red, green, blue and coverage of each pixel from a colour for each side: colours[2 patches][3].
 * Lamps are pale yellow. */
IGI_MUST_USE igi_status igi_view_paint(igi_context *ctx, const igi_view *view,
                                       const uint8_t *colours, uint8_t **pixels);

#endif
