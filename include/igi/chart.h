/* SPDX-License-Identifier: Apache-2.0
 *
 * Charts: speed against accuracy, errors against parameters, stability where assumptions fail.
 */
#ifndef IGI_CHART_H
#define IGI_CHART_H

#include <igi/report.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct igi_chart_options {
    size_t struct_size;
    size_t scene_count;        /* 0: the standard ones */
    const char *const *scenes; /* [scene_count] speed: scene folders with truth/, or specs of igi
                                * synth; stability: specs, in place of those the sweeps name */
    const char *datasets;      /* folder of specs; its sweeps/ holds the sweeps; default
                           * "datasets-synthetic" */
    size_t sweep_count;        /* stability: 0: every file of sweeps/ */
    const char *const *sweeps; /* [sweep_count] names, or paths of files */
    const char *cache;         /* where rendered scenes are kept; NULL: nowhere */
    int seeds;                 /* stability: how many; 0: as the sweeps say */
    bool small;                /* the edition of the tests: less of everything */
    const char *peer;          /* speed: curves of other programs, CSV; NULL: none */
    bool relit;                /* speed: relight each result, too; needs relit/lights.json */
} igi_chart_options;

IGI_API void igi_chart_options_init(igi_chart_options *options);

/* One severity of one sweep, over its seeds and rooms. Errors are relative, as igi_validate's;
 * a median over cases; NaN where it does not apply. */
typedef struct igi_sweep_point {
    double severity;
    size_t cases, refused; /* refused: igi stopped with a sentence */
    size_t flagged;        /* a warning that the unperturbed run does not give, or a refusal */
    size_t silent;         /* an error above three times the stated bound, and not flagged */
    double albedo, albedo_max, specular, alpha, relit;
    double covered; /* share of errors within the stated 95 % interval */
} igi_sweep_point;

typedef struct igi_sweep_result {
    char *name, *about, *subject, *label, *unit; /* subject: what is at fault, or "" */
    size_t point_count;
    igi_sweep_point *points; /* [point_count] in the order of the file */
    size_t breakdown;        /* first point that is too wrong; point_count: none is */
} igi_sweep_result;

/* A number that a sweep's file, or the chart as a whole, wants to be reached. */
typedef struct igi_stability_goal {
    char *what;
    double wanted, found;
    bool at_least; /* wanted: or more; else: or less */
    bool met;
} igi_stability_goal;

typedef struct igi_stability {
    size_t sweep_count;
    igi_sweep_result *sweeps;
    size_t cases, silent;
    size_t goal_count;
    igi_stability_goal *goals;
} igi_stability;

/* Runs the sweeps and writes into the existing folder: cases.csv (a line a case), intervals.csv (a line
 * for each number that a case states with a standard deviation), stability.csv (a line a severity),
 * wanted.csv (the goals), stability.svg and .png (small multiples). No times in them: same input and
 * seed, same bytes. */
IGI_API IGI_MUST_USE igi_status igi_chart_stability(igi_context *context,
                                                    const igi_chart_options *options,
                                                    const char *folder, igi_stability **result);
IGI_API void igi_stability_destroy(igi_stability *stability);

/* Every method with a ladder of budgets on each scene: errors against CPU seconds, rays and memory.
 * Writes into the existing folder
 *   speed.csv, .gp (for gnuplot), .svg, .png   a line a method and budget
 *   parsimony.csv, .gp, .svg, .png             error against the number of a result's parameters
 *   reach.csv, peers.csv                       when an error is reached, by igi and by peers.
 * The same input and seed give the same bytes, but for speed.csv's last columns (cpu_s, ratio,
 * peak_mb, front) and for times in reach.csv. Without gnuplot nothing is drawn, with a warning. */
IGI_API IGI_MUST_USE igi_status igi_chart_speed(igi_context *context,
                                                const igi_chart_options *options,
                                                const char *folder);

/* The second line of these alone: each scene is recovered without lobes, as evidence asks, and with a
 * map on every region; each result is then made simpler, its maps coarser. */
IGI_API IGI_MUST_USE igi_status igi_chart_parsimony(igi_context *context,
                                                    const igi_chart_options *options,
                                                    const char *folder);

#ifdef __cplusplus
}
#endif
#endif
