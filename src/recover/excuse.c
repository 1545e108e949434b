/* SPDX-License-Identifier: Apache-2.0
 *
 * A lamp mirrored in a surface makes one photograph brighter than the others, or the others brighter
 * than one. Of a radiance L where the diffuse part is D and the lobe's S,
 *     L D / (D + S)
 * is what photographs must agree about: as noisy as L, and hardly wrong where S is wrong by a little.
 */
#include "recover/excuse.h"

#include "base/parallel.h"
#include "observe/faults.h"
#include "specular/lobe_view.h"

#include <string.h>

typedef struct job {
    const igi_problem *problem;
    const igi_diffuse *diffuse;
    float *explained; /* [observations][bands] */
} job;

static igi_status explain_frame(igi_context *ctx, void *user, size_t frame, int worker)
{
    const job *j = user;
    const igi_problem *p = j->problem;
    const igi_observations *o = p->observations;
    size_t bands = (size_t)p->bands;
    (void)ctx, (void)worker;
    for (size_t i = o->frame_begin[frame]; i < o->frame_begin[frame + 1]; i++) {
        float lobe[IGI_MAX_BANDS] = {0};
        igi_hit hit = {.triangle = igi_surface_triangle(o->surface[i]),
                       .u = o->uv[2 * i],
                       .v = o->uv[2 * i + 1],
                       .back = igi_surface_is_back(o->surface[i])};
        igi_lobe_view_radiance(p->lobes, p, frame, &hit, lobe);
        uint32_t side = igi_side_at(p->patches, hit.triangle, hit.u, hit.v, hit.back);
        const float *diffuse = j->diffuse->radiance + side * bands;
        for (size_t b = 0; b < bands; b++)
            if (lobe[b] > 0)
                j->explained[i * bands + b] *= fmaxf(0, diffuse[b]) /
                                               (fmaxf(0, diffuse[b]) + lobe[b]);
    }
    return IGI_OK;
}

igi_status igi_excuse_photographs(igi_context *ctx, const igi_problem *problem,
                                  const igi_diffuse *diffuse, igi_observations *observations,
                                  bool *again)
{
    igi_status status = IGI_OK;
    igi_observations *o = observations;
    size_t count = o->count * (size_t)o->bands;
    job j = {problem, diffuse, NULL};
    igi_stage_begin(ctx, "agreement");
    IGI_TRY_GOTO(IGI_ALLOC(ctx, count, &j.explained));
    memcpy(j.explained, o->radiance, count * sizeof *j.explained);
    IGI_TRY_GOTO(igi_parallel_for(ctx, o->frame_count, explain_frame, &j));
    IGI_TRY_GOTO(igi_observations_reconcile_rest(ctx, problem->scene, j.explained, o, again));
cleanup:
    igi_free(j.explained);
    return status;
}
