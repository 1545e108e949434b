/* SPDX-License-Identifier: Apache-2.0
 *
 * One shot: a few hundred points of each region gather light from what the photographs show, and
 * nothing is solved. What a ray meets is looked up on the patches, or in a photograph that shows
 * that very place; what no photograph shows is given the mean of what the other rays of its row
 * met. Cheaper than all patches, and biased where much is unseen. A single pixel is noisier than a
 * patch, and the strips along edges, where pixels are left out, are unseen to it: patches that
 * reach into them are not.
 */
#include "base/parallel.h"
#include "diffuse/methods.h"
#include "diffuse/region_sums.h"
#include "scene/camera.h"

#define POINTS_A_REGION 512
#define DEFAULT_RAYS 64
#define ROWS_A_TASK 64
#define REACH 1.5f /* footprints from a hit to the place that the pixel over it shows */

/* Marks about POINTS_A_REGION seen sides of each region, evenly through their order. */
static igi_status choose_sides(igi_context *ctx, const igi_problem *p, uint8_t *wanted)
{
    size_t regions = p->scene->region_count, sides = 2 * p->patches->count;
    size_t *seen, *met;
    IGI_TRY(IGI_ALLOC(ctx, 2 * regions, &seen));
    met = seen + regions;
    for (int pass = 0; pass < 2; pass++)
        for (uint32_t side = 0; side < sides; side++) {
            if (igi_problem_seen_count(p, side) == 0) continue;
            uint32_t r = igi_patch_region(p->patches, side >> 1);
            if (pass == 0) {
                seen[r]++;
                continue;
            }
            /* the k-th of n is taken when k * points / n passes a whole number */
            size_t k = met[r]++, n = seen[r] > POINTS_A_REGION ? seen[r] : POINTS_A_REGION;
            wanted[side] = (k + 1) * POINTS_A_REGION / n > k * POINTS_A_REGION / n;
        }
    igi_free(seen);
    return IGI_OK;
}

/* The observation that a frame has of a hit; SIZE_MAX: none. A pixel that shows the same side of a
 * region as near as its footprint shows the hit: nothing is in between, and no ray need tell. */
static size_t look_into(const igi_problem *p, size_t frame, const igi_hit *hit)
{
    const igi_observations *o = p->observations;
    const igi_mesh *mesh = &p->scene->mesh;
    const igi_camera *camera = &p->scene->frames[frame].camera;
    igi_vec point = igi_triangle_point(mesh, hit->triangle, hit->u, hit->v);
    double x, y;
    if (!igi_camera_project(camera, point, &x, &y)) return SIZE_MAX;
    if (!(x >= 0 && y >= 0 && x < camera->width && y < camera->height)) return SIZE_MAX;
    size_t i = igi_observation_at(o, frame, (uint32_t)y * (uint32_t)camera->width + (uint32_t)x);
    if (i == SIZE_MAX) return SIZE_MAX;
    uint32_t surface = o->surface[i], triangle = igi_surface_triangle(surface);
    if (mesh->regions[triangle] != mesh->regions[hit->triangle]) return SIZE_MAX;
    if (igi_surface_is_back(surface) != hit->back) return SIZE_MAX;
    float u = o->uv[2 * i], v = o->uv[2 * i + 1];
    float apart = igi_length(igi_sub(igi_triangle_point(mesh, triangle, u, v), point));
    return apart <= REACH * igi_footprint(p, frame, surface, u, v) ? i : SIZE_MAX;
}

/* The first photograph that shows the hit, from a random one on, so that none is favoured. */
static const float *look_up(const igi_problem *p, const igi_hit *hit, uint64_t random)
{
    size_t frames = p->observations->frame_count;
    for (size_t k = 0; k < frames; k++) {
        size_t i = look_into(p, (size_t)((random + k) % frames), hit);
        if (i != SIZE_MAX) return p->observations->radiance + i * (size_t)p->bands;
    }
    return NULL;
}

typedef struct job {
    const igi_problem *problem;
    const igi_rows *rows;
    float *irradiance; /* [rows][bands] */
} job;

/* What a ray of a row meets, of a surface that reflects; NULL: no photograph shows it. */
static const float *radiance_met(const job *j, size_t ray)
{
    const igi_problem *p = j->problem;
    uint32_t side = j->rows->hits[ray];
    if (j->rows->met) return look_up(p, &j->rows->met[ray], igi_hash64(ray) >> 1);
    return igi_problem_seen_count(p, side) > 0 ? p->seen + side * (size_t)p->bands : NULL;
}

static void gather_row(const job *j, size_t row)
{
    size_t bands = (size_t)j->problem->bands, shown = 0;
    float *irradiance = j->irradiance + row * bands, direct[IGI_MAX_BANDS];
    double sum[IGI_MAX_BANDS] = {0};
    for (size_t ray = j->rows->begin[row]; ray < j->rows->begin[row + 1]; ray++) {
        bool dark = j->rows->hits[ray] == IGI_NO_SIDE; /* lamps are in `direct` */
        const float *radiance = dark ? NULL : radiance_met(j, ray);
        for (size_t b = 0; radiance && b < bands; b++) sum[b] += (double)radiance[b];
        shown += dark || radiance;
    }
    igi_row_direct(j->rows, row, j->problem->lights, j->problem->bands, direct);
    for (size_t b = 0; b < bands; b++)
        irradiance[b] = direct[b] + (shown ? IGI_PIF * (float)(sum[b] / (double)shown) : 0);
}

static igi_status gather_rows(igi_context *ctx, void *user, size_t task, int worker)
{
    (void)ctx;
    (void)worker;
    const job *j = user;
    size_t end = (task + 1) * ROWS_A_TASK;
    for (size_t row = task * ROWS_A_TASK; row < end && row < j->rows->count; row++)
        gather_row(j, row);
    return IGI_OK;
}

igi_status igi_method_gather(igi_context *ctx, const igi_problem *problem, igi_diffuse *diffuse)
{
    igi_status status = IGI_OK;
    igi_rows *rows = NULL;
    float *irradiance = NULL;
    uint8_t *wanted = NULL;
    size_t bands = (size_t)problem->bands;
    int rays = problem->options->rays ? problem->options->rays : DEFAULT_RAYS;
    igi_sites sites = igi_problem_sites(problem);
    igi_stage_begin(ctx, "gather");
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 2 * problem->patches->count, &wanted));
    IGI_TRY_GOTO(choose_sides(ctx, problem, wanted));
    igi_gather_options options = {.rays = rays,
                                  .light_points = rays > 3 ? rays / 3 : 1,
                                  .wanted = wanted,
                                  .keep_met = problem->options->gather_from_photos};
    IGI_TRY_GOTO(igi_rows_create(ctx, problem->scene, problem->patches, problem->tracer,
                                 problem->lighting, &sites, &options, &rows));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, rows->count * bands, &irradiance));
    job j = {problem, rows, irradiance};
    size_t tasks = (rows->count + ROWS_A_TASK - 1) / ROWS_A_TASK;
    IGI_TRY_GOTO(igi_parallel_for(ctx, tasks, gather_rows, &j));
    IGI_TRY_GOTO(igi_albedo_of_rows(ctx, problem, rows, irradiance, diffuse));
cleanup:
    igi_free(wanted);
    igi_free(irradiance);
    igi_rows_destroy(rows);
    return status;
}
