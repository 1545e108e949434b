/* SPDX-License-Identifier: Apache-2.0
 *
 * The stability chart's page: small multiples, one a sweep, by subject. From above down each has the
 * errors, the share of the stated intervals that hold the truth, and whether igi says so.
 */
#include "chart/plot.h"
#include "chart/trial.h"

#include <string.h>

#define COLUMNS 6
#define PANEL_WIDTH 300
#define PANEL_HEIGHT 235

/* Heights in per cent of error; below .04 are the strips. */
#define LOWEST ".004"
#define HIGHEST "200"
#define STRIPS ".045"
#define COVERED ".022"
#define FLAGGED ".008"

/* One curve of the table, in per cent of error; nothing where there is none. */
static void put_curve(FILE *script, const char *name, int column, const char *style)
{
    fputs(", \\\n  'stability.csv' using (strcol(1) eq ", script);
    chart_plot_quoted(script, name);
    fprintf(script, " ? $4 : 1/0):(100*$%d) with linespoints %s", column, style);
}

/* In a strip, where the expression over the table's columns is true. */
static void put_marks(FILE *script, const char *name, const char *where, const char *at,
                      const char *style)
{
    fputs("'stability.csv' using (strcol(1) eq ", script);
    chart_plot_quoted(script, name);
    fprintf(script, " && %s ? $4 : 1/0):(%s)%s", where, at, style);
}

static void put_strips(FILE *script, const char *name)
{
    static const char percent[] =
        ":(valid(14) ? sprintf('%.0f', 100*$14) : '') with labels font ',7' textcolor rgb ";
    char style[128];
    put_marks(script, name, "2*$7 >= $5", FLAGGED, " with points pt 5 ps .9 lc rgb '#009e73'");
    fputs(", \\\n  ", script);
    put_marks(script, name, "$8 > 0", FLAGGED, " with points pt 4 ps 1.3 lw 1.5 lc rgb '#d55e00'");
    fputs(", \\\n  ", script);
    snprintf(style, sizeof style, "%s'#808080'", percent);
    put_marks(script, name, "$14 >= .9", COVERED, style);
    fputs(", \\\n  ", script);
    snprintf(style, sizeof style, "%s'#d00000'", percent);
    put_marks(script, name, "$14 < .9", COVERED, style);
}

static void put_title(FILE *script, const igi_sweep_result *r)
{
    char title[256], label[256];
    snprintf(title, sizeof title, "%s%s%s", r->subject, r->subject[0] ? ": " : "", r->name);
    snprintf(label, sizeof label, "%s%s%s", r->label, r->unit[0] ? ", " : "", r->unit);
    fputs("set title ", script);
    chart_plot_text(script, title);
    fputs(" font ',11' offset 0,-.6\nset xlabel ", script);
    chart_plot_text(script, label);
    fprintf(script, " font ',9' offset 0,.5\nset xrange [-.5:%zu-.5]\nset xtics (", r->point_count);
    for (size_t k = 0; k < r->point_count; k++)
        fprintf(script, "%s'%.4g' %zu", k ? ", " : "", r->points[k].severity, k);
    fputs(") font ',8' offset 0,.3\n", script);
}

static void put_panel(FILE *script, const igi_sweep_result *r)
{
    put_title(script, r);
    fputs("unset object 1\n", script);
    if (r->breakdown < r->point_count)
        fprintf(script,
                "set object 1 rectangle from %zu-.5,graph 0 to %zu-.5,graph 1 behind "
                "fc rgb '#f0e6d8' fs solid noborder\n",
                r->breakdown, r->point_count);
    fputs("plot ", script);
    put_strips(script, r->name);
    put_curve(script, r->name, 13, "lt 4 pt 11 ps .5");
    put_curve(script, r->name, 12, "lt 3 pt 9 ps .5");
    put_curve(script, r->name, 11, "lt 2 pt 5 ps .4");
    put_curve(script, r->name, 9, "lt 1 pt 7 ps .6");
    fputs("\n", script);
}

/* What the lines are, in the first panel. */
static void put_key(FILE *script, const igi_sweep_result *unperturbed)
{
    const igi_sweep_point *p = &unperturbed->points[0];
    fprintf(script,
            "set title 'what the lines are' font ',11' offset 0,-.6\n"
            "set xlabel 'unperturbed rooms: %.2g, %.2g, %.2g, %.2g %%' font ',9' offset 0,.5\n"
            "unset xtics\nunset ytics\nunset grid\nunset border\nunset object 1\n"
            "set key at graph 0,1 left top Left reverse font ',9' samplen 2 spacing 1.05\n",
            100 * p->albedo, 100 * p->specular, 100 * p->alpha, 100 * p->relit);
    fputs("plot [0:1] 1/0 with linespoints lt 1 pt 7 title 'error of albedo, %', \\\n"
          "  1/0 with linespoints lt 2 pt 5 ps .6 title 'of ρ_s', \\\n"
          "  1/0 with linespoints lt 3 pt 9 ps .7 title 'of α', \\\n"
          "  1/0 with linespoints lt 4 pt 11 ps .7 title 'of a picture relit', \\\n"
          "  1/0 with points pt 1 ps 0 title '97: % of 95 % intervals that hold; red: < 90', \\\n"
          "  1/0 with points pt 5 lc rgb '#009e73' title 'igi says that something is wrong', \\\n"
          "  1/0 with points pt 4 lc rgb '#d55e00' title 'silent: very wrong, not a word', \\\n"
          "  1/0 with boxes fs solid lc rgb '#f0e6d8' title 'broken down: error > 1 %, × 3'\n"
          "unset key\nset grid ls 100\nset border 3\n",
          script);
}

/* The subjects, in the order in which a sweep's file first names them; the first
 * of all are the unperturbed rooms. */
static void put_panels(FILE *script, const igi_stability *all)
{
    for (size_t i = 1; i < all->sweep_count; i++) {
        const char *subject = all->sweeps[i].subject;
        bool met = false;
        for (size_t k = 1; k < i; k++) met |= strcmp(all->sweeps[k].subject, subject) == 0;
        for (size_t k = i; k < all->sweep_count && !met; k++)
            if (strcmp(all->sweeps[k].subject, subject) == 0) put_panel(script, &all->sweeps[k]);
    }
}

igi_status chart_stability_draw(igi_context *ctx, const igi_stability *all, const char *folder)
{
    igi_file script;
    int rows = (int)(all->sweep_count + COLUMNS - 1) / COLUMNS;
    IGI_TRY(chart_plot_begin(ctx, folder, "stability", PANEL_WIDTH * COLUMNS, PANEL_HEIGHT * rows,
                             &script));
    fprintf(script.stream, "set multiplot layout %d,%d\nunset key\nset logscale y\n", rows,
            COLUMNS);
    fputs("set yrange [" LOWEST ":" HIGHEST "]\n", script.stream);
    put_key(script.stream, &all->sweeps[0]);
    fputs("set ytics ('.1' .1, '1' 1, '10' 10, '100' 100) font ',8'\n"
          "set arrow 9 from graph 0,first " STRIPS " to graph 1,first " STRIPS
          " nohead lw .6 lc rgb '#b0b0b0'\n",
          script.stream);
    put_panels(script.stream, all);
    fputs("unset multiplot\n", script.stream);
    return chart_plot_end(ctx, folder, "stability", &script);
}
