/* SPDX-License-Identifier: Apache-2.0
 *
 * Light has no largest value, a sensor has. Of pixels that carry noise, two hardly ever share the
 * largest value in a band; where some do, all of them would have been brighter. Lamps are no
 * evidence: an even lamp is equally bright everywhere.
 */
#include "observe/saturation.h"

#include <math.h>
#include <string.h>

#define FEWEST_CLIPPED 5
/* The same within one photograph. */
#define FEWEST_OF_ONE 16
#define CLIPPED_SHARE 5e-4

typedef struct scan {
    const igi_scene *scene;
    igi_observations *o;
    size_t (*counts)[2]; /* [regions] scratch */
} scan;

static const igi_region *region_of(const igi_scene *scene, const igi_observations *o, size_t i)
{
    return &scene->regions[scene->mesh.regions[igi_surface_triangle(o->surface[i])]];
}

/* counts[regions][2]: pixels of each region, and those at the top of band b. */
static void count_tops(const scan *s, const size_t range[2], size_t b, float top)
{
    memset(s->counts, 0, s->scene->region_count * sizeof *s->counts);
    for (size_t i = range[0]; i < range[1]; i++) {
        size_t *count = s->counts[region_of(s->scene, s->o, i) - s->scene->regions];
        count[0]++;
        count[1] += s->o->radiance[i * (size_t)s->o->bands + b] >= top;
    }
}

/* The largest value of each band on surfaces among observations [first, end), INFINITY where fewer
 * than so many pixels share it; nor do those of a region count of which most do: its light is even, and
 * the photograph without noise. */
static void find_tops(const scan *s, const size_t range[2], size_t fewest,
                      float tops[IGI_MAX_BANDS])
{
    size_t bands = (size_t)s->o->bands;
    for (size_t b = 0; b < bands; b++) {
        size_t shared = 0;
        tops[b] = 0;
        for (size_t i = range[0]; i < range[1]; i++) { /* few are above: only these are looked at */
            float x = s->o->radiance[i * bands + b];
            if (x > tops[b] && !region_of(s->scene, s->o, i)->emitter) tops[b] = x;
        }
        if (tops[b] > 0) count_tops(s, range, b, tops[b]);
        for (size_t r = 0; tops[b] > 0 && r < s->scene->region_count; r++)
            if (!s->scene->regions[r].emitter && 2 * s->counts[r][1] <= s->counts[r][0])
                shared += s->counts[r][1];
        if (shared < fewest) tops[b] = INFINITY;
    }
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

/* The lower of the limit that all photographs share and that of one, whose exposure may differ. */
static void lower_tops(const scan *s, const size_t range[2], float tops[IGI_MAX_BANDS])
{
    float own[IGI_MAX_BANDS];
    size_t fewest = (size_t)(CLIPPED_SHARE * (double)(range[1] - range[0]));
    find_tops(s, range, fewest > FEWEST_OF_ONE ? fewest : FEWEST_OF_ONE, own);
    for (int b = 0; b < s->o->bands; b++) tops[b] = fminf(tops[b], own[b]);
}

/* Leaves them out, but for lamps, of which a lower bound is better than nothing. */
static size_t leave_out(const scan *s, const float common[IGI_MAX_BANDS], const igi_region **lamp)
{
    igi_observations *o = s->o;
    size_t kept = 0, next = 0;
    for (size_t f = 0; f < o->frame_count; f++) {
        size_t end = o->frame_begin[f + 1], first = kept, seen = end - next;
        float tops[IGI_MAX_BANDS];
        memcpy(tops, common, sizeof tops);
        lower_tops(s, (const size_t[2]){next, end}, tops);
        for (size_t k = 0; k < o->reading_count; k++)
            for (int b = 0; o->readings[k].frame == f && b < o->bands; b++)
                if (o->readings[k].highest[b] >= tops[b]) o->readings[k].error[b] = HUGE_VAL;
        for (; next < end; next++) {
            bool clipped = is_clipped(o, next, tops);
            const igi_region *region = region_of(s->scene, o, next);
            if (clipped && region->emitter) *lamp = region;
            if (clipped && !region->emitter) continue;
            move(o, next, kept++);
        }
        o->frame_begin[f + 1] = kept;
        if (o->saturated && seen > 0) o->saturated[f] += 1 - (double)(kept - first) / (double)seen;
    }
    size_t left_out = o->count - kept;
    o->count = kept;
    return left_out;
}

igi_status igi_observations_unclip(igi_context *ctx, const igi_scene *scene, igi_observations *o)
{
    float tops[IGI_MAX_BANDS] = {0};
    const igi_region *lamp = NULL;
    scan s = {.scene = scene, .o = o};
    IGI_TRY(IGI_ALLOC(ctx, scene->region_count, &s.counts));
    find_tops(&s, (const size_t[2]){0, o->count}, FEWEST_CLIPPED, tops);
    size_t left_out = leave_out(&s, tops, &lamp);
    igi_free(s.counts);
    if (left_out == 0) return IGI_OK;
    char *sentence;
    IGI_TRY(igi_strprintf(
        ctx, &sentence,
        "%zu pixels of surfaces share the largest value and were left out: the "
        "photographs are saturated there%s%s%s, or show a lamp where the mesh has "
        "none; merge shorter exposures",
        left_out, lamp ? ", at the lamp '" : "", lamp ? lamp->name : "", lamp ? "' too" : ""));
    return igi_add_sentence(ctx, &o->warnings, &o->warning_count, sentence);
}

bool igi_observations_retract_clipped(igi_observations *o, size_t warning)
{
    for (size_t f = 0; f < o->frame_count; f++)
        if (o->saturated[f] > 0 && o->frame_begin[f + 1] > o->frame_begin[f]) return false;
    igi_free(o->warnings[warning]);
    o->warning_count--;
    memmove(o->warnings + warning, o->warnings + warning + 1,
            (o->warning_count - warning) * sizeof *o->warnings);
    return true;
}
