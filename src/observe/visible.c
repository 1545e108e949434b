/* SPDX-License-Identifier: Apache-2.0 */
#include "observe/visible.h"

#include "scene/camera.h"

/* Neighbours whose normals differ by more than 30 degrees are an edge. */
#define SMOOTH_COS 0.866f
/* Neighbours that lie this many pixel widths off each other's plane are an edge. */
#define DEPTH_JUMP_PX 2.0f

static void trace_pixels(const igi_tracer *tracer, const igi_camera *camera, igi_hit *hits)
{
    igi_vec centre = igi_camera_centre(camera), directions[IGI_TRACE_BUNDLE];
    for (int y = 0; y < camera->height; y++)
        for (int x = 0; x < camera->width; x += IGI_TRACE_BUNDLE) {
            int count = camera->width - x < IGI_TRACE_BUNDLE ? camera->width - x : IGI_TRACE_BUNDLE;
            for (int i = 0; i < count; i++)
                directions[i] = igi_camera_direction(camera, x + i + 0.5, y + 0.5);
            igi_trace_bundle(tracer, centre, directions, count, hits);
            hits += count;
        }
}

bool igi_visible_is_edge(const igi_scene *scene, const igi_tracer *tracer, const igi_hit *a,
                         const igi_hit *b, float pixel_rad)
{
    if (a->triangle == b->triangle && a->back == b->back) return false;
    if (a->triangle == IGI_NO_HIT || b->triangle == IGI_NO_HIT) return true;
    const igi_mesh *mesh = &scene->mesh;
    if (mesh->regions[a->triangle] != mesh->regions[b->triangle]) return true;
    igi_vec na = igi_tracer_normal(tracer, a->triangle);
    igi_vec nb = igi_tracer_normal(tracer, b->triangle);
    float side = a->back == b->back ? 1.0f : -1.0f;
    if (side * igi_dot(na, nb) < SMOOTH_COS) return true;
    igi_vec offset = igi_sub(igi_triangle_point(mesh, b->triangle, b->u, b->v),
                             igi_triangle_point(mesh, a->triangle, a->u, a->v));
    float pixel_m = pixel_rad * fminf(a->distance, b->distance);
    return fabsf(igi_dot(na, offset)) > DEPTH_JUMP_PX * pixel_m;
}

static void mark_pair(const igi_scene *scene, igi_visible *v, int i, int k)
{
    const igi_hit *a = &v->hits[i], *b = &v->hits[k];
    bool missed = a->triangle == IGI_NO_HIT || b->triangle == IGI_NO_HIT;
    uint8_t grade = 2;
    if (missed || scene->mesh.regions[a->triangle] != scene->mesh.regions[b->triangle]) grade = 3;
    if (v->near_edge[i] < grade) v->near_edge[i] = grade;
    if (v->near_edge[k] < grade) v->near_edge[k] = grade;
}

static void mark_beside_edges(const igi_scene *scene, const igi_tracer *tracer, igi_visible *v,
                              float pixel_rad)
{
    int w = v->width, h = v->height;
    for (int y = 0; y < h; y++)
        for (int x = 0; x < w; x++) {
            int i = y * w + x;
            const igi_hit *hit = &v->hits[i];
            if (x + 1 < w && igi_visible_is_edge(scene, tracer, hit, hit + 1, pixel_rad))
                mark_pair(scene, v, i, i + 1);
            if (y + 1 < h && igi_visible_is_edge(scene, tracer, hit, hit + w, pixel_rad))
                mark_pair(scene, v, i, i + w);
        }
}

static void mark_neighbours(igi_visible *v, int x, int y)
{
    for (int j = y - 1; j <= y + 1; j++)
        for (int i = x - 1; i <= x + 1; i++) {
            if (i < 0 || j < 0 || i >= v->width || j >= v->height) continue;
            uint8_t *mark = &v->near_edge[j * v->width + i];
            if (*mark == 0) *mark = 1;
        }
}

/* An edge may run through a border pixel without any ray of the picture having met its far side; a
 * lamp that only just shows is so bright that the pixel shows little else. */
static void mark_border(igi_visible *v)
{
    for (int y = 0; y < v->height; y++)
        for (int x = 0; x < v->width; x++) {
            bool inside = x > 0 && y > 0 && x + 1 < v->width && y + 1 < v->height;
            uint8_t *mark = &v->near_edge[y * v->width + x];
            if (!inside && *mark == 0) *mark = 1;
        }
}

igi_status igi_visible_create(igi_context *ctx, const igi_scene *scene, const igi_tracer *tracer,
                              const igi_camera *camera, igi_visible *visible)
{
    size_t pixels = (size_t)camera->width * (size_t)camera->height;
    *visible = (igi_visible){.width = camera->width, .height = camera->height};
    igi_status status = IGI_OK;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, pixels, &visible->hits));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, pixels, &visible->near_edge));
    trace_pixels(tracer, camera, visible->hits);
    igi_count_rays(ctx, pixels);
    mark_beside_edges(scene, tracer, visible, (float)(1 / camera->fl_x));
    for (int y = 0; y < visible->height; y++)
        for (int x = 0; x < visible->width; x++)
            if (visible->near_edge[y * visible->width + x] >= 2) mark_neighbours(visible, x, y);
    mark_border(visible);
cleanup:
    if (status != IGI_OK) igi_visible_clear(visible);
    return status;
}

void igi_visible_clear(igi_visible *visible)
{
    igi_free(visible->hits);
    igi_free(visible->near_edge);
    *visible = (igi_visible){0};
}
