/* SPDX-License-Identifier: Apache-2.0
 *
 * One case of the stability chart: a room, broken in one way by one severity, recovered.
 */
#ifndef IGI_SRC_CHART_TRIAL_H
#define IGI_SRC_CHART_TRIAL_H

#include "chart/sweep.h"

typedef struct chart_trial {
    /* What to do. */
    const chart_sweep *sweep; /* NULL: the room as it is */
    size_t point;             /* of the sweep */
    const char *base;
    const chart_room *room;
    uint64_t seed;
    double patch_m;                        /* of igi_recover_options */
    const struct chart_trial *unperturbed; /* of the same base and seed */
    /* What came out. */
    bool skipped; /* the sweep does not apply to this room */
    igi_status status;
    char *message; /* when igi refused */
    double albedo, albedo_median, albedo_max, specular, alpha, relit;
    size_t spoilt, named;      /* photographs, and those of them that a warning names */
    chart_interval *intervals; /* [interval_count] */
    size_t interval_count;
    int models, models_right;
    size_t sign_count; /* warnings */
    char **signs;
} chart_trial;

/* Runs it with a context of its own; files of its own go into `work`. */
IGI_MUST_USE igi_status chart_trial_run(igi_context *ctx, const char *work, size_t number,
                                        chart_trial *trial);
void chart_trial_clear(chart_trial *trial);

/* The first warning that the unperturbed case does not give, or why it was refused; NULL: igi said
 * nothing. */
const char *chart_trial_sign(const chart_trial *trial);
/* The largest error over its standard deviation; of `what` alone unless that is NULL. */
double chart_trial_worst(const chart_trial *trial, const char *what);
/* Of its intervals, those that hold the truth. */
size_t chart_trial_covered(const chart_trial *trial);
/* An error above three times the stated interval's half width, and not a word. */
bool chart_trial_is_silent(const chart_trial *trial);

/* What the sweeps want, and whether it is so, into `all`. */
IGI_MUST_USE igi_status chart_goals_judge(igi_context *ctx, const chart_sweep *sweeps,
                                          size_t sweep_count, chart_trial *const *trials,
                                          size_t trial_count, igi_stability *all);

/* cases.csv: a line a trial; intervals.csv: a line for each of their intervals. */
IGI_MUST_USE igi_status chart_trials_save(igi_context *ctx, chart_trial *const *trials,
                                          size_t count, const char *folder);

#endif
