/* SPDX-License-Identifier: Apache-2.0
 *
 * One way to use threads: a loop over numbered tasks.
 */
#ifndef IGI_SRC_BASE_PARALLEL_H
#define IGI_SRC_BASE_PARALLEL_H

#include "base/context.h"

/* Does task `index`. `ctx` is the worker's own: failures and rays go there. `worker` is in
 * [0, igi_threads(ctx)), for scratch memory that each worker has once. What a task computes may
 * depend on its index, never on its worker: that is what makes results equal for any number of
 * threads. Sums over tasks are added afterwards in the order of tasks. */
typedef igi_status (*igi_task_fn)(igi_context *ctx, void *user, size_t index, int worker);

/* Runs tasks 0..count-1 and reports progress of the running stage. When tasks fail, the sentence
 * of the one with the lowest index stands. */
IGI_MUST_USE igi_status igi_parallel_for(igi_context *ctx, size_t count, igi_task_fn task,
                                         void *user);

#endif
