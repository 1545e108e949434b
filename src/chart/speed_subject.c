/* SPDX-License-Identifier: Apache-2.0
 *
 * The speed chart's scenes: folders, or specs that are rendered first.
 */
#include "chart/speed.h"
#include "chart/sweep.h"
#include "scene/mesh.h"

#include <igi/output.h>

#include <math.h>

#define RELIT_WIDTH 96 /* pixels: enough for a mean over a picture */
#define RELIT_SAMPLES 64
#define PATCH_SHARE 0.0105 /* of the scene's diagonal: what recovery takes by itself */

static const char *const standard_specs[SPEED_STANDARD_SCENES] = {"demo-room.json",
                                                                  "sweeps/rooms/room.json"};

static void clear_subject(speed_subject *s)
{
    chart_relit_clear(&s->relit);
    igi_materials_destroy(s->truth);
    igi_scene_destroy(s->scene);
    *s = (speed_subject){0};
}

/* Under lights that recovery never saw, as the first camera sees it. */
static igi_status load_relit(igi_context *ctx, const char *folder, speed_subject *s)
{
    char *path = NULL;
    igi_camera camera = s->scene->frames[0].camera;
    double shrink = RELIT_WIDTH / (double)camera.width;
    camera.width = RELIT_WIDTH;
    camera.height = (int)(camera.height * shrink);
    camera.fl_x *= shrink;
    camera.fl_y *= shrink;
    camera.cx *= shrink;
    camera.cy *= shrink;
    s->relit = (chart_relit){.scene = s->scene, .camera = camera, .samples = RELIT_SAMPLES};
    IGI_TRY(igi_strprintf(ctx, &path, "%s/relit/lights.json", folder));
    igi_status status = igi_lights_load(ctx, s->scene, path, &s->relit.own_lights,
                                        &s->relit.light_count);
    igi_free(path);
    s->relit.lights = s->relit.own_lights;
    return status == IGI_OK ? chart_relit_begin(ctx, s->truth, &s->relit) : status;
}

static igi_status load_subject(igi_context *ctx, const char *folder, bool relit, speed_subject *s)
{
    igi_status status = IGI_OK;
    char *path = NULL;
    *s = (speed_subject){0};
    double began = igi_cpu_seconds();
    IGI_TRY_GOTO(igi_scene_load(ctx, folder, &s->scene));
    s->load_s = igi_cpu_seconds() - began;
    IGI_TRY_GOTO(igi_strprintf(ctx, &path, "%s/truth", folder));
    IGI_TRY_GOTO(igi_materials_load(ctx, path, &s->truth));
    igi_box box = igi_mesh_box(&s->scene->mesh);
    s->patch_m = PATCH_SHARE * (double)igi_box_diagonal(&box);
    if (relit) IGI_TRY_GOTO(load_relit(ctx, folder, s));
cleanup:
    igi_free(path);
    if (status != IGI_OK) clear_subject(s);
    return status;
}

/* The n-th scene of the options, or the n-th standard one where they name none; a spec is rendered
 * into the folder `rooms` unless it is there. */
static igi_status make_subject(igi_context *ctx, const igi_chart_options *options, size_t n,
                               const char *rooms, speed_subject *s)
{
    igi_status status = IGI_OK;
    char *base = NULL;
    chart_room room = {.seed = 0};
    const igi_json no_changes = {.value = NULL};
    if (options->scene_count) IGI_TRY_GOTO(igi_strdup(ctx, options->scenes[n], &base));
    else IGI_TRY_GOTO(igi_strprintf(ctx, &base, "%s/%s", options->datasets, standard_specs[n]));
    IGI_TRY_GOTO(
        chart_room_plan(ctx, base, &no_changes, 0, igi_seed(ctx), rooms, options->small, &room));
    IGI_TRY_GOTO(chart_room_make(ctx, &room));
    IGI_TRY_GOTO(load_subject(ctx, room.folder, options->relit, s));
cleanup:
    chart_room_clear(&room);
    igi_free(base);
    return status;
}

igi_status speed_subjects_make(igi_context *ctx, const igi_chart_options *options,
                               const char *folder, speed_subjects *s)
{
    igi_status status = IGI_OK;
    char *path = NULL;
    size_t count = options->scene_count ? options->scene_count : SPEED_STANDARD_SCENES;
    const char *rooms = options->cache;
    *s = (speed_subjects){0};
    if (!rooms) { /* never committed: what is rendered there goes when it is destroyed */
        IGI_TRY_GOTO(igi_strprintf(ctx, &path, "%s/scratch", folder));
        IGI_TRY_GOTO(igi_output_begin(ctx, path, false, NULL, &s->scratch));
        rooms = igi_output_folder(s->scratch);
    }
    IGI_TRY_GOTO(IGI_ALLOC(ctx, count, &s->all));
    for (; s->count < count; s->count++)
        IGI_TRY_GOTO(make_subject(ctx, options, s->count, rooms, &s->all[s->count]));
cleanup:
    igi_free(path);
    return status;
}

void speed_subjects_clear(speed_subjects *s)
{
    for (size_t i = 0; i < s->count; i++) clear_subject(&s->all[i]);
    igi_free(s->all);
    igi_output_destroy(s->scratch);
}
