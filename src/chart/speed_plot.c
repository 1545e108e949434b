/* SPDX-License-Identifier: Apache-2.0
 *
 * Curves carry their names at their right ends, moved apart where they would meet, so that nobody
 * has to look up a legend.
 */
#include "chart/speed_plot.h"
#include "base/file.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MAX_LABELS = 16, METHODS = IGI_METHOD_YU99 + 1 };

#define PANEL_WIDTH 430
#define PANEL_HEIGHT 330
#define LABEL_GAP 0.055 /* of an axis, between names */

static const struct {
    const char *column, *title;
} kinds[] = {{"albedo_mean", "albedo {/:Italic ρ_d}, mean over regions"},
             {"specular", "specular {/:Italic ρ_s}"},
             {"alpha", "roughness {/:Italic α}"},
             {"texels", "texels, median"}};

enum { KINDS = sizeof kinds / sizeof kinds[0] };

static const int colours[METHODS] = {[IGI_METHOD_PATCHES] = 1,
                                     [IGI_METHOD_GATHER] = 3,
                                     [IGI_METHOD_RADIOSITY] = 5,
                                     [IGI_METHOD_DIRECT] = 2,
                                     [IGI_METHOD_YU99] = 4};

/* A method that looks for no lobes misses them by 100 %, which is no point of a curve. */
static double error_of(const speed_row *r, size_t kind)
{
    bool lobes = r->method == IGI_METHOD_PATCHES || r->method == IGI_METHOD_YU99;
    const double errors[KINDS] = {r->albedo, lobes ? r->specular : (double)NAN,
                                  lobes ? r->alpha : (double)NAN, r->texels};
    return errors[kind];
}

typedef struct range {
    double low, high;
} range;

static void widen(range *r, double x)
{
    if (!(x > 0) || !isfinite(x)) return;
    r->low = fmin(r->low, x);
    r->high = fmax(r->high, x);
}

typedef struct label {
    double x, y;
    int colour;
    const char *text;
    bool above; /* its point, not at its height */
} label;

typedef struct panel {
    const char *scene;
    size_t kind;
    range x, y;
    label labels[MAX_LABELS];
    int count;
} panel;

static void add_label(panel *p, double x, double y, int colour, const char *text, bool above)
{
    if (p->count < MAX_LABELS && x > 0 && y > 0)
        p->labels[p->count++] = (label){x, y, colour, text, above};
}

static int by_height(const void *a, const void *b)
{
    double x = ((const label *)a)->y, y = ((const label *)b)->y;
    return (x > y) - (x < y);
}

/* Names that would stand over each other move up. */
static void spread_labels(panel *p)
{
    double gap = LABEL_GAP * log(p->y.high / p->y.low), near = .3 * log(p->x.high / p->x.low);
    qsort(p->labels, (size_t)p->count, sizeof *p->labels, by_height);
    for (int i = 1; i < p->count; i++)
        for (int k = 0; k < i; k++) {
            label *a = &p->labels[i], *b = &p->labels[k];
            if (fabs(log(a->x / b->x)) < near && log(a->y / b->y) < gap) a->y = b->y * exp(gap);
        }
}

/* The rightmost point of the method's curve carries its name. */
static void label_methods(panel *p, const speed_rows *rows)
{
    for (int m = 0; m < METHODS; m++) {
        const speed_row *last = NULL;
        for (size_t i = 0; i < rows->count; i++) {
            const speed_row *r = &rows->rows[i];
            if ((int)r->method != m || strcmp(r->scene, p->scene) != 0) continue;
            if (!(error_of(r, p->kind) > 0)) continue;
            if (!last || r->cpu_s > last->cpu_s) last = r;
        }
        if (last)
            add_label(p, last->cpu_s, 100 * error_of(last, p->kind), colours[m],
                      igi_method_name((igi_method)m), false);
    }
}

/* A peer's curve falls from left to right: above its end there is room. */
static void label_peers(panel *p, const peer_curves *peers)
{
    for (size_t i = 0; i < peers->count; i++) {
        const peer_curve *c = &peers->curves[i];
        if (strcmp(c->scene, p->scene) != 0 || c->count == 0) continue;
        double first = c->points[0].cpu_s, last = c->points[c->count - 1].cpu_s;
        size_t k = 0;
        while (k + 1 < c->count && c->points[k].cpu_s < first * pow(last / first, .72)) k++;
        add_label(p, c->points[k].cpu_s, 100 * c->points[k].errors[p->kind], 8, c->peer, true);
    }
}

static void put_curves(FILE *script, const panel *p, const speed_rows *rows,
                       const peer_curves *peers)
{
    const char *column = kinds[p->kind].column;
    fprintf(script, "scene = ");
    chart_plot_quoted(script, p->scene);
    fputs("\nplot ", script);
    if (p->kind == 0)
        fputs("'speed.csv' using (strcol('scene') eq scene && column('front') == 1 ? "
              "column('cpu_s') : NaN):(100*column('albedo_mean')) smooth unique with lines lw 9 "
              "lc rgb '#d8d8d8', \\\n     ",
              script);
    for (size_t i = 0; i < peers->count; i++) {
        if (strcmp(peers->curves[i].scene, p->scene) != 0) continue;
        fprintf(script, "'peers.csv' using (strcol('scene') eq scene && strcol('peer') eq ");
        chart_plot_quoted(script, peers->curves[i].peer);
        fprintf(script,
                " ? column('cpu_s') : NaN):(100*column('%s')) with steps lt 8, \\\n"
                "     ",
                column);
    }
    bool first = true;
    for (int m = 0; m < METHODS; m++) {
        bool any = false;
        for (size_t i = 0; i < rows->count; i++)
            any |= (int)rows->rows[i].method == m && strcmp(rows->rows[i].scene, p->scene) == 0 &&
                   error_of(&rows->rows[i], p->kind) > 0;
        if (!any) continue;
        fprintf(script,
                "%s'speed.csv' using (strcol('scene') eq scene && strcol('method') eq '%s' ? "
                "column('cpu_s') : NaN):(100*column('%s')) smooth unique with linespoints lt %d",
                first ? "" : ", \\\n     ", igi_method_name((igi_method)m), column, colours[m]);
        first = false;
    }
    fputs("\n", script);
}

/* Fewer than two decades need marks between them. */
static void put_marks(FILE *script, char axis, range r)
{
    bool few = r.high / r.low < 120;
    fprintf(script, "set %ctics %s\n", axis, few ? "(0)" : "autofreq");
    for (double decade = pow(10, floor(log10(r.low))); few && decade < r.high; decade *= 10)
        fprintf(script, "set %ctics add (%.4g, %.4g, %.4g)\n", axis, decade, 2 * decade,
                5 * decade);
}

static void put_panel(FILE *script, const panel *p, const speed_rows *rows,
                      const peer_curves *peers, bool leftmost, bool lowest)
{
    fputs("unset label\n", script);
    for (int i = 0; i < p->count; i++) {
        const label *l = &p->labels[i];
        fputs("set label ", script);
        chart_plot_text(script, l->text);
        fprintf(script, " at %.6g,%.6g left offset %s textcolor lt %d front\n", l->x, l->y,
                l->above ? ".5,.8" : ".9,0", l->colour);
    }
    fputs("set title ", script);
    if (p->kind == 0) chart_plot_text(script, p->scene);
    else fputs("''", script);
    fprintf(script, " font ',13'\nset ylabel '%s%s'\nset xlabel '%s'\n",
            leftmost ? kinds[p->kind].title : "", leftmost ? ": error, %" : "",
            lowest ? "CPU seconds of one thread" : "");
    fprintf(script, "set xrange [%.6g:%.6g]\nset yrange [%.6g:%.6g]\n", p->x.low, p->x.high,
            p->y.low, p->y.high);
    put_marks(script, 'x', p->x);
    put_marks(script, 'y', p->y);
    put_curves(script, p, rows, peers);
}

/* The scenes, in the order in which they come. */
static size_t list_scenes(const speed_rows *rows, const char **scenes, size_t room)
{
    size_t count = 0;
    for (size_t i = 0; i < rows->count; i++)
        if (count < room && (count == 0 || strcmp(scenes[count - 1], rows->rows[i].scene) != 0))
            scenes[count++] = rows->rows[i].scene;
    return count;
}

static range times_of(const char *scene, const speed_rows *rows, const peer_curves *peers)
{
    range x = {(double)INFINITY, 0};
    for (size_t i = 0; i < rows->count; i++)
        if (strcmp(rows->rows[i].scene, scene) == 0) widen(&x, rows->rows[i].cpu_s);
    for (size_t i = 0; i < peers->count; i++)
        for (size_t k = 0; strcmp(peers->curves[i].scene, scene) == 0 && k < peers->curves[i].count;
             k++)
            widen(&x, peers->curves[i].points[k].cpu_s);
    /* The names at the right need a third of the axis. */
    return (range){x.low * .7, x.high * pow(x.high / x.low, .4) * 1.4};
}

static range errors_of(size_t kind, const speed_rows *rows, const peer_curves *peers)
{
    range y = {(double)INFINITY, 0};
    for (size_t i = 0; i < rows->count; i++) widen(&y, 100 * error_of(&rows->rows[i], kind));
    for (size_t i = 0; y.high > 0 && i < peers->count; i++)
        for (size_t k = 0; k < peers->curves[i].count; k++)
            widen(&y, 100 * peers->curves[i].points[k].errors[kind]);
    return (range){y.low * .6, y.high * 1.8};
}

static bool has_errors(const char *scene, size_t kind, const speed_rows *rows)
{
    for (size_t i = 0; i < rows->count; i++)
        if (strcmp(rows->rows[i].scene, scene) == 0 && error_of(&rows->rows[i], kind) > 0)
            return true;
    return false;
}

/* The kinds of error that some scene has; how many. */
static size_t list_kinds(const char *const *scenes, size_t count, const speed_rows *rows,
                         size_t list[KINDS])
{
    size_t kinds_count = 0;
    for (size_t kind = 0; kind < KINDS; kind++) {
        bool any = false;
        for (size_t i = 0; i < count; i++) any |= has_errors(scenes[i], kind, rows);
        if (any) list[kinds_count++] = kind;
    }
    return kinds_count;
}

/* Has the scene no errors of the kinds after the list's first? */
static bool is_lowest(const char *scene, const size_t *list, size_t rest, const speed_rows *rows)
{
    for (size_t k = 1; k < rest; k++)
        if (has_errors(scene, list[k], rows)) return false;
    return true;
}

static panel make_panel(const char *scene, size_t kind, const speed_rows *rows,
                        const peer_curves *peers)
{
    panel p = {.scene = scene, .kind = kind};
    p.x = times_of(scene, rows, peers);
    p.y = errors_of(kind, rows, peers);
    label_methods(&p, rows);
    label_peers(&p, peers);
    spread_labels(&p);
    return p;
}

/* In the first cell that has no panel: what the lines are. */
static void put_key(FILE *script, const peer_curves *peers)
{
    static const struct {
        int colour;
        const char *text;
    } lines[] = {{1, "patches: every patch gathers; igi's own choice"},
                 {4, "yu99: the algorithm of 1999"},
                 {5, "radiosity: a dense system on a coarse mesh"},
                 {3, "gather: points look into the photographs"},
                 {2, "direct: no interreflection"}};
    fputs("unset label\nset title ''\nset xlabel ''\nset ylabel ''\n", script);
    double y = .95;
    for (size_t i = 0; i < sizeof lines / sizeof lines[0]; i++, y -= .1) {
        fputs("set label ", script);
        chart_plot_quoted(script, lines[i].text);
        fprintf(script, " at graph 0,%.2f textcolor lt %d\n", y, lines[i].colour);
    }
    if (peers->count > 0)
        fprintf(script,
                "set label 'black: the peer, whose error stays below' "
                "at graph 0,%.2f textcolor lt 8\n",
                y);
    if (peers->count > 0) y -= .1;
    fprintf(script,
            "set label 'broad grey: the front; nothing as quick is more accurate' at graph 0,%.2f "
            "textcolor rgb '#808080'\n"
            "unset border\nunset grid\nset tics scale 0\nset format ''\nunset logscale\n"
            "plot [0:1][0:1] NaN\n"
            "set border 3\nset grid ls 100\nset tics scale .5\nset format '%%g'\n"
            "set logscale xy\n",
            y);
}

igi_status chart_speed_draw(igi_context *ctx, const speed_rows *rows, const peer_curves *peers,
                            const char *folder)
{
    enum { MAX_SCENES = 16 };
    igi_file script;
    const char *scenes[MAX_SCENES];
    size_t list[KINDS], count = list_scenes(rows, scenes, MAX_SCENES);
    size_t lines = list_kinds(scenes, count, rows, list);
    if (lines == 0) return IGI_OK; /* every scene was refused */
    IGI_TRY(chart_plot_begin(ctx, folder, "speed", (int)count * PANEL_WIDTH + 40,
                             (int)lines * PANEL_HEIGHT + 40, &script));
    fprintf(script.stream,
            "set multiplot layout %zu,%zu margins %.3f,.99,%.3f,%.3f spacing .05,.06\n"
            "unset key\nset logscale xy\nset format '%%g'\n",
            lines, count, .16 / (double)count, .2 / (double)lines, 1 - .12 / (double)lines);
    bool explained = false;
    for (size_t k = 0; k < lines; k++)
        for (size_t i = 0; i < count; i++) {
            if (!has_errors(scenes[i], list[k], rows)) {
                if (explained) fputs("set multiplot next\n", script.stream);
                else put_key(script.stream, peers);
                explained = true;
                continue;
            }
            panel p = make_panel(scenes[i], list[k], rows, peers);
            bool leftmost = i == 0 || !has_errors(scenes[i - 1], list[k], rows);
            put_panel(script.stream, &p, rows, peers, leftmost,
                      is_lowest(scenes[i], list + k, lines - k, rows));
        }
    fputs("unset multiplot\n", script.stream);
    return chart_plot_end(ctx, folder, "speed", &script);
}
