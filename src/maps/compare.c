/* SPDX-License-Identifier: Apache-2.0 */
#include "maps/compare.h"

#include "base/parallel.h"
#include "lens/photographs.h"
#include "observe/glare.h"
#include "observe/visible.h"
#include "specular/lobe_view.h"
#include "scene/camera.h"

#include <string.h>

#define PHOTOGRAPHS 4

typedef struct job {
    const igi_problem *problem;
    const igi_field *field;
    const igi_layout *layout;
    igi_recovery *recovery;
    igi_photographs *photographs;
} job;

static void predict(const job *j, size_t frame, const igi_hit *hit, igi_vec direction,
                    float *radiance, float *albedo)
{
    const igi_problem *p = j->problem;
    float irradiance[IGI_MAX_BANDS], x, y;
    for (int b = 0; b < p->bands; b++) albedo[b] = 1;
    if (hit->triangle == IGI_NO_HIT) {
        igi_lighting_add_emitted(p->lighting, direction, hit, radiance);
        return;
    }
    uint32_t region = p->scene->mesh.regions[hit->triangle];
    const igi_region *r = &p->scene->regions[region];
    if (r->emitter) {
        igi_lighting_add_emitted(p->lighting, direction, hit, radiance);
        return;
    }
    const igi_material *m = &j->recovery->materials->materials[region];
    for (int b = 0; b < p->bands; b++) albedo[b] = (float)m->albedo[b];
    if (m->textured && m->map) {
        igi_layout_place(j->layout, hit->triangle, hit->u, hit->v, m->map->width, &x, &y);
        igi_map_at(m->map, p->bands, r->has_uvs && r->uvs_wrap, x, y, albedo);
    }
    igi_field_irradiance(j->field, igi_surface_of(hit), hit->u, hit->v, irradiance);
    for (int b = 0; b < p->bands; b++) radiance[b] = albedo[b] / IGI_PIF * irradiance[b];
    if (p->lobes) igi_lobe_view_radiance(p->lobes, p, frame, hit, radiance);
}

static igi_status take_photograph(igi_context *ctx, const job *j, size_t frame, igi_comparison *c)
{
    igi_image *image = NULL;
    char *warning = NULL; /* observing has noted it already */
    int bands = j->problem->bands;
    igi_status status = IGI_OK;
    IGI_TRY_GOTO(igi_strdup(ctx, j->problem->scene->frames[frame].name, &c->frame));
    IGI_TRY_GOTO(igi_photographs_load(ctx, j->photographs, frame, &image, &warning));
    igi_glare_lift_image(j->problem->observations, frame, image);
    IGI_TRY_GOTO(igi_image_create(ctx, image->width, image->height, bands, &c->photo));
    IGI_TRY_GOTO(igi_image_create(ctx, image->width, image->height, bands, &c->prediction));
    IGI_TRY_GOTO(igi_image_create(ctx, image->width, image->height, bands, &c->albedo));
    for (size_t i = 0; i < (size_t)image->width * (size_t)image->height; i++)
        memcpy(c->photo->samples + i * (size_t)bands, image->samples + i * (size_t)image->channels,
               (size_t)bands * sizeof(float));
cleanup:
    igi_free(warning);
    igi_image_destroy(image);
    return status;
}

/* How many regions have a pixel in a thousand or more. */
static int count_regions(const uint32_t *pixels, size_t regions, size_t total)
{
    int count = 0;
    for (size_t r = 0; r < regions; r++) count += 1000 * (size_t)pixels[r] >= total;
    return count;
}

static igi_status compare_frame(igi_context *ctx, void *user, size_t index, int worker)
{
    (void)worker;
    const job *j = user;
    const igi_problem *p = j->problem;
    size_t number = index * p->scene->frame_count / j->recovery->comparison_count;
    const igi_frame *frame = &p->scene->frames[number];
    igi_comparison *c = &j->recovery->comparisons[index];
    IGI_TRY(take_photograph(ctx, j, number, c));
    igi_vec centre = igi_camera_centre(&frame->camera);
    float *radiance = c->prediction->samples, *albedo = c->albedo->samples;
    uint32_t *pixels = NULL;
    IGI_TRY(IGI_ALLOC(ctx, p->scene->region_count, &pixels));
    for (int y = 0; y < c->photo->height; y++)
        for (int x = 0; x < c->photo->width; x++) {
            igi_vec direction = igi_camera_direction(&frame->camera, x + 0.5, y + 0.5);
            igi_hit hit = igi_trace(p->tracer, centre, direction);
            predict(j, number, &hit, direction, radiance, albedo);
            if (hit.triangle != IGI_NO_HIT) pixels[p->scene->mesh.regions[hit.triangle]]++;
            radiance += p->bands;
            albedo += p->bands;
        }
    c->regions = count_regions(pixels, p->scene->region_count,
                               (size_t)c->photo->width * (size_t)c->photo->height);
    igi_free(pixels);
    igi_count_rays(ctx, (uint64_t)c->photo->width * (uint64_t)c->photo->height);
    return IGI_OK;
}

igi_status igi_compare(igi_context *ctx, const igi_problem *problem, const igi_field *field,
                       const igi_layout *layout, igi_recovery *recovery)
{
    size_t frames = problem->scene->frame_count;
    size_t most = problem->options->target_error > 0 ? 1 : PHOTOGRAPHS; /* in a hurry one will do */
    size_t count = frames < most ? frames : most;
    IGI_TRY(IGI_ALLOC(ctx, count, &recovery->comparisons));
    recovery->comparison_count = count;
    job j = {problem, field, layout, recovery, NULL};
    igi_status status = igi_photographs_open(ctx, problem->scene, &j.photographs);
    if (status == IGI_OK) status = igi_parallel_for(ctx, count, compare_frame, &j);
    igi_photographs_close(j.photographs);
    return status;
}
