/* SPDX-License-Identifier: Apache-2.0
 *
 * Pictures of a scene under light that recovery never saw: the true one, once, and what results make
 * of it. The same paths go to both, so that their noise mostly cancels.
 */
#ifndef IGI_SRC_CHART_RELIT_H
#define IGI_SRC_CHART_RELIT_H

#include "base/context.h"

#include <igi/chart.h>

typedef struct chart_relit {
    const igi_scene *scene;
    const igi_light *lights;
    size_t light_count;
    igi_camera camera;
    int samples;     /* paths a pixel */
    igi_image *want; /* by the true materials */
    igi_scene *own_scene;
    igi_light *own_lights; /* where it loaded them itself */
} chart_relit;

/* The first view of a scene folder's relit/. Without one, `want` stays NULL, and there are no errors. */
IGI_MUST_USE igi_status chart_relit_load(igi_context *ctx, const char *folder, int samples,
                                         chart_relit *relit);
/* Renders `want`; all else is the caller's. */
IGI_MUST_USE igi_status chart_relit_begin(igi_context *ctx, const igi_materials *truth,
                                          chart_relit *relit);
/* The mean over pixels and bands of |got - want|, over the mean of want; NaN where there is no
 * `want`, or a region of the scene is not in `got`. */
IGI_MUST_USE igi_status chart_relit_error(igi_context *ctx, const chart_relit *relit,
                                          const igi_materials *got, double *error);
void chart_relit_clear(chart_relit *relit);

#endif
