/* SPDX-License-Identifier: Apache-2.0
 *
 * Directions come from one two-dimensional low-discrepancy sequence that runs through all rows
 * (the additive recurrence of the plastic number; Roberts 2018): K points in a row are well spread,
 * and so are those of neighbouring rows together, so that sums over a region converge faster than
 * each row does. Measured on a Cornell box: see tests/analytic/test_gather.c.
 */
#include "transport/gather.h"

#include "base/parallel.h"

#include <string.h>

#define ROWS_A_TASK 128
/* Shadow rays from each point to each light: two, so that each corrects the other's bias. */
#define SHADOW_RAYS 2

typedef struct job {
    const igi_scene *scene;
    const igi_patches *patches;
    const igi_tracer *tracer;
    const igi_lighting *lighting;
    const igi_sites *sites;
    igi_gather_options options;
    igi_rows *rows;
    uint64_t shift;    /* of the sequence, from the seed */
    size_t begin, end; /* rows of this round */
} job;

/* Point n of the sequence, in 64-bit fixed point so that it never loses digits. */
static void sequence_point(uint64_t n, uint64_t shift, float *u, float *v)
{
    uint64_t x = n * 0xc13fa9a902a6328fu + shift; /* 2^64 / 1.32471795724474602596 */
    uint64_t y = n * 0x91e10da5c79e7b1du + igi_hash64(shift); /* 2^64 / 1.3247...^2 */
    *u = igi_u32_to_float((uint32_t)(x >> 32));
    *v = igi_u32_to_float((uint32_t)(y >> 32));
}

typedef struct place {
    igi_vec point, normal;
} place;

/* Where ray `k` of `of` starts: spread over the row's sites, or over its patch. */
static place origin(const job *j, uint32_t side, int k, int of, igi_rng *rng)
{
    uint32_t triangle, surface;
    float u, v;
    size_t begin = j->sites->begin[side], n = j->sites->begin[side + 1] - begin;
    if (n > 0) {
        double at = ((double)k + (double)igi_rng_float(rng)) / (double)of;
        uint32_t site = j->sites->order[begin + (size_t)(at * (double)n)];
        surface = j->sites->surface[site];
        triangle = surface >> 1;
        u = j->sites->uv[2 * (size_t)site];
        v = j->sites->uv[2 * (size_t)site + 1];
    } else {
        igi_patch_sample(j->patches, side >> 1, rng, &triangle, &u, &v);
    }
    igi_vec normal = igi_triangle_normal(j->patches->mesh, triangle);
    if (side & 1) normal = igi_scale(normal, -1);
    return (place){igi_triangle_point(j->patches->mesh, triangle, u, v), normal};
}

/* The side a ray meets, or IGI_NO_ROW. */
static uint32_t met(const job *j, const igi_hit *hit)
{
    if (hit->triangle == IGI_NO_HIT) return IGI_NO_ROW;
    uint32_t region = j->scene->mesh.regions[hit->triangle];
    if (j->scene->regions[region].emitter) return IGI_NO_ROW;
    return 2 * igi_patch_at(j->patches, hit->triangle, hit->u, hit->v) + (hit->back ? 1u : 0u);
}

static void gather_indirect(const job *j, size_t row, igi_rng *rng)
{
    igi_rows *r = j->rows;
    igi_vec sum = igi_v(0, 0, 0);
    for (int k = 0; k < r->rays; k++) {
        float u, v;
        sequence_point((uint64_t)row * (uint64_t)r->rays + (uint64_t)k, j->shift, &u, &v);
        place p = origin(j, r->side[row], k, r->rays, rng);
        igi_hit hit = igi_trace(j->tracer, p.point, igi_cosine_direction(p.normal, u, v));
        r->hits[row * (size_t)r->rays + (size_t)k] = met(j, &hit);
        sum = igi_add(sum, p.point);
    }
    sum = igi_scale(sum, 1 / (float)r->rays);
    memcpy(r->point + 3 * row, &sum, 3 * sizeof(float));
}

static void gather_direct(const job *j, size_t row, igi_rng *rng)
{
    igi_rows *r = j->rows;
    int points = j->options.light_points;
    for (int k = 0; k < points; k++) {
        place p = origin(j, r->side[row], k, points, rng);
        for (size_t l = 0; l < r->lights; l++) {
            uint64_t key = ((uint64_t)row * (uint64_t)points + (uint64_t)k) * r->lights + l;
            r->direct[row * r->lights + l] +=
                igi_light_irradiance(j->lighting, j->tracer, l, p.point, p.normal, SHADOW_RAYS, key) /
                (float)points;
        }
    }
}

static igi_status gather_rows(igi_context *ctx, void *user, size_t task, int worker)
{
    (void)worker;
    const job *j = user;
    size_t begin = j->begin + task * ROWS_A_TASK;
    size_t end = begin + ROWS_A_TASK < j->end ? begin + ROWS_A_TASK : j->end;
    for (size_t row = begin; row < end; row++) {
        igi_rng rng = igi_rng_make(igi_seed(ctx), row);
        gather_indirect(j, row, &rng);
        gather_direct(j, row, &rng);
    }
    size_t rays = (size_t)j->rows->rays + (size_t)j->options.light_points * SHADOW_RAYS * j->rows->lights;
    igi_count_rays(ctx, (end - begin) * rays);
    return IGI_OK;
}

/* Gives a row to every side that the rows of this round met for the first time; their number. */
static size_t discover(const job *j)
{
    igi_rows *r = j->rows;
    size_t found = 0;
    for (size_t i = j->begin * (size_t)r->rays; i < j->end * (size_t)r->rays; i++) {
        uint32_t side = r->hits[i];
        if (side == IGI_NO_ROW || r->row_of[side] != IGI_NO_ROW) continue;
        r->row_of[side] = (uint32_t)(r->count + found);
        r->side[r->count + found++] = side;
    }
    return found;
}

static igi_status grow(igi_context *ctx, igi_rows *r, size_t count, size_t capacity[3])
{
    void *grown = igi_grow(ctx, r->hits, &capacity[0], count * (size_t)r->rays, sizeof *r->hits);
    if (!grown) return IGI_E_SYSTEM;
    r->hits = grown;
    size_t from = capacity[1];
    grown = igi_grow(ctx, r->direct, &capacity[1], count * r->lights, sizeof *r->direct);
    if (!grown) return IGI_E_SYSTEM;
    r->direct = grown;
    if (capacity[1] > from) memset(r->direct + from, 0, (capacity[1] - from) * sizeof *r->direct);
    grown = igi_grow(ctx, r->point, &capacity[2], count * 3, sizeof *r->point);
    if (!grown) return IGI_E_SYSTEM;
    r->point = grown;
    return IGI_OK;
}

static void start_with_seen(igi_rows *r, const igi_patches *patches, const igi_sites *sites,
                            const igi_scene *scene)
{
    for (uint32_t side = 0; side < 2 * patches->count; side++) {
        r->row_of[side] = IGI_NO_ROW;
        if (sites->begin[side + 1] == sites->begin[side]) continue;
        if (scene->regions[igi_patch_region(patches, side >> 1)].emitter) continue;
        r->row_of[side] = (uint32_t)r->count;
        r->side[r->count++] = side;
    }
    r->seen_count = r->count;
}

static void sides_to_rows(igi_rows *r)
{
    for (size_t i = 0; i < r->count * (size_t)r->rays; i++)
        if (r->hits[i] != IGI_NO_ROW) r->hits[i] = r->row_of[r->hits[i]];
}

igi_status igi_rows_create(igi_context *ctx, const igi_scene *scene, const igi_patches *patches,
                           const igi_tracer *tracer, const igi_lighting *lighting,
                           const igi_sites *sites, const igi_gather_options *options,
                           igi_rows **rows)
{
    igi_status status = IGI_OK;
    igi_rows *r = NULL;
    size_t capacity[3] = {0, 0, 0};
    *rows = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &r));
    r->rays = options->rays;
    r->lights = igi_lighting_count(lighting);
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 2 * patches->count, &r->side));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 2 * patches->count, &r->row_of));
    start_with_seen(r, patches, sites, scene);
    job j = {.scene = scene, .patches = patches, .tracer = tracer, .lighting = lighting,
             .sites = sites, .options = *options, .rows = r, .shift = igi_hash64(igi_seed(ctx)), .begin = 0, .end = r->count};
    while (j.begin < j.end) {
        IGI_TRY_GOTO(grow(ctx, r, j.end, capacity));
        size_t tasks = (j.end - j.begin + ROWS_A_TASK - 1) / ROWS_A_TASK;
        IGI_TRY_GOTO(igi_parallel_for(ctx, tasks, gather_rows, &j));
        r->count += discover(&j);
        j.begin = j.end;
        j.end = r->count;
    }
    sides_to_rows(r);
    *rows = r;
    r = NULL;
cleanup:
    igi_rows_destroy(r);
    return status;
}

void igi_rows_destroy(igi_rows *rows)
{
    if (!rows) return;
    igi_free(rows->side);
    igi_free(rows->row_of);
    igi_free(rows->hits);
    igi_free(rows->direct);
    igi_free(rows->point);
    igi_free(rows);
}
