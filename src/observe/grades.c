/* SPDX-License-Identifier: Apache-2.0
 *
 * Which pixels show one surface alone.
 */
#include "observe/frame_pixels.h"

#include "base/parallel.h"
#include "observe/cover.h"

#include <string.h>

/* A region of fewer clean pixels is too small to be without those near its edges: rays through each
 * of its pixels tell which show it alone. Where that leaves fewer than twenty, the next grade counts
 * as well (igi_visible), and so on: twenty are better than hundreds that mix. */
#define FEWEST_PIXELS 20
#define FEWEST_OF_PLENTY 200
#define GRADES 4

/* Drops the pixels of too high a grade for their region. */
static void drop_pixels(const observing *j, frame_pixels *f, const uint8_t *highest)
{
    size_t kept = 0, bands = (size_t)j->scene->bands;
    for (size_t i = 0; i < f->count; i++) {
        uint32_t region = j->scene->mesh.regions[igi_surface_triangle(f->surface[i])];
        if (f->grade[i] > highest[region]) continue;
        f->surface[kept] = f->surface[i];
        f->pixel[kept] = f->pixel[i];
        memcpy(f->uv + 2 * kept, f->uv + 2 * i, 2 * sizeof *f->uv);
        memmove(f->radiance + kept * bands, f->radiance + i * bands, bands * sizeof *f->radiance);
        kept++;
    }
    f->count = kept;
    igi_free(f->grade);
    f->grade = NULL;
}

/* Of a region that has few clean pixels, each is judged by rays of its own. */
static igi_status regrade(igi_context *ctx, void *user, size_t frame, int worker)
{
    (void)worker;
    const observing *j = user;
    frame_pixels *f = &j->frames[frame];
    const igi_camera *camera = &j->scene->frames[frame].camera;
    size_t rays = 0;
    for (size_t i = 0; i < f->count; i++) {
        if (!j->scarce[j->scene->mesh.regions[igi_surface_triangle(f->surface[i])]]) continue;
        igi_cover cover = igi_cover_of(j->scene, j->tracer, camera, f->pixel[i], &rays);
        if (cover == IGI_COVER_WIDE) f->grade[i] = 0;
        else if (cover == IGI_COVER_WHOLE) f->grade[i] = 1;
        else if (f->grade[i] < 2) f->grade[i] = 2;
    }
    igi_count_rays(ctx, rays);
    return IGI_OK;
}

/* Pixels of each region by grade: counts[regions][GRADES]. */
static void count_grades(const observing *j, size_t *counts)
{
    memset(counts, 0, j->scene->region_count * GRADES * sizeof *counts);
    for (size_t k = 0; k < j->scene->frame_count; k++)
        for (size_t i = 0; i < j->frames[k].count; i++) {
            uint32_t triangle = igi_surface_triangle(j->frames[k].surface[i]);
            counts[j->scene->mesh.regions[triangle] * GRADES + j->frames[k].grade[i]]++;
        }
}

igi_status drop_edges(igi_context *ctx, observing *j)
{
    size_t regions = j->scene->region_count, *counts = NULL;
    uint8_t *highest = NULL;
    igi_status status = IGI_OK;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions * GRADES, &counts));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions, &highest));
    count_grades(j, counts);
    for (size_t r = 0; r < regions; r++) /* a lamp's edges are the worst */
        j->scarce[r] = counts[r * GRADES] < FEWEST_OF_PLENTY && !j->scene->regions[r].emitter;
    IGI_TRY_GOTO(igi_parallel_for(ctx, j->scene->frame_count, regrade, j));
    count_grades(j, counts);
    for (size_t r = 0; r < regions; r++) {
        size_t sum = counts[r * GRADES];
        j->scarce[r] = sum < FEWEST_OF_PLENTY;
        while (sum < FEWEST_PIXELS && highest[r] + 1 < GRADES)
            sum += counts[r * GRADES + ++highest[r]];
        if (j->scene->regions[r].emitter) highest[r] = 0;
    }
    for (size_t k = 0; k < j->scene->frame_count; k++) drop_pixels(j, &j->frames[k], highest);
cleanup:
    igi_free(counts);
    igi_free(highest);
    return status;
}
