/* SPDX-License-Identifier: Apache-2.0
 *
 * Reading materials.json, or truth.json, which has the same regions.
 *
 * truth.json differs in this: a map is called "texture"; "roughness" stands for alpha in older
 * files, where it equals alpha (glTF's roughness is sqrt(alpha), and never in these files unless
 * "alpha" stands beside it); emitters carry their radiance; the scene has no name.
 */
#include "material/material.h"

#include "base/spectrum.h"
#include "material/result.h"
#include "scene/file_text.h"

#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <unistd.h>

typedef struct reader {
    igi_context *ctx;
    const char *path;   /* of the file, for sentences */
    const char *folder; /* of the maps */
    igi_materials *materials;
} reader;

static igi_status wrong(const reader *r, const char *owner, const char *key, const char *expected)
{
    return igi_fail(r->ctx, IGI_E_DATA, "%s: '%s': \"%s\" must be %s", r->path, owner, key,
                    expected);
}

/* Absent leaves *x; null is "not known": infinity. */
static igi_status read_number(const reader *r, const char *owner, const json_t *o, const char *key,
                              double *x)
{
    const json_t *v = json_object_get(o, key);
    if (!v) return IGI_OK;
    if (json_is_null(v)) *x = HUGE_VAL;
    else if (json_is_number(v)) *x = json_number_value(v);
    else return wrong(r, owner, key, "a number or null");
    return IGI_OK;
}

/* `count` numbers, or one for all. Absent or null leaves x and *present is false. */
static igi_status read_numbers(const reader *r, const char *owner, const json_t *o, const char *key,
                               int count, double *x, bool *present)
{
    const json_t *v = json_object_get(o, key);
    if (present) *present = v && !json_is_null(v);
    if (!v || json_is_null(v)) return IGI_OK;
    char expected[64];
    snprintf(expected, sizeof expected, "an array of %d numbers", count);
    if (json_is_number(v)) {
        for (int i = 0; i < count; i++) x[i] = json_number_value(v);
        return IGI_OK;
    }
    if (!json_is_array(v) || json_array_size(v) != (size_t)count)
        return wrong(r, owner, key, expected);
    for (int i = 0; i < count; i++) {
        const json_t *e = json_array_get(v, (size_t)i);
        if (!json_is_number(e) && !json_is_null(e)) return wrong(r, owner, key, expected);
        x[i] = json_is_null(e) ? HUGE_VAL : json_number_value(e);
    }
    return IGI_OK;
}

static igi_status read_sentences(const reader *r, const json_t *array, char ***texts, size_t *count)
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

/* The bands first, in the file's order, then A: all determined where the file has none. */
static igi_status arrange_map(const reader *r, const char *path, const igi_image *file, int extra,
                              igi_image **map)
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

static igi_status read_map(const reader *r, const char *file, int extra, igi_image **map)
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

/* uncertainty/NAME.exr lies beside albedo/NAME.exr; a truth has none. */
static igi_status read_map_std(const reader *r, const char *albedo_map, igi_material *m)
{
    static const char folder[] = "albedo/";
    if (strncmp(albedo_map, folder, sizeof folder - 1) != 0) return IGI_OK;
    char *file = NULL, *path = NULL;
    igi_status status = IGI_OK;
    IGI_TRY_GOTO(igi_strprintf(r->ctx, &file, "uncertainty/%s", albedo_map + sizeof folder - 1));
    IGI_TRY_GOTO(igi_strprintf(r->ctx, &path, "%s/%s", r->folder, file));
    if (access(path, F_OK) == 0) IGI_TRY_GOTO(read_map(r, file, 0, &m->map_std));
cleanup:
    igi_free(file);
    igi_free(path);
    return status;
}

/* A region without texture has a map too, to be looked at; materials.json does not name it. */
static igi_status read_plain_map(const reader *r, igi_material *m)
{
    char *name = NULL, *file = NULL, *path = NULL;
    igi_status status = IGI_OK;
    IGI_TRY_GOTO(igi_region_file_name(r->ctx, m->region, &name));
    IGI_TRY_GOTO(igi_strprintf(r->ctx, &file, "albedo/%s.exr", name));
    IGI_TRY_GOTO(igi_strprintf(r->ctx, &path, "%s/%s", r->folder, file));
    if (access(path, F_OK) != 0) goto cleanup;
    IGI_TRY_GOTO(read_map(r, file, 1, &m->map));
    IGI_TRY_GOTO(read_map_std(r, file, m));
cleanup:
    igi_free(name);
    igi_free(file);
    igi_free(path);
    return status;
}

static igi_status read_lobe(const reader *r, const json_t *o, igi_material *m)
{
    const char *model = json_string_value(json_object_get(o, "model"));
    if (model && !igi_model_from_name(model, &m->model))
        return wrong(r, m->region, "model", "lambert, ward, ggx or phong");
    if (m->model == IGI_LAMBERT) return IGI_OK;
    IGI_TRY(read_number(r, m->region, o, "specular", &m->specular));
    IGI_TRY(read_number(r, m->region, o, "specular_std", &m->specular_std));
    IGI_TRY(read_numbers(r, m->region, o, "specular_rgb", r->materials->bands, m->specular_rgb,
                         &m->specular_is_rgb));
    const char *key = json_is_number(json_object_get(o, "alpha")) ? "alpha" : "roughness";
    IGI_TRY(read_number(r, m->region, o, key, &m->alpha));
    if (!(m->alpha > 0 && m->alpha <= 1))
        return wrong(r, m->region, "alpha", "above 0 and at most 1");
    return read_number(r, m->region, o, "alpha_std", &m->alpha_std);
}

static igi_status read_region(const reader *r, const char *name, const json_t *o, igi_material *m)
{
    IGI_TRY(igi_strdup(r->ctx, name, &m->region));
    if (!json_is_object(o)) return wrong(r, name, name, "an object");
    int bands = r->materials->bands;
    bool present = false;
    m->emitter = json_is_true(json_object_get(o, "emitter"));
    IGI_TRY(read_numbers(r, name, o, "albedo", bands, m->albedo, &present));
    if (!present) return wrong(r, name, "albedo", "an array with a number for each band");
    IGI_TRY(read_numbers(r, name, o, "albedo_std", bands, m->albedo_std, NULL));
    IGI_TRY(read_lobe(r, o, m));
    m->observed = 1; /* a truth is known everywhere, seen or not; its "seen1" is how much is seen */
    IGI_TRY(read_number(r, name, o, "seen1", &m->observed));
    IGI_TRY(read_number(r, name, o, "observed", &m->observed));
    m->determined = m->observed > 0 && !m->emitter;
    m->views = (int)json_integer_value(json_object_get(o, "views"));
    IGI_TRY(read_sentences(r, json_object_get(o, "warnings"), &m->warnings, &m->warning_count));
    const char *map = json_string_value(json_object_get(o, "albedo_map"));
    if (!map) map = json_string_value(json_object_get(o, "texture"));
    if (!map) return read_plain_map(r, m);
    m->textured = true;
    IGI_TRY(read_map(r, map, 1, &m->map));
    return read_map_std(r, map, m);
}

static int material_named(const igi_materials *materials, const char *name)
{
    for (size_t i = 0; name && i < materials->count; i++)
        if (strcmp(materials->materials[i].region, name) == 0) return (int)i;
    return -1;
}

static igi_status read_light(const reader *r, const json_t *o, igi_light *l, double *std)
{
    const char *type = json_string_value(json_object_get(o, "type"));
    l->sky.given = type && strcmp(type, "sky") == 0;
    if (!type || !igi_light_type_from_name(l->sky.given ? "env" : type, &l->type))
        return wrong(r, "lights", "type", "a kind of light");
    l->region = material_named(r->materials, json_string_value(json_object_get(o, "region")));
    IGI_TRY(read_numbers(r, type, o, "position", 3, l->position, NULL));
    IGI_TRY(read_numbers(r, type, o, "from", 3, l->position, NULL));
    IGI_TRY(read_numbers(r, type, o, "to", 3, l->end, NULL));
    IGI_TRY(read_numbers(r, type, o, "direction", 3, l->direction, NULL));
    IGI_TRY(read_number(r, type, o, "cutoff_deg", &l->cutoff_deg));
    IGI_TRY(read_number(r, type, o, "beam_deg", &l->beam_deg));
    IGI_TRY(read_number(r, type, o, "rotation_deg", &l->rotation_deg));
    IGI_TRY(read_number(r, type, o, "sun_elevation_deg", &l->sky.sun_elevation_deg));
    IGI_TRY(read_number(r, type, o, "sun_azimuth_deg", &l->sky.sun_azimuth_deg));
    IGI_TRY(read_number(r, type, o, "turbidity", &l->sky.turbidity));
    IGI_TRY(read_number(r, type, o, "cloudiness", &l->sky.cloudiness));
    const char *file = json_string_value(json_object_get(o, "profile"));
    if (!file) file = json_string_value(json_object_get(o, "image"));
    if (file) IGI_TRY(igi_strdup(r->ctx, file, &l->file));
    const char *key = igi_light_value_key(l->type);
    char std_key[32];
    snprintf(std_key, sizeof std_key, "%s_std", key);
    IGI_TRY(read_numbers(r, type, o, key, r->materials->bands, l->value, &l->known));
    return read_numbers(r, type, o, std_key, r->materials->bands, std, NULL);
}

static igi_status count_bands(const reader *r, json_t *regions)
{
    const char *name;
    json_t *region;
    json_object_foreach (regions, name, region) {
        size_t n = json_array_size(json_object_get(region, "albedo"));
        if (n < 1 || n > IGI_MAX_BANDS)
            return wrong(r, name, "albedo", "an array with a number for each of 1 to 16 bands");
        r->materials->bands = (int)n;
        return IGI_OK;
    }
    return wrong(r, "regions", "regions", "an object with a region at least");
}

static igi_status read_root(const reader *r, json_t *root)
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
    reader r = {.ctx = ctx, .path = path, .folder = folder, .materials = *materials};
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

/* The keys that are there; an albedo without a map takes the place of the map. */
static igi_status edit_region(const reader *r, const char *name, json_t *o, igi_material *m)
{
    static const char *const known[] = {"model",        "albedo", "albedo_map", "specular",
                                        "specular_rgb", "alpha",  "albedo_hsv"};
    enum { KNOWN = sizeof known / sizeof known[0] };
    const char *map = json_string_value(json_object_get(o, "albedo_map"));
    if (!json_is_object(o) || m->emitter)
        return wrong(r, name, name, "an object, and of a region that is no lamp");
    const char *key;
    json_t *value;
    json_object_foreach (o, key, value) {
        size_t k = 0;
        while (k < KNOWN && strcmp(known[k], key) != 0) k++;
        if (k == KNOWN)
            return wrong(r, name, key,
                         "left out; known are model, albedo, albedo_hsv, albedo_map, specular, "
                         "specular_rgb and alpha");
    }
    bool present = false, coloured = m->specular_is_rgb;
    IGI_TRY(read_numbers(r, name, o, "albedo", r->materials->bands, m->albedo, &present));
    if (json_object_get(o, "albedo_hsv")) {
        double hsv[3];
        if (present || r->materials->bands != 3)
            return wrong(r, name, "albedo_hsv", "in place of \"albedo\", and of 3 bands");
        IGI_TRY(read_numbers(r, name, o, "albedo_hsv", 3, hsv, &present));
        igi_rgb_of_hsv(hsv, m->albedo);
    }
    for (int b = 0; b < r->materials->bands; b++)
        if (present && !(m->albedo[b] >= 0 && m->albedo[b] <= 1))
            return wrong(r, name, "albedo", "numbers from 0 to 1");
    if (present || map) {
        igi_image_destroy(m->map);
        igi_image_destroy(m->map_std);
        m->map = m->map_std = NULL;
        m->textured = map != NULL;
        memset(m->albedo_std, 0, sizeof m->albedo_std); /* what is given is known */
    }
    if (json_object_get(o, "specular") || json_object_get(o, "specular_rgb")) m->specular_std = 0;
    if (json_object_get(o, "alpha")) m->alpha_std = 0;
    if (map) IGI_TRY(read_map(r, map, 1, &m->map));
    if (m->model == IGI_LAMBERT && !json_object_get(o, "model") && json_object_get(o, "specular"))
        return wrong(r, name, "model", "given: it is lambert, which has no lobe");
    IGI_TRY(read_lobe(r, o, m));
    if (!json_object_get(o, "specular_rgb"))
        m->specular_is_rgb = coloured && !json_object_get(o, "specular");
    return IGI_OK;
}

igi_status igi_materials_edit(igi_context *ctx, igi_materials *materials, const char *path)
{
    igi_status status = IGI_OK;
    char *folder = NULL;
    const char *name;
    json_error_t error;
    json_t *region, *root = json_load_file(path, JSON_REJECT_DUPLICATES, &error);
    if (!root) return igi_fail(ctx, IGI_E_DATA, "%s:%d: %s", path, error.line, error.text);
    IGI_TRY_GOTO(igi_path_folder(ctx, path, &folder));
    reader r = {.ctx = ctx, .path = path, .folder = folder, .materials = materials};
    json_t *regions = json_object_get(root, "regions");
    if (!json_is_object(regions)) IGI_TRY_GOTO(wrong(&r, "regions", "regions", "an object"));
    json_object_foreach (regions, name, region) {
        int at = material_named(materials, name);
        if (at < 0)
            IGI_TRY_GOTO(igi_fail(ctx, IGI_E_DATA, "%s: the scene has no region '%s'", path, name));
        IGI_TRY_GOTO(edit_region(&r, name, region, &materials->materials[at]));
    }
cleanup:
    json_decref(root);
    igi_free(folder);
    return status;
}
