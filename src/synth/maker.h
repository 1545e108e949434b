/* SPDX-License-Identifier: Apache-2.0
 *
 * A scene folder while it is made.
 */
#ifndef IGI_SRC_SYNTH_MAKER_H
#define IGI_SRC_SYNTH_MAKER_H

#include "synth/synth.h"

#include <igi/scene.h>

typedef struct maker {
    igi_context *ctx;
    const char *folder;
    const char *basis; /* of the camera's response, or NULL */
    bool photos;       /* images/ as a camera would have delivered them */
    spec spec;
    igi_scene *scene;
    igi_tracer *tracer;
    size_t *highlight; /* [regions] pixels that show one */
} maker;

/* The lights that are on, and what the progress calls the work. */
typedef struct lit_by {
    const char *stage;
    const igi_light *lights;
    size_t count;
} lit_by;

/* folder/name; the caller's. */
IGI_MUST_USE igi_status maker_path(const maker *m, const char *name, char **path);
IGI_MUST_USE igi_status maker_folder(const maker *m, const char *name);
/* One set of views with its cameras and pictures in `folder` ("" or "NAME/"); *cameras may be asked
 * for. */
IGI_MUST_USE igi_status maker_views(maker *m, const char *folder, const view_set *views,
                                    const lit_by *by, igi_camera **cameras, size_t *camera_count);

#endif
