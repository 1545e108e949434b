/* SPDX-License-Identifier: Apache-2.0
 *
 * Photographs that something is wrong with: found, named, and kept from doing harm.
 */
#ifndef IGI_SRC_OBSERVE_FAULTS_H
#define IGI_SRC_OBSERVE_FAULTS_H

#include "observe/agreement.h"

typedef struct igi_frame_fault {
    bool contradicts; /* it shows something else, or part of it does: to be left out */
    bool plainly;     /* and so much of it that no lobe accounts for that */
    double scale;     /* what its radiance is to be multiplied by; 1 where the gain is no fault */
    bool off;         /* its edges clearly lie off the mesh's */
} igi_frame_fault;

typedef struct igi_faults {
    size_t frame_count;
    igi_frame_fault *frames;
    size_t contradicting;
    bool divided;       /* so many contradict that nobody knows who is right: none is left out */
    double gain_spread; /* robust standard deviation of ln gain, */
    bool drifts;        /* and whether it is a fault of all */
    double offset_px;   /* typical distance of a photograph's edges from the mesh's, */
    bool all_off;       /* and whether it is a fault of all */
} igi_faults;

IGI_MUST_USE igi_status igi_faults_find(igi_context *ctx, const igi_observations *observations,
                                        const igi_agreement *agreement, igi_faults **faults);
void igi_faults_destroy(igi_faults *faults);

/* What the photograph shows has no say any more. */
void igi_observations_leave_out(igi_observations *observations, size_t frame);
/* Leaves out photographs, scales them and takes veils off as the faults ask for, with a warning for each. Lamps mirrored in surfaces look like faults of
 * photographs: where lobes are to be looked for, what they may account for waits, and *waits says so. */
IGI_MUST_USE igi_status igi_observations_reconcile(igi_context *ctx, const igi_scene *scene,
                                                   bool lobes_follow,
                                                   igi_observations *observations, bool *waits);
/* The rest, once lobes are known: explained[observations][bands] is the radiance less what they account
 * for. *changed: a photograph was left out or scaled, or a veil taken off. */
IGI_MUST_USE igi_status igi_observations_reconcile_rest(igi_context *ctx, const igi_scene *scene,
                                                        float *explained,
                                                        igi_observations *observations,
                                                        bool *changed);
/* Nothing waits; for who wants to know what was found. */
IGI_MUST_USE igi_status igi_observations_judge(igi_context *ctx, const igi_scene *scene,
                                               igi_observations *observations,
                                               igi_agreement **agreement, igi_faults **faults);

#endif
