/* SPDX-License-Identifier: Apache-2.0
 *
 * Which lobes do the photographs show? The lamps' light that a lobe mirrors into each pixel is
 * rendered alone (no albedo, paths of two edges). A pixel shows a highlight where that is SHARE of
 * the photographed radiance or more and the region reaches EDGE pixels around it.
 */
#include "synth/synth.h"

#include "render/render.h"
#include "scene/camera.h"

#include <string.h>

#define SHARE 0.2f
#define EDGE 2
#define SAMPLES 16

/* The region that each pixel's centre shows; -1: none. */
static void find_regions(const igi_scene *scene, const igi_tracer *tracer, const igi_camera *camera,
                         int *region)
{
    igi_vec centre = igi_camera_centre(camera);
    for (int y = 0; y < camera->height; y++)
        for (int x = 0; x < camera->width; x++) {
            igi_hit hit = igi_trace(tracer, centre, igi_camera_direction(camera, x + .5, y + .5));
            region[y * camera->width + x] = hit.triangle == IGI_NO_HIT
                                                ? -1
                                                : (int)scene->mesh.regions[hit.triangle];
        }
}

static bool is_inside(const int *region, const igi_camera *camera, int x, int y)
{
    if (x < EDGE || y < EDGE || x + EDGE >= camera->width || y + EDGE >= camera->height)
        return false;
    for (int j = y - EDGE; j <= y + EDGE; j++)
        for (int i = x - EDGE; i <= x + EDGE; i++)
            if (region[j * camera->width + i] != region[y * camera->width + x]) return false;
    return true;
}

static void count_in(const igi_camera *camera, const int *region, const igi_image *photo,
                     const igi_image *lobes, size_t *pixels)
{
    size_t bands = (size_t)photo->channels;
    for (int y = 0; y < camera->height; y++)
        for (int x = 0; x < camera->width; x++) {
            size_t at = (size_t)y * (size_t)camera->width + (size_t)x;
            float all = 0, lobe = 0;
            for (size_t b = 0; b < bands; b++) {
                all += photo->samples[at * bands + b];
                lobe += lobes->samples[at * bands + b];
            }
            if (region[at] >= 0 && lobe >= SHARE * all && is_inside(region, camera, x, y))
                pixels[region[at]]++;
        }
}

/* The same materials with nothing but their lobes; shares their names. */
static igi_status lobes_alone(igi_context *ctx, const igi_materials *all, igi_materials *alone)
{
    *alone = (igi_materials){.scene = all->scene, .bands = all->bands, .count = all->count};
    IGI_TRY(IGI_ALLOC(ctx, all->count, &alone->materials));
    for (size_t i = 0; i < all->count; i++) {
        igi_material *m = &alone->materials[i];
        *m = all->materials[i];
        memset(m->albedo, 0, sizeof m->albedo);
        m->map = NULL;
    }
    return IGI_OK;
}

static bool any_lobe(const igi_materials *materials)
{
    for (size_t i = 0; i < materials->count; i++)
        if (materials->materials[i].model != IGI_LAMBERT) return true;
    return false;
}

igi_status highlights_count(igi_context *ctx, const igi_scene *scene, const igi_tracer *tracer,
                            const igi_materials *materials, const igi_camera *cameras,
                            size_t camera_count, igi_image *const *photos, size_t *pixels)
{
    igi_status status = IGI_OK;
    igi_materials alone = {.count = 0};
    igi_renderer *renderer = NULL;
    int *region = NULL;
    igi_render_options options;
    if (!any_lobe(materials)) return IGI_OK;
    igi_render_options_init(&options);
    options.samples = SAMPLES;
    options.max_depth = 2;
    IGI_TRY_GOTO(lobes_alone(ctx, materials, &alone));
    IGI_TRY_GOTO(
        igi_renderer_create(ctx, scene, &alone, scene->lights, scene->light_count, &renderer));
    igi_stage_begin(ctx, "highlights");
    for (size_t f = 0; f < camera_count; f++) {
        const igi_camera *camera = &cameras[f];
        igi_image *lobes = NULL;
        igi_free(region);
        IGI_TRY_GOTO(IGI_ALLOC(ctx, (size_t)camera->width * (size_t)camera->height, &region));
        find_regions(scene, tracer, camera, region);
        IGI_TRY_GOTO(igi_image_create(ctx, camera->width, camera->height, scene->bands, &lobes));
        status = igi_renderer_frames(ctx, renderer, camera, 1, &options, f,
                                     &(igi_layers){.pictures = &lobes});
        if (status == IGI_OK) count_in(camera, region, photos[f], lobes, pixels);
        igi_image_destroy(lobes);
        IGI_TRY_GOTO(status);
    }
cleanup:
    igi_renderer_destroy(renderer);
    igi_free(alone.materials);
    igi_free(region);
    return status;
}
