/* SPDX-License-Identifier: Apache-2.0
 *
 * What all photographs share comes before what each has of its own: a wrong principal point or focal length
 * moves all pictures alike, and so do cameras that share a frame of reference which is not the mesh's
 * (its scale, above all). A magnified picture may be either; from different places, things at different
 * distances tell. Both are fitted to the same edges, and each camera by itself, and Bayes' information
 * criterion chooses.
 */
#include "base/parallel.h"
#include "register/register_private.h"

#include <math.h>
#include <string.h>

#define SHARED_ROUNDS 3
#define TOGETHER_ROUNDS 3

static igi_status find_for_all(igi_context *ctx, void *user, size_t frame, int worker)
{
    register_job *j = user;
    igi_image *photo;
    (void)worker;
    IGI_TRY(register_load(ctx, j, frame, &photo));
    igi_status status = register_find_sites(ctx, j, &j->scene->frames[frame].camera, photo,
                                            j->options->search_px, &j->sites[frame]);
    igi_image_destroy(photo);
    return status;
}

static igi_status find_all(igi_context *ctx, register_job *j)
{
    return igi_parallel_for(ctx, j->scene->frame_count, find_for_all, j);
}

static void forget_sites(register_job *j)
{
    for (size_t i = 0; j->sites && i < j->scene->frame_count; i++) igi_free(j->sites[i].sites);
    igi_free(j->sites);
    j->sites = NULL;
}

static void apply(register_job *j, const pose_shared *s)
{
    igi_registered *r = j->out;
    if (s->kind == POSE_OF_ALL) {
        igi_scene_move_cameras(j->scene, &s->similarity);
        similarity_compose(&s->similarity, &r->together);
        return;
    }
    const igi_camera *first = &j->scene->frames[0].camera;
    double before = first->fl_x;
    for (size_t i = 0; i < j->scene->frame_count; i++)
        lens_change(s->change, &j->scene->frames[i].camera);
    r->shared.magnification *= first->fl_x / before;
    for (int k = 0; k < 2; k++) r->shared.shift_px[k] += s->change[k];
}

igi_status register_together(igi_context *ctx, register_job *j)
{
    igi_status status = IGI_OK;
    pose_shared step;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, j->scene->frame_count, &j->sites));
    for (int round = 0; round < TOGETHER_ROUNDS; round++) {
        IGI_TRY_GOTO(find_all(ctx, j));
        IGI_TRY_GOTO(pose_refine_shared(ctx, j->sites, j->scene, POSE_OF_ALL, &step));
        apply(j, &step);
    }
cleanup:
    forget_sites(j);
    return status;
}

static igi_status measure_frame(igi_context *ctx, void *user, size_t frame, int worker)
{
    register_job *j = user;
    igi_status status = IGI_OK;
    igi_image *photo = NULL;
    igi_visible visible = {0};
    const igi_camera *camera = &j->scene->frames[frame].camera;
    (void)worker;
    IGI_TRY_GOTO(register_load(ctx, j, frame, &photo));
    IGI_TRY_GOTO(igi_visible_create(ctx, j->scene, j->tracer, camera, &visible));
    IGI_TRY_GOTO(igi_registration_measure(ctx, j->scene, j->tracer, camera, photo, &visible,
                                          &j->registrations[frame]));
cleanup:
    igi_visible_clear(&visible);
    igi_image_destroy(photo);
    return status;
}

static igi_status measure(igi_context *ctx, register_job *j)
{
    IGI_TRY(igi_parallel_for(ctx, j->scene->frame_count, measure_frame, j));
    return igi_alignment_judge(ctx, j->registrations, j->scene->frame_count, &j->alignment);
}

static igi_status fit(igi_context *ctx, const register_job *j, pose_kind kind, pose_shared *best)
{
    pose_shared found;
    IGI_TRY(pose_refine_shared(ctx, j->sites, j->scene, kind, &found));
    if (found.criterion < best->criterion) *best = found;
    return IGI_OK;
}

/* POSE_OF_ONE: they share nothing. Pictures that a calibration made have the lens that they were made
 * for. */
static igi_status choose(igi_context *ctx, register_job *j, pose_shared *best)
{
    *best = (pose_shared){.kind = POSE_OF_ONE};
    IGI_TRY(find_all(ctx, j));
    IGI_TRY(pose_criterion_each(ctx, j->sites, j->scene, &best->criterion));
    IGI_TRY(fit(ctx, j, POSE_OF_ALL, best));
    if (!j->scene->calibration) IGI_TRY(fit(ctx, j, POSE_OF_LENS, best));
    return IGI_OK;
}

static igi_status refine_shared(igi_context *ctx, register_job *j)
{
    pose_shared best;
    IGI_TRY(IGI_ALLOC(ctx, j->scene->frame_count, &j->sites));
    IGI_TRY(choose(ctx, j, &best));
    if (best.kind == POSE_OF_ONE) return IGI_OK;
    for (int round = 0;; round++) {
        apply(j, &best);
        if (round + 1 == SHARED_ROUNDS) break;
        IGI_TRY(find_all(ctx, j));
        IGI_TRY(pose_refine_shared(ctx, j->sites, j->scene, best.kind, &best));
    }
    j->out->lens = best.kind == POSE_OF_LENS;
    j->out->world = best.kind == POSE_OF_ALL;
    return measure(ctx, j);
}

/* Where a few cameras or none seem to be off, nothing is shared. */
igi_status register_shared(igi_context *ctx, register_job *j)
{
    j->out->shared.magnification = 1;
    if (!j->measured) IGI_TRY(measure(ctx, j));
    if (j->which || !j->alignment.all_off) return IGI_OK;
    igi_status status = refine_shared(ctx, j);
    forget_sites(j);
    return status;
}
