/* SPDX-License-Identifier: Apache-2.0
 *
 * Maps of a result or of a truth.
 */
#include "material/read.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

/* The bands first, in the file's order, then A: all determined where the file has none. */
static igi_status arrange_map(const igi_material_reader *r, const char *path, const igi_image *file,
                              int extra, igi_image **map)
{
    int bands = r->materials->bands, order[IGI_MAX_BANDS + 1], found = 0, alpha = -1;
    for (int c = 0; c < file->channels; c++) {
        if (strcmp(file->names[c], "A") == 0) alpha = c;
        else if (found < IGI_MAX_BANDS) order[found++] = c;
    }
    if (found != bands)
        return igi_fail(r->ctx, IGI_E_DATA, "%s: has %d bands where %s has %d", path, found,
                        r->path, bands);
    if (extra) order[found] = alpha;
    IGI_TRY(igi_image_create(r->ctx, file->width, file->height, bands + extra, map));
    size_t pixels = (size_t)file->width * (size_t)file->height;
    for (int c = 0; c < bands + extra; c++) {
        float *to = (*map)->samples + c;
        size_t to_step = (size_t)(bands + extra), from_step = (size_t)file->channels;
        snprintf((*map)->names[c], IGI_CHANNEL_NAME_SIZE, "%s",
                 order[c] < 0 ? "A" : file->names[order[c]]);
        for (size_t i = 0; i < pixels; i++)
            to[i * to_step] = order[c] < 0 ? 1 : file->samples[i * from_step + (size_t)order[c]];
    }
    return IGI_OK;
}

igi_status igi_read_map(const igi_material_reader *r, const char *file, int extra, igi_image **map)
{
    igi_status status = IGI_OK;
    char *path = NULL;
    igi_image *image = NULL;
    IGI_TRY_GOTO(igi_strprintf(r->ctx, &path, "%s/%s", r->folder, file));
    IGI_TRY_GOTO(igi_image_load_exr(r->ctx, path, &image));
    IGI_TRY_GOTO(arrange_map(r, path, image, extra, map));
cleanup:
    igi_image_destroy(image);
    igi_free(path);
    return status;
}

igi_status igi_read_map_std(const igi_material_reader *r, const char *albedo_map, igi_material *m)
{
    static const char folder[] = "albedo/";
    if (strncmp(albedo_map, folder, sizeof folder - 1) != 0) return IGI_OK;
    char *file = NULL, *path = NULL;
    igi_status status = IGI_OK;
    IGI_TRY_GOTO(igi_strprintf(r->ctx, &file, "uncertainty/%s", albedo_map + sizeof folder - 1));
    IGI_TRY_GOTO(igi_strprintf(r->ctx, &path, "%s/%s", r->folder, file));
    if (access(path, F_OK) == 0) IGI_TRY_GOTO(igi_read_map(r, file, 0, &m->map_std));
cleanup:
    igi_free(file);
    igi_free(path);
    return status;
}

igi_status igi_read_plain_map(const igi_material_reader *r, igi_material *m)
{
    char *name = NULL, *file = NULL, *path = NULL;
    igi_status status = IGI_OK;
    IGI_TRY_GOTO(igi_region_file_name(r->ctx, m->region, &name));
    IGI_TRY_GOTO(igi_strprintf(r->ctx, &file, "albedo/%s.exr", name));
    IGI_TRY_GOTO(igi_strprintf(r->ctx, &path, "%s/%s", r->folder, file));
    if (access(path, F_OK) != 0) goto cleanup;
    IGI_TRY_GOTO(igi_read_map(r, file, 1, &m->map));
    IGI_TRY_GOTO(igi_read_map_std(r, file, m));
cleanup:
    igi_free(name);
    igi_free(file);
    igi_free(path);
    return status;
}
