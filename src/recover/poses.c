/* SPDX-License-Identifier: Apache-2.0 */
#include "recover/poses.h"

#include "observe/alignment.h"
#include "observe/faults.h"
#include "register/register.h"

#include <math.h>
#include <string.h>

/* One camera off among cameras that are right must convince: its edges come this much nearer. Shadows
 * and what is mirrored pass for edges, and a few of them find a camera that suits them. All cameras
 * together must convince likewise. */
#define LEAVES .5

/* Edges lie up to .25 pixels off where cameras and mesh are exact; a mesh that is off by no more is not
 * worth a word. */
#define WORTH_A_WORD_PX .3
/* As scales are found where the mesh is exact. */
#define WORTH_A_SCALE .002

/* Of all photographs. */
#define MOST_LEFT_OUT .34

typedef enum need { NOBODY, SOME, ALL } need;

/* which[frames]: of SOME. */
static igi_status find_need(igi_context *ctx, const igi_observations *o, igi_registering when,
                            need *who, bool *which)
{
    igi_alignment a;
    *who = when == IGI_REGISTER_ALWAYS ? ALL : NOBODY;
    if (when != IGI_REGISTER_AUTO) return IGI_OK;
    IGI_TRY(igi_alignment_judge(ctx, o->registrations, o->frame_count, &a));
    for (size_t i = 0; i < o->frame_count; i++) {
        which[i] = igi_registration_is_off(&o->registrations[i]);
        if (which[i]) *who = SOME;
    }
    if (a.all_off) *who = ALL;
    return IGI_OK;
}

static void keep(const igi_scene *given, igi_poses *p, size_t frame)
{
    igi_registered_frame *f = &p->registered->frames[frame];
    p->scene.frames[frame].camera = given->frames[frame].camera;
    f->moved = false;
    f->after_px = f->before_px;
    f->moved_px = 0;
    f->unsettled = false;
}

void igi_poses_keep_unconvincing(const igi_scene *given, bool all, igi_poses *p)
{
    const igi_registered *r = p->registered;
    bool none = all && r->after_px > LEAVES * r->before_px;
    for (size_t i = 0; i < r->frame_count; i++) {
        const igi_registered_frame *f = &r->frames[i];
        bool one = !all && f->moved && !(f->after_px < LEAVES * f->before_px);
        if (none || one) keep(given, p, i);
    }
}

/* What registering found no better camera for is no camera that is off; its edges are. */
static void clear_refuted(const igi_registered *r, const bool *which, igi_observations *o)
{
    for (size_t i = 0; i < r->frame_count; i++)
        if (!r->frames[i].moved && (!which || which[i]))
            o->registrations[i] = (igi_registration){.residual = o->registrations[i].residual};
}

/* They stay in where so many do that the others are no measure. */
static igi_status leave_unsettled_out(igi_context *ctx, const igi_registered *r,
                                      igi_observations *o)
{
    char *sentence;
    size_t count = 0;
    for (size_t i = 0; i < r->frame_count; i++) count += r->frames[i].unsettled;
    bool out = (double)count <= MOST_LEFT_OUT * (double)r->frame_count;
    for (size_t i = 0; i < r->frame_count; i++) {
        const igi_registered_frame *f = &r->frames[i];
        if (!f->unsettled) continue;
        if (out) igi_observations_leave_out(o, i);
        IGI_TRY(igi_strprintf(
            ctx, &sentence,
            "image %s: its camera was off, and did not settle by its %zu edges; it "
            "was %s give its camera a better start",
            f->image, f->edges, out ? "left out;" : "used, as many others; leave it out, or"));
        IGI_TRY(igi_add_sentence(ctx, &o->warnings, &o->warning_count, sentence));
    }
    return IGI_OK;
}

static size_t count_moved(const igi_registered *r)
{
    size_t moved = 0;
    for (size_t i = 0; i < r->frame_count; i++) moved += r->frames[i].moved;
    return moved;
}

static igi_status say_lens(igi_context *ctx, const igi_registered *r, const igi_scene *scene,
                           igi_observations *o)
{
    char *sentence;
    const double *shift = r->shared.shift_px;
    double larger = r->shared.magnification - 1;
    const igi_camera *c = &scene->frames[0].camera;
    if (hypot(shift[0], shift[1]) > 0) {
        IGI_TRY(
            igi_strprintf(ctx, &sentence,
                          "all photographs are shifted alike against the mesh, by %+.2f columns "
                          "and %+.2f rows: the principal point is off; %.2f, %.2f was taken in "
                          "place of the cameras' cx, cy",
                          shift[0], shift[1], c->cx, c->cy));
        IGI_TRY(igi_add_sentence(ctx, &o->warnings, &o->warning_count, sentence));
    }
    if (larger == 0) return IGI_OK;
    IGI_TRY(
        igi_strprintf(ctx, &sentence,
                      "all photographs are %.2f %% %s than the mesh as the cameras have it: the "
                      "focal length is off; %.2f was taken in place of fl_x",
                      100 * fabs(larger), larger > 0 ? "larger" : "smaller", c->fl_x));
    return igi_add_sentence(ctx, &o->warnings, &o->warning_count, sentence);
}

/* A scale is told from the mesh's size, a turn and a move by what they do in its middle. */
static igi_status say_world(igi_context *ctx, const igi_registered *r, igi_observations *o)
{
    char *sentence;
    double larger = r->together.scale - 1;
    if (fabs(larger) < WORTH_A_SCALE)
        IGI_TRY(
            igi_strprintf(ctx, &sentence,
                          "all cameras are off alike against the mesh: they were moved together, "
                          "by a turn and a move; the frames of reference of cameras and mesh "
                          "differ: igi register --points"));
    else
        IGI_TRY(igi_strprintf(ctx, &sentence,
                              "the mesh is %.2f %% %s than the room as the cameras have it: their "
                              "places were scaled to the mesh; lengths, and lights given by their "
                              "places, are right only if the mesh is",
                              100 * fabs(larger), larger > 0 ? "larger" : "smaller"));
    return igi_add_sentence(ctx, &o->warnings, &o->warning_count, sentence);
}

static igi_status say_mesh(igi_context *ctx, const igi_registered *r, igi_observations *o)
{
    char *sentence;
    IGI_TRY(igi_strprintf(ctx, &sentence,
                          "the photographs' edges lie %.2f pixels off the mesh's, and edges of "
                          "different things ask for different cameras: things were moved, or the "
                          "mesh is not exact; mend it",
                          r->before_px));
    return igi_add_sentence(ctx, &o->warnings, &o->warning_count, sentence);
}

static igi_status say(igi_context *ctx, const igi_registered *r, const igi_scene *scene,
                      igi_observations *o)
{
    char *sentence;
    if (r->lens) IGI_TRY(say_lens(ctx, r, scene, o));
    if (r->world) IGI_TRY(say_world(ctx, r, o));
    IGI_TRY(
        igi_strprintf(ctx, &sentence,
                      "cameras were off: the photographs' edges lay %.2f pixels off the mesh's; "
                      "%zu of %zu cameras were registered, to %.2f pixels; --register never "
                      "keeps them as given",
                      r->before_px, count_moved(r), r->frame_count, r->after_px));
    return igi_add_sentence(ctx, &o->warnings, &o->warning_count, sentence);
}

/* *poses: NULL where too few edges tell. */
static igi_status find(igi_context *ctx, const igi_scene *scene, const igi_register_start *start,
                       igi_poses **poses)
{
    igi_status status = IGI_OK;
    igi_register_options options;
    igi_poses *p = NULL;
    igi_register_options_init(&options);
    options.compare = false;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &p));
    p->scene = *scene;
    p->scene.frames = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, scene->frame_count, &p->scene.frames));
    memcpy(p->scene.frames, scene->frames, scene->frame_count * sizeof *scene->frames);
    status = igi_register_from(ctx, &p->scene, start, &options, &p->registered);
    if (status == IGI_E_NO_ANSWER) { /* they stay as given */
        status = IGI_OK;
        goto cleanup;
    }
    IGI_TRY_GOTO(status);
    *poses = p;
    p = NULL;
cleanup:
    igi_poses_destroy(p);
    return status;
}

igi_status igi_poses_mend(igi_context *ctx, const igi_scene *scene, const igi_tracer *tracer,
                          igi_registering when, igi_observations **observations, igi_poses **poses)
{
    igi_status status = IGI_OK;
    igi_observations *again = NULL;
    igi_poses *p = NULL;
    bool *which = NULL;
    need who;
    *poses = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, scene->frame_count, &which));
    IGI_TRY_GOTO(find_need(ctx, *observations, when, &who, which));
    if (who == NOBODY) goto cleanup;
    igi_register_start start = {.tracer = tracer,
                                .registrations = (*observations)->registrations,
                                .which = who == SOME ? which : NULL};
    IGI_TRY_GOTO(find(ctx, scene, &start, &p));
    if (!p) goto cleanup;
    if (when == IGI_REGISTER_AUTO) igi_poses_keep_unconvincing(scene, who == ALL, p);
    if (count_moved(p->registered) > 0) {
        igi_stage_begin(ctx, "observe");
        IGI_TRY_GOTO(igi_observe(ctx, &p->scene, tracer, 0, &again));
        IGI_TRY_GOTO(say(ctx, p->registered, &p->scene, again));
        IGI_TRY_GOTO(leave_unsettled_out(ctx, p->registered, again));
        igi_observations_destroy(*observations);
        *observations = again;
        again = NULL;
    }
    if ((*observations)->registrations) clear_refuted(p->registered, start.which, *observations);
    if (p->registered->mesh_is_off && p->registered->before_px > WORTH_A_WORD_PX)
        IGI_TRY_GOTO(say_mesh(ctx, p->registered, *observations));
    if (count_moved(p->registered) == 0) goto cleanup;
    *poses = p;
    p = NULL;
cleanup:
    igi_free(which);
    igi_observations_destroy(again);
    igi_poses_destroy(p);
    return status;
}

void igi_poses_destroy(igi_poses *poses)
{
    if (!poses) return;
    igi_free(poses->scene.frames);
    igi_registered_destroy(poses->registered);
    igi_free(poses);
}
