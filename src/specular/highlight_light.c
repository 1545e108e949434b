/* SPDX-License-Identifier: Apache-2.0
 *
 * The light that reaches the chosen pixels. What is known of them from fewer is taken over.
 */
#include "specular/highlights_private.h"

#include "base/parallel.h"

#include <string.h>

#define PIECE_PATCHES 6 /* side of a piece of the surface, in patches */
#define PIXELS_A_TASK 16
#define UNKNOWN UINT32_MAX

typedef struct job {
    igi_highlight_task task;
    const igi_highlights *fewer;
    uint32_t *known; /* [count] the same pixel among the fewer ones; UNKNOWN: not there */
    igi_highlights *out;
    uint64_t *rays; /* of each task */
} job;

/* The piece of the surface at a point: a cell of a coarse grid. */
static uint32_t piece_of(const job *j, igi_vec point)
{
    float side = PIECE_PATCHES * j->task.problem->patches->size_m;
    uint64_t h = (uint64_t)(int64_t)floorf(point.x / side);
    h = igi_hash64(h) ^ (uint64_t)(int64_t)floorf(point.y / side);
    h = igi_hash64(h) ^ (uint64_t)(int64_t)floorf(point.z / side);
    return (uint32_t)igi_hash64(h);
}

/* Takes over what is known of the pixel. */
static void copy_pixel(const igi_highlights *from, size_t k, igi_highlights *to, size_t i)
{
    size_t bands = (size_t)to->bands, samples = (size_t)to->samples;
    to->piece[i] = from->piece[k];
    memcpy(to->radiance + i * bands, from->radiance + k * bands, bands * sizeof(float));
    memcpy(to->irradiance + i * bands, from->irradiance + k * bands, bands * sizeof(float));
    memcpy(to->directions + i * samples, from->directions + k * samples,
           samples * sizeof *to->directions);
    memcpy(to->incident + i * samples * bands, from->incident + k * samples * bands,
           samples * bands * sizeof(float));
}

static uint64_t light_pixel(const job *j, size_t i)
{
    igi_highlights *h = j->out;
    size_t bands = (size_t)h->bands, observation = h->observation[i];
    const igi_highlight_source *source = j->task.source;
    const igi_observations *o = j->task.problem->observations;
    igi_rng rng = igi_rng_make(igi_hash64(j->task.region), observation);
    memcpy(h->radiance + i * bands, o->radiance + observation * bands, bands * sizeof(float));
    source->irradiance(source->user, observation, h->irradiance + i * bands);
    igi_pixel_view v = igi_pixel_view_of(j->task.problem, observation);
    h->piece[i] = piece_of(j, v.point);
    return igi_highlight_directions(&j->task, &v, &rng, h->directions + i * (size_t)h->samples,
                                    h->incident + i * (size_t)h->samples * bands);
}

static igi_status light_pixels(igi_context *ctx, void *user, size_t task, int worker)
{
    (void)worker;
    const job *j = user;
    uint64_t rays = 0;
    size_t end = (task + 1) * PIXELS_A_TASK;
    if (end > j->out->count) end = j->out->count;
    for (size_t i = task * PIXELS_A_TASK; i < end; i++) {
        if (j->known[i] != UNKNOWN) copy_pixel(j->fewer, j->known[i], j->out, i);
        else rays += light_pixel(j, i);
    }
    igi_count_rays(ctx, rays);
    j->rays[task] = rays;
    return IGI_OK;
}

/* Both are chosen in the same order, so that the fewer ones are met one after the other. */
static void find_known(const igi_highlights *fewer, const igi_highlights *h, uint32_t *known)
{
    size_t next = 0;
    bool alike = fewer && fewer->samples == h->samples && fewer->lobe_samples == h->lobe_samples;
    for (size_t i = 0; i < h->count; i++) {
        bool met = alike && next < fewer->count && fewer->observation[next] == h->observation[i];
        known[i] = met ? (uint32_t)next++ : UNKNOWN;
    }
}

igi_status igi_highlights_light(igi_context *ctx, const igi_highlight_source *source, size_t region,
                                const igi_highlight_options *options, const igi_highlights *fewer,
                                igi_highlights *out)
{
    igi_status status = IGI_OK;
    size_t n = out->count, bands = (size_t)out->bands, samples = (size_t)out->samples;
    size_t tasks = (n + PIXELS_A_TASK - 1) / PIXELS_A_TASK;
    job j = {{source->field->problem, source, options, region}, fewer, NULL, out, NULL};
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n, &out->piece));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n * bands, &out->radiance));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n * bands, &out->irradiance));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n * samples, &out->directions));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n * samples * bands, &out->incident));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n, &j.known));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, tasks, &j.rays));
    find_known(fewer, out, j.known);
    IGI_TRY_GOTO(igi_parallel_for(ctx, tasks, light_pixels, &j));
    for (size_t t = 0; t < tasks; t++) out->rays += j.rays[t];
cleanup:
    igi_free(j.known);
    igi_free(j.rays);
    return status;
}
