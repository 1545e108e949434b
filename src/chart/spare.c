/* SPDX-License-Identifier: Apache-2.0
 *
 * Parsimony: what each further parameter of a result buys. A result is made simpler step by step,
 * its maps coarser, down to one albedo a region, and compared texel by texel each time.
 */
#include "chart/speed.h"

#include <math.h>
#include <string.h>

#define DETERMINED 0.5f /* a map's A, to count as a parameter: as in report/validate.c */

static bool has_map(const igi_material *m)
{
    return !m->emitter && m->textured && m->map;
}

/* All but the texels of maps: an albedo where there is no map, and the lobes. */
static size_t plain_parameters(const igi_materials *materials)
{
    size_t parameters = 0, bands = (size_t)materials->bands;
    for (size_t i = 0; i < materials->count; i++) {
        const igi_material *m = &materials->materials[i];
        if (m->emitter) continue;
        if (!has_map(m)) parameters += bands;
        if (m->model != IGI_LAMBERT) parameters += (m->specular_is_rgb ? bands : 1) + 1;
    }
    return parameters;
}

size_t chart_parameters(const igi_materials *materials)
{
    size_t texels = 0, bands = (size_t)materials->bands;
    for (size_t i = 0; i < materials->count; i++) {
        const igi_image *map = materials->materials[i].map;
        if (!has_map(&materials->materials[i])) continue;
        for (size_t t = 0; t < (size_t)map->width * (size_t)map->height; t++)
            texels += map->samples[t * (bands + 1) + bands] > DETERMINED;
    }
    return plain_parameters(materials) + bands * texels;
}

/* The map in `size` cells along a side: each the mean over its texels that photographs determine.
 * The number of texels, and which of them are judged, stay. *used: cells that have such texels. */
static igi_status coarsen(igi_context *ctx, igi_image *map, int size, size_t *used)
{
    size_t bands = (size_t)map->channels - 1, step = bands + 1;
    size_t width = (size_t)map->width, texels = width * (size_t)map->height;
    size_t columns = size < map->width ? (size_t)size : width;
    size_t rows = size < map->height ? (size_t)size : (size_t)map->height;
    double *sums = NULL; /* [rows][columns][bands + 1], the last is the count */
    IGI_TRY(IGI_ALLOC(ctx, rows * columns * step, &sums));
    for (int pass = 0; pass < 2; pass++)
        for (size_t t = 0; t < texels; t++) {
            size_t column = t % width * columns / width;
            double *sum = sums + (t / width * rows / (size_t)map->height * columns + column) * step;
            float *texel = map->samples + t * step;
            if (!(texel[bands] > DETERMINED)) continue;
            for (size_t b = 0; b < bands; b++)
                if (pass == 0) sum[b] += (double)texel[b];
                else texel[b] = (float)(sum[b] / sum[bands]);
            if (pass == 0) *used += sum[bands]++ == 0;
        }
    igi_free(sums);
    return IGI_OK;
}

static igi_status coarsen_all(igi_context *ctx, igi_materials *materials, int size, size_t *used)
{
    *used = 0;
    for (size_t i = 0; i < materials->count; i++)
        if (has_map(&materials->materials[i]))
            IGI_TRY(coarsen(ctx, materials->materials[i].map, size, used));
    return IGI_OK;
}

static int largest_map(const igi_materials *materials)
{
    int largest = 0;
    for (size_t i = 0; i < materials->count; i++) {
        const igi_material *m = &materials->materials[i];
        if (!has_map(m)) continue;
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
    for (size_t i = 0; i < materials->count; i++)
        row.lobes += materials->materials[i].model != IGI_LAMBERT;
    void *grown = igi_grow(ctx, rows->rows, &rows->capacity, rows->count + 1, sizeof *rows->rows);
    if (!grown) return IGI_E_SYSTEM;
    rows->rows = grown;
    rows->rows[rows->count++] = row;
    return IGI_OK;
}

/* The simpler forms of a result. Its maps get smaller. */
static igi_status add_forms(igi_context *ctx, const char *scene, const char *model,
                            igi_materials *materials, const igi_materials *truth, spare_rows *rows)
{
    int largest = largest_map(materials), size = largest;
    do {
        size_t cells;
        IGI_TRY(coarsen_all(ctx, materials, size, &cells));
        spare_row row = {.scene = scene,
                         .model = model,
                         .map_size = size > 1 ? size : 0,
                         .chosen = size == largest && strcmp(model, "auto") == 0,
                         .parameters = plain_parameters(materials) +
                                       (size_t)materials->bands * cells};
        IGI_TRY(add_row(ctx, row, materials, truth, rows));
        size /= 2;
    } while (size >= 1);
    return IGI_OK;
}

/* As if scene.json said of every region that it has a texture. */
static void ask_for_maps(igi_scene *scene, igi_tristate *before)
{
    for (size_t r = 0; r < scene->region_count; r++) {
        before[r] = scene->regions[r].textured;
        scene->regions[r].textured = IGI_YES;
    }
}

static igi_status add_result(igi_context *ctx, const speed_subject *s, const char *name, int model,
                             spare_rows *rows)
{
    chart_case c;
    igi_recover_options options;
    igi_recover_options_init(&options);
    options.model = model;
    IGI_TRY(chart_case_run(ctx, s->scene, s->truth, &options, igi_seed(ctx), &c));
    igi_status status = IGI_OK;
    if (c.materials) status = add_forms(ctx, s->scene->name, name, c.materials, s->truth, rows);
    chart_case_clear(&c);
    return status;
}

igi_status chart_spare_scene(igi_context *ctx, const speed_subject *s, spare_rows *rows)
{
    igi_tristate *before;
    IGI_TRY(add_result(ctx, s, "lambert", IGI_LAMBERT, rows));
    IGI_TRY(add_result(ctx, s, "auto", IGI_ANY_MODEL, rows));
    IGI_TRY(IGI_ALLOC(ctx, s->scene->region_count, &before));
    ask_for_maps(s->scene, before);
    igi_status status = add_result(ctx, s, "maps", IGI_ANY_MODEL, rows);
    for (size_t r = 0; r < s->scene->region_count; r++) s->scene->regions[r].textured = before[r];
    igi_free(before);
    return status;
}

igi_status igi_chart_parsimony(igi_context *ctx, const igi_chart_options *options,
                               const char *folder)
{
    igi_status status = IGI_OK;
    spare_rows rows = {.count = 0};
    speed_subjects subjects = {.count = 0};
    igi_stage_begin(ctx, "rooms");
    IGI_TRY_GOTO(speed_subjects_make(ctx, options, folder, &subjects));
    igi_stage_begin(ctx, "parsimony");
    for (size_t i = 0; i < subjects.count; i++) {
        IGI_TRY_GOTO(chart_spare_scene(ctx, &subjects.all[i], &rows));
        IGI_TRY_GOTO(igi_progress(ctx, (double)(i + 1) / (double)subjects.count));
    }
    IGI_TRY_GOTO(chart_spare_save(ctx, &rows, folder));
cleanup:
    igi_stage_begin(ctx, NULL);
    speed_subjects_clear(&subjects);
    igi_free(rows.rows);
    return status;
}
