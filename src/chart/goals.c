/* SPDX-License-Identifier: Apache-2.0
 *
 * What a sweep's file wants ("wanted"), and what came out of it.
 */
#include "chart/trial.h"

#include "base/order.h"

#include <string.h>

#define MOST_SILENT 0.01
#define FEWEST_COVERED 0.9

static const char *const measure_names[] = {"albedo", "cost", "told", "named"};

igi_status chart_goals_read(igi_context *ctx, chart_sweep *s)
{
    static const char *const known[] = {"at", "albedo", "cost", "told", "named"};
    igi_json all = igi_json_member(&s->root, "wanted");
    size_t count = 0;
    if (!all.value) return IGI_OK;
    IGI_TRY(igi_json_array(ctx, &all, &count));
    if (!count) return igi_json_fail(ctx, &all, "is empty");
    IGI_TRY(IGI_ALLOC(ctx, count * CHART_MEASURES, &s->goals));
    for (size_t i = 0; i < count; i++) {
        igi_json one = igi_json_element(&all, i), at = igi_json_member(&one, "at");
        double severity;
        IGI_TRY(igi_json_object(ctx, &one));
        IGI_TRY(igi_json_check_keys(ctx, &one, known, sizeof known / sizeof known[0]));
        IGI_TRY(igi_json_number(ctx, &at, &severity));
        for (int m = 0; m < CHART_MEASURES; m++) {
            igi_json limit = igi_json_member(&one, measure_names[m]);
            chart_goal *goal = &s->goals[s->goal_count];
            if (!limit.value) continue;
            *goal = (chart_goal){.at = severity, .measure = (chart_measure)m};
            IGI_TRY(igi_json_number(ctx, &limit, &goal->limit));
            s->goal_count++;
        }
    }
    return IGI_OK;
}

static bool is_share(chart_measure measure)
{
    return measure == CHART_TOLD || measure == CHART_NAMED;
}

/* Of one case; a refusal says all there is to say, and gives no albedo. */
static double measured(const chart_trial *t, chart_measure measure)
{
    switch (measure) {
    case CHART_ALBEDO: return t->status == IGI_OK ? t->albedo : HUGE_VAL;
    case CHART_COST: return t->status == IGI_OK ? t->albedo - t->unperturbed->albedo : HUGE_VAL;
    case CHART_TOLD:
        return chart_trial_sign(t) || chart_trial_worst(t, CHART_SPECULAR) <= CHART_HALF_INTERVAL;
    case CHART_NAMED: return t->spoilt ? (double)t->named / (double)t->spoilt : 0;
    }
    return HUGE_VAL;
}

/* Over the cases of that severity: a mean of shares, a median of errors. NaN: there is none. */
static double find_goal(const chart_sweep *sweep, const chart_goal *goal,
                        chart_trial *const *trials, size_t trial_count, double *values)
{
    size_t count = 0;
    double sum = 0;
    for (size_t i = 0; i < trial_count; i++) {
        const chart_trial *t = trials[i];
        if (t->sweep != sweep || t->skipped || sweep->severities[t->point] != goal->at) continue;
        values[count] = measured(t, goal->measure);
        sum += values[count++];
    }
    if (count == 0) return (double)NAN;
    return is_share(goal->measure) ? sum / (double)count : igi_median(values, count);
}

static void add_goal(igi_stability *all, double limit, double found, bool at_least, char *what)
{
    igi_stability_goal *goal = &all->goals[all->goal_count++];
    *goal = (igi_stability_goal){.what = what,
                                 .wanted = limit,
                                 .found = found,
                                 .at_least = at_least,
                                 .met = at_least ? found >= limit : found <= limit};
}

static igi_status judge_sweep(igi_context *ctx, const chart_sweep *s, chart_trial *const *trials,
                              size_t trial_count, double *values, igi_stability *all)
{
    static const char *const words[CHART_MEASURES] = {
        "albedo error", "albedo error beyond the unperturbed room's",
        "rho_s within its interval, or flagged", "photographs found by name"};
    for (size_t g = 0; g < s->goal_count; g++) {
        const chart_goal *goal = &s->goals[g];
        double found = find_goal(s, goal, trials, trial_count, values);
        char *what = NULL;
        if (isnan(found)) continue; /* the small edition has fewer severities */
        IGI_TRY(igi_strprintf(ctx, &what, "%s, %s %g%s%s: %s", s->name, s->label, goal->at,
                              s->unit[0] ? " " : "", s->unit, words[goal->measure]));
        add_goal(all, goal->limit, found, is_share(goal->measure), what);
    }
    return IGI_OK;
}

/* Severities before a breakdown, and how many of them hold too few intervals. */
static double uncovered(const igi_stability *all)
{
    size_t points = 0, bad = 0;
    for (size_t i = 0; i < all->sweep_count; i++)
        for (size_t k = 0; k < all->sweeps[i].breakdown; k++) {
            double covered = all->sweeps[i].points[k].covered;
            points += !isnan(covered);
            bad += covered < FEWEST_COVERED;
        }
    return points ? (double)bad / (double)points : 0;
}

igi_status chart_goals_judge(igi_context *ctx, const chart_sweep *sweeps, size_t sweep_count,
                             chart_trial *const *trials, size_t trial_count, igi_stability *all)
{
    igi_status status = IGI_OK;
    double *values = NULL;
    size_t most = 2;
    for (size_t i = 0; i < sweep_count; i++) most += sweeps[i].goal_count;
    IGI_TRY(IGI_ALLOC(ctx, most, &all->goals));
    IGI_TRY(IGI_ALLOC(ctx, trial_count + 1, &values));
    for (size_t i = 0; i < sweep_count; i++)
        IGI_TRY_GOTO(judge_sweep(ctx, &sweeps[i], trials, trial_count, values, all));
    char *what;
    IGI_TRY_GOTO(igi_strdup(ctx, "silent failures, of all cases", &what));
    double silent = all->cases ? (double)all->silent / (double)all->cases : 0;
    add_goal(all, MOST_SILENT, silent, false, what);
    IGI_TRY_GOTO(igi_strdup(
        ctx, "severities before a breakdown that hold less than 90 % of the intervals", &what));
    add_goal(all, 0, uncovered(all), false, what);
cleanup:
    igi_free(values);
    return status;
}
