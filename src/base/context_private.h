/* SPDX-License-Identifier: Apache-2.0
 *
 * The context's fields, for src/base alone.
 */
#ifndef IGI_SRC_BASE_CONTEXT_PRIVATE_H
#define IGI_SRC_BASE_CONTEXT_PRIVATE_H

#include <igi/base.h>
#include <stdatomic.h>

#define IGI_MAX_THREADS 256
#define IGI_MAX_STAGES 64

struct igi_context {
    igi_context_options options;
    char message[1024];
    igi_context *root; /* a worker's context points to the caller's; the caller's to itself */

    /* Of the root alone. */
    atomic_bool cancelled;
    _Atomic uint64_t rays;
    atomic_long allocations_left; /* -1: unlimited */
    igi_stage stages[IGI_MAX_STAGES];
    size_t stage_count;
    bool stage_open;
    double stage_cpu0, stage_wall0, last_report_s;
    uint64_t stage_rays0;
};

#endif
