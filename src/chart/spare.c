/* SPDX-License-Identifier: Apache-2.0
 *
 * Parsimony: what each further parameter of a result buys. A result is made simpler step by step,
 * its maps coarser down to one albedo a region, and compared texel by texel each time.
 */
#include "chart/speed.h"

#include "report/resample.h"

#include <math.h>
#include <string.h>

#define DETERMINED 0.5f /* a map's A, to count as a parameter: as in report/validate.c */

size_t chart_parameters(const igi_materials *materials)
{
    size_t parameters = 0, bands = (size_t)materials->bands;
    for (size_t i = 0; i < materials->count; i++) {
        const igi_material *m = &materials->materials[i];
        size_t texels = 0;
        if (m->emitter) continue;
        if (m->textured && m->map) {
            size_t all = (size_t)m->map->width * (size_t)m->map->height;
            for (size_t t = 0; t < all; t++)
                texels += m->map->samples[t * (bands + 1) + bands] > DETERMINED;
        }
        parameters += bands * (texels ? texels : 1);
        if (m->model != IGI_LAMBERT) parameters += (m->specular_is_rgb ? bands : 1) + 1;
    }
    return parameters;
}

static igi_status shrink_maps(igi_context *ctx, igi_materials *materials, int size)
{
    for (size_t i = 0; i < materials->count; i++) {
        igi_material *m = &materials->materials[i];
        igi_image *smaller;
        if (!m->map || !m->textured) continue;
        int width = m->map->width < size ? m->map->width : size;
        int height = m->map->height < size ? m->map->height : size;
        if (width == m->map->width && height == m->map->height) continue;
        IGI_TRY(igi_image_resample(ctx, m->map, width, height, &smaller));
        igi_image_destroy(m->map);
        m->map = smaller;
    }
    return IGI_OK;
}

static int largest_map(const igi_materials *materials)
{
    int largest = 0;
    for (size_t i = 0; i < materials->count; i++) {
        const igi_material *m = &materials->materials[i];
        if (!m->map || !m->textured || m->emitter) continue;
        if (m->map->width > largest) largest = m->map->width;
        if (m->map->height > largest) largest = m->map->height;
    }
    return largest;
}

static igi_status add_row(igi_context *ctx, spare_row row, const igi_materials *materials,
                          const igi_materials *truth, spare_rows *rows)
{
    igi_validation *v = NULL;
    double sum = 0;
    size_t count = 0;
    IGI_TRY(igi_validate_materials(ctx, materials, truth, &v));
    for (size_t i = 0; i < v->region_count; i++) {
        const igi_region_error *e = &v->regions[i];
        if (!e->judged) continue;
        sum += isnan(e->texture_mean) ? e->albedo : e->texture_mean;
        count++;
    }
    row.error = count ? sum / (double)count : (double)NAN;
    row.specular = v->specular_mean;
    igi_validation_destroy(v);
    row.parameters = chart_parameters(materials);
    for (size_t i = 0; i < materials->count; i++)
        row.lobes += materials->materials[i].model != IGI_LAMBERT;
    void *grown = igi_grow(ctx, rows->rows, &rows->capacity, rows->count + 1, sizeof *rows->rows);
    if (!grown) return IGI_E_SYSTEM;
    rows->rows = grown;
    rows->rows[rows->count++] = row;
    return IGI_OK;
}

igi_status chart_spare(igi_context *ctx, const char *scene, const char *model,
                       igi_materials *materials, const igi_materials *truth, spare_rows *rows)
{
    int size = largest_map(materials);
    bool first = true;
    do {
        spare_row row = {.scene = scene,
                         .model = model,
                         .map_size = size > 1 ? size : 0,
                         .chosen = first && strcmp(model, "auto") == 0};
        IGI_TRY(shrink_maps(ctx, materials, size > 0 ? size : 1));
        IGI_TRY(add_row(ctx, row, materials, truth, rows));
        first = false;
        if (size <= 1) break;
        size /= 2;
    } while (size >= 1);
    return IGI_OK;
}
