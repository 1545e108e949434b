/* SPDX-License-Identifier: Apache-2.0
 *
 * What every method of recovery starts from, and what it hands on.
 */
#ifndef IGI_SRC_DIFFUSE_PROBLEM_H
#define IGI_SRC_DIFFUSE_PROBLEM_H

#include "observe/observations.h"
#include "transport/gather.h"

#include <igi/recover.h>

/* The photographs on the patches: what was seen of each side of each patch. */
struct igi_lobe_view; /* recover/lobe_view.h */
struct igi_positions; /* diffuse/positions.h */

typedef struct igi_problem {
    const igi_scene *scene;
    const igi_tracer *tracer;
    const igi_observations *observations;
    const igi_patches *patches;
    const igi_recover_options *options;
    igi_lighting *lighting;
    size_t light_count;
    igi_light *lights; /* [light_count] the scene's, with values read from the photographs; an
                          environment counts as one light for each band, dark in the others, since
                          its light falls differently in each */
    size_t *light_of;  /* [light_count] number of the scene's light */
    double (*light_std)[IGI_MAX_BANDS]; /* [light_count] */
    /* [light_count] neither given nor seen by itself: its value is solved for with the albedos, in
     * `lights` and `light_std`, from what was read of it if it is known by then; 0 and not known where
     * it cannot be */
    bool *solved;
    int bands;

    size_t *site_begin; /* [2 patches + 1] observations of a side: order[begin..) */
    uint32_t *order;    /* [observations] */
    float *seen;        /* [2 patches][bands] mean radiance seen of a side; 0 where nothing was */
    const struct igi_positions
        *positions;                    /* what was found of lights' places, or NULL; the caller's */
    const struct igi_lobe_view *lobes; /* what was found of lobes, or NULL; the caller's */
    float *seen_var;                   /* [2 patches] variance of that mean, average of the bands */
} igi_problem;

IGI_MUST_USE igi_status igi_problem_create(igi_context *ctx, const igi_scene *scene,
                                           const igi_tracer *tracer,
                                           const igi_observations *observations,
                                           const igi_patches *patches,
                                           const igi_recover_options *options,
                                           igi_problem **problem);
void igi_problem_destroy(igi_problem *problem);

igi_sites igi_problem_sites(const igi_problem *problem);

static inline size_t igi_problem_seen_count(const igi_problem *p, uint32_t side)
{
    return p->site_begin[side + 1] - p->site_begin[side];
}

/* Side of a frame's pixel on the surface, metres: the root of its footprint's area. */
float igi_footprint(const igi_problem *problem, size_t frame, uint32_t surface, float u, float v);

/* The side of a patch that an observation shows. */
uint32_t igi_problem_side_of(const igi_problem *problem, size_t observation);

/* What lobes add to diffuse transport, to be taken out of it: see specular/correction.h. */
typedef struct igi_correction {
    float *seen;     /* [2 patches][bands] the lobes' part of what was seen of each side */
    float *trust;    /* [2 patches] weight of each side in its region's albedo, 0..1 */
    float *received; /* [rows][bands] irradiance that lobes send beyond the diffuse part */

    size_t *view_begin;   /* [2 patches + 1] the photographs that show a side: views
                             view_begin[side]..., in order; the last may stand for several */
    uint32_t *view_frame; /* [views] */
    /* [2][views][bands] the lobes' part of what it shows that came from no lamp, by either half of the
     * rays; [2][views] and the other part, mean over bands */
    float *surfaces, *lamps;
} igi_correction;

/* What a method finds. */
typedef struct igi_diffuse {
    double (*albedo)[IGI_MAX_BANDS];     /* [regions] */
    double (*albedo_std)[IGI_MAX_BANDS]; /* [regions] one standard deviation, */
    /* [regions] and the part of it that is a pattern, should the region have one: it scatters beyond
     * what places of other regions do. NULL: not told apart */
    double (*pattern_std)[IGI_MAX_BANDS];
    bool *determined; /* [regions] */
    float
        *radiance; /* [2 patches][bands] radiance that leaves each side: what was seen, and what the
                        method solved for; irradiance is gathered from it afterwards */
    igi_rows *rows;        /* the rows that the method gathered with, or NULL: owned */
    const float *received; /* [rows][bands] irradiance that lobes add to the rows', or NULL; the
                              caller's */
    bool ignores_indirect; /* the method knows no light but the lamps' */
    size_t warning_count;
    char **warnings; /* what was not determined, and what would determine it: owned */
} igi_diffuse;

IGI_MUST_USE igi_status igi_diffuse_create(igi_context *ctx, const igi_problem *problem,
                                           igi_diffuse **diffuse);
void igi_diffuse_destroy(igi_diffuse *diffuse);
void igi_diffuse_forget_warnings(igi_diffuse *diffuse);

#endif
