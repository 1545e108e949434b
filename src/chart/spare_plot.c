/* SPDX-License-Identifier: Apache-2.0
 *
 * Error against the number of parameters, a panel a scene.
 */
#include "chart/speed_plot.h"
#include "base/file.h"

#include <math.h>
#include <string.h>

#define PANEL_WIDTH 430
#define PANEL_HEIGHT 340

static void put_panel(FILE *script, const char *scene, bool leftmost)
{
    fputs("set title ", script);
    chart_plot_text(script, scene);
    fprintf(script, " font ',13'\nset ylabel '%s'\nscene = ",
            leftmost ? "albedo texel by texel: mean error, %" : "");
    chart_plot_quoted(script, scene);
    fputs("\nplot ", script);
    static const struct {
        const char *name;
        int colour;
    } models[] = {{"lambert", 2}, {"maps", 4}, {"auto", 1}};
    for (size_t m = 0; m < 3; m++)
        fprintf(script,
                "'parsimony.csv' using (strcol('scene') eq scene && strcol('model') eq '%s' ? "
                "column('parameters') : NaN):(100*column('error')) with linespoints lt %d, \\\n"
                "     ",
                models[m].name, models[m].colour);
    fputs("'parsimony.csv' using (strcol('scene') eq scene && column('chosen') == 1 ? "
          "column('parameters') : NaN):(100*column('error')) with points pt 6 ps 2.2 lw 2 "
          "lc rgb '#000000'\n",
          script);
}

/* What igi chooses: above its point where that is at the left, else below it. */
static void label_choice(FILE *script, const spare_row *r, size_t most)
{
    bool leftmost = r->parameters * r->parameters < 5 * most;
    char maps[48] = "no map";
    if (r->map_size > 0) snprintf(maps, sizeof maps, "maps to %d texels a side", r->map_size);
    fprintf(script,
            "set label \"igi's choice:\\n%zu parameters,\\n%zu lobes, %s\" at %zu,%.6g %s "
            "textcolor lt 1\n",
            r->parameters, r->lobes, maps, r->parameters, 100 * r->error,
            leftmost ? "left offset 0,3.6" : "right offset 2,-1.6");
}

static void put_labels(FILE *script, const spare_rows *rows, const char *scene, size_t most)
{
    const spare_row *lambert = NULL, *maps = NULL;
    fputs("unset label\n", script);
    for (size_t i = 0; i < rows->count; i++) {
        const spare_row *r = &rows->rows[i];
        if (strcmp(r->scene, scene) != 0) continue;
        if (!lambert && strcmp(r->model, "lambert") == 0) lambert = r;
        if (!maps && strcmp(r->model, "maps") == 0) {
            maps = r;
            fprintf(script,
                    "set label \"a map for every region\" at %zu,%.6g right "
                    "offset 2,2 textcolor lt 4\n",
                    r->parameters, 100 * r->error);
        }
        if (!r->chosen) continue;
        label_choice(script, r, most);
        if (lambert && lambert->error > 1.3 * r->error)
            fprintf(script, "set label 'no lobes' at %zu,%.6g right offset 0,1 textcolor lt 2\n",
                    lambert->parameters, 100 * lambert->error);
    }
}

igi_status chart_spare_draw(igi_context *ctx, const spare_rows *rows, const char *folder)
{
    igi_file script;
    size_t scenes = 0, most = 1;
    double low = (double)INFINITY, high = 0;
    for (size_t i = 0; i < rows->count; i++) {
        const spare_row *r = &rows->rows[i];
        scenes += i == 0 || strcmp(r->scene, rows->rows[i - 1].scene) != 0;
        if (r->parameters > most) most = r->parameters;
        if (!(r->error > 0)) continue;
        low = fmin(low, 100 * r->error);
        high = fmax(high, 100 * r->error);
    }
    if (!(high > 0)) return IGI_OK;
    IGI_TRY(chart_plot_begin(ctx, folder, "parsimony", (int)scenes * PANEL_WIDTH + 40,
                             PANEL_HEIGHT + 30, &script));
    fprintf(script.stream,
            "set multiplot layout 1,%zu margins %.3f,.99,.18,.9 spacing .05,.06\n"
            "unset key\nset logscale xy\nset format y '%%g'\nset format x '10^{%%L}'\n"
            "set xlabel 'parameters of the result'\nset xrange [5:%zu]\n"
            "set yrange [%.6g:%.6g]\n",
            scenes, .16 / (double)scenes, most * 4, low * .25, high * 1.6);
    for (size_t i = 0; i < rows->count; i++) {
        const char *scene = rows->rows[i].scene;
        if (i > 0 && strcmp(scene, rows->rows[i - 1].scene) == 0) continue;
        put_labels(script.stream, rows, scene, most);
        put_panel(script.stream, scene, i == 0);
    }
    fputs("unset multiplot\n", script.stream);
    return chart_plot_end(ctx, folder, "parsimony", &script);
}
