/* SPDX-License-Identifier: Apache-2.0 */
#include "observe/glimpses.h"

#include "base/box.h"
#include "base/rng.h"
#include "scene/camera.h"

#include <math.h>

#define CELL_SHARE 0.02f /* side of a cube, of the extent of what is seen */
#define CELL_PIXELS 8.0f /* and at least so many pixels across */
#define SAMPLES 400000   /* pixels that are looked at, about */
#define SIZE_SAMPLES 1000
#define FEWEST_PIXELS 4 /* of a photograph that shows a place */
#define DARK 1e-3       /* of the mean brightness: below, a logarithm is noise */

typedef struct tally {
    double sum, squares, glow;
    uint32_t pixels;
} tally;

typedef struct job {
    const igi_scene *scene;
    const igi_observations *o;
    igi_glimpses *g;
    float size; /* of a cube, metres */
    double dark;
} job;

static double brightness(const igi_observations *o, size_t i)
{
    double sum = 0;
    for (int b = 0; b < o->bands; b++) sum += (double)o->radiance[i * (size_t)o->bands + (size_t)b];
    return sum;
}

static igi_vec point_of(const job *j, size_t i)
{
    return igi_triangle_point(&j->scene->mesh, igi_surface_triangle(j->o->surface[i]),
                              j->o->uv[2 * i], j->o->uv[2 * i + 1]);
}

/* The side of a cube and what is dark, from an even sample of the pixels. */
static void look_around(job *j)
{
    igi_box box = igi_box_empty();
    double pixel = 0, light = 0, n = 0;
    for (size_t k = 0; k < SIZE_SAMPLES && j->o->count > 0; k++) {
        size_t i = (size_t)((double)k / SIZE_SAMPLES * (double)j->o->count);
        const igi_camera *camera = &j->scene->frames[igi_observation_frame(j->o, i)].camera;
        igi_vec p = point_of(j, i);
        igi_box_add(&box, p);
        pixel += (double)igi_length(igi_sub(p, igi_camera_centre(camera))) / camera->fl_x;
        light += brightness(j->o, i);
        n++;
    }
    j->dark = n > 0 ? fmax(DARK * light / n, 1e-30) : 1;
    j->size = n > 0 ? fmaxf(CELL_SHARE * igi_box_diagonal(&box), CELL_PIXELS * (float)(pixel / n))
                    : 1;
}

/* Cube, facing, region and side, in 64 bits that hardly meet by chance. */
static uint64_t key_of(const job *j, size_t i)
{
    uint32_t surface = j->o->surface[i], triangle = igi_surface_triangle(surface);
    igi_vec p = point_of(j, i), n = igi_triangle_normal(&j->scene->mesh, triangle);
    int64_t at[3] = {(int64_t)floorf(p.x / j->size), (int64_t)floorf(p.y / j->size),
                     (int64_t)floorf(p.z / j->size)};
    int64_t facing = lroundf(2 * n.x) + 5 * lroundf(2 * n.y) + 25 * lroundf(2 * n.z);
    uint64_t key = (uint64_t)j->scene->mesh.regions[triangle] << 1 | (surface & 1);
    key = igi_hash64(key ^ (uint64_t)facing << 40);
    for (int k = 0; k < 3; k++) key = igi_hash64(key ^ (uint64_t)at[k]);
    return key;
}

static igi_status find_places(igi_context *ctx, job *j, size_t samples)
{
    igi_status status = IGI_OK;
    igi_glimpses *g = j->g;
    size_t slots = 1, capacity = 0;
    uint64_t *keys = NULL;
    uint32_t *ids = NULL;
    while (slots < 2 * samples + 2) slots *= 2;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, slots, &keys));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, slots, &ids)); /* 1 + place; 0: free */
    IGI_TRY_GOTO(IGI_ALLOC(ctx, samples, &g->place_of));
    for (size_t k = 0; k < samples; k++) {
        uint64_t key = key_of(j, k * g->stride);
        size_t slot = key & (slots - 1);
        while (ids[slot] && keys[slot] != key) slot = (slot + 1) & (slots - 1);
        if (!ids[slot]) {
            uint32_t *grown = igi_grow(ctx, g->region, &capacity, g->place_count + 1,
                                       sizeof *grown);
            if (!grown) IGI_TRY_GOTO(IGI_E_SYSTEM);
            g->region = grown;
            uint32_t triangle = igi_surface_triangle(j->o->surface[k * g->stride]);
            g->region[g->place_count] = j->scene->mesh.regions[triangle];
            keys[slot] = key;
            ids[slot] = (uint32_t)++g->place_count;
        }
        g->place_of[k] = ids[slot] - 1;
    }
cleanup:
    igi_free(keys);
    igi_free(ids);
    return status;
}

/* The glimpses of one photograph, from its samples first..last. */
static igi_status take_glimpses(igi_context *ctx, const job *j, size_t frame, size_t first,
                                size_t last, tally *sums, size_t *capacity)
{
    igi_glimpses *g = j->g;
    const igi_camera *camera = &j->scene->frames[frame].camera;
    const int size[2] = {camera->width, camera->height};
    const float *glow = j->o->glow ? j->o->glow + frame * IGI_GLOW_CELLS : NULL;
    for (size_t k = first; k < last; k++) {
        double x = brightness(j->o, k * g->stride);
        if (glow)
            sums[g->place_of[k]].glow += (double)igi_glow_at(glow, size,
                                                             j->o->pixel[k * g->stride]);
        sums[g->place_of[k]].sum += x;
        sums[g->place_of[k]].squares += x * x;
        sums[g->place_of[k]].pixels++;
    }
    for (size_t k = first; k < last; k++) {
        uint32_t place = g->place_of[k];
        tally t = sums[place];
        sums[place] = (tally){0};
        if (t.pixels < FEWEST_PIXELS || j->scene->regions[g->region[place]].emitter) continue;
        double mean = t.sum / t.pixels, floor = fmax(mean, j->dark);
        double error = sqrt(fmax(0, t.squares / t.pixels - mean * mean) / (t.pixels - 1)) / floor;
        igi_glimpse *grown = igi_grow(ctx, g->glimpses, capacity, g->count + 1, sizeof *grown);
        if (!grown) return IGI_E_SYSTEM;
        g->glimpses = grown;
        g->glimpses[g->count++] = (igi_glimpse){place, (uint32_t)frame, (float)log(floor),
                                                (float)error, (float)(t.glow / t.pixels)};
    }
    return IGI_OK;
}

/* Counting sort by place; frames stay in order. */
static igi_status sort_by_place(igi_context *ctx, igi_glimpses *g)
{
    igi_glimpse *sorted;
    IGI_TRY(IGI_ALLOC(ctx, g->place_count + 2, &g->begin));
    IGI_TRY(IGI_ALLOC(ctx, g->count, &sorted));
    for (size_t i = 0; i < g->count; i++) g->begin[g->glimpses[i].place + 2]++;
    for (size_t p = 0; p < g->place_count; p++) g->begin[p + 2] += g->begin[p + 1];
    for (size_t i = 0; i < g->count; i++)
        sorted[g->begin[g->glimpses[i].place + 1]++] = g->glimpses[i];
    igi_free(g->glimpses);
    g->glimpses = sorted;
    return IGI_OK;
}

igi_status igi_glimpses_create(igi_context *ctx, const igi_scene *scene,
                               const igi_observations *observations, igi_glimpses *glimpses)
{
    igi_status status = IGI_OK;
    const igi_observations *o = observations;
    job j = {.scene = scene, .o = o, .g = glimpses};
    tally *sums = NULL;
    size_t capacity = 0;
    *glimpses = (igi_glimpses){.stride = o->count / SAMPLES + 1};
    size_t samples = (o->count + glimpses->stride - 1) / glimpses->stride;
    look_around(&j);
    IGI_TRY_GOTO(find_places(ctx, &j, samples));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, glimpses->place_count, &sums));
    for (size_t f = 0, k = 0; f < o->frame_count; f++) {
        size_t first = k;
        while (k < samples && k * glimpses->stride < o->frame_begin[f + 1]) k++;
        IGI_TRY_GOTO(take_glimpses(ctx, &j, f, first, k, sums, &capacity));
    }
    IGI_TRY_GOTO(sort_by_place(ctx, glimpses));
cleanup:
    igi_free(sums);
    if (status != IGI_OK) igi_glimpses_clear(glimpses);
    return status;
}

void igi_glimpses_clear(igi_glimpses *glimpses)
{
    igi_free(glimpses->region);
    igi_free(glimpses->begin);
    igi_free(glimpses->glimpses);
    igi_free(glimpses->place_of);
    *glimpses = (igi_glimpses){0};
}
