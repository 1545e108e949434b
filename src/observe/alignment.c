/* SPDX-License-Identifier: Apache-2.0
 *
 * Limits: where cameras are right, photographs of 320 x 240 pixels are found shifted by .02 to .08 px
 * in the median, by up to .8 where few edges tell; from .3 px on recovery suffers.
 */
#include "observe/alignment.h"

#include "base/order.h"

#include <math.h>

#define KNOWN_PX 0.5 /* error of a shift that counts */
#define FEWEST_KNOWN 3
#define OFF_PX 0.15   /* typical shift, */
#define OFF_RATIO 2.0 /* and so many times what is explained */
#define CUT 5.0       /* standard deviations: one photograph is not all */
#define ALONE_PX 0.5
#define ALONE_SIGMAS 4.0
/* What all share: this many photographs, this much, by errors, and by how the photographs scatter. */
#define FEWEST_SHARING 5
#define SHARED_PX 0.2
#define SHARED_SIGMAS 4.0
#define SHARED_SCATTERS 2.0
/* Median over mean of a square with three or four degrees of freedom. */
#define MEDIAN_OF_SQUARE 0.82

static bool is_known(const igi_registration *r)
{
    return r->edges > 0 && r->shift_error < KNOWN_PX;
}

bool igi_registration_is_off(const igi_registration *r)
{
    return r->edges > 0 && r->shift > ALONE_PX + ALONE_SIGMAS * r->shift_error;
}

typedef struct value {
    double value, error;
} value;

/* A mean of values that scatter more than their errors say: robust, by the median's scatter. *least: what
 * clearly is more than errors and scatter. */
static void find_mean(const value *v, size_t n, double *scratch, value *mean, double *least)
{
    double weights = 0, sum = 0;
    for (size_t i = 0; i < n; i++) scratch[i] = v[i].value;
    double middle = igi_median(scratch, n);
    for (size_t i = 0; i < n; i++) scratch[i] = fabs(v[i].value - middle);
    double scatter = 1.4826 * igi_median(scratch, n);
    for (size_t i = 0; i < n; i++) {
        double w = 1 / (v[i].error * v[i].error + scatter * scatter);
        double off = fabs(v[i].value - middle) * sqrt(w);
        if (off > 2) w *= 2 / off;
        weights += w;
        sum += w * v[i].value;
    }
    *mean = (value){sum / weights, 1 / sqrt(weights)};
    *least = fmax(SHARED_PX, fmax(SHARED_SIGMAS * mean->error, SHARED_SCATTERS * scatter));
    if (n < FEWEST_SHARING) *least = (double)INFINITY;
}

/* *scratch and *values of the photographs' number. */
static void judge(const igi_registration *r, size_t count, double *scratch, value *values,
                  igi_alignment *a)
{
    size_t n = 0;
    double ratio = 0;
    for (size_t i = 0; i < count; i++) {
        if (!is_known(&r[i])) continue;
        double z = r[i].shift / r[i].shift_error;
        ratio += fmin(z * z, CUT * CUT);
        scratch[n++] = r[i].shift * r[i].shift -
                       MEDIAN_OF_SQUARE * r[i].shift_error * r[i].shift_error;
    }
    a->known = n;
    if (n < FEWEST_KNOWN) return;
    a->typical_ratio = ratio / (double)n;
    a->typical_px = sqrt(fmax(0, igi_median(scratch, n)));
    a->all_off = a->typical_px > OFF_PX && a->typical_ratio > OFF_RATIO;
    value means[3];
    double least[3];
    for (int k = 0; k < 3; k++) {
        n = 0;
        for (size_t i = 0; i < count; i++)
            if (is_known(&r[i]))
                values[n++] = (value){k < 2 ? r[i].offset[k] : r[i].magnified,
                                      k < 2 ? r[i].offset_error : r[i].corner_error};
        find_mean(values, n, scratch, &means[k], &least[k]);
    }
    a->shift[0] = means[0].value;
    a->shift[1] = means[1].value;
    a->magnified = means[2].value;
    a->shift_is_shared = hypot(a->shift[0], a->shift[1]) > fmax(least[0], least[1]);
    a->magnified_is_shared = fabs(a->magnified) > least[2];
}

igi_status igi_alignment_judge(igi_context *ctx, const igi_registration *registrations,
                               size_t count, igi_alignment *alignment)
{
    igi_status status = IGI_OK;
    double *scratch = NULL;
    value *values = NULL;
    *alignment = (igi_alignment){0};
    IGI_TRY_GOTO(IGI_ALLOC(ctx, count, &scratch));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, count, &values));
    judge(registrations, count, scratch, values, alignment);
cleanup:
    igi_free(scratch);
    igi_free(values);
    return status;
}
