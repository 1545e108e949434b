/* SPDX-License-Identifier: Apache-2.0
 *
 * Registration from what recovery has measured already.
 */
#ifndef IGI_SRC_REGISTER_REGISTER_H
#define IGI_SRC_REGISTER_REGISTER_H

#include "observe/edges.h"

#include <igi/register.h>

typedef struct igi_register_start {
    const igi_tracer *tracer; /* of the scene's mesh */
    const igi_registration
        *registrations; /* [frame_count] as the cameras are; NULL: not measured */
    const bool
        *which; /* [frame_count] the cameras that may move; NULL: all. The others are taken to be
                          right: nothing is shared then, and nothing is said of the mesh */
} igi_register_start;

IGI_MUST_USE igi_status igi_register_from(igi_context *ctx, igi_scene *scene,
                                          const igi_register_start *start,
                                          const igi_register_options *options,
                                          igi_registered **registered);

#endif
