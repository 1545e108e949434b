/* SPDX-License-Identifier: Apache-2.0
 *
 * Stability where the method's assumptions fail. All trials of all sweeps are planned, the rooms
 * that they need are rendered, and all trials are run side by side; then each severity is summed up.
 *
 * A sweep breaks down at the first severity whose median error of albedo is above three times that
 * of the unperturbed rooms and above one per cent.
 */
#include "chart/trial.h"

#include "base/order.h"
#include "base/parallel.h"

#include <igi/output.h>

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define WORSE 3.0
#define TOO_WRONG 0.01
#define SMALL_PATCH 0.12 /* metres: the small edition is to be quick */

typedef struct study {
    igi_context *ctx;
    const igi_chart_options *options;
    const char *rooms_folder, *work;
    size_t sweep_count;
    chart_sweep *sweeps;
    size_t room_count, room_capacity;
    chart_room **rooms;
    size_t trial_count, trial_capacity;
    chart_trial **trials; /* the unperturbed ones before those that need them */
} study;

void igi_chart_options_init(igi_chart_options *options)
{
    *options = (igi_chart_options){.struct_size = sizeof *options,
                                   .datasets = "datasets-synthetic"};
}

static int compare_names(const void *a, const void *b)
{
    return strcmp(*(char *const *)a, *(char *const *)b);
}

/* The .json files of a folder, sorted. */
static igi_status list_files(igi_context *ctx, const char *folder, char ***names, size_t *count)
{
    size_t capacity = 0;
    DIR *at = opendir(folder);
    if (!at)
        return igi_fail(ctx, IGI_E_DATA, "%s: no folder of sweeps (%s); name it with --datasets",
                        folder, strerror(errno));
    igi_status status = IGI_OK;
    for (struct dirent *e = readdir(at); e && status == IGI_OK; e = readdir(at)) {
        if (!igi_ends_with(e->d_name, ".json")) continue;
        char **grown = igi_grow(ctx, *names, &capacity, *count + 1, sizeof *grown);
        if (!grown) status = IGI_E_SYSTEM;
        if (status != IGI_OK) break;
        *names = grown;
        status = igi_strprintf(ctx, &grown[*count], "%s/%s", folder, e->d_name);
        *count += status == IGI_OK;
    }
    closedir(at);
    if (status == IGI_OK && *count) qsort(*names, *count, sizeof **names, compare_names);
    return status;
}

/* A name among the standard sweeps, or a path. */
static igi_status sweep_path(igi_context *ctx, const char *folder, const char *name, char **path)
{
    if (igi_file_exists(name)) return igi_strdup(ctx, name, path);
    return igi_strprintf(ctx, path, "%s/%s.json", folder, name);
}

static igi_status load_sweeps(study *s)
{
    igi_context *ctx = s->ctx;
    const igi_chart_options *o = s->options;
    char *folder = NULL, **paths = NULL;
    size_t count = 0;
    igi_status status = IGI_OK;
    IGI_TRY_GOTO(igi_strprintf(ctx, &folder, "%s/sweeps", o->datasets));
    if (o->sweep_count) IGI_TRY_GOTO(IGI_ALLOC(ctx, o->sweep_count, &paths));
    for (; count < o->sweep_count; count++)
        IGI_TRY_GOTO(sweep_path(ctx, folder, o->sweeps[count], &paths[count]));
    if (!o->sweep_count) IGI_TRY_GOTO(list_files(ctx, folder, &paths, &count));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, count, &s->sweeps));
    for (size_t i = 0; i < count; i++) {
        chart_sweep *sweep = &s->sweeps[s->sweep_count++];
        IGI_TRY_GOTO(chart_sweep_load(ctx, paths[i], o, sweep));
        if (!o->small || o->sweep_count || sweep->in_small) continue;
        chart_sweep_clear(sweep);
        s->sweep_count--;
    }
    if (!s->sweep_count)
        status = igi_fail(ctx, IGI_E_DATA, "%s: holds no sweep; name one with --sweeps", folder);
cleanup:
    for (size_t i = 0; paths && i < count; i++) igi_free(paths[i]);
    igi_free(paths);
    igi_free(folder);
    return status;
}

/* The room of that base and severity, planned once for all. */
static igi_status need_room(study *s, const char *base, const igi_json *set, double severity,
                            uint64_t seed, const chart_room **room)
{
    chart_room *planned = NULL;
    igi_status status = IGI_OK;
    IGI_TRY(IGI_ALLOC(s->ctx, 1, &planned));
    IGI_TRY_GOTO(chart_room_plan(s->ctx, base, set, severity, seed, s->rooms_folder,
                                 s->options->small, planned));
    for (size_t i = 0; i < s->room_count; i++)
        if (strcmp(s->rooms[i]->folder, planned->folder) == 0) {
            *room = s->rooms[i];
            goto cleanup;
        }
    chart_room **grown = igi_grow(s->ctx, s->rooms, &s->room_capacity, s->room_count + 1,
                                  sizeof *grown);
    IGI_TRY_GOTO(grown ? IGI_OK : IGI_E_SYSTEM);
    s->rooms = grown;
    *room = grown[s->room_count++] = planned;
    return IGI_OK;
cleanup:
    chart_room_clear(planned);
    igi_free(planned);
    return status;
}

static igi_status add_trial(study *s, const chart_trial *trial)
{
    chart_trial **grown = igi_grow(s->ctx, s->trials, &s->trial_capacity, s->trial_count + 1,
                                   sizeof *grown);
    if (!grown) return IGI_E_SYSTEM;
    s->trials = grown;
    IGI_TRY(IGI_ALLOC(s->ctx, 1, &grown[s->trial_count]));
    *grown[s->trial_count] = *trial;
    if (s->options->small) grown[s->trial_count]->patch_m = SMALL_PATCH;
    s->trial_count++;
    return IGI_OK;
}

static igi_status need_unperturbed(study *s, const char *base, uint64_t seed,
                                   const chart_trial **trial)
{
    const igi_json none = {.value = NULL};
    chart_trial t = {.base = base, .seed = seed};
    for (size_t i = 0; i < s->trial_count; i++)
        if (!s->trials[i]->sweep && s->trials[i]->seed == seed &&
            strcmp(s->trials[i]->base, base) == 0) {
            *trial = s->trials[i];
            return IGI_OK;
        }
    IGI_TRY(need_room(s, base, &none, 0, seed, &t.room));
    IGI_TRY(add_trial(s, &t));
    *trial = s->trials[s->trial_count - 1];
    return IGI_OK;
}

static igi_status plan_sweep(study *s, const chart_sweep *sweep)
{
    for (size_t point = 0; point < sweep->severity_count; point++)
        for (size_t base = 0; base < sweep->base_count; base++)
            for (int seed = 0; seed < sweep->seeds; seed++) {
                chart_trial t = {.sweep = sweep,
                                 .point = point,
                                 .base = sweep->bases[base],
                                 .seed = igi_seed(s->ctx) + (uint64_t)seed};
                if (igi_is_folder(t.base) && sweep->set.value) continue; /* there is no spec */
                IGI_TRY(need_unperturbed(s, t.base, t.seed, &t.unperturbed));
                IGI_TRY(
                    need_room(s, t.base, &sweep->set, sweep->severities[point], t.seed, &t.room));
                IGI_TRY(add_trial(s, &t));
            }
    return IGI_OK;
}

static igi_status make_room(igi_context *ctx, void *user, size_t index, int worker)
{
    (void)worker;
    const study *s = user;
    return chart_room_make(ctx, s->rooms[index]);
}

static igi_status run_trial(igi_context *ctx, void *user, size_t index, int worker)
{
    (void)worker;
    study *s = user;
    return chart_trial_run(ctx, s->work, index, s->trials[index]);
}

/* The median of a field over the trials of a point that have it. */
static double median_of(const study *s, const chart_sweep *sweep, size_t point, size_t field,
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
static double too_wrong(const study *s, const chart_sweep *sweep, double *values)
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

static void sum_up(const study *s, const chart_sweep *sweep, size_t point, double *values,
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
static igi_status sum_up_sweep(const study *s, const chart_sweep *sweep, double *values,
                               igi_sweep_result *r)
{
    igi_context *ctx = s->ctx;
    IGI_TRY(igi_strdup(ctx, sweep ? sweep->name : "unperturbed", &r->name));
    IGI_TRY(igi_strdup(ctx, sweep ? sweep->about : "the rooms as they are", &r->about));
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

static igi_status sum_up_all(const study *s, igi_stability **result)
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

static igi_status work_through(study *s, const char *folder, igi_stability **result)
{
    igi_context *ctx = s->ctx;
    IGI_TRY(load_sweeps(s));
    for (size_t i = 0; i < s->sweep_count; i++) IGI_TRY(plan_sweep(s, &s->sweeps[i]));
    igi_stage_begin(ctx, "rooms");
    IGI_TRY(igi_parallel_for(ctx, s->room_count, make_room, s));
    igi_stage_begin(ctx, "trials");
    IGI_TRY(igi_parallel_for(ctx, s->trial_count, run_trial, s));
    igi_stage_begin(ctx, "draw");
    IGI_TRY(chart_trials_save(ctx, s->trials, s->trial_count, folder));
    IGI_TRY(sum_up_all(s, result));
    return chart_stability_save(ctx, *result, folder);
}

igi_status igi_chart_stability(igi_context *ctx, const igi_chart_options *options,
                               const char *folder, igi_stability **result)
{
    igi_status status = IGI_OK;
    igi_output *scratch = NULL;
    char *path = NULL;
    study s = {.ctx = ctx, .options = options, .rooms_folder = options->cache};
    *result = NULL;
    /* Never committed: what is written there goes when it is destroyed. */
    IGI_TRY_GOTO(igi_strprintf(ctx, &path, "%s/scratch", folder));
    IGI_TRY_GOTO(igi_output_begin(ctx, path, false, NULL, &scratch));
    s.work = igi_output_folder(scratch);
    if (!s.rooms_folder) s.rooms_folder = s.work;
    IGI_TRY_GOTO(work_through(&s, folder, result));
cleanup:
    igi_stage_begin(ctx, NULL);
    for (size_t i = 0; i < s.trial_count; i++) {
        chart_trial_clear(s.trials[i]);
        igi_free(s.trials[i]);
    }
    for (size_t i = 0; i < s.room_count; i++) {
        chart_room_clear(s.rooms[i]);
        igi_free(s.rooms[i]);
    }
    for (size_t i = 0; i < s.sweep_count; i++) chart_sweep_clear(&s.sweeps[i]);
    igi_free(s.trials);
    igi_free(s.rooms);
    igi_free(s.sweeps);
    igi_output_destroy(scratch);
    igi_free(path);
    if (status != IGI_OK) {
        igi_stability_destroy(*result);
        *result = NULL;
    }
    return status;
}

void igi_stability_destroy(igi_stability *stability)
{
    if (!stability) return;
    for (size_t i = 0; stability->sweeps && i < stability->sweep_count; i++) {
        igi_sweep_result *s = &stability->sweeps[i];
        igi_free(s->name);
        igi_free(s->about);
        igi_free(s->label);
        igi_free(s->unit);
        igi_free(s->points);
    }
    for (size_t i = 0; i < stability->goal_count; i++) igi_free(stability->goals[i].what);
    igi_free(stability->goals);
    igi_free(stability->sweeps);
    igi_free(stability);
}
