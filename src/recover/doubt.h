/* SPDX-License-Identifier: Apache-2.0
 *
 * What the files of doubts share. Each looks at one assumption and adds its warnings to the
 * materials; what it leaves open below its limit comes back as a relative error.
 */
#ifndef IGI_SRC_RECOVER_DOUBT_H
#define IGI_SRC_RECOVER_DOUBT_H

#include "recover/light_shares.h"

#include <igi/recover.h>

/* Takes the sentence. */
static inline igi_status igi_doubt_say(igi_context *ctx, igi_materials *m, char *sentence)
{
    return igi_add_sentence(ctx, &m->warnings, &m->warning_count, sentence);
}

/* What is sure of a number that should be 0 and is known to within `error`: scatter alone passes for no
 * fault. */
static inline double igi_doubt_sure(double x, double error)
{
    return sqrt(fmax(0, x * x - 4 * error * error));
}

/* Of one side of a region's mesh, m^2. */
double igi_doubt_area(const igi_mesh *mesh, size_t region);

/* Lamps that the photographs show with another radiance than is stated. *off: what may be small
 * errors of their values, the mean over the lamps' light. */
IGI_MUST_USE igi_status igi_doubt_lamps(igi_context *ctx, const igi_problem *p, igi_materials *m,
                                        double *off);
/* Lamps that shine into other directions than their profile says. */
IGI_MUST_USE igi_status igi_doubt_profiles(igi_context *ctx, const igi_problem *p,
                                           igi_materials *m);
/* Lamps whose outline in the photographs is another than the mesh's. *off: of the lamps' light
 * together. */
IGI_MUST_USE igi_status igi_doubt_outlines(igi_context *ctx, const igi_problem *p, igi_materials *m,
                                           double *off);
/* What the error bars of the chosen method do not hold. */
IGI_MUST_USE igi_status igi_doubt_method(igi_context *ctx, const igi_problem *p, igi_materials *m);
/* *off: of the light that reaches surfaces. */
IGI_MUST_USE igi_status igi_doubt_gaps(igi_context *ctx, const igi_problem *p, igi_materials *m,
                                       double *off);
/* Lights whose stated power the surfaces contradict. off[regions]: of the light that reaches each,
 * added to what is there. */
IGI_MUST_USE igi_status igi_doubt_powers(igi_context *ctx, const igi_light_shares *survey,
                                         igi_materials *m, double *off);
/* What a mesh that is off, as edges say, does to the light of each region, likewise. */
IGI_MUST_USE igi_status igi_doubt_shape(igi_context *ctx, const igi_light_shares *survey,
                                        igi_materials *m, double *off);
/* A light that is not in the list, likewise. */
IGI_MUST_USE igi_status igi_doubt_missing(igi_context *ctx, const igi_light_shares *survey,
                                          igi_materials *m, double *off);

#endif
