/* SPDX-License-Identifier: Apache-2.0
 *
 * A bracket while it is being merged; bracket.c leads, neighbours.c compares, judge.c says what is wrong with it.
 */
#ifndef IGI_SRC_HDR_BRACKET_PRIVATE_H
#define IGI_SRC_HDR_BRACKET_PRIVATE_H

#include "hdr/hdr_private.h"

#include <string.h>

typedef struct ordered {
    const igi_exposure *exposure;
    double h;
    size_t given; /* its place in the caller's order */
} ordered;

typedef struct job {
    const igi_merge_options *options;
    const igi_exposure *exposures; /* as given */
    ordered *frames;
    igi_bracket bracket;
    igi_photo *longest;     /* exposure, after the first pass */
    igi_response *response; /* NULL until known */
    bool fitted;
    bool guessed;         /* the response is sRGB's for want of another photograph */
    bool taken_as_linear; /* codes of 16 bits that no raw file was developed to */
    double brightest;     /* code of all, a part of the range */
} job;

/* The first pass: fills the bracket but for its response, where that is to be recovered. */
IGI_MUST_USE igi_status igi_hdr_compare_exposures(igi_context *ctx, job *j);

/* The i-th photograph and the one before must not be one picture. */
IGI_MUST_USE igi_status igi_hdr_refuse_twins(igi_context *ctx, const job *j, size_t i,
                                             const igi_photo *before, const igi_photo *photo);
/* Refuses brackets without light, or with too much everywhere; notes a guessed response. */
IGI_MUST_USE igi_status igi_hdr_judge_light(igi_context *ctx, const job *j, char **warning);
/* Refuses false lists; puts EXIF's ratio in the place of one that a camera's processing shows. */
IGI_MUST_USE igi_status igi_hdr_judge_exposures(igi_context *ctx, job *j, char **warning);

#endif
