/* SPDX-License-Identifier: Apache-2.0 */
#include "specular/correction.h"

#include "base/order.h"
#include "base/parallel.h"
#include "specular/effort.h"
#include "specular/lobe_photons.h"
#include "specular/side_views.h"

#include <string.h>

#define SIDES_A_TASK 64
#define SEEN_SAMPLES 40000 /* photographs' pixels of a region whose lobe is taken out, about; */
#define FIRST_SHARE 4      /* fewer in the first round, which only refining uses */
#define FEWEST_SAMPLES 12
#define MOST_SAMPLES 512
#define VIEW_SAMPLES 4 /* of a view, at least */
#define RECEIVED_SAMPLES \
    120000               /* rays of a region's rows that look for lobes, about; of each row */
#define LEAST_RECEIVED 8 /* so many at least, half of those it gathers with at most */
#define MOST_RECEIVED 512

typedef struct region_level {
    size_t sides, rows;
    igi_side_level level;
} region_level;

typedef struct job {
    const igi_problem *problem;
    const igi_radiance_field *field;
    const igi_diffuse *diffuse;
    igi_correction *correction;
    const region_level *regions;
    uint64_t round;
} job;

/* The rows of a large region are many, and smoothed over neighbours. */
static int received_samples(const job *j, size_t row)
{
    const igi_rows *rows = j->diffuse->rows;
    const region_level *r =
        &j->regions[igi_patch_region(j->problem->patches, rows->side[row] >> 1)];
    size_t most = (rows->begin[row + 1] - rows->begin[row]) / 2;
    size_t samples = RECEIVED_SAMPLES / (j->round == 0 ? FIRST_SHARE : 1) / r->rows;
    if (samples < LEAST_RECEIVED) samples = LEAST_RECEIVED;
    if (samples > most) samples = most;
    return samples > MOST_RECEIVED ? MOST_RECEIVED : samples > 1 ? (int)samples : 2;
}

/* Irradiance of a row by surfaces in the lobes of what its rays meet. */
static uint64_t received_part(const job *j, size_t row, igi_rng *rng)
{
    const igi_problem *p = j->problem;
    const igi_rows *rows = j->diffuse->rows;
    uint32_t side = rows->side[row];
    size_t bands = (size_t)p->bands;
    int samples = received_samples(j, row);
    float sum[IGI_MAX_BANDS] = {0};
    uint64_t rays = 0;
    float start[2] = {igi_rng_float(rng), igi_rng_float(rng)};
    for (int k = 0; k < samples; k++) {
        uint32_t triangle;
        float u, v, x = start[0] + (float)k * 0.7548776662f,
                    y = start[1] + (float)k * 0.5698402910f;
        igi_patch_sample(p->patches, side >> 1, rng, &triangle, &u, &v);
        igi_vec point = igi_triangle_point(&p->scene->mesh, triangle, u, v);
        igi_vec normal = igi_tracer_normal(p->tracer, triangle);
        if (side & 1) normal = igi_scale(normal, -1);
        igi_vec direction = igi_cosine_direction(normal, x - floorf(x), y - floorf(y));
        igi_hit hit = igi_trace(p->tracer, point, direction);
        rays++;
        if (hit.triangle == IGI_NO_HIT) continue;
        const igi_lobe *lobe = &j->field->lobes[p->scene->mesh.regions[hit.triangle]];
        if (lobe->model == IGI_LAMBERT) continue;
        igi_vec met = igi_tracer_normal(p->tracer, hit.triangle);
        if (hit.back) met = igi_scale(met, -1);
        rays += (uint64_t)igi_lobe_radiance(j->field, lobe,
                                            igi_madd(point, direction, hit.distance), met,
                                            igi_scale(direction, -1), rng, NULL, sum);
    }
    for (size_t b = 0; b < bands; b++)
        j->correction->received[row * bands + b] = sum[b] * IGI_PIF / (float)samples;
    return rays;
}

/* The lobe's part of what was seen of a side. */
static uint64_t seen_part(const job *j, uint32_t side, igi_rng *rng)
{
    uint32_t region = igi_patch_region(j->problem->patches, side >> 1);
    const region_level *r = &j->regions[region];
    if (igi_problem_seen_count(j->problem, side) == 0) return 0;
    if (j->field->lobes[region].model == IGI_LAMBERT) return 0;
    bool roughly = j->round == 0 || igi_lobe_effort(j->problem->options) < 0.5;
    int samples = (int)(SEEN_SAMPLES / (roughly ? FIRST_SHARE : 1) / r->sides);
    samples = samples < FEWEST_SAMPLES ? FEWEST_SAMPLES : samples;
    samples = samples > MOST_SAMPLES ? MOST_SAMPLES : samples;
    const float *before = j->diffuse->radiance + side * (size_t)j->problem->bands;
    igi_side_effort effort = {samples, roughly ? 2 : VIEW_SAMPLES};
    return igi_side_views_part(j->field, side, effort, before, r->level, rng, j->correction);
}

static igi_status correct_rows(igi_context *ctx, void *user, size_t task, int worker)
{
    (void)worker;
    const job *j = user;
    const igi_rows *rows = j->diffuse->rows;
    uint64_t rays = 0;
    size_t end = (task + 1) * SIDES_A_TASK;
    if (end > rows->count) end = rows->count;
    for (size_t row = task * SIDES_A_TASK; row < end; row++) {
        igi_rng rng = igi_rng_make(igi_seed(ctx) + 0x51ec + j->round, row);
        rays += seen_part(j, rows->side[row], &rng);
        rays += received_part(j, row, &rng);
    }
    igi_count_rays(ctx, rays);
    return IGI_OK;
}

static void average_regions(const igi_problem *p, const igi_diffuse *diffuse, region_level *regions)
{
    size_t bands = (size_t)p->bands;
    for (size_t i = 0; i < diffuse->rows->seen_count; i++) {
        uint32_t side = diffuse->rows->side[i];
        region_level *r = &regions[igi_patch_region(p->patches, side >> 1)];
        r->sides++;
        r->level.seen += igi_mean(p->seen + side * bands, bands);
        r->level.diffuse += fmax(0, igi_mean(diffuse->radiance + side * bands, bands));
    }
    for (size_t row = 0; row < diffuse->rows->count; row++)
        regions[igi_patch_region(p->patches, diffuse->rows->side[row] >> 1)].rows++;
    for (size_t r = 0; r < p->scene->region_count; r++) {
        regions[r].level.seen /= fmax(1, (double)regions[r].sides);
        regions[r].level.diffuse /= fmax(1, (double)regions[r].sides);
    }
}

igi_status igi_correction_find(igi_context *ctx, const igi_radiance_field *field,
                               const igi_diffuse *diffuse, uint64_t round,
                               igi_correction *correction)
{
    const igi_problem *p = field->problem;
    region_level *regions;
    size_t sides = 2 * p->patches->count, bands = (size_t)p->bands;
    IGI_TRY(IGI_ALLOC(ctx, p->scene->region_count, &regions));
    average_regions(p, diffuse, regions);
    memset(correction->seen, 0, sides * bands * sizeof(float));
    memset(correction->surfaces, 0, 2 * correction->view_begin[sides] * bands * sizeof(float));
    memset(correction->lamps, 0, 2 * correction->view_begin[sides] * sizeof(float));
    for (size_t i = 0; i < sides; i++) correction->trust[i] = 1;
    job j = {p, field, diffuse, correction, regions, round};
    size_t tasks = (diffuse->rows->count + SIDES_A_TASK - 1) / SIDES_A_TASK;
    igi_status status = igi_parallel_for(ctx, tasks, correct_rows, &j);
    if (status == IGI_OK)
        status = igi_lobe_photons_add(ctx, field, diffuse->rows, round, correction->received);
    igi_free(regions);
    return status;
}

/* The photographs that show each side; frames NULL: counts them only. */
static void list_views(const igi_problem *p, size_t *begin, uint32_t *frames)
{
    size_t views = 0, sides = 2 * p->patches->count, at = 0;
    for (size_t side = 0; side < sides; side++) {
        uint32_t last = UINT32_MAX;
        begin[side] = views;
        for (size_t k = p->site_begin[side]; k < p->site_begin[side + 1]; k++) {
            at = igi_observation_frame_near(p->observations, p->order[k], at);
            uint32_t frame = (uint32_t)at;
            if (frame == last || views - begin[side] == IGI_SIDE_VIEWS) continue;
            last = frame;
            if (frames) frames[views] = frame;
            views++;
        }
    }
    begin[sides] = views;
}

igi_status igi_correction_create(igi_context *ctx, const igi_problem *problem, const igi_rows *rows,
                                 igi_correction *correction)
{
    size_t sides = 2 * problem->patches->count, bands = (size_t)problem->bands;
    igi_correction *c = correction;
    IGI_TRY(IGI_ALLOC(ctx, sides * bands, &c->seen));
    IGI_TRY(IGI_ALLOC(ctx, sides, &c->trust));
    IGI_TRY(IGI_ALLOC(ctx, rows->count * bands, &c->received));
    IGI_TRY(IGI_ALLOC(ctx, sides + 1, &c->view_begin));
    list_views(problem, c->view_begin, NULL);
    IGI_TRY(IGI_ALLOC(ctx, c->view_begin[sides], &c->view_frame));
    IGI_TRY(IGI_ALLOC(ctx, 2 * c->view_begin[sides] * bands, &c->surfaces));
    IGI_TRY(IGI_ALLOC(ctx, 2 * c->view_begin[sides], &c->lamps));
    list_views(problem, c->view_begin, c->view_frame);
    return IGI_OK;
}

void igi_correction_clear(igi_correction *correction)
{
    igi_free(correction->seen);
    igi_free(correction->trust);
    igi_free(correction->received);
    igi_free(correction->view_begin);
    igi_free(correction->view_frame);
    igi_free(correction->surfaces);
    igi_free(correction->lamps);
    *correction = (igi_correction){0};
}
