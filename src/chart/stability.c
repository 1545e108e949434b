/* SPDX-License-Identifier: Apache-2.0
 *
 * Stability where the method's assumptions fail. All trials of all sweeps are planned, the rooms
 * that they need are rendered, and all trials are run side by side; then each severity is summed up.
 */
#include "chart/stability.h"

#include "base/parallel.h"

#include <igi/output.h>

#define RELIT_SAMPLES 8 /* paths a pixel; the true picture has the same */

void igi_chart_options_init(igi_chart_options *options)
{
    *options = (igi_chart_options){.struct_size = sizeof *options,
                                   .datasets = "datasets-synthetic"};
}

/* With the random numbers that the room's trials have. */
static igi_status load_relit(igi_context *ctx, chart_room *room)
{
    igi_context *own;
    IGI_TRY(chart_own_context(ctx, room->seed, &own));
    igi_status status = chart_relit_load(own, room->folder, RELIT_SAMPLES, &room->relit);
    if (status != IGI_OK) status = igi_fail(ctx, status, "%s", igi_context_message(own));
    igi_context_destroy(own);
    return status;
}

static igi_status make_room(igi_context *ctx, void *user, size_t index, int worker)
{
    (void)worker;
    const chart_study *s = user;
    chart_room *room = s->rooms[index];
    IGI_TRY(chart_room_make(ctx, room));
    return load_relit(ctx, room);
}

static igi_status run_trial(igi_context *ctx, void *user, size_t index, int worker)
{
    (void)worker;
    chart_study *s = user;
    return chart_trial_run(ctx, s->work, index, s->trials[index]);
}

static igi_status work_through(chart_study *s, const char *folder, igi_stability **result)
{
    igi_context *ctx = s->ctx;
    IGI_TRY(chart_study_plan(s));
    igi_stage_begin(ctx, "rooms");
    IGI_TRY(igi_parallel_for(ctx, s->room_count, make_room, s));
    igi_stage_begin(ctx, "trials");
    IGI_TRY(igi_parallel_for(ctx, s->trial_count, run_trial, s));
    igi_stage_begin(ctx, "draw");
    IGI_TRY(chart_trials_save(ctx, s->trials, s->trial_count, folder));
    IGI_TRY(chart_study_sum(s, result));
    return chart_stability_save(ctx, *result, folder);
}

igi_status igi_chart_stability(igi_context *ctx, const igi_chart_options *options,
                               const char *folder, igi_stability **result)
{
    igi_status status = IGI_OK;
    igi_output *scratch = NULL;
    char *path = NULL;
    chart_study s = {.ctx = ctx, .options = options, .rooms_folder = options->cache};
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
