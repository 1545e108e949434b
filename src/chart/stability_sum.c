/* SPDX-License-Identifier: Apache-2.0
 *
 * Each severity, summed up over its trials. A sweep breaks down at the first severity whose median
 * error of albedo is above three times that of the unperturbed rooms and above one per cent.
 */
#include "chart/stability.h"

#include "base/order.h"

#include <string.h>

#define WORSE 3.0
#define TOO_WRONG 0.01

/* The median of a field over the trials of a point that have it. */
static double median_of(const chart_study *s, const chart_sweep *sweep, size_t point, size_t field,
                        double *values)
{
    size_t count = 0;
    for (size_t i = 0; i < s->trial_count; i++) {
        const chart_trial *t = s->trials[i];
        double x;
        memcpy(&x, (const char *)t + field, sizeof x);
        if (t->sweep == sweep && t->point == point && !t->skipped && !isnan(x)) values[count++] = x;
    }
    return igi_median(values, count);
}

/* The error above which a sweep has broken down. */
static double too_wrong(const chart_study *s, const chart_sweep *sweep, double *values)
{
    size_t count = 0;
    for (size_t i = 0; i < s->trial_count; i++) {
        const chart_trial *t = s->trials[i];
        if (t->sweep == sweep && !isnan(t->unperturbed->albedo))
            values[count++] = t->unperturbed->albedo;
    }
    double usual = count ? igi_median(values, count) : 0;
    return fmax(TOO_WRONG, WORSE * usual);
}

static void sum_up(const chart_study *s, const chart_sweep *sweep, size_t point, double *values,
                   igi_sweep_point *p)
{
    size_t intervals = 0, covered = 0;
    p->severity = sweep ? sweep->severities[point] : 0;
    for (size_t i = 0; i < s->trial_count; i++) {
        const chart_trial *t = s->trials[i];
        if (t->sweep != sweep || t->point != point || t->skipped) continue;
        p->cases++;
        p->refused += t->status != IGI_OK;
        p->flagged += chart_trial_sign(t) != NULL;
        p->silent += chart_trial_is_silent(t);
        intervals += t->interval_count;
        covered += chart_trial_covered(t);
    }
    p->albedo = median_of(s, sweep, point, offsetof(chart_trial, albedo), values);
    p->albedo_max = median_of(s, sweep, point, offsetof(chart_trial, albedo_max), values);
    p->specular = median_of(s, sweep, point, offsetof(chart_trial, specular), values);
    p->alpha = median_of(s, sweep, point, offsetof(chart_trial, alpha), values);
    p->relit = median_of(s, sweep, point, offsetof(chart_trial, relit), values);
    p->covered = intervals ? (double)covered / (double)intervals : (double)NAN;
}

/* A NULL sweep: the rooms as they are. */
static igi_status sum_up_sweep(const chart_study *s, const chart_sweep *sweep, double *values,
                               igi_sweep_result *r)
{
    igi_context *ctx = s->ctx;
    IGI_TRY(igi_strdup(ctx, sweep ? sweep->name : "unperturbed", &r->name));
    IGI_TRY(igi_strdup(ctx, sweep ? sweep->about : "the rooms as they are", &r->about));
    IGI_TRY(igi_strdup(ctx, sweep ? sweep->subject : "", &r->subject));
    IGI_TRY(igi_strdup(ctx, sweep ? sweep->label : "", &r->label));
    IGI_TRY(igi_strdup(ctx, sweep ? sweep->unit : "", &r->unit));
    r->point_count = sweep ? sweep->severity_count : 1;
    IGI_TRY(IGI_ALLOC(ctx, r->point_count, &r->points));
    for (size_t p = 0; p < r->point_count; p++) sum_up(s, sweep, p, values, &r->points[p]);
    r->breakdown = r->point_count;
    double limit = sweep ? too_wrong(s, sweep, values) : HUGE_VAL;
    for (size_t p = r->point_count; p-- > 0;) {
        const igi_sweep_point *at = &r->points[p];
        if (at->albedo > limit || (at->cases && at->refused == at->cases)) r->breakdown = p;
    }
    return IGI_OK;
}

igi_status chart_study_sum(const chart_study *s, igi_stability **result)
{
    double *values = NULL;
    igi_stability *all = NULL;
    igi_status status = IGI_OK;
    IGI_TRY_GOTO(IGI_ALLOC(s->ctx, s->trial_count, &values));
    IGI_TRY_GOTO(IGI_ALLOC(s->ctx, 1, &all));
    IGI_TRY_GOTO(IGI_ALLOC(s->ctx, s->sweep_count + 1, &all->sweeps));
    for (size_t i = 0; i <= s->sweep_count; i++) {
        igi_sweep_result *r = &all->sweeps[all->sweep_count++];
        IGI_TRY_GOTO(sum_up_sweep(s, i ? &s->sweeps[i - 1] : NULL, values, r));
        for (size_t p = 0; p < r->point_count; p++) {
            all->cases += r->points[p].cases;
            all->silent += r->points[p].silent;
        }
    }
    IGI_TRY_GOTO(
        chart_goals_judge(s->ctx, s->sweeps, s->sweep_count, s->trials, s->trial_count, all));
    *result = all;
    all = NULL;
cleanup:
    igi_free(values);
    igi_stability_destroy(all);
    return status;
}

void igi_stability_destroy(igi_stability *stability)
{
    if (!stability) return;
    for (size_t i = 0; stability->sweeps && i < stability->sweep_count; i++) {
        igi_sweep_result *s = &stability->sweeps[i];
        igi_free(s->name);
        igi_free(s->about);
        igi_free(s->subject);
        igi_free(s->label);
        igi_free(s->unit);
        igi_free(s->points);
    }
    for (size_t i = 0; i < stability->goal_count; i++) igi_free(stability->goals[i].what);
    igi_free(stability->goals);
    igi_free(stability->sweeps);
    igi_free(stability);
}
