/* SPDX-License-Identifier: Apache-2.0
 *
 * The speed chart's tables. What differs from run to run (times, memory, and the front, which
 * depends on them) stands in the last columns; all else is the same bytes every time.
 */
#include "chart/speed_plot.h"
#include "base/file.h"

#include <math.h>
#include <string.h>

/* A name in a table: without what would cut it. */
static void put_name(FILE *file, const char *name)
{
    for (; *name; name++) fputc(strchr(",\"\r\n", *name) ? '_' : *name, file);
}

/* ",1.234e-3", or "," for what does not apply. */
static void put(FILE *file, double x)
{
    if (isnan(x)) fputc(',', file);
    else fprintf(file, ",%.4g", x);
}

static void put_row(FILE *file, const speed_row *r)
{
    const double errors[] = {r->albedo, r->albedo_max, r->specular, r->alpha, r->texels, r->relit};
    put_name(file, r->scene);
    fprintf(file, ",%s,%.4g,%d,%g,%zu", igi_method_name(r->method), r->patch_m, r->rays_each,
            r->target, r->photographs);
    for (size_t i = 0; i < sizeof errors / sizeof errors[0]; i++) put(file, errors[i]);
    fprintf(file, ",%d,%d,%zu,%llu,%.3f,%.3g,%.0f,%d\n", r->models_right, r->models, r->parameters,
            (unsigned long long)r->rays, r->cpu_s, r->ratio, (double)r->peak_bytes * 1e-6,
            r->front);
}

static igi_status save_peers(igi_context *ctx, const peer_curves *peers, const char *folder)
{
    igi_file file;
    IGI_TRY(chart_table_begin(ctx, folder, "peers.csv",
                              "peer,scene,albedo_mean,specular,alpha,texels,cpu_s", &file));
    for (size_t i = 0; i < peers->count; i++)
        for (size_t k = 0; k < peers->curves[i].count; k++) {
            const peer_point *p = &peers->curves[i].points[k];
            bool last = k + 1 == peers->curves[i].count;
            if (k > 0 && !last && memcmp(p->errors, p[-1].errors, sizeof p->errors) == 0) continue;
            put_name(file.stream, peers->curves[i].peer);
            fputs(",", file.stream);
            put_name(file.stream, peers->curves[i].scene);
            for (size_t e = 0; e < 4; e++) put(file.stream, p->errors[e]);
            fprintf(file.stream, ",%.3f\n", p->cpu_s);
        }
    return igi_file_end(ctx, &file, IGI_OK);
}

/* The quickest recovery of a scene whose mean error of albedo is at most `below`; NULL: none. */
static const speed_row *reach(const speed_rows *rows, const char *scene, double below)
{
    const speed_row *best = NULL;
    for (size_t i = 0; i < rows->count; i++) {
        const speed_row *r = &rows->rows[i];
        if (strcmp(r->scene, scene) != 0 || !(r->albedo <= below)) continue;
        if (!best || r->cpu_s < best->cpu_s) best = r;
    }
    return best;
}

/* From when on a peer's error stays at most `below`; NaN: never. */
static double stays(const peer_curve *c, double below)
{
    for (size_t k = 0; k < c->count; k++)
        if (c->points[k].errors[0] <= below) return c->points[k].cpu_s;
    return (double)NAN;
}

/* The peer that is there first, when, and how much longer that takes. */
static void put_best_peer(FILE *file, const peer_curves *peers, const char *scene, double below,
                          double cpu_s)
{
    double first = (double)NAN;
    const char *name = "";
    for (size_t i = 0; i < peers->count; i++) {
        if (strcmp(peers->curves[i].scene, scene) != 0) continue;
        double s = stays(&peers->curves[i], below);
        if (!name[0] || s < first || isnan(first)) name = peers->curves[i].peer;
        first = fmin(first, s);
    }
    fputs(",", file);
    put_name(file, name);
    put(file, first);
    put(file, first / cpu_s);
    fputs("\n", file);
}

static igi_status save_reach(igi_context *ctx, const speed_rows *rows, const peer_curves *peers,
                             const char *folder)
{
    static const double levels[] = {.1, .05, .02, .01, .005, .002, .001, .0005};
    igi_file file;
    IGI_TRY(chart_table_begin(ctx, folder, "reach.csv",
                              "scene,albedo_mean,method,cpu_s,peer,peer_cpu_s,times", &file));
    for (size_t i = 0; i < rows->count; i++) {
        const char *scene = rows->rows[i].scene;
        if (i > 0 && strcmp(scene, rows->rows[i - 1].scene) == 0) continue;
        for (size_t k = 0; k < sizeof levels / sizeof levels[0]; k++) {
            const speed_row *r = reach(rows, scene, levels[k]);
            if (!r) continue;
            put_name(file.stream, scene);
            fprintf(file.stream, ",%g,%s,%.3f", levels[k], igi_method_name(r->method), r->cpu_s);
            put_best_peer(file.stream, peers, scene, levels[k], r->cpu_s);
        }
    }
    return igi_file_end(ctx, &file, IGI_OK);
}

igi_status chart_speed_save(igi_context *ctx, const speed_rows *rows, const peer_curves *peers,
                            const char *folder)
{
    igi_file file;
    IGI_TRY(chart_table_begin(
        ctx, folder, "speed.csv",
        "scene,method,patch_m,rays_each,target,photographs,albedo_mean,albedo_max,specular,alpha,"
        "texels,relit,models_right,models,parameters,rays,cpu_s,ratio,peak_mb,front",
        &file));
    for (size_t i = 0; i < rows->count; i++) put_row(file.stream, &rows->rows[i]);
    IGI_TRY(igi_file_end(ctx, &file, IGI_OK));
    IGI_TRY(save_peers(ctx, peers, folder));
    IGI_TRY(save_reach(ctx, rows, peers, folder));
    return chart_speed_draw(ctx, rows, peers, folder);
}

igi_status chart_spare_save(igi_context *ctx, const spare_rows *rows, const char *folder)
{
    igi_file file;
    IGI_TRY(chart_table_begin(ctx, folder, "parsimony.csv",
                              "scene,model,map_size,chosen,parameters,lobes,error,specular",
                              &file));
    for (size_t i = 0; i < rows->count; i++) {
        const spare_row *r = &rows->rows[i];
        put_name(file.stream, r->scene);
        fprintf(file.stream, ",%s,%d,%d,%zu,%zu", r->model, r->map_size, r->chosen, r->parameters,
                r->lobes);
        put(file.stream, r->error);
        put(file.stream, r->specular);
        fputs("\n", file.stream);
    }
    IGI_TRY(igi_file_end(ctx, &file, IGI_OK));
    return chart_spare_draw(ctx, rows, folder);
}
