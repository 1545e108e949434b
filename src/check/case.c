/* SPDX-License-Identifier: Apache-2.0 */
#include "check/case.h"

#include <math.h>
#include <stdarg.h>
#include <string.h>

const char *igi_verdict_name(igi_verdict verdict)
{
    return verdict == IGI_HOLDS ? "holds" : verdict == IGI_DOUBTFUL ? "doubtful" : "fails";
}

igi_assumption *igi_case_add(const igi_case *c, const char *name)
{
    igi_assumption *a = &c->check->assumptions[c->check->assumption_count++];
    *a = (igi_assumption){.name = name, .number = (double)NAN, .region = -1, .frame = -1};
    return a;
}

igi_status igi_case_find(const igi_case *c, igi_assumption *a, igi_verdict verdict, double number,
                         const char *format, ...)
{
    va_list arguments;
    a->verdict = verdict;
    a->number = number;
    if (verdict > c->check->verdict) c->check->verdict = verdict;
    va_start(arguments, format);
    igi_status status = igi_vstrprintf(c->ctx, &a->finding, format, arguments);
    va_end(arguments);
    return status;
}

/* The remedy so far becomes the reason why a photograph from there is to be taken. */
static igi_status add_photograph(const igi_case *c, igi_assumption *a, const igi_advice *advice)
{
    const double eye[3] = {(double)advice->eye.x, (double)advice->eye.y, (double)advice->eye.z};
    const double target[3] = {(double)advice->target.x, (double)advice->target.y,
                              (double)advice->target.z};
    char *why = a->remedy;
    a->has_view = true;
    memcpy(a->eye, eye, sizeof eye);
    memcpy(a->target, target, sizeof target);
    igi_status status = igi_strprintf(
        c->ctx, &a->remedy,
        "add a photograph from about (%.2f, %.2f, %.2f) m looking at (%.2f, %.2f, %.2f) m: %s",
        eye[0], eye[1], eye[2], target[0], target[1], target[2], why);
    igi_free(why);
    return status;
}

igi_status igi_case_remedy(const igi_case *c, igi_assumption *a, const igi_advice *advice,
                           const char *format, ...)
{
    va_list arguments;
    va_start(arguments, format);
    igi_status status = igi_vstrprintf(c->ctx, &a->remedy, format, arguments);
    va_end(arguments);
    if (status != IGI_OK || !advice || !(advice->gain > 0)) return status;
    return add_photograph(c, a, advice);
}
