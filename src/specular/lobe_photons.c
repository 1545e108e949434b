/* SPDX-License-Identifier: Apache-2.0
 *
 * A lamp mirrored in a narrow lobe is a small bright spot in the hemisphere of what it shines on: a
 * ray from there seldom finds it, which left half a per cent of a block's albedo open. From the lamp
 * by way of the lobe, paths carry about alike: from side y of area a_y, by one of N of them,
 *     E_x += a_y / (N a_x)  W value cos_in  f(in, out) cos_out / p(out)
 * where x is the side met along `out`, of area a_x, and W value the lamp's light by its sample
 * (Jensen 1996, one bounce). Which side and which lamp a path begins with is drawn by what the rows
 * say that the lobe sends on, and the lamp's point in proportion to what it gives, so that all paths
 * carry about as much: with as many from each side, and points anywhere on a lamp, a side that touches
 * one sent a path of a thousand times the usual light, and whole regions' irradiance scattered by 8 %.
 */
#include "specular/lobe_photons.h"

#include "base/parallel.h"
#include "brdf/brdf.h"

#define PHOTONS 300000  /* about; */
#define FIRST_SHARE 4   /* fewer in the first round, which only refining uses */
#define MOST_PHOTONS 64 /* of a side, on average */
#define HIDDEN 0.25f    /* of a lamp's open light, beside what a row's few shadow rays saw */
#define ROWS_A_TASK 64

typedef struct job {
    const igi_radiance_field *field;
    const igi_rows *rows;
    uint64_t round;
    size_t count;     /* of rows that have a lobe, */
    uint32_t *glossy; /* [count] these */
    double *expected; /* [count] photons of each, on average */
    size_t *begin;    /* [count + 1] photons of a row: met[begin[i]...] */
    uint32_t *met;    /* the row that each arrives at, or IGI_NO_ROW */
    float *flux;      /* [photons][bands] */
} job;

static const igi_lobe *lobe_of(const job *j, size_t row)
{
    const igi_problem *p = j->field->problem;
    return &j->field->lobes[igi_patch_region(p->patches, j->rows->side[row] >> 1)];
}

static uint32_t row_met(const job *j, const igi_hit *hit)
{
    const igi_problem *p = j->field->problem;
    if (hit->triangle == IGI_NO_HIT) return IGI_NO_ROW;
    if (p->scene->regions[p->scene->mesh.regions[hit->triangle]].emitter) return IGI_NO_ROW;
    return j->rows->row_of[igi_side_at(p->patches, hit->triangle, hit->u, hit->v, hit->back)];
}

/* What a lamp gives a row, about, and never nothing unless it cannot. */
static double lamp_power(const job *j, size_t row, size_t light)
{
    const igi_problem *p = j->field->problem;
    size_t k = row * j->rows->lights + light;
    double value = 0;
    for (int b = 0; b < p->bands; b++) value += p->lights[light].value[b] / p->bands;
    return value * (double)(j->rows->direct[k] + HIDDEN * j->rows->open[k]);
}

/* What a row's lobe sends on, about. */
static double row_power(const job *j, size_t row)
{
    const igi_problem *p = j->field->problem;
    double lamps = 0, specular = 0;
    for (size_t l = 0; l < j->rows->lights; l++) lamps += lamp_power(j, row, l);
    for (int b = 0; b < p->bands; b++) specular += (double)lobe_of(j, row)->specular[b] / p->bands;
    return lamps * specular * (double)p->patches->area[j->rows->side[row] >> 1];
}

/* A lamp, and *chance: of its being drawn. */
static size_t draw_lamp(const job *j, size_t row, double u, double *chance)
{
    double total = 0, below = 0, power = 0;
    size_t l, last = 0;
    for (l = 0; l < j->rows->lights; l++) total += lamp_power(j, row, l);
    for (l = 0; l < j->rows->lights; l++) {
        double next = lamp_power(j, row, l);
        if (!(next > 0)) continue;
        last = l;
        power = next;
        below += next;
        if (u * total < below) break;
    }
    *chance = total > 0 ? power / total : 0;
    return last;
}

/* Returns its rays. */
static uint64_t send(const job *j, size_t i, igi_rng *rng, uint32_t *met, float *flux)
{
    const igi_problem *p = j->field->problem;
    const igi_lobe *lobe = lobe_of(j, j->glossy[i]);
    uint32_t side = j->rows->side[j->glossy[i]], triangle;
    double chance;
    size_t light = draw_lamp(j, j->glossy[i], (double)igi_rng_float(rng), &chance);
    float u, v, scale, base;
    igi_light_sample s;
    *met = IGI_NO_ROW;
    igi_patch_sample(p->patches, side >> 1, rng, &triangle, &u, &v);
    igi_vec point = igi_triangle_point(&p->scene->mesh, triangle, u, v);
    igi_vec normal = igi_tracer_normal(p->tracer, triangle);
    if (side & 1) normal = igi_scale(normal, -1);
    u = igi_rng_float(rng);
    v = igi_rng_float(rng);
    if (!(chance > 0)) return 0;
    (void)igi_light_sample_facing(p->lighting, light, point, normal, u, v, &s);
    if (!(s.weight > 0)) return 0;
    igi_vec in = igi_to_local(s.direction, normal);
    if (in.z <= 0 || igi_light_hidden(p->tracer, point, &s)) return 1;
    u = igi_rng_float(rng);
    igi_vec out = igi_lobe_sample(lobe->model, lobe->alpha, in, u, igi_rng_float(rng));
    float pdf = igi_lobe_pdf(lobe->model, lobe->alpha, out, in);
    if (out.z <= 0 || !(pdf > 0)) return 1;
    igi_hit hit = igi_trace(p->tracer, point, igi_to_world(out, normal));
    *met = row_met(j, &hit);
    igi_lobe_terms(lobe->model, lobe->alpha, in, out, &scale, &base);
    float weight = p->patches->area[side >> 1] / (float)(chance * j->expected[i]) * s.weight *
                   in.z * out.z / pdf;
    for (int b = 0; b < p->bands; b++)
        flux[b] = weight * (lobe->specular[b] * scale + base) *
                  igi_light_sample_value(&p->lights[light], &s, b);
    return 2;
}

static igi_status send_rows(igi_context *ctx, void *user, size_t task, int worker)
{
    (void)worker;
    const job *j = user;
    uint64_t rays = 0;
    size_t end = (task + 1) * ROWS_A_TASK;
    if (end > j->count) end = j->count;
    for (size_t i = task * ROWS_A_TASK; i < end; i++) {
        igi_rng rng = igi_rng_make(igi_seed(ctx) + 0x9407 + j->round, j->glossy[i]);
        for (size_t k = j->begin[i]; k < j->begin[i + 1]; k++)
            rays += send(j, i, &rng, &j->met[k], j->flux + k * (size_t)j->field->problem->bands);
    }
    igi_count_rays(ctx, rays);
    return IGI_OK;
}

/* How many photons each row sends: the fractions of one add up, so that a row of little light sends
 * one now and then. */
static igi_status share_out(igi_context *ctx, job *j, double photons)
{
    const igi_rows *rows = j->rows;
    igi_rng rng = igi_rng_make(igi_seed(ctx) + 0x9408, j->round);
    double total = 0, sum = (double)igi_rng_float(&rng);
    IGI_TRY(IGI_ALLOC(ctx, rows->count, &j->glossy));
    IGI_TRY(IGI_ALLOC(ctx, rows->count, &j->expected));
    IGI_TRY(IGI_ALLOC(ctx, rows->count + 1, &j->begin));
    for (size_t row = 0; row < rows->count; row++) {
        double power = lobe_of(j, row)->model == IGI_LAMBERT ? 0 : row_power(j, row);
        if (!(power > 0)) continue;
        j->expected[j->count] = power;
        j->glossy[j->count++] = (uint32_t)row;
        total += power;
    }
    photons = fmin(photons, MOST_PHOTONS * (double)j->count);
    for (size_t i = 0; i < j->count; i++) {
        j->expected[i] *= photons / total;
        sum += j->expected[i];
        j->begin[i + 1] = (size_t)sum;
    }
    return IGI_OK;
}

igi_status igi_lobe_photons_add(igi_context *ctx, const igi_radiance_field *field,
                                const igi_rows *rows, uint64_t round, float *received)
{
    const igi_problem *p = field->problem;
    igi_status status = IGI_OK;
    job j = {.field = field, .rows = rows, .round = round};
    size_t bands = (size_t)p->bands;
    IGI_TRY_GOTO(share_out(ctx, &j, (double)PHOTONS / (round == 0 ? FIRST_SHARE : 1)));
    size_t count = j.begin[j.count];
    IGI_TRY_GOTO(IGI_ALLOC(ctx, count, &j.met));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, count * bands, &j.flux));
    IGI_TRY_GOTO(igi_parallel_for(ctx, (j.count + ROWS_A_TASK - 1) / ROWS_A_TASK, send_rows, &j));
    for (size_t k = 0; k < count; k++) {
        if (j.met[k] == IGI_NO_ROW) continue;
        float area = p->patches->area[rows->side[j.met[k]] >> 1];
        for (size_t b = 0; b < bands && area > 0; b++)
            received[j.met[k] * bands + b] += j.flux[k * bands + b] / area;
    }
cleanup:
    igi_free(j.glossy);
    igi_free(j.expected);
    igi_free(j.begin);
    igi_free(j.met);
    igi_free(j.flux);
    return status;
}
