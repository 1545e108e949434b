/* SPDX-License-Identifier: Apache-2.0
 *
 * One camera. Where it is off it sees other edges than it will: so edges are found, the camera is moved,
 * and edges are found again, nearer each time. A photograph is read once and refined to its end.
 */
#include "register/register_private.h"
#include "scene/camera.h"

#include <math.h>
#include <string.h>

/* Pixels: edges this near are found at least. */
#define NEAREST 1.5
#define ROUNDS 5
/* A camera is moved where that leaves less than this share of the residual, and the edges gain more
 * by it than six numbers gain by chance (chi-square, 1 %). */
#define BETTER .98
#define GAIN 16.8
/* Of what edges gain that the others tell of (predict.c), so much must be gained by that alone. */
#define PREDICTED .5
/* Of cameras whose edges are not found near, edges are looked for so far off, pixels; there must be as
 * many then as seem to be where the camera was given. */
#define FAR 10.0
#define AS_MANY .8
#define UNSURE_PX .7
/* A shift of a picture by one pixel, of six numbers that have a part in it; and the least that they are
 * allowed. */
#define PART_OF_SHIFT .45
#define LEAST_PX .1
#define UNKNOWN_PX 2.0
/* In its last round a camera that settles moves by less, pixels. */
#define SETTLED_PX .08

/* Root mean square, over the sites, of the shift of their places between two cameras. */
static double shift_between(const igi_edge_sites *sites, const igi_camera *a, const igi_camera *b)
{
    double sum = 0, p[2], q[2];
    size_t count = 0;
    for (size_t i = 0; i < sites->count; i++) {
        if (!igi_camera_project(a, sites->sites[i].point, &p[0], &p[1]) ||
            !igi_camera_project(b, sites->sites[i].point, &q[0], &q[1]))
            continue;
        sum += (p[0] - q[0]) * (p[0] - q[0]) + (p[1] - q[1]) * (p[1] - q[1]);
        count++;
    }
    return count ? sqrt(sum / (double)count) : 0;
}

/* What each number of its place is expected to move the picture by. */
static double expected_px(const register_job *j, size_t frame)
{
    const igi_registration *r = &j->registrations[frame];
    double shift = j->alignment.typical_px;
    if (j->alignment.known == 0) return UNKNOWN_PX;
    if (igi_registration_is_off(r)) shift = fmax(shift, r->shift);
    return fmax(LEAST_PX, PART_OF_SHIFT * shift);
}

typedef struct frame_job {
    const register_job *j;
    camera_evidence *evidence;
    const igi_image *photo;
    const igi_camera *start;
    igi_edge_sites sites; /* as found last */
} frame_job;

typedef struct attempt {
    igi_camera camera;
    igi_registered_frame out;
    double gain;
    pose_prediction predicted;
    bool better;
} attempt;

/* As they are first found, they favour neither what is given nor what will be found. */
static igi_status keep_sites(igi_context *ctx, frame_job *f)
{
    igi_edge_sites *kept = &f->evidence->sites;
    if (kept->sites) return IGI_OK;
    *kept = f->sites;
    kept->capacity = f->sites.count;
    IGI_TRY(IGI_ALLOC(ctx, f->sites.count, &kept->sites));
    memcpy(kept->sites, f->sites.sites, f->sites.count * sizeof *kept->sites);
    return IGI_OK;
}

/* Finds and refines until the camera settles. */
static igi_status refine_from(igi_context *ctx, frame_job *f, double reach, double expected,
                              attempt *a)
{
    for (int round = 0; round < ROUNDS; round++) {
        igi_camera before = a->camera;
        IGI_TRY(register_find_sites(ctx, f->j, &a->camera, f->photo, reach, &f->sites));
        if (round == 0) IGI_TRY(pose_residual(ctx, &f->sites, &a->camera, &a->out.before_px));
        if (round == 0) IGI_TRY(keep_sites(ctx, f));
        IGI_TRY(pose_refine(ctx, &f->sites, expected, &a->camera, &a->out.sigma_px));
        double moved = shift_between(&f->sites, &before, &a->camera);
        a->out.unsettled = moved > SETTLED_PX;
        if (reach <= NEAREST && moved < .01) break;
        reach = fmax(NEAREST, fmin(reach / 2, 3 * moved));
    }
    IGI_TRY(register_find_sites(ctx, f->j, &a->camera, f->photo, NEAREST, &f->sites));
    a->out.edges = f->sites.count;
    return pose_residual(ctx, &f->sites, &a->camera, &a->out.after_px);
}

/* Is what is found better than where it was? With too few edges it is not. */
static igi_status try_from(igi_context *ctx, frame_job *f, double reach, double expected,
                           attempt *a)
{
    double there, spread;
    pose_prediction p = {0};
    *a = (attempt){.camera = *f->start, .out = {.before_px = (double)NAN, .after_px = (double)NAN}};
    igi_status status = refine_from(ctx, f, reach, expected, a);
    if (status == IGI_OK) status = pose_residual(ctx, &f->sites, f->start, &there);
    if (status == IGI_OK)
        status = pose_gain(ctx, &f->sites, f->start, &a->camera, &a->gain, &spread);
    if (status == IGI_OK) status = pose_predict(ctx, &f->sites, f->start, spread, expected, &p);
    if (status == IGI_E_NO_ANSWER) return IGI_OK;
    IGI_TRY(status);
    a->predicted = p;
    f->evidence->spread = spread;
    a->better = a->out.after_px < BETTER * fmin(there, a->out.before_px) && a->gain > GAIN &&
                p.told_gain >= PREDICTED * p.told_most;
    return IGI_OK;
}

static igi_status try_far(igi_context *ctx, frame_job *f, attempt *a)
{
    attempt far;
    IGI_TRY(register_find_sites(ctx, f->j, f->start, f->photo, NEAREST, &f->sites));
    size_t edges = f->sites.count;
    IGI_TRY(try_from(ctx, f, FAR, PART_OF_SHIFT * FAR, &far));
    if (far.better && (double)far.out.edges >= AS_MANY * (double)edges) *a = far;
    return IGI_OK;
}

/* It stays; what was measured of it stands. */
static void pass_over(const register_job *j, size_t frame)
{
    igi_registered_frame *out = &j->out->frames[frame];
    out->edges = j->registrations[frame].edges;
    out->before_px = out->after_px = (double)NAN;
}

igi_status register_frame(igi_context *ctx, void *user, size_t frame, int worker)
{
    register_job *j = user;
    igi_status status = IGI_OK;
    igi_image *photo = NULL;
    igi_camera *camera = &j->scene->frames[frame].camera;
    const igi_camera start = *camera;
    const igi_registration *r = &j->registrations[frame];
    igi_registered_frame *out = &j->out->frames[frame];
    frame_job f = {.j = j, .evidence = &j->evidence[frame], .start = &start};
    attempt a = {.better = false};
    (void)worker;
    f.evidence->start = start;
    if (j->which && !j->which[frame]) {
        pass_over(j, frame);
        return IGI_OK;
    }
    IGI_TRY_GOTO(register_load(ctx, j, frame, &photo));
    f.photo = photo;
    IGI_TRY_GOTO(try_from(ctx, &f, j->options->search_px, expected_px(j, frame), &a));
    if (!a.better && (r->edges == 0 || r->shift_error > UNSURE_PX || igi_registration_is_off(r)))
        IGI_TRY_GOTO(try_far(ctx, &f, &a));
    if (a.gain > GAIN) {
        f.evidence->gain = a.predicted.gain;
        f.evidence->most = a.predicted.most;
    }
    a.out.image = out->image;
    *out = a.out;
    if (a.better) *camera = a.camera;
    else out->after_px = out->before_px;
    out->unsettled = a.better && out->unsettled;
    out->moved = a.better || j->out->lens || j->out->world;
    if (!out->moved || isnan(out->before_px)) goto cleanup;
    IGI_TRY_GOTO(register_find_sites(ctx, j, camera, photo, NEAREST, &f.sites));
    out->moved_px = shift_between(&f.sites, camera, &j->given[frame]);
    if (j->out->lens || j->out->world)
        status = pose_residual(ctx, &f.sites, &j->given[frame], &out->before_px);
    if (status == IGI_E_NO_ANSWER) status = IGI_OK;
cleanup:
    igi_free(f.sites.sites);
    igi_image_destroy(photo);
    return status;
}
