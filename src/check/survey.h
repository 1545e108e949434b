/* SPDX-License-Identifier: Apache-2.0
 *
 * What the photographs show of the mesh, and what the shown parts see of it.
 */
#ifndef IGI_SRC_CHECK_SURVEY_H
#define IGI_SRC_CHECK_SURVEY_H

#include "light/light.h"
#include "observe/observations.h"
#include "transport/patches.h"

#include <igi/check.h>

typedef struct igi_survey {
    const igi_scene *scene;
    const igi_tracer *tracer;
    const igi_observations *observations;
    igi_patches *patches;
    igi_light *lights; /* [light_count] the scene's; an area light that is seen has a value */
    igi_lighting *lighting;
    uint32_t *seen;  /* [2 patches] pixels of a side */
    float *radiance; /* [2 patches][bands] their mean */
    uint8_t *views;  /* [2 patches] photographs that show a side; 255: so many or more */
    float *cosine;   /* [2 patches] of the view nearest its normal; 0: none */
} igi_survey;

IGI_MUST_USE igi_status igi_survey_create(igi_context *ctx, const igi_scene *scene,
                                          const igi_tracer *tracer,
                                          const igi_observations *observations, igi_survey *survey);
void igi_survey_clear(igi_survey *survey);

/* Mean radiance that the photographs show of the front of a lamp; false: they show nothing of it. */
bool igi_survey_lamp(const igi_survey *survey, int region, double radiance[IGI_MAX_BANDS]);
/* Area, observed share, views; with rays: what is unseen or escapes, and a first albedo. */
IGI_MUST_USE igi_status igi_survey_regions(igi_context *ctx, igi_survey *survey, igi_check *check);
/* Which photographs show each side, and how near its normal the best one is. */
IGI_MUST_USE igi_status igi_survey_coverage(igi_context *ctx, igi_survey *survey);
/* A (place, photograph) pair each: angles of view, highlights predicted and seen. */
IGI_MUST_USE igi_status igi_survey_views(igi_context *ctx, const igi_survey *survey,
                                         igi_check *check);

/* Would a mirror at this point show a lamp to the eye? The normal is on the eye's side. */
bool igi_survey_mirrors_lamp(const igi_survey *survey, igi_vec eye, igi_vec point, igi_vec normal);

/* Where to take another photograph from. Places are reachable: in line with what a camera saw. */
typedef struct igi_advice {
    double gain; /* share of the area in question that it would show; 0: no place was found */
    igi_vec eye, target;
} igi_advice;

/* To show what no photograph shows of a region (of all: -1). */
IGI_MUST_USE igi_status igi_advise_unseen(igi_context *ctx, const igi_survey *survey, int region,
                                          igi_advice *advice);
/* To show a highlight of a region. */
IGI_MUST_USE igi_status igi_advise_highlight(igi_context *ctx, const igi_survey *survey, int region,
                                             igi_advice *advice);

#endif
