/* SPDX-License-Identifier: Apache-2.0
 *
 * The outer loop. A camera that is off sees other edges than it will: so edges are found, the camera
 * is moved, and edges are found again, nearer each time. A photograph is read once and refined to
 * its end; one similarity for all comes first when it is asked for.
 */
#include "base/context.h"
#include "base/parallel.h"
#include "scene/camera.h"
#include "lens/photographs.h"
#include "observe/agreement.h"
#include "observe/alignment.h"
#include "register/register_private.h"

#include <math.h>
#include <string.h>

/* Pixels: edges this near are found at least. */
#define NEAREST 1.5
#define ROUNDS 5
#define LENS_ROUNDS 3
/* A camera is moved where that leaves less than this share of the residual, and the edges gain more
 * by it than six numbers gain by chance (chi-square, 1 %). */
#define BETTER .98
#define GAIN 16.8
/* Of what edges gain that the others tell of (predict.c), so much must be gained by that alone; and over
 * all cameras, of what all edges gain: else the mesh is off, not they. (Rooms whose cameras are off have
 * .77 to .96 of it; with things moved .6 and .7, with corners moved 0.) */
#define PREDICTED .5
#define PREDICTED_BY_ALL .73
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

/* A camera before and after, and what speaks for moving it (pose_prediction). */
typedef struct evidence {
    igi_camera start;
    double gain, most;
} evidence;

typedef struct job {
    igi_scene *scene;
    const igi_tracer *tracer;
    const igi_photographs *photographs;
    const igi_register_options *options;
    igi_registered *out;
    igi_edge_sites *sites;           /* [frame_count] for what is done together */
    igi_camera *given;               /* [frame_count] */
    igi_registration *registrations; /* [frame_count] */
    igi_alignment alignment;
    evidence *evidence; /* [frame_count] */
} job;

void igi_register_options_init(igi_register_options *options)
{
    *options = (igi_register_options){
        .struct_size = sizeof *options, .search_px = 4, .compare = true};
}

static igi_status take(igi_context *ctx, const job *j, size_t frame, igi_image **photo)
{
    char *warning;
    IGI_TRY(igi_photographs_load(ctx, j->photographs, frame, photo, &warning));
    igi_free(warning);
    return IGI_OK;
}

static igi_status find_sites(igi_context *ctx, const job *j, const igi_camera *camera,
                             const igi_image *photo, double reach, igi_edge_sites *sites)
{
    igi_status status = IGI_OK;
    igi_visible visible = {0};
    const igi_edge_search search = {j->scene, j->tracer, camera, photo, &visible, reach, SIZE_MAX};
    IGI_TRY_GOTO(igi_visible_create(ctx, j->scene, j->tracer, camera, &visible));
    IGI_TRY_GOTO(igi_edge_sites_find(ctx, &search, sites));
cleanup:
    igi_visible_clear(&visible);
    return status;
}

static igi_status find_for_all(igi_context *ctx, void *user, size_t frame, int worker)
{
    job *j = user;
    igi_image *photo;
    (void)worker;
    IGI_TRY(take(ctx, j, frame, &photo));
    igi_status status = find_sites(ctx, j, &j->scene->frames[frame].camera, photo,
                                   j->options->search_px, &j->sites[frame]);
    igi_image_destroy(photo);
    return status;
}

static void compose(const igi_similarity *then, igi_similarity *s)
{
    igi_similarity first = *s;
    s->scale = then->scale * first.scale;
    for (int i = 0; i < 3; i++) {
        s->offset[i] = then->offset[i];
        for (int j = 0; j < 3; j++) {
            s->rotation[i][j] = 0;
            s->offset[i] += then->scale * then->rotation[i][j] * first.offset[j];
            for (int k = 0; k < 3; k++)
                s->rotation[i][j] += then->rotation[i][k] * first.rotation[k][j];
        }
    }
}

static igi_status refine_together(igi_context *ctx, job *j)
{
    igi_status status = IGI_OK;
    igi_similarity step;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, j->scene->frame_count, &j->sites));
    for (int round = 0; round < 3; round++) {
        IGI_TRY_GOTO(igi_parallel_for(ctx, j->scene->frame_count, find_for_all, j));
        IGI_TRY_GOTO(pose_refine_together(ctx, j->sites, j->scene, &step));
        compose(&step, &j->out->together);
    }
cleanup:
    for (size_t i = 0; j->sites && i < j->scene->frame_count; i++) igi_free(j->sites[i].sites);
    igi_free(j->sites);
    j->sites = NULL;
    return status;
}

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

/* ---- what all share ---- */

static igi_status measure_frame(igi_context *ctx, void *user, size_t frame, int worker)
{
    job *j = user;
    igi_status status = IGI_OK;
    igi_image *photo = NULL;
    igi_visible visible = {0};
    const igi_camera *camera = &j->scene->frames[frame].camera;
    (void)worker;
    IGI_TRY_GOTO(take(ctx, j, frame, &photo));
    IGI_TRY_GOTO(igi_visible_create(ctx, j->scene, j->tracer, camera, &visible));
    IGI_TRY_GOTO(igi_registration_measure(ctx, j->scene, j->tracer, camera, photo, &visible,
                                          &j->registrations[frame]));
cleanup:
    igi_visible_clear(&visible);
    igi_image_destroy(photo);
    return status;
}

static igi_status measure(igi_context *ctx, job *j)
{
    IGI_TRY(igi_parallel_for(ctx, j->scene->frame_count, measure_frame, j));
    return igi_alignment_judge(ctx, j->registrations, j->scene->frame_count, &j->alignment);
}

/* A principal point and a focal length that are wrong move all pictures alike, which poses do not: they
 * are put right first. Pictures that a calibration made have those that they were made for. */
static igi_status refine_lens(igi_context *ctx, job *j)
{
    igi_registered *r = j->out;
    IGI_TRY(measure(ctx, j));
    r->shared.magnification = 1;
    for (int round = 0; round < LENS_ROUNDS && !j->scene->calibration; round++) {
        const igi_alignment a = j->alignment;
        if (!a.shift_is_shared && !a.magnified_is_shared) break;
        double larger = 1;
        for (size_t i = 0; i < j->scene->frame_count; i++) {
            igi_camera *c = &j->scene->frames[i].camera;
            if (a.magnified_is_shared)
                larger = 1 + a.magnified / hypot(c->width / 2.0, c->height / 2.0);
            c->cx += a.shift_is_shared ? a.shift[0] : 0;
            c->cy += a.shift_is_shared ? a.shift[1] : 0;
            c->fl_x *= larger;
            c->fl_y *= larger;
        }
        r->shared.magnification *= larger;
        for (int k = 0; k < 2; k++) r->shared.shift_px[k] += a.shift_is_shared ? a.shift[k] : 0;
        r->lens = true;
        IGI_TRY(measure(ctx, j));
    }
    return IGI_OK;
}

/* ---- each camera ---- */

/* What each number of its place is expected to move the picture by. */
static double expected_px(const job *j, size_t frame)
{
    const igi_registration *r = &j->registrations[frame];
    double shift = j->alignment.typical_px;
    if (j->alignment.known == 0) return UNKNOWN_PX;
    if (igi_registration_is_off(r)) shift = fmax(shift, r->shift);
    return fmax(LEAST_PX, PART_OF_SHIFT * shift);
}

typedef struct frame_job {
    const job *j;
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

/* Finds and refines until the camera settles. */
static igi_status refine_from(igi_context *ctx, frame_job *f, double reach, double expected,
                              attempt *a)
{
    for (int round = 0; round < ROUNDS; round++) {
        igi_camera before = a->camera;
        IGI_TRY(find_sites(ctx, f->j, &a->camera, f->photo, reach, &f->sites));
        if (round == 0) IGI_TRY(pose_residual(ctx, &f->sites, &a->camera, &a->out.before_px));
        IGI_TRY(pose_refine(ctx, &f->sites, expected, &a->camera, &a->out.sigma_px));
        double moved = shift_between(&f->sites, &before, &a->camera);
        if (reach <= NEAREST && moved < .01) break;
        reach = fmax(NEAREST, fmin(reach / 2, 3 * moved));
    }
    IGI_TRY(find_sites(ctx, f->j, &a->camera, f->photo, NEAREST, &f->sites));
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
    a->better = a->out.after_px < BETTER * fmin(there, a->out.before_px) && a->gain > GAIN &&
                p.told_gain >= PREDICTED * p.told_most;
    return IGI_OK;
}

static igi_status try_far(igi_context *ctx, frame_job *f, attempt *a)
{
    attempt far;
    IGI_TRY(find_sites(ctx, f->j, f->start, f->photo, NEAREST, &f->sites));
    size_t edges = f->sites.count;
    IGI_TRY(try_from(ctx, f, FAR, PART_OF_SHIFT * FAR, &far));
    if (far.better && (double)far.out.edges >= AS_MANY * (double)edges) *a = far;
    return IGI_OK;
}

static igi_status register_frame(igi_context *ctx, void *user, size_t frame, int worker)
{
    job *j = user;
    igi_status status = IGI_OK;
    igi_image *photo = NULL;
    igi_camera *camera = &j->scene->frames[frame].camera;
    const igi_camera start = *camera;
    const igi_registration *r = &j->registrations[frame];
    igi_registered_frame *out = &j->out->frames[frame];
    frame_job f = {.j = j, .start = &start};
    attempt a = {.better = false};
    (void)worker;
    IGI_TRY_GOTO(take(ctx, j, frame, &photo));
    f.photo = photo;
    IGI_TRY_GOTO(try_from(ctx, &f, j->options->search_px, expected_px(j, frame), &a));
    if (!a.better && (r->edges == 0 || r->shift_error > UNSURE_PX || igi_registration_is_off(r)))
        IGI_TRY_GOTO(try_far(ctx, &f, &a));
    j->evidence[frame] = (evidence){.start = start};
    if (a.gain > GAIN) {
        j->evidence[frame].gain = a.predicted.gain;
        j->evidence[frame].most = a.predicted.most;
    }
    a.out.image = out->image;
    *out = a.out;
    if (a.better) *camera = a.camera;
    else out->after_px = out->before_px;
    out->moved = a.better || j->out->lens;
    if (!out->moved || isnan(out->before_px)) goto cleanup;
    IGI_TRY_GOTO(find_sites(ctx, j, camera, photo, NEAREST, &f.sites));
    out->moved_px = shift_between(&f.sites, camera, &j->given[frame]);
    if (j->out->lens) status = pose_residual(ctx, &f.sites, &j->given[frame], &out->before_px);
    if (status == IGI_E_NO_ANSWER) status = IGI_OK;
cleanup:
    igi_free(f.sites.sites);
    igi_image_destroy(photo);
    return status;
}

/* Where things moved, many a camera finds a place that suits what it sees of them; over all cameras,
 * they do not agree. */
static void judge_mesh(job *j)
{
    double gain = 0, most = 0;
    for (size_t i = 0; i < j->scene->frame_count; i++) {
        gain += j->evidence[i].gain;
        most += j->evidence[i].most;
    }
    j->out->mesh_is_off = gain < PREDICTED_BY_ALL * most;
    if (!j->out->mesh_is_off) return;
    for (size_t i = 0; i < j->scene->frame_count; i++) {
        igi_registered_frame *f = &j->out->frames[i];
        j->scene->frames[i].camera = j->evidence[i].start;
        f->moved = j->out->lens;
        f->after_px = f->before_px;
        if (!f->moved) f->moved_px = 0;
    }
}

static igi_status sum_up(igi_context *ctx, igi_registered *r)
{
    double before = 0, after = 0;
    size_t known = 0;
    for (size_t i = 0; i < r->frame_count; i++) {
        if (isnan(r->frames[i].after_px)) continue;
        before += r->frames[i].before_px * r->frames[i].before_px;
        after += r->frames[i].after_px * r->frames[i].after_px;
        known++;
    }
    if (known == 0)
        return igi_fail(ctx, IGI_E_NO_ANSWER,
                        "no photograph shows enough edges of the mesh; bring the cameras nearer "
                        "first (--points), or widen --search");
    r->before_px = sqrt(before / (double)known);
    r->after_px = sqrt(after / (double)known);
    return IGI_OK;
}

/* Root mean square of ln gain. */
static double spread_of_gains(const igi_agreement *a)
{
    double sum = 0, count = 0;
    for (size_t i = 0; i < a->frame_count; i++) {
        if (!a->frames[i].places) continue;
        sum += log(a->frames[i].gain) * log(a->frames[i].gain);
        count++;
    }
    return count > 0 ? sqrt(sum / count) : 0;
}

/* Reads the photographs once more, with the cameras as they now are. */
static igi_status compare_photographs(igi_context *ctx, const igi_scene *scene,
                                      const igi_tracer *tracer, igi_registered *r)
{
    igi_status status = IGI_OK;
    igi_observations *observations = NULL;
    igi_agreement *agreement = NULL;
    igi_glimpses glimpses = {0};
    IGI_TRY_GOTO(igi_observe(ctx, scene, tracer, 0, &observations));
    IGI_TRY_GOTO(igi_glimpses_create(ctx, scene, observations, &glimpses));
    IGI_TRY_GOTO(igi_agreement_create(ctx, scene, &glimpses, &agreement));
    r->gain_spread = spread_of_gains(agreement);
    r->contradicts = agreement->typical_share;
    for (size_t i = 0; i < r->frame_count; i++) {
        r->frames[i].gain = agreement->frames[i].gain;
        r->frames[i].gain_sigma = agreement->frames[i].gain_error;
    }
cleanup:
    igi_agreement_destroy(agreement);
    igi_glimpses_clear(&glimpses);
    igi_observations_destroy(observations);
    return status;
}

igi_status igi_register(igi_context *ctx, igi_scene *scene, const igi_register_options *options,
                        igi_registered **registered)
{
    igi_status status = IGI_OK;
    igi_register_options o;
    igi_tracer *tracer = NULL;
    igi_photographs *photographs = NULL;
    igi_registered *r = NULL;
    job j = {0};
    *registered = NULL;
    igi_register_options_init(&o);
    if (options) o = *options;
    igi_stage_begin(ctx, "register");
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &r));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, scene->frame_count, &r->frames));
    r->frame_count = scene->frame_count;
    r->together.scale = 1;
    for (int i = 0; i < 3; i++) r->together.rotation[i][i] = 1;
    IGI_TRY_GOTO(igi_tracer_create(ctx, &scene->mesh, &tracer));
    IGI_TRY_GOTO(igi_photographs_open(ctx, scene, &photographs));
    j = (job){
        .scene = scene, .tracer = tracer, .photographs = photographs, .options = &o, .out = r};
    IGI_TRY_GOTO(IGI_ALLOC(ctx, scene->frame_count, &j.given));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, scene->frame_count, &j.registrations));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, scene->frame_count, &j.evidence));
    for (size_t i = 0; i < scene->frame_count; i++) {
        j.given[i] = scene->frames[i].camera;
        IGI_TRY_GOTO(igi_strdup(ctx, scene->frames[i].name, &r->frames[i].image));
    }
    if (o.together) IGI_TRY_GOTO(refine_together(ctx, &j));
    IGI_TRY_GOTO(refine_lens(ctx, &j));
    IGI_TRY_GOTO(igi_parallel_for(ctx, scene->frame_count, register_frame, &j));
    judge_mesh(&j);
    IGI_TRY_GOTO(sum_up(ctx, r));
    if (o.compare) IGI_TRY_GOTO(compare_photographs(ctx, scene, tracer, r));
    *registered = r;
    r = NULL;
cleanup:
    igi_stage_begin(ctx, NULL);
    igi_registered_destroy(r);
    igi_free(j.given);
    igi_free(j.registrations);
    igi_free(j.evidence);
    igi_photographs_close(photographs);
    igi_tracer_destroy(tracer);
    return status;
}

void igi_registered_destroy(igi_registered *registered)
{
    if (!registered) return;
    for (size_t i = 0; registered->frames && i < registered->frame_count; i++)
        igi_free(registered->frames[i].image);
    igi_free(registered->frames);
    igi_free(registered);
}
