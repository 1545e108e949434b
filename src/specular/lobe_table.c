/* SPDX-License-Identifier: Apache-2.0 */
#include "specular/lobe_table.h"

#include "base/parallel.h"
#include "brdf/brdf.h"

#include <string.h>

#define PIXELS_A_TASK 32

typedef struct job {
    const igi_highlights *highlights;
    igi_lobe_table *table;
} job;

/* Adds the directions begin..end to the pixel's columns. */
static void add_directions(const igi_highlights *h, const igi_lobe_table *t, size_t i,
                           const int range[2], float *scale, float *base)
{
    size_t bands = (size_t)h->bands;
    for (int m = range[0]; m < range[1]; m++) {
        size_t at = i * (size_t)h->samples + (size_t)m;
        const igi_direction_sample *d = &h->directions[at];
        if (!(d->weight > 0)) continue;
        float s[IGI_TABLE_ALPHAS], b0[IGI_TABLE_ALPHAS], light[IGI_MAX_BANDS];
        igi_lobe_terms_over(t->model, t->alphas, t->alpha_count, d->in, d->out, s, b0);
        for (size_t b = 0; b < bands; b++) light[b] = d->weight * h->incident[at * bands + b];
        for (size_t a = 0; a < t->alpha_count; a++)
            for (size_t b = 0; b < bands; b++) {
                scale[a * bands + b] += s[a] * light[b];
                if (base) base[a * bands + b] += b0[a] * light[b];
            }
    }
}

static void tabulate_pixel(const igi_highlights *h, igi_lobe_table *t, size_t i)
{
    size_t width = t->alpha_count * (size_t)h->bands;
    float *scale = t->scale + i * width, *noise = t->noise + i * width;
    float *base = t->base ? t->base + i * width : NULL;
    const int first[2] = {0, h->lobe_samples / 2};
    const int second[2] = {h->lobe_samples / 2, h->lobe_samples};
    const int lamps[2] = {h->lobe_samples, h->samples};
    add_directions(h, t, i, second, noise, base);
    add_directions(h, t, i, first, scale, base);
    for (size_t k = 0; k < width; k++) {
        float a = scale[k], b = noise[k];
        scale[k] = a + b;
        noise[k] = (a - b) * (a - b);
    }
    add_directions(h, t, i, lamps, scale, base);
}

static igi_status tabulate(igi_context *ctx, void *user, size_t task, int worker)
{
    (void)ctx;
    (void)worker;
    const job *j = user;
    size_t end = (task + 1) * PIXELS_A_TASK;
    if (end > j->highlights->count) end = j->highlights->count;
    for (size_t i = task * PIXELS_A_TASK; i < end; i++) tabulate_pixel(j->highlights, j->table, i);
    return IGI_OK;
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
    if (model == IGI_GGX) IGI_TRY_GOTO(IGI_ALLOC(ctx, size, &table->base));
    job j = {highlights, table};
    IGI_TRY_GOTO(igi_parallel_for(ctx, (highlights->count + PIXELS_A_TASK - 1) / PIXELS_A_TASK,
                                  tabulate, &j));
cleanup:
    if (status != IGI_OK) igi_lobe_table_clear(table);
    return status;
}

void igi_lobe_table_lamps(const igi_highlights *highlights, igi_model model, double alpha,
                          float *scale)
{
    const igi_highlights *h = highlights;
    const igi_lobe_table t = {.model = model, .alpha_count = 1, .alphas = {(float)alpha}};
    const int lamps[2] = {h->lobe_samples, h->samples};
    memset(scale, 0, h->count * (size_t)h->bands * sizeof *scale);
    for (size_t i = 0; i < h->count; i++)
        add_directions(h, &t, i, lamps, scale + i * (size_t)h->bands, NULL);
}

void igi_lobe_table_clear(igi_lobe_table *table)
{
    igi_free(table->scale);
    igi_free(table->base);
    igi_free(table->noise);
    *table = (igi_lobe_table){.model = IGI_LAMBERT};
}
