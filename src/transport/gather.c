/* SPDX-License-Identifier: Apache-2.0
 *
 * Directions come from one two-dimensional low-discrepancy sequence, the additive recurrence of the
 * plastic number (Roberts 2018). It runs through a triangle's cells in Morton's order, so that the
 * rays of a row are well spread, and so are those of neighbouring rows together: sums over a region
 * converge faster than each row does (Ahmed & Wonka 2020 do so for pixels).
 */
#include "transport/gather.h"

#include "base/parallel.h"

#include <string.h>

#define ROWS_A_TASK 128
#define MOST_FOLD 16  /* a row sends at most so many times the rays that were asked for, */
#define LEAST_SHARE 8 /* and at least one in so many */

typedef struct job {
    const igi_scene *scene;
    const igi_patches *patches;
    const igi_tracer *tracer;
    const igi_lighting *lighting;
    const igi_sites *sites;
    igi_gather_options options;
    igi_rows *rows;
    uint64_t shift;    /* of the sequence, from the seed */
    int *region_rays;  /* [regions] of each of its rows with sites */
    int unseen_rays;   /* of each row without */
    size_t begin, end; /* rows of this round */
} job;

/* Point n of the additive recurrence of the plastic number (Roberts 2018), in fixed point. */
static void sequence_point(uint32_t n, uint64_t shift, float *u, float *v)
{
    uint64_t x = n * 0xc13fa9a902a6328fu + shift, y = n * 0x91e10da5c79e7b1du + igi_hash64(shift);
    *u = igi_u32_to_float((uint32_t)(x >> 32));
    *v = igi_u32_to_float((uint32_t)(y >> 32));
}

/* Cells of a lattice in Morton's order: neighbours in space are neighbours in the sequence. */
static uint32_t spread_bits(uint32_t x)
{
    x = (x | x << 8) & 0x00ff00ff;
    x = (x | x << 4) & 0x0f0f0f0f;
    x = (x | x << 2) & 0x33333333;
    return (x | x << 1) & 0x55555555;
}

static uint32_t sequence_start(const igi_patches *p, uint32_t side)
{
    const igi_triangle_lattice *l = &p->lattices[p->triangle[side >> 1]];
    uint32_t cell = (side >> 1) - l->first;
    return spread_bits(cell % l->nu) | spread_bits(cell / l->nu) << 1;
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
    igi_vec normal = igi_tracer_normal(j->tracer, triangle);
    if (side & 1) normal = igi_scale(normal, -1);
    return (place){igi_triangle_point(j->patches->mesh, triangle, u, v), normal};
}

/* The side a ray meets, or IGI_NO_SIDE. */
static uint32_t met(const job *j, const igi_hit *hit)
{
    if (hit->triangle == IGI_NO_HIT) return IGI_NO_SIDE;
    uint32_t region = j->scene->mesh.regions[hit->triangle];
    if (j->scene->regions[region].emitter) return IGI_NO_SIDE;
    return igi_side_at(j->patches, hit->triangle, hit->u, hit->v, hit->back);
}

static void gather_indirect(const job *j, size_t row, igi_rng *rng)
{
    igi_rows *r = j->rows;
    uint32_t side = r->side[row];
    int rays = (int)(r->begin[row + 1] - r->begin[row]);
    uint32_t first = sequence_start(j->patches, side) * (uint32_t)rays;
    uint64_t shift = igi_hash64(j->shift ^
                                (2 * (uint64_t)j->patches->triangle[side >> 1] + (side & 1)));
    for (int k = 0; k < rays; k++) {
        float u, v;
        sequence_point(first + (uint32_t)k, shift, &u, &v);
        place p = origin(j, r->side[row], k, rays, rng);
        igi_hit hit = igi_trace(j->tracer, p.point, igi_cosine_direction(p.normal, u, v));
        r->hits[r->begin[row] + (size_t)k] = met(j, &hit);
        if (r->met) r->met[r->begin[row] + (size_t)k] = hit;
    }
}

/* Light l from the row's places: closed form where nothing is in between, times the visible share
 * of what the shadow rays carry. Every light is looked for from the same places. */
static void light_row(const job *j, size_t row, size_t l, int points, igi_rng rng)
{
    uint32_t side = j->rows->side[row];
    uint32_t first = sequence_start(j->patches, side) * (uint32_t)points;
    uint64_t shift = igi_hash64(igi_hash64(j->shift + l + 1) ^
                                (2 * (uint64_t)j->patches->triangle[side >> 1] + (side & 1)));
    igi_rng places = rng;
    float open = 0, sent = 0, arrived = 0, sent2 = 0, arrived2 = 0;
    for (int k = 0; k < points; k++) {
        igi_light_sample s;
        float u, v;
        place p = origin(j, side, k, points, &rng);
        sequence_point(first + (uint32_t)k, shift, &u, &v);
        open += igi_light_sample_facing(j->lighting, l, p.point, p.normal, u, v, &s);
        if (!(s.weight > 0)) continue;
        float carried = igi_dot(s.direction, p.normal) * s.weight;
        if (carried <= 0) continue;
        sent += carried;
        sent2 += carried * carried;
        if (igi_light_hidden(j->tracer, p.point, &s)) continue;
        arrived += carried;
        arrived2 += carried * carried;
    }
    if (open > 0 && !(sent > 0)) { /* each point of the lamp that was tried faces away */
        sent = open;
        rng = places;
        for (int k = 0; k < points; k++) {
            place p = origin(j, side, k, points, &rng);
            arrived += igi_light_irradiance(j->lighting, j->tracer, l, p.point, p.normal, 1,
                                            igi_hash64(shift + first + (uint32_t)k));
        }
    }
    float visible = sent > 0 ? arrived / sent : 0;
    size_t at = row * j->rows->lights + l;
    j->rows->open[at] = open / (float)points;
    j->rows->direct[at] = open / (float)points * visible;
    /* sum of (carried (arrived or not - visible))^2 */
    float squares = arrived2 * (1 - 2 * visible) + sent2 * visible * visible;
    j->rows->visible_var[at] = sent > 0 ? fmaxf(0.0f, squares / (sent * sent)) : 0;
}

/* Points from which a row looks for the lights: in proportion to its rays. */
static int points_of(const job *j, size_t row)
{
    size_t rays = j->rows->begin[row + 1] - j->rows->begin[row];
    if (j->options.rays == 0) return j->options.light_points;
    int points = (int)(rays * (size_t)j->options.light_points / (size_t)j->options.rays);
    return points > 0 ? points : 1;
}

static void gather_direct(const job *j, size_t row, igi_rng rng)
{
    igi_vec sum = igi_v(0, 0, 0);
    igi_rng places = rng;
    int points = points_of(j, row);
    for (int k = 0; k < points; k++)
        sum = igi_add(sum, origin(j, j->rows->side[row], k, points, &places).point);
    sum = igi_scale(sum, 1 / (float)points);
    memcpy(j->rows->point + 3 * row, &sum, 3 * sizeof(float));
    for (size_t l = 0; l < j->rows->lights; l++) light_row(j, row, l, points, rng);
}

static igi_status gather_rows(igi_context *ctx, void *user, size_t task, int worker)
{
    (void)worker;
    const job *j = user;
    size_t begin = j->begin + task * ROWS_A_TASK;
    size_t end = begin + ROWS_A_TASK < j->end ? begin + ROWS_A_TASK : j->end;
    size_t rays = j->rows->begin[end] - j->rows->begin[begin];
    for (size_t row = begin; row < end; row++) {
        igi_rng rng = igi_rng_make(igi_seed(ctx), row);
        gather_indirect(j, row, &rng);
        gather_direct(j, row, rng);
        rays += (size_t)points_of(j, row) * j->rows->lights;
    }
    igi_count_rays(ctx, rays);
    return IGI_OK;
}

/* Gives a row to every side that the rows of this round met for the first time; their number. */
static size_t discover(const job *j)
{
    igi_rows *r = j->rows;
    size_t found = 0;
    for (size_t i = r->begin[j->begin]; i < r->begin[j->end]; i++) {
        uint32_t side = r->hits[i];
        if (side == IGI_NO_SIDE || r->row_of[side] != IGI_NO_ROW) continue;
        r->row_of[side] = (uint32_t)(r->count + found);
        r->side[r->count + found++] = side;
    }
    return found;
}

/* Makes room for rows begin..end - 1; arrays of a row are zeroed, whatever it will fill in. */
static igi_status grow(igi_context *ctx, const job *j, size_t capacity[5])
{
    igi_rows *r = j->rows;
    size_t begin = j->begin, end = j->end;
    for (size_t row = begin; row < end; row++) {
        uint32_t region = igi_patch_region(j->patches, r->side[row] >> 1);
        int rays = row < r->seen_count ? j->region_rays[region] : j->unseen_rays;
        r->begin[row + 1] = r->begin[row] + (size_t)rays;
    }
    void *grown = igi_grow(ctx, r->hits, &capacity[0], r->begin[end], sizeof *r->hits);
    if (!grown) return IGI_E_SYSTEM;
    r->hits = grown;
    grown = igi_grow(ctx, r->point, &capacity[1], end * 3, sizeof *r->point);
    if (!grown) return IGI_E_SYSTEM;
    r->point = grown;
    float **of_lights[] = {&r->direct, &r->open, &r->visible_var};
    for (int k = 0; k < 3; k++) {
        grown = igi_grow(ctx, *of_lights[k], &capacity[2 + k], end * r->lights, sizeof(float));
        if (!grown) return IGI_E_SYSTEM;
        *of_lights[k] = grown;
        memset(*of_lights[k] + begin * r->lights, 0, (end - begin) * r->lights * sizeof(float));
    }
    return IGI_OK;
}

static void start_with_seen(igi_rows *r, const igi_patches *patches, const igi_sites *sites,
                            const igi_scene *scene, const uint8_t *wanted)
{
    for (uint32_t side = 0; side < 2 * patches->count; side++) {
        r->row_of[side] = IGI_NO_ROW;
        bool has_sites = sites->begin[side + 1] > sites->begin[side];
        if (wanted ? !wanted[side] : !has_sites) continue;
        if (scene->regions[igi_patch_region(patches, side >> 1)].emitter) continue;
        r->row_of[side] = (uint32_t)r->count;
        r->side[r->count++] = side;
    }
    r->seen_count = r->count;
}

/* How many rays each row sends. */
static igi_status share_rays(igi_context *ctx, job *j)
{
    const igi_rows *r = j->rows;
    int rays = j->options.rays, wanted = j->options.region_rays;
    size_t sides = 2 * j->patches->count, sent = 0;
    j->unseen_rays = rays;
    IGI_TRY(IGI_ALLOC(ctx, j->scene->region_count, &j->region_rays));
    for (size_t row = 0; row < r->count; row++)
        j->region_rays[igi_patch_region(j->patches, r->side[row] >> 1)]++;
    for (size_t k = 0; k < j->scene->region_count; k++) {
        int rows = j->region_rays[k], each = wanted / (rows > 0 ? rows : 1);
        j->region_rays[k] = each > MOST_FOLD * rays ? MOST_FOLD * rays : each > rays ? each : rays;
        sent += (size_t)(rows * j->region_rays[k]);
    }
    if (wanted == 0 || sides == r->count) return IGI_OK;
    size_t each = sent / (sides - r->count), least = (size_t)(rays / LEAST_SHARE + 1);
    if (each < (size_t)rays) j->unseen_rays = (int)(each > least ? each : least);
    return IGI_OK;
}

igi_status igi_rows_create(igi_context *ctx, const igi_scene *scene, const igi_patches *patches,
                           const igi_tracer *tracer, const igi_lighting *lighting,
                           const igi_sites *sites, const igi_gather_options *options,
                           igi_rows **rows)
{
    igi_status status = IGI_OK;
    igi_rows *r = NULL;
    size_t capacity[5] = {0};
    job j = {.region_rays = NULL};
    *rows = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &r));
    r->lights = igi_lighting_count(lighting);
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 2 * patches->count, &r->side));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 2 * patches->count, &r->row_of));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 2 * patches->count + 1, &r->begin));
    start_with_seen(r, patches, sites, scene, options->wanted);
    if (options->wanted && options->keep_met)
        IGI_TRY_GOTO(IGI_ALLOC(ctx, r->count * (size_t)options->rays, &r->met));
    j = (job){.scene = scene,
              .patches = patches,
              .tracer = tracer,
              .lighting = lighting,
              .sites = sites,
              .options = *options,
              .rows = r,
              .shift = igi_hash64(igi_seed(ctx)),
              .begin = 0,
              .end = r->count};
    IGI_TRY_GOTO(share_rays(ctx, &j));
    while (j.begin < j.end) {
        IGI_TRY_GOTO(grow(ctx, &j, capacity));
        size_t tasks = (j.end - j.begin + ROWS_A_TASK - 1) / ROWS_A_TASK;
        IGI_TRY_GOTO(igi_parallel_for(ctx, tasks, gather_rows, &j));
        if (!options->wanted) r->count += discover(&j);
        j.begin = j.end;
        j.end = r->count;
    }
    *rows = r;
    r = NULL;
cleanup:
    igi_free(j.region_rays);
    igi_rows_destroy(r);
    return status;
}
