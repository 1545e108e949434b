/* SPDX-License-Identifier: Apache-2.0
 *
 * Texture repeats: two halves of the photographs show it alike, while pixel noise differs, and so do
 * highlights, which lie elsewhere in every view. What repeats as well is a wrong irradiance.
 *
 * Of each patch the albedo's relative deviation d from that of its surroundings (a cell of a grid: a
 * slow trend is rather light than paint) is taken from either half. The statistic is the median
 * over patches of the products d_A d_B: it grows with the square of the texture's amplitude, and
 * shadows' edges and contacts, where the irradiance is wrong in few patches, do not move it.
 *     amplitude = sqrt(median d_A d_B)       agreement = median d_A d_B / median |d_A| |d_B|
 * It is a texture when the halves agree, and the amplitude exceeds what the irradiance's own
 * uncertainty explains. A mesh without texture coordinates was hardly meant to have textures: there
 * the margin is wider.
 */
#include "maps/maps_private.h"

#include "base/order.h"
#include "specular/lobe_view.h"

#include <stdlib.h>
#include <string.h>

#define CELL_PATCHES 12
#define CELL_FEWEST 4 /* patches that make a surrounding */
#define SITES_A_SIDE 32
#define FEWEST 40 /* patches that make evidence */
#define AMPLITUDE 0.03f
#define AGREEMENT 0.35f
/* The amplitude is above so many standard deviations of the irradiance beside. */
#define SIGMAS 0.5f
#define SIGMAS_WITHOUT_UVS 3.0f
/* Patches that a sharp shadow crosses are left out where this share of the others remains. */
#define SMOOTH_SHARE 0.3

typedef struct patch {
    uint32_t side;
    float half[2][IGI_MAX_BANDS]; /* reflected, pi L */
    float received[IGI_MAX_BANDS];
} patch;

typedef struct cell {
    uint32_t count; /* 0: the slot is empty */
    int32_t at[3];
    float reflected[IGI_MAX_BANDS], received[IGI_MAX_BANDS];
} cell;

typedef struct evidence {
    const igi_problem *problem;
    const igi_field *field;
    size_t count;
    patch *patches;
    cell *cells;
    size_t slots;
    float *product, *size, *std; /* of each patch with surroundings */
} evidence;

static bool take_patch(evidence *e, uint32_t side)
{
    const igi_problem *p = e->problem;
    patch *to = &e->patches[e->count];
    size_t sites = igi_problem_seen_count(p, side), frame = 0, taken[2] = {0, 0};
    size_t wanted = sites < SITES_A_SIDE ? sites : SITES_A_SIDE;
    *to = (patch){.side = side};
    if (!igi_field_of_side(e->field, side, to->received)) return false;
    for (int b = 0; b < p->bands; b++)
        if (!(to->received[b] > 0)) return false;
    for (size_t n = 0; n < wanted; n++) {
        size_t i = p->order[p->site_begin[side] + n * sites / wanted];
        while (i >= p->observations->frame_begin[frame + 1]) frame++;
        const float *radiance = p->observations->radiance + i * (size_t)p->bands;
        for (int b = 0; b < p->bands; b++) to->half[frame % 2][b] += radiance[b];
        taken[frame % 2]++;
    }
    if (taken[0] == 0 || taken[1] == 0) return false;
    const float *lobe = p->lobes ? p->lobes->correction->seen + side * (size_t)p->bands : NULL;
    for (int h = 0; h < 2; h++)
        for (int b = 0; b < p->bands; b++)
            to->half[h][b] = IGI_PIF * (to->half[h][b] / (float)taken[h] - (lobe ? lobe[b] : 0));
    return true;
}

static void take_patches(evidence *e, const igi_region_sides *sides, uint32_t region)
{
    size_t begin = sides->begin[region], end = sides->begin[region + 1], smooth = 0;
    for (size_t k = begin; k < end; k++) smooth += !igi_field_has_edge(e->field, sides->sides[k]);
    bool skip_edges = (double)smooth > SMOOTH_SHARE * (double)(end - begin);
    for (size_t k = begin; k < end; k++)
        if (!(skip_edges && igi_field_has_edge(e->field, sides->sides[k])))
            e->count += take_patch(e, sides->sides[k]);
}

static cell *find_cell(const evidence *e, uint32_t side)
{
    igi_vec p = igi_field_point(e->field, side);
    float scale = 1 / (CELL_PATCHES * e->problem->patches->size_m);
    int32_t at[3] = {(int32_t)floorf(p.x * scale), (int32_t)floorf(p.y * scale),
                     (int32_t)floorf(p.z * scale)};
    uint64_t h = igi_hash64(((uint64_t)(uint32_t)at[0] << 32 | (uint32_t)at[1]) ^
                            igi_hash64((uint32_t)at[2]));
    for (size_t i = h & (e->slots - 1);; i = (i + 1) & (e->slots - 1)) {
        cell *c = &e->cells[i];
        if (c->count == 0) memcpy(c->at, at, sizeof at);
        if (memcmp(c->at, at, sizeof at) == 0) return c;
    }
}

static void sum_cells(const evidence *e)
{
    for (size_t i = 0; i < e->count; i++) {
        const patch *p = &e->patches[i];
        cell *c = find_cell(e, p->side);
        float area = e->problem->patches->area[p->side >> 1];
        c->count++;
        for (int b = 0; b < e->problem->bands; b++) {
            c->reflected[b] += area * 0.5f * (p->half[0][b] + p->half[1][b]);
            c->received[b] += area * p->received[b];
        }
    }
}

/* Deviations of both halves, over the bands: their product and the product of their sizes. */
static bool deviate(const evidence *e, const patch *p, float *product, float *size)
{
    const cell *c = find_cell(e, p->side);
    float dot = 0, squares[2] = {0, 0}, mean = 0;
    if (c->count < CELL_FEWEST) return false;
    for (int b = 0; b < e->problem->bands; b++) {
        float local = c->reflected[b] / c->received[b];
        float d[2] = {p->half[0][b] / p->received[b] - local,
                      p->half[1][b] / p->received[b] - local};
        dot += d[0] * d[1];
        mean += local * local;
        for (int h = 0; h < 2; h++) squares[h] += d[h] * d[h];
    }
    if (!(mean > 0)) return false;
    *product = dot / mean;
    *size = sqrtf(squares[0] * squares[1]) / mean;
    return true;
}

static float median(float *values, size_t count)
{
    qsort(values, count, sizeof *values, igi_compare_floats);
    return values[count / 2];
}

static bool judge(const evidence *e, bool has_uvs, igi_texture_evidence *found)
{
    size_t n = 0;
    for (size_t i = 0; i < e->count; i++) {
        if (!deviate(e, &e->patches[i], &e->product[n], &e->size[n])) continue;
        e->std[n++] = igi_field_std(e->field, e->patches[i].side);
    }
    if (n < FEWEST) return false;
    float repeats = median(e->product, n), size = median(e->size, n), std = median(e->std, n);
    float least = AMPLITUDE + (has_uvs ? SIGMAS : SIGMAS_WITHOUT_UVS) * std;
    float amplitude = repeats > 0 ? sqrtf(repeats) : 0;
    if (found) {
        found->amplitude = (double)amplitude;
        found->least = (double)least;
        found->agreement = size > 0 ? (double)(repeats / size) : 0;
    }
    return repeats > AGREEMENT * size && amplitude > least;
}

igi_status igi_find_texture(igi_context *ctx, const igi_problem *problem, const igi_field *field,
                            const igi_region_sides *sides, uint32_t region, bool *textured,
                            igi_texture_evidence *found)
{
    igi_status status = IGI_OK;
    evidence e = {.problem = problem, .field = field, .slots = 64};
    size_t most = sides->begin[region + 1] - sides->begin[region];
    *textured = false;
    if (most < FEWEST) return IGI_OK;
    while (e.slots < 2 * most) e.slots *= 2;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, most, &e.patches));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, e.slots, &e.cells));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, most, &e.product));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, most, &e.size));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, most, &e.std));
    take_patches(&e, sides, region);
    sum_cells(&e);
    *textured = judge(&e, problem->scene->regions[region].has_uvs, found);
cleanup:
    igi_free(e.patches);
    igi_free(e.cells);
    igi_free(e.product);
    igi_free(e.size);
    igi_free(e.std);
    return status;
}
