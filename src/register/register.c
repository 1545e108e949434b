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
#include "register/register_private.h"

#include <math.h>
#include <string.h>

/* Pixels: edges this near are found at least. */
#define NEAREST 1.5
#define ROUNDS 5
/* A frame counts as moved when that leaves less than this share of the residual, or so little of it
 * that there is nothing to gain. */
#define BETTER .98

typedef struct job {
    igi_scene *scene;
    const igi_tracer *tracer;
    const igi_photographs *photographs;
    const igi_register_options *options;
    igi_registered *out;
    edge_sites *sites; /* [frame_count] for what is done together */
    double search_px;
} job;

void igi_register_options_init(igi_register_options *options)
{
    *options = (igi_register_options){.struct_size = sizeof *options, .search_px = 4};
}

static igi_status take(igi_context *ctx, const job *j, size_t frame, igi_image **photo)
{
    char *warning;
    IGI_TRY(igi_photographs_load(ctx, j->photographs, frame, photo, &warning));
    igi_free(warning);
    return IGI_OK;
}

static igi_status find_for_all(igi_context *ctx, void *user, size_t frame, int worker)
{
    job *j = user;
    igi_image *photo;
    (void)worker;
    IGI_TRY(take(ctx, j, frame, &photo));
    j->sites[frame].count = 0;
    igi_status status = edge_sites_find(ctx, j->scene, j->tracer, &j->scene->frames[frame].camera,
                                        photo, j->search_px, &j->sites[frame]);
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
static double shift_between(const edge_sites *sites, const igi_camera *a, const igi_camera *b)
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

/* Finds and refines until the camera settles; `sites` holds what was found last. */
static igi_status refine_frame(igi_context *ctx, const job *j, const igi_image *photo,
                               igi_camera *camera, edge_sites *sites, igi_registered_frame *out)
{
    double reach = j->search_px;
    for (int round = 0; round < ROUNDS; round++) {
        igi_camera before = *camera;
        sites->count = 0;
        IGI_TRY(edge_sites_find(ctx, j->scene, j->tracer, camera, photo, reach, sites));
        if (round == 0) IGI_TRY(pose_residual(ctx, sites, camera, &out->before_px));
        IGI_TRY(pose_refine(ctx, sites, camera, &out->sigma_px));
        double moved = shift_between(sites, &before, camera);
        if (reach <= NEAREST && moved < .01) break;
        reach = fmax(NEAREST, fmin(reach / 2, 3 * moved));
    }
    sites->count = 0;
    IGI_TRY(edge_sites_find(ctx, j->scene, j->tracer, camera, photo, NEAREST, sites));
    out->edges = sites->count;
    return pose_residual(ctx, sites, camera, &out->after_px);
}

static igi_status register_frame(igi_context *ctx, void *user, size_t frame, int worker)
{
    job *j = user;
    igi_status status = IGI_OK;
    igi_image *photo = NULL;
    edge_sites sites = {0};
    igi_registered_frame *out = &j->out->frames[frame];
    igi_camera camera = j->scene->frames[frame].camera;
    (void)worker;
    out->before_px = out->after_px = (double)NAN;
    IGI_TRY_GOTO(take(ctx, j, frame, &photo));
    status = refine_frame(ctx, j, photo, &camera, &sites, out);
    if (status == IGI_E_NO_ANSWER) status = IGI_OK; /* it stays where it is, and says so */
    else if (status == IGI_OK && out->after_px < BETTER * out->before_px) {
        out->moved = true;
        out->moved_px = shift_between(&sites, &camera, &j->scene->frames[frame].camera);
        j->scene->frames[frame].camera = camera;
    } else if (status == IGI_OK) {
        out->after_px = out->before_px;
    }
cleanup:
    igi_free(sites.sites);
    igi_image_destroy(photo);
    return status;
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
    IGI_TRY_GOTO(igi_observe(ctx, scene, tracer, 0, &observations));
    IGI_TRY_GOTO(igi_agreement_create(ctx, scene, observations, &agreement));
    r->gain_spread = spread_of_gains(agreement);
    r->contradicts = agreement->typical_share;
    for (size_t i = 0; i < r->frame_count; i++) {
        r->frames[i].gain = agreement->frames[i].gain;
        r->frames[i].gain_sigma = agreement->frames[i].gain_error;
    }
cleanup:
    igi_agreement_destroy(agreement);
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
    job j = {scene, tracer, photographs, &o, r, NULL, o.search_px};
    if (o.together) IGI_TRY_GOTO(refine_together(ctx, &j));
    IGI_TRY_GOTO(igi_parallel_for(ctx, scene->frame_count, register_frame, &j));
    IGI_TRY_GOTO(sum_up(ctx, r));
    IGI_TRY_GOTO(compare_photographs(ctx, scene, tracer, r));
    *registered = r;
    r = NULL;
cleanup:
    igi_stage_begin(ctx, NULL);
    igi_registered_destroy(r);
    igi_photographs_close(photographs);
    igi_tracer_destroy(tracer);
    return status;
}

void igi_registered_destroy(igi_registered *registered)
{
    if (!registered) return;
    igi_free(registered->frames);
    igi_free(registered);
}
