/* SPDX-License-Identifier: Apache-2.0
 *
 * The case that igi check makes: what was looked at, and what is found to hold or not.
 */
#ifndef IGI_SRC_CHECK_CASE_H
#define IGI_SRC_CHECK_CASE_H

#include "check/survey.h"
#include "observe/faults.h"

enum { IGI_ASSUMPTIONS = 12 };

typedef struct igi_case {
    igi_context *ctx;
    const igi_scene *scene;
    const igi_survey *survey;
    const igi_agreement *agreement;
    const igi_faults *faults;
    igi_check *check;
} igi_case;

/* Adds an assumption that holds; what follows may make it worse. */
igi_assumption *igi_case_add(const igi_case *c, const char *name);
/* Its sentence. */
IGI_MUST_USE igi_status igi_case_find(const igi_case *c, igi_assumption *a, igi_verdict verdict,
                                      double number, const char *format, ...) IGI_PRINTF(5, 6);
/* Its remedy; with advice that helps, the photograph to take is named. */
IGI_MUST_USE igi_status igi_case_remedy(const igi_case *c, igi_assumption *a,
                                        const igi_advice *advice, const char *format, ...)
    IGI_PRINTF(4, 5);

#endif
