/* SPDX-License-Identifier: Apache-2.0
 *
 * The fewest photographs, and the coarsest pixels of them, that a wanted accuracy needs: no more is
 * read than that.
 */
#ifndef IGI_SRC_RECOVER_CHOICE_H
#define IGI_SRC_RECOVER_CHOICE_H

#include "trace/trace.h"

typedef struct igi_need {
    double target_error; /* relative, of albedo */
    double sharpness;    /* so many times the pixels that usually do */
    bool highlights;     /* where surfaces mirror lamps counts, too */
} igi_need;

typedef struct igi_choice {
    igi_scene scene; /* the whole one with fewer frames, of fewer pixels; all else is shared */
    bool *read;      /* [frames of the whole scene] */
    int reduce;      /* pixels of a photograph along one of the scene's */
    size_t left_out; /* frames */
} igi_choice;

/* By rays from every camera, before any photograph is read. Both scenes must outlive the choice. */
IGI_MUST_USE igi_status igi_choice_make(igi_context *ctx, const igi_scene *scene,
                                        const igi_tracer *tracer, const igi_need *need,
                                        igi_choice **choice);
void igi_choice_destroy(igi_choice *choice);

/* Which photographs were read, and why those; the caller's. */
IGI_MUST_USE igi_status igi_choice_sentence(igi_context *ctx, const igi_choice *choice,
                                            const igi_scene *whole, char **sentence);

#endif
