/* SPDX-License-Identifier: Apache-2.0
 *
 * Cameras that are off their places, put right before anything rests on them.
 */
#ifndef IGI_SRC_RECOVER_POSES_H
#define IGI_SRC_RECOVER_POSES_H

#include "observe/observations.h"

#include <igi/recover.h>

typedef struct igi_poses {
    igi_scene scene; /* with the cameras as they were found; all else is that of the given one */
    igi_registered *registered;
} igi_poses;

/* Where the edges of the photographs lie clearly off the mesh's (or `when` is always), registers the
 * cameras, and observes anew, with a warning that says so. *poses stays NULL where nothing was
 * changed; the given scene must outlive it. */
IGI_MUST_USE igi_status igi_poses_mend(igi_context *ctx, const igi_scene *scene,
                                       const igi_tracer *tracer, igi_registering when,
                                       igi_observations **observations, igi_poses **poses);
/* Gives back the cameras whose edges did not come clearly nearer: where `all` seemed off, all of them by
 * what all edges did together, else each by its own. */
void igi_poses_keep_unconvincing(const igi_scene *given, bool all, igi_poses *poses);
void igi_poses_destroy(igi_poses *poses);

#endif
