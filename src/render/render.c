/* SPDX-License-Identifier: Apache-2.0
 *
 * Pictures: tiles of pixels as tasks, paths in batches, the mean and its variance.
 */
#include "base/parallel.h"
#include "render/path.h"
#include "render/cache.h"
#include "scene/camera.h"

#include <string.h>

#define TILE 16
#define PATHS_A_SIDE 32 /* rough radiosity costs what ten to twenty paths a side do */

void igi_render_options_init(igi_render_options *options)
{
    *options = (igi_render_options){
        .struct_size = sizeof *options, .samples = 64, .max_depth = 1024};
}

static const igi_material *material_of(const igi_materials *materials, const igi_scene *scene,
                                       size_t region)
{
    const char *name = scene->regions[region].name;
    for (size_t k = 0; k < materials->count; k++) { /* usually the first that is tried */
        const igi_material *m = &materials->materials[(region + k) % materials->count];
        if (m->region && strcmp(m->region, name) == 0) return m;
    }
    return NULL;
}

static igi_status prepare(igi_context *ctx, const igi_renderer *r, const igi_materials *materials,
                          size_t region, finish *f)
{
    const igi_region *where = &r->scene->regions[region];
    const igi_material *m = material_of(materials, r->scene, region);
    f->absorbs = where->emitter;
    if (f->absorbs) return IGI_OK;
    if (!m)
        return igi_fail(ctx, IGI_E_DATA, "materials: there is none for the region '%s'",
                        where->name);
    if (m->map && m->map->channels < r->bands)
        return igi_fail(ctx, IGI_E_DATA, "materials: the map of '%s' has %d bands, the scene %d",
                        where->name, m->map->channels, r->bands);
    f->model = m->model;
    f->alpha = (float)m->alpha;
    f->map = where->has_uvs && m->textured ? m->map : NULL;
    f->repeat = where->uvs_wrap;
    for (int b = 0; b < r->bands; b++) {
        f->albedo[b] = (float)m->albedo[b];
        f->map_scale[b] = 1;
        f->specular[b] = (float)(m->specular_is_rgb ? m->specular_rgb[b] : m->specular);
        f->specular_mean += f->specular[b] / (float)r->bands;
    }
    return IGI_OK;
}

igi_status igi_renderer_create(igi_context *ctx, const igi_scene *scene,
                               const igi_materials *materials, const igi_light *lights,
                               size_t light_count, igi_renderer **renderer)
{
    igi_status status = IGI_OK;
    IGI_TRY(IGI_ALLOC(ctx, 1, renderer));
    igi_renderer *r = *renderer;
    r->scene = scene;
    r->bands = scene->bands;
    r->lights = lights;
    if (materials->bands != scene->bands)
        IGI_TRY_GOTO(igi_fail(ctx, IGI_E_DATA, "materials: have %d bands, the scene has %d",
                              materials->bands, scene->bands));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, scene->region_count, &r->finishes));
    IGI_TRY_GOTO(igi_lighting_create(ctx, scene, lights, light_count, &r->lighting));
    for (size_t i = 0; i < scene->region_count; i++)
        IGI_TRY_GOTO(prepare(ctx, r, materials, i, &r->finishes[i]));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, scene->mesh.triangle_count, &r->normals));
    for (size_t t = 0; t < scene->mesh.triangle_count; t++)
        r->normals[t] = igi_triangle_normal(&scene->mesh, (uint32_t)t);
    IGI_TRY_GOTO(igi_tracer_create(ctx, &scene->mesh, &r->tracer));
cleanup:
    if (status != IGI_OK) {
        igi_renderer_destroy(r);
        *renderer = NULL;
    }
    return status;
}

igi_status igi_renderer_vary(igi_context *ctx, const igi_renderer *base, const igi_light *lights,
                             igi_renderer **renderer)
{
    igi_status status = IGI_OK;
    size_t regions = base->scene->region_count, light_count = igi_lighting_count(base->lighting);
    IGI_TRY(IGI_ALLOC(ctx, 1, renderer));
    igi_renderer *r = *renderer;
    *r = (igi_renderer){.scene = base->scene,
                        .bands = base->bands,
                        .normals = base->normals,
                        .tracer = base->tracer,
                        .lights = lights,
                        .is_variant = true};
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions, &r->finishes));
    memcpy(r->finishes, base->finishes, regions * sizeof *r->finishes);
    IGI_TRY_GOTO(igi_lighting_create(ctx, r->scene, lights, light_count, &r->lighting));
cleanup:
    if (status != IGI_OK) {
        igi_renderer_destroy(r);
        *renderer = NULL;
    }
    return status;
}

void igi_renderer_destroy(igi_renderer *renderer)
{
    if (!renderer) return;
    igi_cache_destroy(renderer->cache);
    igi_cache_destroy(renderer->expected);
    igi_lighting_destroy(renderer->lighting);
    igi_free(renderer->finishes);
    if (!renderer->is_variant) igi_tracer_destroy(renderer->tracer);
    if (!renderer->is_variant) igi_free(renderer->normals);
    igi_free(renderer);
}

igi_status igi_renderer_add_cache(igi_context *ctx, igi_renderer *renderer)
{
    static const igi_cache_options smooth = {.rays = 64, .light_points = 4, .patch_share = 0.02f};
    IGI_TRY(igi_cache_create(ctx, renderer, &smooth, &renderer->cache));
    renderer->cache_edge = 2;
    return IGI_OK;
}

igi_status igi_renderer_expect(igi_context *ctx, igi_renderer *renderer, double paths)
{
    igi_cache_options rough = {.rays = 16, .light_points = 1, .patch_share = 0.03f};
    rough.most_sides = 1 + (size_t)fmin(paths / PATHS_A_SIDE, 1e9);
    return igi_cache_create(ctx, renderer, &rough, &renderer->expected);
}

typedef struct job {
    const igi_renderer *renderer;
    const igi_camera *cameras;
    igi_render_options options;
    int batch, batches; /* paths in each, and of them */
    uint64_t key;
    igi_layers layers;
    size_t *first_tile; /* [count + 1] */
    size_t count;
} job;

static float *samples_of(igi_image **images, size_t frame, size_t at)
{
    return images ? images[frame]->samples + at : NULL;
}

static void put_parts(const job *j, size_t frame, size_t at, const path_parts *sum)
{
    float *direct = samples_of(j->layers.direct, frame, at);
    float *albedo = samples_of(j->layers.albedos, frame, at);
    for (int b = 0; b < j->renderer->bands; b++) {
        if (direct) direct[b] = sum->direct[b] / (float)j->batches;
        if (albedo) albedo[b] = sum->albedo[b] / (float)j->batches;
    }
}

/* Mean of a pixel's batches, and the variance of that mean. */
static uint64_t render_pixel(const job *j, size_t frame, int x, int y, size_t at)
{
    const igi_camera *camera = &j->cameras[frame];
    int bands = j->renderer->bands;
    double sum[IGI_MAX_BANDS] = {0}, squares[IGI_MAX_BANDS] = {0};
    uint64_t rays = 0, pixel = (uint64_t)y * (uint64_t)camera->width + (uint64_t)x;
    uint64_t stream = igi_hash64(igi_hash64(j->key ^ frame) ^ pixel);
    igi_vec centre = igi_camera_centre(camera);
    bool apart = j->layers.direct || j->layers.albedos;
    path_parts all = {{0}, {0}};
    for (int k = 0; k < j->batches; k++) {
        float batch[IGI_MAX_BANDS] = {0};
        path_parts parts = {{0}, {0}};
        for (int i = 0; i < j->batch; i++) {
            sampler points = {igi_hash64(stream ^ (uint64_t)k), (uint32_t)i, (uint32_t)j->batch - 1,
                              0};
            float u, v;
            sampler_next(&points, &u, &v);
            igi_vec d = igi_camera_direction(camera, x + (double)u, y + (double)v);
            rays += trace_path(j->renderer, centre, d, j->options.max_depth, &points, batch,
                               apart ? &parts : NULL);
        }
        for (int b = 0; b < bands; b++) {
            double value = (double)(batch[b] + parts.direct[b]) / j->batch;
            all.direct[b] += parts.direct[b] / (float)j->batch;
            all.albedo[b] += parts.albedo[b] / (float)j->batch;
            sum[b] += value;
            squares[b] += value * value;
        }
    }
    double n = j->batches;
    float *mean = samples_of(j->layers.pictures, frame, at);
    float *variance = samples_of(j->layers.variances, frame, at);
    put_parts(j, frame, at, &all);
    for (int b = 0; b < bands; b++) {
        mean[b] = (float)(sum[b] / n);
        if (variance)
            variance[b] = (float)(fmax(0.0, squares[b] / n - sum[b] / n * sum[b] / n) /
                                  fmax(1.0, n - 1));
    }
    return rays;
}

static igi_status render_tile(igi_context *ctx, void *user, size_t index, int worker)
{
    (void)worker;
    const job *j = user;
    size_t frame = 0;
    while (j->first_tile[frame + 1] <= index) frame++;
    const igi_camera *camera = &j->cameras[frame];
    int tile = (int)(index - j->first_tile[frame]), columns = (camera->width + TILE - 1) / TILE;
    int x0 = tile % columns * TILE, y0 = tile / columns * TILE, bands = j->renderer->bands;
    uint64_t rays = 0;
    for (int y = y0; y < y0 + TILE && y < camera->height; y++)
        for (int x = x0; x < x0 + TILE && x < camera->width; x++) {
            size_t at = ((size_t)y * (size_t)camera->width + (size_t)x) * (size_t)bands;
            rays += render_pixel(j, frame, x, y, at);
        }
    igi_count_rays(ctx, rays);
    return IGI_OK;
}

igi_status igi_renderer_frames(igi_context *ctx, const igi_renderer *renderer,
                               const igi_camera *cameras, size_t count,
                               const igi_render_options *options, uint64_t key,
                               const igi_layers *layers)
{
    igi_status status = IGI_OK;
    job j = {.renderer = renderer,
             .cameras = cameras,
             .options = *options,
             .count = count,
             .key = igi_hash64(igi_seed(ctx)) ^ key,
             .layers = *layers};
    if (options->struct_size != sizeof *options || options->samples < 1 || options->max_depth < 1)
        return igi_fail(ctx, IGI_E_USAGE, "render: samples and max_depth must be at least 1");
    /* At least four batches, or there is no variance to speak of. */
    j.batch = options->samples % 16 == 0 && options->samples >= 64  ? 16
              : options->samples % 4 == 0 && options->samples >= 16 ? 4
                                                                    : 1;
    j.batches = options->samples / j.batch;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, count + 1, &j.first_tile));
    for (size_t i = 0; i < count; i++) {
        size_t columns = (size_t)(cameras[i].width + TILE - 1) / TILE;
        size_t rows = (size_t)(cameras[i].height + TILE - 1) / TILE;
        j.first_tile[i + 1] = j.first_tile[i] + columns * rows;
    }
    IGI_TRY_GOTO(igi_parallel_for(ctx, j.first_tile[count], render_tile, &j));
cleanup:
    igi_free(j.first_tile);
    return status;
}

igi_status igi_render(igi_context *ctx, const igi_scene *scene, const igi_materials *materials,
                      const igi_light *lights, size_t light_count, const igi_camera *camera,
                      const igi_render_options *options, igi_image **picture, igi_image **variance)
{
    igi_status status = IGI_OK;
    igi_renderer *renderer = NULL;
    igi_render_options defaults;
    igi_render_options_init(&defaults);
    *picture = NULL;
    if (variance) *variance = NULL;
    IGI_TRY_GOTO(igi_renderer_create(ctx, scene, materials, lights, light_count, &renderer));
    IGI_TRY_GOTO(igi_image_create(ctx, camera->width, camera->height, scene->bands, picture));
    if (variance)
        IGI_TRY_GOTO(igi_image_create(ctx, camera->width, camera->height, scene->bands, variance));
    igi_layers layers = {.pictures = picture, .variances = variance};
    IGI_TRY_GOTO(
        igi_renderer_frames(ctx, renderer, camera, 1, options ? options : &defaults, 0, &layers));
cleanup:
    igi_renderer_destroy(renderer);
    if (status != IGI_OK) {
        igi_image_destroy(*picture);
        *picture = NULL;
        if (variance) {
            igi_image_destroy(*variance);
            *variance = NULL;
        }
    }
    return status;
}
