/* SPDX-License-Identifier: Apache-2.0
 *
 * Which regions get a fine map, how fine, and what is said of them.
 *
 * A region without texture gets a coarse map from the means of its patches: cheap, and enough to
 * show where its albedo fits badly. A textured one gets all its pixels, at the photographs' own
 * resolution.
 */
#include "maps/maps_private.h"

#include "base/order.h"
#include "base/parallel.h"

#include <stdlib.h>
#include <string.h>

#define SMALLEST 16
#define LARGEST 1024
#define LARGEST_PLAIN 64 /* of a region without texture */
#define FOOTPRINTS 4096  /* looked at to find a map's size */
#define SITES_A_SIDE 8

static igi_status sort_sides(igi_context *ctx, const igi_problem *p, igi_region_sides *s)
{
    size_t regions = p->scene->region_count;
    uint32_t sides = 2 * (uint32_t)p->patches->count;
    IGI_TRY(IGI_ALLOC(ctx, regions + 2, &s->begin));
    for (uint32_t side = 0; side < sides; side++)
        if (igi_problem_seen_count(p, side))
            s->begin[igi_patch_region(p->patches, side >> 1) + 2]++;
    for (size_t r = 0; r < regions; r++) s->begin[r + 2] += s->begin[r + 1];
    IGI_TRY(IGI_ALLOC(ctx, s->begin[regions + 1], &s->sides));
    for (uint32_t side = 0; side < sides; side++)
        if (igi_problem_seen_count(p, side))
            s->sides[s->begin[igi_patch_region(p->patches, side >> 1) + 1]++] = side;
    return IGI_OK;
}

typedef struct job {
    const igi_problem *problem;
    igi_field *field;
    const igi_layout *layout;
    igi_region_sides sides;
    igi_materials *materials;
    igi_region_evidence *evidence; /* NULL: nobody asks */
} job;

static float uv_per_metre(const igi_layout *layout, uint32_t triangle)
{
    const float *t = layout->uvs + 6 * (size_t)triangle;
    float area = 0.5f * fabsf((t[2] - t[0]) * (t[5] - t[1]) - (t[3] - t[1]) * (t[4] - t[0]));
    float surface = igi_triangle_area(&layout->scene->mesh, triangle);
    return surface > 0 ? sqrtf(area / surface) : 0;
}

static int power_of_two(float texels, int largest)
{
    int size = SMALLEST;
    while (size < largest && (float)size * 1.4142f < texels) size *= 2;
    return size;
}

/* One texel for a pixel whose footprint is smaller than three quarters of all. */
static igi_status fine_size(igi_context *ctx, const job *j, uint32_t region, int *size)
{
    const igi_problem *p = j->problem;
    const igi_observations *o = p->observations;
    float *prints;
    size_t count = 0, total = 0, seen = 0, step;
    const uint32_t *sides = j->sides.sides;
    for (size_t k = j->sides.begin[region]; k < j->sides.begin[region + 1]; k++)
        total += igi_problem_seen_count(p, sides[k]);
    step = total / FOOTPRINTS + 1;
    IGI_TRY(IGI_ALLOC(ctx, total / step + 1, &prints));
    for (size_t k = j->sides.begin[region]; k < j->sides.begin[region + 1]; k++)
        for (size_t n = p->site_begin[sides[k]]; n < p->site_begin[sides[k] + 1]; n++) {
            if (seen++ % step) continue;
            size_t i = p->order[n], frame = 0;
            while (i >= o->frame_begin[frame + 1]) frame++;
            float print = igi_footprint(p, frame, o->surface[i], o->uv[2 * i], o->uv[2 * i + 1]) *
                          uv_per_metre(j->layout, igi_surface_triangle(o->surface[i]));
            if (print > 0) prints[count++] = print; /* collapsed coordinates resolve nothing */
        }
    qsort(prints, count, sizeof *prints, igi_compare_floats);
    *size = count > 0 ? power_of_two(1 / prints[count / 4], LARGEST) : SMALLEST;
    igi_free(prints);
    return IGI_OK;
}

/* A texel about as large as a patch. */
static int plain_size(const job *j, uint32_t region)
{
    uint32_t side = j->sides.sides[j->sides.begin[region]];
    float scale = uv_per_metre(j->layout, j->problem->patches->triangle[side >> 1]);
    return power_of_two(1 / fmaxf(scale * j->problem->patches->size_m, 1e-6f), LARGEST_PLAIN);
}

/* Mean of the map over the area that the photographs show, as far as they determine it. */
static void take_area_mean(const job *j, uint32_t region, igi_material *m)
{
    const igi_problem *p = j->problem;
    const igi_observations *o = p->observations;
    const igi_region *r = &p->scene->regions[region];
    double sum[IGI_MAX_BANDS] = {0}, area = 0;
    for (size_t k = j->sides.begin[region]; k < j->sides.begin[region + 1]; k++) {
        uint32_t side = j->sides.sides[k];
        size_t sites = igi_problem_seen_count(p, side);
        size_t taken = sites < SITES_A_SIDE ? sites : SITES_A_SIDE;
        double share = (double)p->patches->area[side >> 1] / (double)taken;
        for (size_t n = 0; n < taken; n++) {
            size_t i = p->order[p->site_begin[side] + n * sites / taken];
            float x, y, albedo[IGI_MAX_BANDS + 1];
            igi_layout_place(j->layout, igi_surface_triangle(o->surface[i]), o->uv[2 * i],
                             o->uv[2 * i + 1], m->map->width, &x, &y);
            igi_map_at(m->map, p->bands + 1, r->has_uvs && r->uvs_wrap, x, y, albedo);
            double known = share * (double)albedo[p->bands];
            for (int b = 0; b < p->bands; b++) sum[b] += known * (double)albedo[b];
            area += known;
        }
    }
    for (int b = 0; b < p->bands && area > 0; b++) m->albedo[b] = sum[b] / area;
}

static igi_status decide(igi_context *ctx, void *user, size_t index, int worker)
{
    (void)worker;
    const job *j = user;
    const igi_region *r = &j->problem->scene->regions[index];
    igi_material *m = &j->materials->materials[index];
    if (r->emitter || !m->determined) return IGI_OK;
    igi_texture_evidence *found = j->evidence ? &j->evidence[index].texture : NULL;
    m->textured = r->textured == IGI_YES;
    if (found) found->given = r->textured != IGI_AUTO;
    if (r->textured != IGI_AUTO) return IGI_OK;
    return igi_find_texture(ctx, j->problem, j->field, &j->sides, (uint32_t)index, &m->textured,
                            found);
}

static igi_status make_map(igi_context *ctx, void *user, size_t index, int worker)
{
    (void)worker;
    job *j = user;
    uint32_t region = (uint32_t)index;
    const igi_problem *p = j->problem;
    const igi_region *r = &p->scene->regions[region];
    igi_material *m = &j->materials->materials[region];
    igi_texels texels = {0};
    igi_status status = IGI_OK;
    int size;
    if (r->emitter || !m->determined || j->sides.begin[region + 1] == j->sides.begin[region])
        return IGI_OK;
    if (m->textured) {
        size = p->options->map_size;
        if (size <= 0) IGI_TRY(fine_size(ctx, j, region, &size));
        IGI_TRY_GOTO(igi_texels_create(ctx, size, p->bands, r->has_uvs && r->uvs_wrap, &texels));
        for (int b = 0; b < p->bands; b++) texels.albedo += (float)m->albedo[b] / (float)p->bands;
        IGI_TRY_GOTO(
            igi_texels_add_pixels(ctx, &texels, p, j->field, j->layout, &j->sides, region));
    } else {
        size = plain_size(j, region);
        IGI_TRY_GOTO(igi_texels_create(ctx, size, p->bands, r->has_uvs && r->uvs_wrap, &texels));
        igi_texels_add_patches(&texels, p, j->field, j->layout, &j->sides, region);
    }
    IGI_TRY_GOTO(igi_texels_finish(ctx, &texels, m));
    if (m->textured) take_area_mean(j, region, m);
cleanup:
    igi_texels_clear(&texels);
    return status;
}

igi_status igi_maps_create(igi_context *ctx, const igi_problem *problem, igi_field *field,
                           const igi_layout *layout, igi_materials *materials,
                           igi_region_evidence *evidence)
{
    igi_status status = IGI_OK;
    job j = {.problem = problem,
             .field = field,
             .layout = layout,
             .materials = materials,
             .evidence = evidence};
    size_t regions = problem->scene->region_count;
    for (size_t r = 0; evidence && r < regions; r++) {
        igi_texture_evidence *t = &evidence[r].texture;
        t->amplitude = t->least = t->agreement = (double)NAN;
    }
    IGI_TRY_GOTO(sort_sides(ctx, problem, &j.sides));
    IGI_TRY_GOTO(igi_parallel_for(ctx, regions, decide, &j));
    for (uint32_t r = 0; r < regions; r++)
        if (materials->materials[r].textured) IGI_TRY_GOTO(igi_field_refine(ctx, field, r));
    IGI_TRY_GOTO(igi_parallel_for(ctx, regions, make_map, &j));
cleanup:
    igi_free(j.sides.begin);
    igi_free(j.sides.sides);
    return status;
}
