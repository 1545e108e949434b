/* SPDX-License-Identifier: Apache-2.0
 *
 * Photographs for the page, and marks on them.
 */
#include "check/sketch.h"

#include "observe/glare.h"
#include "observe/visible.h"

#include <string.h>

#define GRID 3 /* pixels between places that are asked for a highlight */

igi_status igi_snapshot_take(const igi_sketch *s, size_t frame, int side, igi_snapshot *snap)
{
    igi_status status = IGI_OK;
    igi_context *ctx = s->c->ctx;
    *snap = (igi_snapshot){.frame = frame};
    IGI_TRY_GOTO(
        igi_image_reduce(ctx, s->c->survey->observations->previews[frame], side, &snap->image));
    igi_image *image = snap->image;
    igi_glare_lift_image(s->c->survey->observations, frame, image);
    igi_view_of_camera(s->c->survey, &s->c->scene->frames[frame].camera, image->width, &snap->view);
    snap->view.height = image->height;
    IGI_TRY_GOTO(igi_view_look(ctx, &snap->view));
    size_t count = (size_t)image->width * (size_t)image->height;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 3 * count, &snap->pixels));
    float scale = (float)s->c->faults->frames[frame].scale;
    for (size_t i = 0; i < count; i++) {
        float *from = image->samples + i * (size_t)image->channels;
        for (int b = 0; b < s->c->scene->bands; b++) from[b] *= scale;
        for (int c = 0; c < 3; c++)
            snap->pixels[3 * i + (size_t)c] = igi_srgb_byte(
                &s->page->srgb, s->exposure * from[igi_band_of(c, s->c->scene->bands)]);
    }
cleanup:
    if (status != IGI_OK) igi_snapshot_clear(snap);
    return status;
}

void igi_snapshot_clear(igi_snapshot *snap)
{
    igi_image_destroy(snap->image);
    igi_free(snap->pixels);
    igi_view_clear(&snap->view);
    *snap = (igi_snapshot){0};
}

igi_status igi_snapshot_print(const igi_sketch *s, const igi_snapshot *snap, const char *label)
{
    return igi_page_pixels(s->page, snap->pixels, snap->image->width, snap->image->height, 3,
                           label);
}

static void ink(uint8_t *pixel, const uint8_t colour[3], float share)
{
    for (int c = 0; c < 3; c++)
        pixel[c] = (uint8_t)((1 - share) * (float)pixel[c] + share * (float)colour[c] + .5f);
}

void igi_snapshot_mark_edges(igi_snapshot *snap)
{
    size_t count = (size_t)snap->view.width * (size_t)snap->view.height;
    for (size_t i = 0; i < count; i++)
        if (snap->view.lines[i]) ink(snap->pixels + 3 * i, igi_mirrors, 0.85f);
}

static bool shows_lamp(const igi_view *v, int x, int y)
{
    if (x < 0 || y < 0 || x >= v->width || y >= v->height) return false;
    const igi_hit *hit = igi_view_hit(v, x, y);
    const igi_scene *scene = v->survey->scene;
    return hit->triangle != IGI_NO_HIT &&
           scene->regions[scene->mesh.regions[hit->triangle]].emitter;
}

/* A ring around each. */
void igi_snapshot_mark_lamps(igi_snapshot *snap)
{
    static const uint8_t ring[3] = {255, 120, 0};
    const igi_view *v = &snap->view;
    for (int y = 0; y < v->height; y++)
        for (int x = 0; x < v->width; x++) {
            bool near = false;
            for (int k = 0; k < 25; k++) near |= shows_lamp(v, x + k % 5 - 2, y + k / 5 - 2);
            if (near && !shows_lamp(v, x, y))
                ink(snap->pixels + 3 * ((size_t)y * (size_t)v->width + (size_t)x), ring, 0.9f);
        }
}

/* Surfaces as bright as the brightest that recovery takes, in a photograph that is saturated. */
void igi_snapshot_mark_saturated(const igi_sketch *s, igi_snapshot *snap)
{
    const igi_observations *o = s->c->survey->observations;
    const igi_scene *scene = s->c->scene;
    float tops[IGI_MAX_BANDS] = {0};
    size_t bands = (size_t)o->bands, begin = o->frame_begin[snap->frame],
           end = o->frame_begin[snap->frame + 1];
    if (!(s->c->check->photos[snap->frame].saturated > 0) || begin == end) return;
    for (size_t i = begin; i < end; i++)
        if (!scene->regions[scene->mesh.regions[igi_surface_triangle(o->surface[i])]].emitter)
            for (size_t b = 0; b < bands; b++) tops[b] = fmaxf(tops[b], o->radiance[i * bands + b]);
    for (int y = 0; y < snap->view.height; y++)
        for (int x = 0; x < snap->view.width; x++) {
            size_t at = (size_t)y * (size_t)snap->view.width + (size_t)x;
            const float *pixel = snap->image->samples + at * (size_t)snap->image->channels;
            bool full = false;
            for (size_t b = 0; b < bands; b++) full |= pixel[b] >= tops[b];
            if (full && !shows_lamp(&snap->view, x, y))
                ink(snap->pixels + 3 * at, igi_never_seen, 1);
        }
}

static bool mirrors(const igi_view *v, int region, int x, int y)
{
    const igi_survey *s = v->survey;
    if (x >= v->width) x = v->width - 1;
    if (y >= v->height) y = v->height - 1;
    const igi_hit *hit = igi_view_hit(v, x, y);
    if (hit->triangle == IGI_NO_HIT) return false;
    int here = (int)s->scene->mesh.regions[hit->triangle];
    if (s->scene->regions[here].emitter || (region >= 0 && here != region)) return false;
    igi_vec point = igi_triangle_point(&s->scene->mesh, hit->triangle, hit->u, hit->v);
    igi_vec normal = igi_tracer_normal(s->tracer, hit->triangle);
    if (hit->back) normal = igi_scale(normal, -1);
    return igi_survey_mirrors_lamp(s, igi_view_eye(v), point, normal);
}

/* How much of a pixel's neighbourhood mirrors, between the places of the grid. */
static float between(const bool *grid, int columns, int x, int y)
{
    float fx = (float)(x % GRID) / GRID, fy = (float)(y % GRID) / GRID;
    const bool *at = grid + y / GRID * columns + x / GRID;
    return (1 - fy) * ((1 - fx) * at[0] + fx * at[1]) +
           fy * ((1 - fx) * at[columns] + fx * at[columns + 1]);
}

igi_status igi_mark_highlights(const igi_sketch *s, const igi_view *v, int region, uint8_t *pixels,
                               int channels, double *share)
{
    int columns = v->width / GRID + 2, rows = v->height / GRID + 2;
    bool *grid;
    size_t found = 0;
    IGI_TRY(IGI_ALLOC(s->c->ctx, (size_t)columns * (size_t)rows, &grid));
    for (int j = 0; j < rows; j++)
        for (int i = 0; i < columns; i++) {
            grid[j * columns + i] = mirrors(v, region, i * GRID, j * GRID);
            found += grid[j * columns + i];
        }
    igi_count_rays(s->c->ctx, (uint64_t)(columns * rows));
    for (int y = 0; y < v->height; y++)
        for (int x = 0; x < v->width; x++) {
            float here = between(grid, columns, x, y), far = fabsf(here - 0.5f);
            size_t at = ((size_t)y * (size_t)v->width + (size_t)x) * (size_t)channels;
            if (here > 0 && here < 1 && far < 0.3f) ink(pixels + at, igi_mirrors, 0.9f);
            else if (here >= 0.5f) ink(pixels + at, igi_mirrors, 0.25f);
        }
    *share = (double)found / (columns * rows);
    igi_free(grid);
    return IGI_OK;
}
