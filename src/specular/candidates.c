/* SPDX-License-Identifier: Apache-2.0 */
#include "specular/candidates.h"

#include "scene/camera.h"

#define CANDIDATES 100000 /* pixels of a region to choose from, at most */
#define FLAT_SIDES 16     /* a region of more directions is curved */

igi_pixel_view igi_pixel_view_of(const igi_problem *problem, size_t observation)
{
    const igi_observations *o = problem->observations;
    uint32_t surface = o->surface[observation], triangle = igi_surface_triangle(surface);
    igi_pixel_view v;
    v.camera = &problem->scene->frames[igi_observation_frame(o, observation)].camera;
    v.pixel = o->pixel[observation];
    v.point = igi_triangle_point(&problem->scene->mesh, triangle, o->uv[2 * observation],
                                 o->uv[2 * observation + 1]);
    v.normal = igi_tracer_normal(problem->tracer, triangle);
    if (igi_surface_is_back(surface)) v.normal = igi_scale(v.normal, -1);
    v.out = igi_normalize(igi_sub(igi_camera_centre(v.camera), v.point));
    return v;
}

uint32_t igi_observation_region(const igi_problem *problem, size_t observation)
{
    return problem->scene->mesh
        .regions[igi_surface_triangle(problem->observations->surface[observation])];
}

/* Does the region turn through more directions than a thing of flat sides would? */
static void find_curved(const igi_problem *p, bool *curved)
{
    igi_vec known[FLAT_SIDES];
    for (uint32_t r = 0; r < p->scene->region_count; r++) {
        size_t count = 0;
        for (uint32_t t = 0; t < p->scene->mesh.triangle_count && !curved[r]; t++) {
            if (p->scene->mesh.regions[t] != r) continue;
            igi_vec n = igi_tracer_normal(p->tracer, t);
            size_t k = 0;
            while (k < count && igi_dot(known[k], n) < 0.9999f) k++;
            if (k < count) continue;
            if (count == FLAT_SIDES) curved[r] = true;
            else known[count++] = n;
        }
    }
}

igi_status igi_candidates_create(igi_context *ctx, const igi_problem *problem,
                                 igi_candidates *candidates)
{
    const igi_observations *o = problem->observations;
    size_t regions = problem->scene->region_count, *total = NULL;
    igi_status status = IGI_OK;
    *candidates = (igi_candidates){NULL, NULL, NULL};
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 3 * regions, &total));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions, &candidates->curved));
    find_curved(problem, candidates->curved);
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions + 1, &candidates->begin));
    size_t *stride = total + regions, *seen = stride + regions;
    for (size_t i = 0; i < o->count; i++) total[igi_observation_region(problem, i)]++;
    for (size_t r = 0; r < regions; r++) {
        stride[r] = total[r] / CANDIDATES + 1;
        candidates->begin[r + 1] = candidates->begin[r] + (total[r] + stride[r] - 1) / stride[r];
    }
    IGI_TRY_GOTO(IGI_ALLOC(ctx, candidates->begin[regions], &candidates->observation));
    for (size_t i = 0; i < o->count; i++) {
        size_t r = igi_observation_region(problem, i), k = seen[r]++;
        if (k % stride[r] == 0)
            candidates->observation[candidates->begin[r] + k / stride[r]] = (uint32_t)i;
    }
cleanup:
    igi_free(total);
    if (status != IGI_OK) igi_candidates_clear(candidates);
    return status;
}

void igi_candidates_clear(igi_candidates *candidates)
{
    igi_free(candidates->begin);
    igi_free(candidates->observation);
    igi_free(candidates->curved);
    *candidates = (igi_candidates){NULL, NULL, NULL};
}
