/* SPDX-License-Identifier: Apache-2.0 */
#include "specular/lobe_table.h"

#include "base/parallel.h"
#include "brdf/lobe_pairs.h"

#include <string.h>

#define PIXELS_A_TASK 64
#define LANES IGI_LOBE_LANES
/* Two halves of the directions to surfaces, those to lamps, two halves to what is around the scene. */
#define LAMPS 2
#define AROUND 3
#define PARTS 5

typedef struct job {
    const igi_highlights *highlights;
    igi_lobe_table *table;
} job;

/* A pixel's directions that carry light, ready for any roughness. */
typedef struct workspace {
    igi_lobe_pairs pairs;
    size_t begin[PARTS + 1]; /* of each part's pairs: multiples of LANES */
    float *light;            /* [bands][room] incident times weight */
    float *schlick;          /* [bands][room] the same times (1 - cos)^5, which goes to the base */
} workspace;

static igi_status create_workspace(igi_context *ctx, const igi_highlights *h, igi_model model,
                                   workspace *w)
{
    igi_status status = IGI_OK;
    w->light = NULL;
    IGI_TRY_GOTO(igi_lobe_pairs_create(ctx, model, (size_t)h->samples + PARTS * LANES, &w->pairs));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 2 * (size_t)h->bands * w->pairs.room, &w->light));
    w->schlick = w->light + (size_t)h->bands * w->pairs.room;
cleanup:
    return status;
}

static void clear_workspace(workspace *w)
{
    igi_lobe_pairs_clear(&w->pairs);
    igi_free(w->light);
}

/* Adds the directions m of pixel i that are around the scene in that half (1 or 2), or in no half (0).
 * Returns whether others are. */
static bool add_directions(workspace *w, const igi_highlights *h, size_t i, const int m[2],
                           int half)
{
    size_t bands = (size_t)h->bands, room = w->pairs.room, first = i * (size_t)h->samples;
    bool others = false;
    for (size_t at = first + (size_t)m[0]; at < first + (size_t)m[1]; at++) {
        const igi_direction_sample *d = &h->directions[at];
        if (!(d->weight > 0 && d->in.z > 0 && d->out.z > 0)) continue;
        if (d->around != half) {
            others = true;
            continue;
        }
        size_t k = w->pairs.count;
        igi_lobe_pairs_add(&w->pairs, d->in, d->out);
        for (size_t b = 0; b < bands; b++)
            w->light[b * room + k] = d->weight * h->incident[at * bands + b];
    }
    size_t carry = w->pairs.count;
    igi_lobe_pairs_pad(&w->pairs);
    for (; carry < w->pairs.count; carry++)
        for (size_t b = 0; b < bands; b++) w->light[b * room + carry] = 0;
    return others;
}

/* ggx: the base's part of the light is parted off. */
static void part_schlick(workspace *w, size_t bands)
{
    for (size_t b = 0; b < bands; b++) {
        float *light = w->light + b * w->pairs.room, *base = w->schlick + b * w->pairs.room;
        for (size_t k = 0; k < w->pairs.count; k++) {
            base[k] = light[k] * w->pairs.schlick[k];
            light[k] -= base[k];
        }
    }
}

static void take_pixel(workspace *w, const igi_highlights *h, size_t i)
{
    const int to[AROUND + 1] = {0, h->lobe_samples / 2, h->lobe_samples, h->samples};
    bool around = false;
    w->pairs.count = w->begin[0] = 0;
    for (int part = 0; part < AROUND; part++) {
        around |= add_directions(w, h, i, to + part, 0);
        w->begin[part + 1] = w->pairs.count;
    }
    for (int part = AROUND; part < PARTS; part++) {
        const int all[2] = {0, around ? h->samples : 0};
        (void)add_directions(w, h, i, all, 1 + part - AROUND);
        w->begin[part + 1] = w->pairs.count;
    }
    igi_lobe_pairs_prepare(&w->pairs);
    if (w->pairs.model == IGI_GGX) part_schlick(w, (size_t)h->bands);
}

/* sum x y; a partial sum for each lane. */
static float product(const float *restrict x, const float *restrict y, size_t count)
{
    float sums[4] = {0};
    for (size_t i = 0; i < count; i += 4)
        for (size_t k = 0; k < 4; k++) sums[k] += x[i + k] * y[i + k];
    return (sums[0] + sums[2]) + (sums[1] + sums[3]);
}

/* One column of one pixel, [bands] each. */
static void tabulate_column(workspace *w, const igi_lobe_table *t, size_t a,
                            const igi_highlights *h, size_t to)
{
    size_t bands = (size_t)h->bands;
    const double *tint = h->tint;
    igi_lobe_pairs *p = &w->pairs;
    const size_t *begin = w->begin;
    igi_lobe_pairs_evaluate(p, t->alphas[a], 0, p->count);
    for (size_t b = 0; b < bands; b++) {
        const float *light = w->light + b * p->room;
        float part[PARTS];
        for (int k = 0; k < PARTS; k++)
            part[k] = product(p->values + begin[k], light + begin[k], begin[k + 1] - begin[k]);
        float first = part[0] + part[AROUND], second = part[1] + part[AROUND + 1];
        t->scale[to + b] = first + second + part[LAMPS];
        t->lamps[to + b] = part[AROUND] + part[AROUND + 1] + part[LAMPS];
        t->noise[to + b] = (first - second) * (first - second);
        if (tint) {
            t->scale[to + b] *= (float)tint[b];
            t->lamps[to + b] *= (float)tint[b];
            t->noise[to + b] *= (float)(tint[b] * tint[b]);
        }
        if (t->base) t->base[to + b] = product(p->values, w->schlick + b * p->room, p->count);
    }
}

static igi_status tabulate(igi_context *ctx, void *user, size_t task, int worker)
{
    (void)worker;
    const job *j = user;
    const igi_highlights *h = j->highlights;
    size_t bands = (size_t)h->bands, end = (task + 1) * PIXELS_A_TASK;
    workspace w;
    igi_status status = IGI_OK;
    if (end > h->count) end = h->count;
    IGI_TRY_GOTO(create_workspace(ctx, h, j->table->model, &w));
    for (size_t i = task * PIXELS_A_TASK; i < end; i++) {
        take_pixel(&w, h, i);
        for (size_t a = 0; a < j->table->alpha_count; a++)
            tabulate_column(&w, j->table, a, h, (i * j->table->alpha_count + a) * bands);
    }
cleanup:
    clear_workspace(&w);
    return status;
}

igi_status igi_lobe_table_create(igi_context *ctx, const igi_highlights *highlights,
                                 igi_model model, const double *alphas, size_t alpha_count,
                                 igi_lobe_table *table)
{
    size_t size = highlights->count * alpha_count * (size_t)highlights->bands;
    *table = (igi_lobe_table){.model = model, .alpha_count = alpha_count};
    for (size_t a = 0; a < alpha_count; a++) table->alphas[a] = (float)alphas[a];
    igi_status status = IGI_OK;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, size, &table->scale));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, size, &table->noise));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, size, &table->lamps));
    if (model == IGI_GGX) IGI_TRY_GOTO(IGI_ALLOC(ctx, size, &table->base));
    job j = {highlights, table};
    IGI_TRY_GOTO(igi_parallel_for(ctx, (highlights->count + PIXELS_A_TASK - 1) / PIXELS_A_TASK,
                                  tabulate, &j));
cleanup:
    if (status != IGI_OK) igi_lobe_table_clear(table);
    return status;
}

void igi_lobe_table_clear(igi_lobe_table *table)
{
    igi_free(table->scale);
    igi_free(table->base);
    igi_free(table->noise);
    igi_free(table->lamps);
    *table = (igi_lobe_table){.model = IGI_LAMBERT};
}
