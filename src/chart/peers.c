/* SPDX-License-Identifier: Apache-2.0
 *
 * Peers' curves. An optimiser's error goes up and down; what counts is from when on it stays below
 * a value, so that each point takes the largest error from there to the end of its run.
 */
#include "chart/speed.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_LINE 1024

enum { PEER, RUN, SCENE, CPU, ALBEDO, SPECULAR, ALPHA, TEXELS, COLUMNS };

typedef struct reader {
    const char *path;
    int line, at[COLUMNS]; /* where the columns stand */
    char run[64];          /* of the points since `began` */
    size_t began;
    peer_curve *curve;
} reader;

/* Cuts a line in place; how many cells. */
static int cut(char *line, char *cells[], int room)
{
    int count = 0;
    line[strcspn(line, "\r\n")] = 0;
    for (char *at = line; at && count < room;) {
        cells[count++] = at;
        at = strchr(at, ',');
        if (at) *at++ = 0;
    }
    return count;
}

static igi_status read_head(igi_context *ctx, reader *r, char *line)
{
    static const char *const names[COLUMNS] = {"peer",        "run",      "scene", "cpu_s",
                                               "albedo_mean", "specular", "alpha", "texels"};
    char *cells[32];
    int count = cut(line, cells, 32);
    for (int c = 0; c < COLUMNS; c++) {
        r->at[c] = -1;
        for (int i = 0; i < count; i++)
            if (strcmp(cells[i], names[c]) == 0) r->at[c] = i;
        if (r->at[c] < 0)
            return igi_fail(ctx, IGI_E_DATA, "%s:1: no column %s; see scripts/peers", r->path,
                            names[c]);
    }
    return IGI_OK;
}

static double number(const char *text)
{
    char *end;
    double x = strtod(text, &end);
    return end == text || *end || !isfinite(x) ? (double)NAN : x;
}

/* The run is over: its points take the largest error that still follows. */
static void end_run(reader *r)
{
    if (!r->curve) return;
    for (size_t i = r->curve->count; i-- > r->began + 1;) {
        double *later = r->curve->points[i].errors, *now = r->curve->points[i - 1].errors;
        for (int k = 0; k < 4; k++) now[k] = fmax(now[k], later[k]);
    }
}

static igi_status find_curve(igi_context *ctx, peer_curves *curves, const char *peer,
                             const char *scene, peer_curve **curve)
{
    for (size_t i = 0; i < curves->count; i++) {
        *curve = &curves->curves[i];
        if (strcmp((*curve)->peer, peer) == 0 && strcmp((*curve)->scene, scene) == 0) return IGI_OK;
    }
    void *grown = igi_grow(ctx, curves->curves, &curves->capacity, curves->count + 1,
                           sizeof *curves->curves);
    if (!grown) return IGI_E_SYSTEM;
    curves->curves = grown;
    *curve = &curves->curves[curves->count++];
    **curve = (peer_curve){.count = 0};
    snprintf((*curve)->peer, sizeof(*curve)->peer, "%s", peer);
    snprintf((*curve)->scene, sizeof(*curve)->scene, "%s", scene);
    return IGI_OK;
}

static igi_status read_line(igi_context *ctx, reader *r, char *line, peer_curves *curves)
{
    char *cells[32];
    peer_curve *curve;
    int count = cut(line, cells, 32);
    if (count == 1 && !cells[0][0]) return IGI_OK;
    for (int c = 0; c < COLUMNS; c++)
        if (r->at[c] >= count)
            return igi_fail(ctx, IGI_E_DATA, "%s:%d: has too few columns", r->path, r->line);
    peer_point p = {.cpu_s = number(cells[r->at[CPU]])};
    if (!(p.cpu_s > 0))
        return igi_fail(ctx, IGI_E_DATA, "%s:%d: cpu_s '%s': must be a number above 0", r->path,
                        r->line, cells[r->at[CPU]]);
    for (int k = 0; k < 4; k++) p.errors[k] = number(cells[r->at[ALBEDO + k]]);
    IGI_TRY(find_curve(ctx, curves, cells[r->at[PEER]], cells[r->at[SCENE]], &curve));
    if (curve != r->curve || strcmp(r->run, cells[r->at[RUN]]) != 0) {
        end_run(r);
        r->curve = curve;
        r->began = curve->count;
        snprintf(r->run, sizeof r->run, "%s", cells[r->at[RUN]]);
    }
    void *grown = igi_grow(ctx, curve->points, &curve->capacity, curve->count + 1,
                           sizeof *curve->points);
    if (!grown) return IGI_E_SYSTEM;
    curve->points = grown;
    curve->points[curve->count++] = p;
    return IGI_OK;
}

static int by_time(const void *a, const void *b)
{
    double x = ((const peer_point *)a)->cpu_s, y = ((const peer_point *)b)->cpu_s;
    return (x > y) - (x < y);
}

/* All runs of a peer on a scene become one curve: at each time the best of them. */
static void merge_runs(peer_curve *c)
{
    qsort(c->points, c->count, sizeof *c->points, by_time);
    for (size_t i = 1; i < c->count; i++)
        for (int k = 0; k < 4; k++)
            c->points[i].errors[k] = fmin(c->points[i].errors[k], c->points[i - 1].errors[k]);
}

igi_status chart_peers_load(igi_context *ctx, const char *path, peer_curves *curves)
{
    char line[MAX_LINE];
    reader r = {.path = path};
    igi_status status = IGI_OK;
    *curves = (peer_curves){0};
    FILE *file = fopen(path, "r");
    if (!file) return igi_fail(ctx, IGI_E_SYSTEM, "%s: cannot be read (%s)", path, strerror(errno));
    while (status == IGI_OK && fgets(line, sizeof line, file))
        status = r.line++ ? read_line(ctx, &r, line, curves) : read_head(ctx, &r, line);
    fclose(file);
    if (status == IGI_OK && r.line == 0) status = igi_fail(ctx, IGI_E_DATA, "%s: is empty", path);
    end_run(&r);
    for (size_t i = 0; i < curves->count; i++) merge_runs(&curves->curves[i]);
    if (status != IGI_OK) chart_peers_clear(curves);
    return status;
}

void chart_peers_clear(peer_curves *curves)
{
    for (size_t i = 0; i < curves->count; i++) igi_free(curves->curves[i].points);
    igi_free(curves->curves);
    *curves = (peer_curves){0};
}
