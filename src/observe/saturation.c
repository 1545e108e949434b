/* SPDX-License-Identifier: Apache-2.0
 *
 * Light has no largest value, a sensor has. Of pixels that carry noise, two hardly ever share the
 * largest value in a band; where some do, all of them would have been brighter. Lamps are no
 * evidence: an even lamp is equally bright everywhere.
 */
#include "observe/saturation.h"

#include <string.h>

#define FEWEST_CLIPPED 5

static const igi_region *region_of(const igi_scene *scene, const igi_observations *o, size_t i)
{
    return &scene->regions[scene->mesh.regions[igi_surface_triangle(o->surface[i])]];
}

/* The largest value of each band on surfaces, INFINITY where too few pixels share it. */
static size_t find_tops(const igi_scene *scene, const igi_observations *o,
                        float tops[IGI_MAX_BANDS])
{
    size_t shared[IGI_MAX_BANDS] = {0}, clipped = 0, bands = (size_t)o->bands;
    for (size_t b = 0; b < bands; b++) tops[b] = 0;
    for (size_t i = 0; i < o->count; i++) {
        if (region_of(scene, o, i)->emitter) continue;
        for (size_t b = 0; b < bands; b++) {
            float x = o->radiance[i * bands + b];
            if (x > tops[b]) shared[b] = 0;
            if (x >= tops[b] && x > 0) shared[b]++;
            tops[b] = fmaxf(tops[b], x);
        }
    }
    for (size_t b = 0; b < bands; b++) {
        if (shared[b] < FEWEST_CLIPPED) tops[b] = INFINITY;
        else clipped += shared[b];
    }
    return clipped;
}

static bool is_clipped(const igi_observations *o, size_t i, const float tops[IGI_MAX_BANDS])
{
    for (int b = 0; b < o->bands; b++)
        if (o->radiance[i * (size_t)o->bands + (size_t)b] >= tops[b]) return true;
    return false;
}

static void move(igi_observations *o, size_t from, size_t to)
{
    size_t bands = (size_t)o->bands;
    o->surface[to] = o->surface[from];
    o->pixel[to] = o->pixel[from];
    memmove(o->uv + 2 * to, o->uv + 2 * from, 2 * sizeof *o->uv);
    memmove(o->radiance + to * bands, o->radiance + from * bands, bands * sizeof *o->radiance);
}

/* Leaves them out, but for lamps, of which a lower bound is better than nothing. */
static size_t leave_out(const igi_scene *scene, igi_observations *o,
                        const float tops[IGI_MAX_BANDS], const igi_region **lamp)
{
    size_t kept = 0, next = 0;
    for (size_t f = 0; f < o->frame_count; f++) {
        size_t end = o->frame_begin[f + 1];
        for (; next < end; next++) {
            bool clipped = is_clipped(o, next, tops);
            const igi_region *region = region_of(scene, o, next);
            if (clipped && region->emitter) *lamp = region;
            if (clipped && !region->emitter) continue;
            move(o, next, kept++);
        }
        o->frame_begin[f + 1] = kept;
    }
    size_t left_out = o->count - kept;
    o->count = kept;
    return left_out;
}

igi_status igi_observations_unclip(igi_context *ctx, const igi_scene *scene, igi_observations *o)
{
    float tops[IGI_MAX_BANDS];
    const igi_region *lamp = NULL;
    if (find_tops(scene, o, tops) == 0) return IGI_OK;
    size_t left_out = leave_out(scene, o, tops, &lamp);
    char *sentence;
    IGI_TRY(igi_strprintf(
        ctx, &sentence,
        "%zu pixels of surfaces share the largest value and were left out: the "
        "photographs are saturated there%s%s%s, or show a lamp where the mesh has "
        "none; merge shorter exposures",
        left_out, lamp ? ", at the lamp '" : "", lamp ? lamp->name : "", lamp ? "' too" : ""));
    return igi_add_sentence(ctx, &o->warnings, &o->warning_count, sentence);
}
