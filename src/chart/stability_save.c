/* SPDX-License-Identifier: Apache-2.0
 *
 * The stability chart on disk: two tables, and small multiples, one a sweep.
 */
#include "chart/plot.h"
#include "chart/trial.h"

#include <stdio.h>
#include <string.h>

#define COLUMNS 6 /* of the small multiples */

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

/* One curve of the table, in per cent of error; nothing where there is none. */
static void put_curve(FILE *script, const char *name, int column, const char *style)
{
    fputs(", \\\n  'stability.csv' using (strcol(1) eq ", script);
    chart_plot_text(script, name);
    fprintf(script, " ? $4 : 1/0):(100*$%d) with linespoints %s", column, style);
}

/* Marks along the lower edge, where the expression over the table's columns is not 0. */
static void put_marks(FILE *script, const char *name, const char *where, const char *style)
{
    fputs("'stability.csv' using (strcol(1) eq ", script);
    chart_plot_text(script, name);
    fprintf(script, " && %s ? $4 : 1/0):(.014) with points %s", where, style);
}

static void put_panel(FILE *script, const igi_sweep_result *r)
{
    char label[256];
    snprintf(label, sizeof label, "%s%s%s", r->label, r->unit[0] ? ", " : "", r->unit);
    fputs("set title ", script);
    chart_plot_text(script, r->name);
    fputs(" font ',11'\nset xlabel ", script);
    chart_plot_text(script, label);
    fprintf(script, " font ',9'\nset xrange [-.5:%zu-.5]\nset xtics (", r->point_count);
    for (size_t k = 0; k < r->point_count; k++)
        fprintf(script, "%s'%.4g' %zu", k ? ", " : "", r->points[k].severity, k);
    fputs(") font ',8'\nunset arrow\n", script);
    if (r->breakdown < r->point_count)
        fprintf(script, "set arrow from %zu-.5,.01 to %zu-.5,200 nohead dt 3 lc rgb '#999999'\n",
                r->breakdown, r->breakdown);
    fputs("plot ", script);
    put_marks(script, r->name, "2*$7 >= $5", "pt 5 ps .9 lc rgb '#009e73'");
    fputs(", \\\n  ", script);
    put_marks(script, r->name, "$8 > 0", "pt 4 ps 1.3 lw 1.5 lc rgb '#d55e00'");
    put_curve(script, r->name, 13, "lt 4 pt 7 ps .4");
    put_curve(script, r->name, 12, "lt 3 pt 7 ps .4");
    put_curve(script, r->name, 11, "lt 2 pt 7 ps .4");
    put_curve(script, r->name, 9, "lt 1 pt 7 ps .6");
    fputs("\n", script);
}

static void put_key(FILE *script)
{
    fputs("set title 'what the lines are'\nunset xlabel\nset xtics (' ' 0)\nunset arrow\n"
          "set key at graph .95,.95 font ',9'\n"
          "plot 1/0 with linespoints lt 1 pt 7 title 'albedo, % error', \\\n"
          "  1/0 with linespoints lt 2 pt 7 title 'rho_s', \\\n"
          "  1/0 with linespoints lt 3 pt 7 title 'alpha', \\\n"
          "  1/0 with linespoints lt 4 pt 7 title 'relit picture', \\\n"
          "  1/0 with points pt 5 lc rgb '#009e73' title 'igi mostly says so', \\\n"
          "  1/0 with points pt 4 lc rgb '#d55e00' title 'silent failure', \\\n"
          "  1/0 with lines dt 3 lc rgb '#999999' title 'breaks down'\n",
          script);
}

static void put_script(FILE *script, const igi_stability *all)
{
    int rows = (int)(all->sweep_count + COLUMNS) / COLUMNS;
    fprintf(script,
            "set multiplot layout %d,%d\nset key noenhanced\nunset key\nset logscale y\n"
            "set yrange [.01:200]\nset ytics ('.01' .01, '.1' .1, '1' 1, '10' 10, '100' 100) "
            "font ',8'\n",
            rows, COLUMNS);
    for (size_t i = 0; i < all->sweep_count; i++) put_panel(script, &all->sweeps[i]);
    put_key(script);
    fputs("unset multiplot\n", script);
}

static igi_status draw(igi_context *ctx, const igi_stability *all, const char *folder)
{
    igi_file script;
    int rows = (int)(all->sweep_count + COLUMNS) / COLUMNS;
    IGI_TRY(chart_plot_begin(ctx, folder, "stability", 300 * COLUMNS, 230 * rows, &script));
    put_script(script.stream, all);
    return chart_plot_end(ctx, folder, "stability", &script);
}

igi_status chart_stability_save(igi_context *ctx, const igi_stability *all, const char *folder)
{
    IGI_TRY(save_table(ctx, all, folder));
    IGI_TRY(save_goals(ctx, all, folder));
    return draw(ctx, all, folder);
}
