/* SPDX-License-Identifier: Apache-2.0
 *
 * Speed against accuracy: every method climbs a ladder of budgets on every scene. What is timed is
 * the recovery, from the photographs' files to materials with maps, on one thread.
 */
#include "chart/speed.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

/* A rung: the side of a patch in multiples of the standard one, and rays; 0: the method's own. Or an
 * error to aim at: igi chooses the photographs, pixels, patches and rays. */
typedef struct rung {
    igi_method method;
    double patch;
    int rays;
    bool small; /* part of the tests' edition */
    double target;
} rung;

static const rung ladder[] = {
    {IGI_METHOD_PATCHES, 0, 0, false, .01},   {IGI_METHOD_PATCHES, 0, 0, false, .005},
    {IGI_METHOD_PATCHES, 0, 0, false, .003},  {IGI_METHOD_PATCHES, 4, 8, true, 0},
    {IGI_METHOD_PATCHES, 3, 16, false, 0},    {IGI_METHOD_PATCHES, 2.5, 16, false, 0},
    {IGI_METHOD_PATCHES, 1.5, 32, true, 0},   {IGI_METHOD_PATCHES, 1, 64, false, 0},
    {IGI_METHOD_PATCHES, 1, 256, false, 0},   {IGI_METHOD_GATHER, 2, 4, false, 0},
    {IGI_METHOD_GATHER, 1, 16, false, 0},     {IGI_METHOD_GATHER, 1, 64, false, 0},
    {IGI_METHOD_GATHER, 1, 256, false, 0},    {IGI_METHOD_GATHER, 1, 1024, false, 0},
    {IGI_METHOD_RADIOSITY, 6, 0, false, 0},   {IGI_METHOD_RADIOSITY, 4, 0, false, 0},
    {IGI_METHOD_RADIOSITY, 2.5, 0, false, 0}, {IGI_METHOD_RADIOSITY, 1.5, 0, false, 0},
    {IGI_METHOD_RADIOSITY, 1, 0, false, 0},   {IGI_METHOD_YU99, 6, 0, false, 0},
    {IGI_METHOD_YU99, 4, 0, false, 0},        {IGI_METHOD_YU99, 2.5, 0, false, 0},
    {IGI_METHOD_YU99, 1.5, 0, false, 0},      {IGI_METHOD_YU99, 1, 0, false, 0},
    {IGI_METHOD_DIRECT, 6, 0, true, 0},       {IGI_METHOD_DIRECT, 2.5, 0, false, 0},
    {IGI_METHOD_DIRECT, 1, 0, true, 0},       {IGI_METHOD_DIRECT, .7, 0, false, 0}};

/* Lets the most resident memory begin anew, where the system can (Linux: proc(5), clear_refs). */
static void forget_peak(void)
{
    FILE *file = fopen("/proc/self/clear_refs", "w");
    if (!file) return;
    fputs("5", file);
    fclose(file);
}

static void describe(const chart_case *c, speed_row *row)
{
    const double none = (double)NAN;
    const igi_validation *v = c->validation;
    row->refused = c->status != IGI_OK;
    row->albedo = row->albedo_max = row->specular = row->alpha = row->texels = row->relit = none;
    row->rays = c->rays;
    row->photographs = c->photographs;
    row->cpu_s = c->cpu_s;
    row->peak_bytes = c->peak_bytes;
    if (!v) return;
    row->albedo = v->albedo_mean;
    row->albedo_max = v->albedo_max;
    row->specular = v->specular_mean;
    row->alpha = v->alpha_mean;
    row->texels = v->texture_median;
    row->models = v->models;
    row->models_right = v->models_right;
    row->parameters = chart_parameters(c->materials);
}

/* Peers are told which surfaces shine. So is what is compared with them on their own ground: where
 * none does, a rung with a target looks for no lobe. */
static bool has_lobes(const igi_materials *truth)
{
    for (size_t i = 0; i < truth->count; i++)
        if (truth->materials[i].model != IGI_LAMBERT) return true;
    return false;
}

static igi_status climb(igi_context *ctx, const speed_subject *s, const rung *step,
                        speed_rows *rows)
{
    igi_status status = IGI_OK;
    chart_case c = {.status = IGI_OK};
    double before, after; /* a busy machine is slow, and not always equally so */
    igi_recover_options options;
    igi_recover_options_init(&options);
    options.method = step->method;
    options.patch_m = step->patch * s->patch_m;
    options.rays = step->rays;
    options.target_error = step->target;
    if (step->target > 0 && !has_lobes(s->truth)) options.model = IGI_LAMBERT;
    void *grown = igi_grow(ctx, rows->rows, &rows->capacity, rows->count + 1, sizeof *rows->rows);
    if (!grown) return IGI_E_SYSTEM;
    rows->rows = grown;
    speed_row *row = &rows->rows[rows->count];
    *row = (speed_row){.scene = s->scene->name,
                       .method = step->method,
                       .patch_m = options.patch_m,
                       .rays_each = step->rays,
                       .target = step->target};
    IGI_TRY(chart_reference_seconds(ctx, &before));
    forget_peak();
    IGI_TRY_GOTO(chart_case_run(ctx, s->scene, s->truth, &options, igi_seed(ctx), &c));
    describe(&c, row);
    row->cpu_s += s->load_s;
    IGI_TRY_GOTO(chart_reference_seconds(ctx, &after));
    row->ratio = row->cpu_s / ((before + after) / 2);
    if (c.materials) IGI_TRY_GOTO(chart_relit_error(ctx, &s->relit, c.materials, &row->relit));
    rows->count++;
cleanup:
    chart_case_clear(&c);
    return status;
}

/* The front of one scene's rows: nothing that is as quick is more accurate. */
static void mark_front(speed_row *rows, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        rows[i].front = !isnan(rows[i].albedo);
        for (size_t k = 0; k < count; k++)
            if (rows[k].cpu_s < rows[i].cpu_s && rows[k].albedo <= rows[i].albedo)
                rows[i].front = false;
    }
}

typedef struct range {
    double low, high;
} range;

/* The first recovery of a process pays for reading files and touching memory; nobody counts it. */
static igi_status warm_up(igi_context *ctx, const speed_subject *s)
{
    chart_case c;
    igi_recover_options options;
    igi_recover_options_init(&options);
    options.method = IGI_METHOD_DIRECT;
    options.patch_m = 6 * s->patch_m;
    IGI_TRY(chart_case_run(ctx, s->scene, s->truth, &options, igi_seed(ctx), &c));
    chart_case_clear(&c);
    return IGI_OK;
}

typedef struct tables {
    speed_rows speed;
    spare_rows spare;
    peer_curves peers;
} tables;

static igi_status run_scene(igi_context *ctx, const speed_subject *s, bool small, range part,
                            tables *t)
{
    size_t steps = sizeof ladder / sizeof ladder[0], first = t->speed.count;
    IGI_TRY(warm_up(ctx, s));
    for (size_t i = 0; i < steps; i++) {
        if (small && !ladder[i].small) continue;
        IGI_TRY(climb(ctx, s, &ladder[i], &t->speed));
        double done = (double)(i + 1) / (double)(steps + 2);
        IGI_TRY(igi_progress(ctx, part.low + done * (part.high - part.low)));
    }
    mark_front(t->speed.rows + first, t->speed.count - first);
    return chart_spare_scene(ctx, s, &t->spare);
}

igi_status igi_chart_speed(igi_context *ctx, const igi_chart_options *options, const char *folder)
{
    igi_status status = IGI_OK;
    tables t = {.speed.count = 0};
    speed_subjects subjects = {.count = 0};
    igi_stage_begin(ctx, "rooms"); /* mistakes are found before the long work */
    if (options->peer) IGI_TRY_GOTO(chart_peers_load(ctx, options->peer, &t.peers));
    IGI_TRY_GOTO(speed_subjects_make(ctx, options, folder, &subjects));
    igi_stage_begin(ctx, "speed");
    for (size_t i = 0; i < subjects.count; i++) {
        double count = (double)subjects.count;
        range part = {(double)i / count, (double)(i + 1) / count};
        IGI_TRY_GOTO(run_scene(ctx, &subjects.all[i], options->small, part, &t));
    }
    IGI_TRY_GOTO(chart_speed_save(ctx, &t.speed, &t.peers, folder));
    IGI_TRY_GOTO(chart_spare_save(ctx, &t.spare, folder));
cleanup:
    igi_stage_begin(ctx, NULL);
    speed_subjects_clear(&subjects);
    igi_free(t.speed.rows);
    igi_free(t.spare.rows);
    chart_peers_clear(&t.peers);
    return status;
}
