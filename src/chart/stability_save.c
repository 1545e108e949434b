/* SPDX-License-Identifier: Apache-2.0
 *
 * The stability chart's tables on disk.
 */
#include "chart/plot.h"
#include "chart/trial.h"

#include <stdio.h>
#include <string.h>

static void put_number(FILE *file, double x)
{
    if (isfinite(x)) fprintf(file, ",%.6g", x);
    else fputs(",", file);
}

static void put_text(FILE *file, const char *text)
{
    fputs(",\"", file);
    for (; *text; text++) {
        if (*text == '"') fputc('"', file);
        fputc(*text == '\n' ? ' ' : *text, file);
    }
    fputc('"', file);
}

/* The spec's or folder's name. */
static const char *base_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash && slash[1] ? slash + 1 : path;
}

static void put_head(FILE *file, const chart_trial *t)
{
    fprintf(file, "%s,%.6g", t->sweep ? t->sweep->name : "unperturbed",
            t->sweep ? t->sweep->severities[t->point] : 0);
    put_text(file, base_name(t->base));
    fprintf(file, ",%llu", (unsigned long long)t->seed);
}

static void put_trial(FILE *file, const chart_trial *t)
{
    const char *sign = chart_trial_sign(t);
    put_head(file, t);
    fprintf(file, ",%d", (int)t->status);
    put_number(file, t->albedo);
    put_number(file, t->albedo_median);
    put_number(file, t->albedo_max);
    put_number(file, t->specular);
    put_number(file, t->alpha);
    put_number(file, t->relit);
    fprintf(file, ",%d,%d,%zu,%zu,%.4g,%d,%d", t->models_right, t->models, chart_trial_covered(t),
            t->interval_count, chart_trial_worst(t, NULL), sign != NULL, chart_trial_is_silent(t));
    put_text(file, sign ? sign : "");
    fputc('\n', file);
}

static igi_status save_intervals(igi_context *ctx, chart_trial *const *trials, size_t count,
                                 const char *folder)
{
    igi_file file;
    IGI_TRY(chart_table_begin(ctx, folder, "intervals.csv",
                              "sweep,severity,room,seed,region,what,got,want,std", &file));
    for (size_t k = 0; k < count; k++)
        for (size_t i = 0; i < trials[k]->interval_count; i++) {
            const chart_interval *one = &trials[k]->intervals[i];
            put_head(file.stream, trials[k]);
            put_text(file.stream, one->region);
            fprintf(file.stream, ",%s,%.6g,%.6g,%.4g\n", one->what, one->got, one->want, one->std);
        }
    return igi_file_end(ctx, &file, IGI_OK);
}

igi_status chart_trials_save(igi_context *ctx, chart_trial *const *trials, size_t count,
                             const char *folder)
{
    igi_file file;
    IGI_TRY(chart_table_begin(
        ctx, folder, "cases.csv",
        "sweep,severity,room,seed,status,albedo_mean,albedo_median,albedo_max,rho_s,alpha,"
        "relit,models_right,models,covered,intervals,worst_sigmas,flagged,silent,sign",
        &file));
    for (size_t i = 0; i < count; i++)
        if (!trials[i]->skipped) put_trial(file.stream, trials[i]);
    IGI_TRY(igi_file_end(ctx, &file, IGI_OK));
    return save_intervals(ctx, trials, count, folder);
}

static void put_point(FILE *file, const igi_sweep_result *r, size_t point)
{
    const igi_sweep_point *p = &r->points[point];
    fprintf(file, "%s", r->name);
    put_text(file, r->unit);
    fprintf(file, ",%.6g,%zu,%zu,%zu,%zu,%zu", p->severity, point, p->cases, p->refused, p->flagged,
            p->silent);
    put_number(file, p->albedo);
    put_number(file, p->albedo_max);
    put_number(file, p->specular);
    put_number(file, p->alpha);
    put_number(file, p->relit);
    put_number(file, p->covered);
    fprintf(file, ",%d\n", point >= r->breakdown);
}

static igi_status save_table(igi_context *ctx, const igi_stability *all, const char *folder)
{
    igi_file file;
    IGI_TRY(chart_table_begin(
        ctx, folder, "stability.csv",
        "sweep,unit,severity,place,cases,refused,flagged,silent,albedo,albedo_max,rho_s,alpha,"
        "relit,covered,broken_down",
        &file));
    for (size_t i = 0; i < all->sweep_count; i++)
        for (size_t k = 0; k < all->sweeps[i].point_count; k++)
            put_point(file.stream, &all->sweeps[i], k);
    return igi_file_end(ctx, &file, IGI_OK);
}

static igi_status save_goals(igi_context *ctx, const igi_stability *all, const char *folder)
{
    igi_file file;
    IGI_TRY(chart_table_begin(ctx, folder, "wanted.csv", "wanted,found,met,what", &file));
    for (size_t i = 0; i < all->goal_count; i++) {
        const igi_stability_goal *goal = &all->goals[i];
        fprintf(file.stream, "%s%.6g", goal->at_least ? ">=" : "<=", goal->wanted);
        put_number(file.stream, goal->found);
        fprintf(file.stream, ",%d", goal->met);
        put_text(file.stream, goal->what);
        fputc('\n', file.stream);
    }
    return igi_file_end(ctx, &file, IGI_OK);
}

igi_status chart_stability_save(igi_context *ctx, const igi_stability *all, const char *folder)
{
    IGI_TRY(save_table(ctx, all, folder));
    IGI_TRY(save_goals(ctx, all, folder));
    return chart_stability_draw(ctx, all, folder);
}
