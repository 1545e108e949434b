/* SPDX-License-Identifier: Apache-2.0
 *
 * The whole way once, with the photographs that the caller chose.
 */
#ifndef IGI_SRC_RECOVER_ONCE_H
#define IGI_SRC_RECOVER_ONCE_H

#include "trace/trace.h"

#include <igi/recover.h>

/* What the diffuse solution may state as its error, and what it does. */
typedef struct igi_aim {
    double limit, stated;
} igi_aim;

/* One recovery, from observing on. *recovery stays NULL where the stated error of the diffuse
 * solution is above its limit. Photographs that lobes do not account for are left out, or scaled, and all
 * is solved again. */
IGI_MUST_USE igi_status igi_recover_once(igi_context *ctx, const igi_scene *scene,
                                         const igi_tracer *tracer,
                                         const igi_recover_options *options, igi_aim *wanted,
                                         igi_recovery **recovery);

#endif
