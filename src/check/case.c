/* SPDX-License-Identifier: Apache-2.0 */
#include "check/case.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>

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
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    a->verdict = verdict;
    a->number = number;
    if (verdict > c->check->verdict) c->check->verdict = verdict;
    return igi_strdup(c->ctx, text, &a->finding);
}

igi_status igi_case_remedy(const igi_case *c, igi_assumption *a, const igi_advice *advice,
                           const char *format, ...)
{
    char text[512];
    va_list arguments;
    va_start(arguments, format);
    vsnprintf(text, sizeof text, format, arguments);
    va_end(arguments);
    if (!advice || !(advice->gain > 0)) return igi_strdup(c->ctx, text, &a->remedy);
    const igi_vec e = advice->eye, t = advice->target;
    a->has_view = true;
    const float eye[3] = {e.x, e.y, e.z}, target[3] = {t.x, t.y, t.z};
    for (int k = 0; k < 3; k++) {
        a->eye[k] = (double)eye[k];
        a->target[k] = (double)target[k];
    }
    return igi_strprintf(
        c->ctx, &a->remedy,
        "add a photograph from about (%.2f %.2f %.2f) looking at (%.2f %.2f %.2f): "
        "%s",
        (double)e.x, (double)e.y, (double)e.z, (double)t.x, (double)t.y, (double)t.z, text);
}
