/* SPDX-License-Identifier: Apache-2.0
 *
 * Reading materials.json, or truth.json, which has the same regions.
 *
 * truth.json differs in this: a map is called "texture"; "roughness" stands for alpha in older
 * files, where it equals alpha (glTF's roughness is sqrt(alpha), and never in these files unless
 * "alpha" stands beside it); emitters carry their radiance; the scene has no name.
 */
#include "material/read.h"

#include "scene/light_profile.h"

#include <stdio.h>
#include <string.h>
#include <unistd.h>

static igi_status read_sentences(const igi_material_reader *r, const json_t *array, char ***texts,
                                 size_t *count)
{
    size_t n = json_array_size(array); /* 0 when it is none */
    if (n == 0) return IGI_OK;
    IGI_TRY(IGI_ALLOC(r->ctx, n, texts));
    *count = n;
    for (size_t i = 0; i < n; i++) {
        const char *text = json_string_value(json_array_get(array, i));
        IGI_TRY(igi_strdup(r->ctx, text ? text : "", &(*texts)[i]));
    }
    return IGI_OK;
}

static igi_status read_region(const igi_material_reader *r, const char *name, const json_t *o,
                              igi_material *m)
{
    IGI_TRY(igi_strdup(r->ctx, name, &m->region));
    if (!json_is_object(o)) return igi_read_wrong(r, name, name, "an object");
    int bands = r->materials->bands;
    bool present = false;
    m->emitter = json_is_true(json_object_get(o, "emitter"));
    IGI_TRY(igi_read_numbers(r, name, o, "albedo", bands, m->albedo, &present));
    if (!present) return igi_read_wrong(r, name, "albedo", "an array with a number for each band");
    for (int b = 0; b < bands; b++)
        if (m->albedo[b] < 0) return igi_read_wrong(r, name, "albedo", "numbers from 0 on");
    IGI_TRY(igi_read_numbers(r, name, o, "albedo_std", bands, m->albedo_std, NULL));
    IGI_TRY(igi_read_lobe(r, o, m));
    m->observed = 1; /* a truth is known everywhere, seen or not; its "seen1" is how much is seen */
    IGI_TRY(igi_read_number(r, name, o, "seen1", &m->observed));
    IGI_TRY(igi_read_number(r, name, o, "observed", &m->observed));
    m->determined = m->observed > 0 && !m->emitter;
    m->views = (int)json_integer_value(json_object_get(o, "views"));
    IGI_TRY(read_sentences(r, json_object_get(o, "warnings"), &m->warnings, &m->warning_count));
    const char *map = json_string_value(json_object_get(o, "albedo_map"));
    if (!map) map = json_string_value(json_object_get(o, "texture"));
    if (!map) return igi_read_plain_map(r, m);
    m->textured = true;
    IGI_TRY(igi_read_map(r, map, 1, &m->map));
    return igi_read_map_std(r, map, m);
}

static igi_status read_light(const igi_material_reader *r, const json_t *o, igi_light *l,
                             double *std)
{
    const char *type = json_string_value(json_object_get(o, "type"));
    l->sky.given = type && strcmp(type, "sky") == 0;
    if (!type || !igi_light_type_from_name(l->sky.given ? "env" : type, &l->type))
        return igi_read_wrong(r, "lights", "type", "a kind of light");
    l->region = igi_material_named(r->materials, json_string_value(json_object_get(o, "region")));
    IGI_TRY(igi_read_numbers(r, type, o, "position", 3, l->position, NULL));
    IGI_TRY(igi_read_numbers(r, type, o, "from", 3, l->position, NULL));
    IGI_TRY(igi_read_numbers(r, type, o, "to", 3, l->end, NULL));
    IGI_TRY(igi_read_numbers(r, type, o, "position_std", 3, l->position_std, NULL));
    IGI_TRY(igi_read_numbers(r, type, o, "direction", 3, l->direction, NULL));
    IGI_TRY(igi_read_number(r, type, o, "cutoff_deg", &l->cutoff_deg));
    IGI_TRY(igi_read_number(r, type, o, "beam_deg", &l->beam_deg));
    IGI_TRY(igi_read_number(r, type, o, "rotation_deg", &l->rotation_deg));
    IGI_TRY(igi_read_number(r, type, o, "sun_elevation_deg", &l->sky.sun_elevation_deg));
    IGI_TRY(igi_read_number(r, type, o, "sun_azimuth_deg", &l->sky.sun_azimuth_deg));
    IGI_TRY(igi_read_number(r, type, o, "turbidity", &l->sky.turbidity));
    IGI_TRY(igi_read_number(r, type, o, "cloudiness", &l->sky.cloudiness));
    const char *file = json_string_value(json_object_get(o, "profile"));
    if (!file) IGI_TRY(igi_read_number(r, type, o, "profile", &l->profile));
    if (!(l->profile >= 0 && l->profile <= IGI_MOST_PROFILE))
        return igi_read_wrong(r, type, "profile", "an exponent from 0 to 100");
    if (!file) file = json_string_value(json_object_get(o, "image"));
    if (file) IGI_TRY(igi_strdup(r->ctx, file, &l->file));
    const char *key = igi_light_value_key(l->type);
    char std_key[32];
    snprintf(std_key, sizeof std_key, "%s_std", key);
    IGI_TRY(igi_read_numbers(r, type, o, key, r->materials->bands, l->value, &l->known));
    return igi_read_numbers(r, type, o, std_key, r->materials->bands, std, NULL);
}

static igi_status count_bands(const igi_material_reader *r, json_t *regions)
{
    const char *name;
    json_t *region;
    json_object_foreach (regions, name, region) {
        size_t n = json_array_size(json_object_get(region, "albedo"));
        if (n < 1 || n > IGI_MAX_BANDS)
            return igi_read_wrong(r, name, "albedo",
                                  "an array with a number for each of 1 to 16 bands");
        r->materials->bands = (int)n;
        return IGI_OK;
    }
    return igi_read_wrong(r, "regions", "regions", "an object with a region at least");
}

static igi_status read_root(const igi_material_reader *r, json_t *root)
{
    igi_materials *m = r->materials;
    json_t *regions = json_object_get(root, "regions"), *lights = json_object_get(root, "lights");
    const char *scene = json_string_value(json_object_get(root, "scene"));
    IGI_TRY(igi_strdup(r->ctx, scene ? scene : "", &m->scene));
    IGI_TRY(count_bands(r, regions));
    IGI_TRY(IGI_ALLOC(r->ctx, json_object_size(regions), &m->materials));
    const char *name;
    json_t *region;
    json_object_foreach (regions, name, region)
        IGI_TRY(read_region(r, name, region, &m->materials[m->count++]));
    size_t count = json_array_size(lights);
    IGI_TRY(IGI_ALLOC(r->ctx, count, &m->lights));
    IGI_TRY(IGI_ALLOC(r->ctx, count, &m->light_std));
    for (; m->light_count < count; m->light_count++)
        IGI_TRY(read_light(r, json_array_get(lights, m->light_count), &m->lights[m->light_count],
                           m->light_std[m->light_count]));
    return read_sentences(r, json_object_get(root, "warnings"), &m->warnings, &m->warning_count);
}

static igi_status find_file(igi_context *ctx, const char *folder, char **path)
{
    static const char *const names[] = {"materials.json", "truth.json"};
    for (size_t i = 0; i < 2; i++) {
        IGI_TRY(igi_strprintf(ctx, path, "%s/%s", folder, names[i]));
        if (access(*path, F_OK) == 0) return IGI_OK;
        igi_free(*path);
        *path = NULL;
    }
    return igi_fail(ctx, IGI_E_DATA,
                    "%s: has neither materials.json nor truth.json; give the folder that igi "
                    "recover wrote, or a scene's truth folder",
                    folder);
}

igi_status igi_materials_load(igi_context *ctx, const char *folder, igi_materials **materials)
{
    igi_status status = IGI_OK;
    char *path = NULL;
    json_t *root = NULL;
    json_error_t error;
    *materials = NULL;
    IGI_TRY_GOTO(find_file(ctx, folder, &path));
    root = json_load_file(path, JSON_REJECT_DUPLICATES, &error);
    if (!root) IGI_TRY_GOTO(igi_fail(ctx, IGI_E_DATA, "%s:%d: %s", path, error.line, error.text));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, materials));
    igi_material_reader r = {.ctx = ctx, .path = path, .folder = folder, .materials = *materials};
    IGI_TRY_GOTO(read_root(&r, root));
cleanup:
    if (status != IGI_OK) {
        igi_materials_destroy(*materials);
        *materials = NULL;
    }
    json_decref(root);
    igi_free(path);
    return status;
}
