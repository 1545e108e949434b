/* SPDX-License-Identifier: Apache-2.0
 *
 * What the files of the stability chart's whole share: what is to be run, and what becomes of it.
 */
#ifndef IGI_SRC_CHART_STABILITY_H
#define IGI_SRC_CHART_STABILITY_H

#include "chart/trial.h"

typedef struct chart_study {
    igi_context *ctx;
    const igi_chart_options *options;
    const char *rooms_folder, *work;
    size_t sweep_count;
    chart_sweep *sweeps;
    size_t room_count, room_capacity;
    chart_room **rooms;
    size_t trial_count, trial_capacity;
    chart_trial **trials; /* the unperturbed ones before those that need them */
} chart_study;

/* Sweeps, rooms and trials of the options. */
IGI_MUST_USE igi_status chart_study_plan(chart_study *study);
/* Each severity over its trials; the sweeps' goals. */
IGI_MUST_USE igi_status chart_study_sum(const chart_study *study, igi_stability **result);

#endif
