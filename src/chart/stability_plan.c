/* SPDX-License-Identifier: Apache-2.0
 *
 * Which sweeps, of which rooms, with which seeds: all trials, the unperturbed ones first.
 */
#include "chart/stability.h"

#include <dirent.h>
#include <errno.h>
#include <stdlib.h>
#include <string.h>

#define SMALL_PATCH 0.12 /* metres: the small edition is to be quick */

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

static igi_status load_sweeps(chart_study *s)
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
static igi_status need_room(chart_study *s, const char *base, const igi_json *set, double severity,
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

static igi_status add_trial(chart_study *s, const chart_trial *trial)
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

static igi_status need_unperturbed(chart_study *s, const char *base, uint64_t seed,
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

static igi_status plan_sweep(chart_study *s, const chart_sweep *sweep)
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

igi_status chart_study_plan(chart_study *s)
{
    IGI_TRY(load_sweeps(s));
    for (size_t i = 0; i < s->sweep_count; i++) IGI_TRY(plan_sweep(s, &s->sweeps[i]));
    return IGI_OK;
}
