/* SPDX-License-Identifier: Apache-2.0 */
#include "maps/maps.h"

#include "scene/atlas.h"

#include <string.h>

igi_status igi_layout_create(igi_context *ctx, const igi_scene *scene, igi_layout **layout)
{
    igi_layout *l = NULL;
    igi_status status = IGI_OK;
    *layout = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &l));
    l->scene = scene;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 6 * scene->mesh.triangle_count, &l->uvs));
    if (scene->mesh.uvs)
        memcpy(l->uvs, scene->mesh.uvs, 6 * scene->mesh.triangle_count * sizeof(float));
    for (uint32_t r = 0; r < scene->region_count; r++)
        if (!(scene->regions[r].has_uvs && scene->mesh.uvs) && !scene->regions[r].emitter)
            IGI_TRY_GOTO(igi_atlas_fill(ctx, &scene->mesh, r, l->uvs));
    *layout = l;
    l = NULL;
cleanup:
    igi_layout_destroy(l);
    return status;
}

void igi_layout_destroy(igi_layout *layout)
{
    if (!layout) return;
    igi_free(layout->uvs);
    igi_free(layout);
}

void igi_layout_place(const igi_layout *layout, uint32_t triangle, float u, float v, int size,
                      float *x, float *y)
{
    const float *t = layout->uvs + 6 * (size_t)triangle;
    const igi_region *region = &layout->scene->regions[layout->scene->mesh.regions[triangle]];
    float at[2], below = (float)size * (1 - 1e-6f);
    for (int k = 0; k < 2; k++) {
        at[k] = (1 - u - v) * t[k] + u * t[2 + k] + v * t[4 + k];
        if (region->has_uvs && region->uvs_wrap) at[k] -= floorf(at[k]);
    }
    *x = fminf(fmaxf(at[0] * (float)size, 0), below);
    *y = fminf(fmaxf((1 - at[1]) * (float)size, 0), below);
}

void igi_map_at(const igi_image *map, int bands, bool wraps, float x, float y, float *albedo)
{
    int i = (int)floorf(x - 0.5f), j = (int)floorf(y - 0.5f);
    float fx = x - 0.5f - (float)i, fy = y - 0.5f - (float)j;
    for (int b = 0; b < bands; b++) albedo[b] = 0;
    for (int k = 0; k < 4; k++) {
        int column = i + k % 2, line = j + k / 2;
        if (wraps) {
            column = (column + map->width) % map->width;
            line = (line + map->height) % map->height;
        }
        column = column < 0 ? 0 : column >= map->width ? map->width - 1 : column;
        line = line < 0 ? 0 : line >= map->height ? map->height - 1 : line;
        const float *texel = map->samples +
                             (size_t)(line * map->width + column) * (size_t)map->channels;
        float w = (k % 2 ? fx : 1 - fx) * (k / 2 ? fy : 1 - fy);
        for (int b = 0; b < bands; b++) albedo[b] += w * texel[b];
    }
}
