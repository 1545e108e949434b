/* SPDX-License-Identifier: Apache-2.0
 *
 * One case of a chart: a scene is recovered and compared with its truth.
 */
#ifndef IGI_SRC_CHART_CASE_H
#define IGI_SRC_CHART_CASE_H

#include "base/context.h"

#include <igi/chart.h>

#define CHART_HALF_INTERVAL 1.96 /* of a normal distribution's 95 %, in standard deviations */

#define CHART_SPECULAR "rho_s"

/* What a result states with a standard deviation, and the truth. */
typedef struct chart_interval {
    char region[64], what[24]; /* "albedo 0".., CHART_SPECULAR, "alpha" */
    double got, want, std;
} chart_interval;

/* How many standard deviations it is off. */
double chart_interval_sigmas(const chart_interval *interval);

/* Errors are relative, as igi_validation's; NaN where they do not apply. */
typedef struct chart_case {
    igi_status status;          /* of the recovery: that igi refuses a scene is a result */
    char message[512];          /* its sentence, when it refused */
    igi_materials *materials;   /* what was found; NULL when it refused */
    igi_validation *validation; /* likewise */
    chart_interval *intervals;  /* [interval_count] of judged albedos, rho_s and alpha */
    size_t interval_count, interval_capacity;
    double cpu_s;              /* of the whole process while the case ran */
    size_t photographs;        /* that were read */
    uint64_t rays, peak_bytes; /* peak: of the process so far */
} chart_case;

/* A context of one thread for a part of the work; it hears when the user wants `ctx` to stop. */
IGI_MUST_USE igi_status chart_own_context(igi_context *ctx, uint64_t seed, igi_context **own);

/* Recovers with a context of its own (one thread, its own streams by `seed`), so that many cases
 * can run at once. Fails only when memory ends or the user interrupts. */
IGI_MUST_USE igi_status chart_case_recover(igi_context *ctx, const igi_scene *scene,
                                           const igi_recover_options *options, uint64_t seed,
                                           chart_case *result);
/* Compares what was found with truth; nothing to do where the scene was refused. */
IGI_MUST_USE igi_status chart_case_judge(igi_context *ctx, const igi_materials *truth,
                                         chart_case *c);
/* Both. */
IGI_MUST_USE igi_status chart_case_run(igi_context *ctx, const igi_scene *scene,
                                       const igi_materials *truth,
                                       const igi_recover_options *options, uint64_t seed,
                                       chart_case *result);
void chart_case_clear(chart_case *c);

#endif
