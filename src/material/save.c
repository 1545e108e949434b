/* SPDX-License-Identifier: Apache-2.0
 *
 * materials.json and its maps. The order of keys is that of the code below, numbers have nine
 * digits: the same materials give the same bytes.
 */
#include "material/material.h"
#include "base/file.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

/* JSON has no word for what is not a finite number: null. */
static json_t *number(double x)
{
    return isfinite(x) ? json_real(x) : json_null();
}

static json_t *numbers(const double *x, int count)
{
    json_t *array = json_array();
    for (int i = 0; i < count; i++)
        if (json_array_append_new(array, number(x[i]))) break;
    return array;
}

static json_t *sentences(char **texts, size_t count)
{
    json_t *array = json_array();
    for (size_t i = 0; i < count; i++)
        if (json_array_append_new(array, json_string(texts[i]))) break;
    return array;
}

/* Arrays of numbers on one line each: blanks after [ and before ] go, others within become one. */
static void join_numbers(char *text)
{
    char *to = text;
    for (const char *at = text; *at;) {
        size_t length = *at == '[' ? strcspn(at + 1, "[]{}\"") : 0;
        if (*at == '"') { /* a string, with what it escapes */
            for (*to++ = *at++; *at && *at != '"'; *to++ = *at++)
                if (*at == '\\') *to++ = *at++;
        }
        if (length == 0 || at[length + 1] != ']') {
            if (*at) *to++ = *at++;
            continue;
        }
        for (const char *end = at + length + 1; at < end;) {
            size_t blanks = strspn(at, " \n");
            if (blanks && to[-1] != '[' && at + blanks < end) *to++ = ' ';
            if (blanks) at += blanks;
            else *to++ = *at++;
        }
    }
    *to = 0;
}

static igi_status save_json(igi_context *ctx, const json_t *root, const char *path)
{
    json_free_t release;
    json_get_alloc_funcs(NULL, &release);
    char *text = json_dumps(root, JSON_INDENT(1) | JSON_REAL_PRECISION(9));
    if (!text) return igi_fail(ctx, IGI_E_SYSTEM, "%s: no memory to write it", path);
    join_numbers(text);
    igi_file file;
    igi_status status = igi_file_begin(ctx, path, &file);
    if (status == IGI_OK) {
        fprintf(file.stream, "%s\n", text);
        status = igi_file_end(ctx, &file, IGI_OK);
    }
    release(text);
    return status;
}

static igi_status make_folder(igi_context *ctx, const char *folder, const char *name)
{
    char *path = NULL;
    IGI_TRY(igi_strprintf(ctx, &path, "%s/%s", folder, name));
    igi_status status = IGI_OK;
    if (mkdir(path, 0777) && errno != EEXIST)
        status = igi_fail(ctx, IGI_E_SYSTEM, "%s: cannot be made (%s); check the folder", path,
                          strerror(errno));
    igi_free(path);
    return status;
}

/* R G B A, or Y A, or band00 .. A. */
static void name_channels(igi_image *image, int bands)
{
    for (int i = 0; i < image->channels; i++) {
        char *name = image->names[i];
        if (i == bands) snprintf(name, IGI_CHANNEL_NAME_SIZE, "A");
        else if (bands == 3) snprintf(name, IGI_CHANNEL_NAME_SIZE, "%c", "RGB"[i]);
        else if (bands == 1) snprintf(name, IGI_CHANNEL_NAME_SIZE, "Y");
        else snprintf(name, IGI_CHANNEL_NAME_SIZE, "band%02d", i);
    }
}

static igi_status save_map(igi_context *ctx, const igi_image *map, int bands, const char *folder,
                           const char *kind, const char *name)
{
    char *path = NULL;
    IGI_TRY(igi_strprintf(ctx, &path, "%s/%s/%s.exr", folder, kind, name));
    igi_image named = *map; /* the samples are borrowed */
    name_channels(&named, bands);
    igi_status status = igi_image_save_exr(ctx, &named, IGI_EXR_HALF, path);
    igi_free(path);
    return status;
}

static igi_status save_maps(igi_context *ctx, const igi_materials *materials, const char *folder)
{
    for (size_t i = 0; i < materials->count; i++) {
        const igi_material *m = &materials->materials[i];
        if (!m->map) continue;
        char *name = NULL;
        IGI_TRY(make_folder(ctx, folder, "albedo"));
        IGI_TRY(make_folder(ctx, folder, "uncertainty"));
        IGI_TRY(igi_region_file_name(ctx, m->region, &name));
        igi_status status = save_map(ctx, m->map, materials->bands, folder, "albedo", name);
        if (status == IGI_OK && m->map_std)
            status = save_map(ctx, m->map_std, materials->bands, folder, "uncertainty", name);
        igi_free(name);
        IGI_TRY(status);
    }
    return IGI_OK;
}

static igi_status region_json(igi_context *ctx, const igi_material *m, int bands, json_t *regions)
{
    char *name = NULL;
    IGI_TRY(igi_region_file_name(ctx, m->region, &name));
    bool glossy = m->model != IGI_LAMBERT;
    json_t *o = json_object();
    int bad = json_object_set_new(o, "model", json_string(igi_model_name(m->model)));
    if (m->emitter) bad |= json_object_set_new(o, "emitter", json_true());
    bad |= json_object_set_new(o, "albedo", numbers(m->albedo, bands));
    bad |= json_object_set_new(o, "albedo_std", numbers(m->albedo_std, bands));
    bad |= json_object_set_new(
        o, "albedo_map", m->map && m->textured ? json_sprintf("albedo/%s.exr", name) : json_null());
    bad |= json_object_set_new(o, "specular", number(glossy ? m->specular : 0));
    bad |= json_object_set_new(o, "specular_std", number(m->specular_std));
    bad |= json_object_set_new(o, "specular_rgb",
                               glossy && m->specular_is_rgb ? numbers(m->specular_rgb, bands)
                                                            : json_null());
    if (glossy && m->specular_is_rgb)
        bad |= json_object_set_new(o, "specular_rgb_std", numbers(m->specular_rgb_std, bands));
    bad |= json_object_set_new(o, "alpha", glossy ? number(m->alpha) : json_null());
    bad |= json_object_set_new(o, "alpha_std", glossy ? number(m->alpha_std) : json_null());
    bad |= json_object_set_new(o, "observed", number(m->observed));
    bad |= json_object_set_new(o, "views", json_integer(m->views));
    bad |= json_object_set_new(o, "warnings", sentences(m->warnings, m->warning_count));
    bad |= json_object_set_new(regions, m->region, o);
    igi_free(name);
    if (bad)
        return igi_fail(ctx, IGI_E_DATA,
                        "materials.json: region '%s' cannot be written; its name or a warning is "
                        "not UTF-8, or memory ran out",
                        m->region);
    return IGI_OK;
}

/* Relative to the scene's folder, since materials.json holds no path of this machine. */
static const char *portable_path(const igi_scene *scene, const char *file)
{
    size_t length = scene && scene->folder ? strlen(scene->folder) : 0;
    if (length && strncmp(file, scene->folder, length) == 0 && file[length] == '/')
        return file + length + 1;
    return igi_file_name(file);
}

static bool all_equal(const double *x, int count)
{
    for (int i = 1; i < count; i++)
        if (x[i] != x[0]) return false;
    return true;
}

static bool any_nonzero(const double *x, int count)
{
    for (int i = 0; i < count; i++)
        if (x[i] != 0) return true;
    return false;
}

static int put_place(json_t *o, const igi_light *l, const igi_scene *scene)
{
    int bad = 0;
    switch (l->type) {
    case IGI_LIGHT_AREA:
        if (scene && l->region >= 0 && (size_t)l->region < scene->region_count)
            bad |= json_object_set_new(o, "region", json_string(scene->regions[l->region].name));
        if (l->profile > 0) bad |= json_object_set_new(o, "profile", number(l->profile));
        break;
    case IGI_LIGHT_SPOT:
        bad |= json_object_set_new(o, "position", numbers(l->position, 3));
        bad |= json_object_set_new(o, "direction", numbers(l->direction, 3));
        bad |= json_object_set_new(o, "cutoff_deg", number(l->cutoff_deg));
        bad |= json_object_set_new(o, "beam_deg", number(l->beam_deg));
        break;
    case IGI_LIGHT_LINE:
        bad |= json_object_set_new(o, "from", numbers(l->position, 3));
        bad |= json_object_set_new(o, "to", numbers(l->end, 3));
        break;
    case IGI_LIGHT_POINT: bad |= json_object_set_new(o, "position", numbers(l->position, 3)); break;
    case IGI_LIGHT_GONIOMETRIC:
        bad |= json_object_set_new(o, "position", numbers(l->position, 3));
        if (l->file)
            bad |= json_object_set_new(o, "profile", json_string(portable_path(scene, l->file)));
        break;
    case IGI_LIGHT_DIRECTIONAL:
        bad |= json_object_set_new(o, "direction", numbers(l->direction, 3));
        break;
    case IGI_LIGHT_ENV:
        if (l->sky.given) {
            bad |= json_object_set_new(o, "sun_elevation_deg", number(l->sky.sun_elevation_deg));
            bad |= json_object_set_new(o, "sun_azimuth_deg", number(l->sky.sun_azimuth_deg));
            bad |= json_object_set_new(o, "turbidity", number(l->sky.turbidity));
            bad |= json_object_set_new(o, "cloudiness", number(l->sky.cloudiness));
        }
        if (l->file)
            bad |= json_object_set_new(o, "image", json_string(portable_path(scene, l->file)));
        bad |= json_object_set_new(o, "rotation_deg", number(l->rotation_deg));
        break;
    case IGI_LIGHT_AMBIENT: break;
    }
    if (any_nonzero(l->position_std, 3))
        bad |= json_object_set_new(o, "position_std", numbers(l->position_std, 3));
    return bad;
}

json_t *igi_light_json(const igi_light *l, const double *std, int bands, const igi_scene *scene)
{
    const char *key = igi_light_value_key(l->type);
    bool scale = l->type == IGI_LIGHT_GONIOMETRIC || l->type == IGI_LIGHT_ENV;
    char std_key[32];
    snprintf(std_key, sizeof std_key, "%s_std", key);
    json_t *o = json_object();
    int bad = json_object_set_new(o, "type",
                                  json_string(l->sky.given ? "sky" : igi_light_type_name(l->type)));
    bad |= put_place(o, l, scene);
    if (l->known || any_nonzero(l->value, bands))
        bad |= json_object_set_new(o, key,
                                   scale && all_equal(l->value, bands) ? number(l->value[0])
                                                                       : numbers(l->value, bands));
    if (std && any_nonzero(std, bands))
        bad |= json_object_set_new(
            o, std_key, scale && all_equal(l->value, bands) ? number(std[0]) : numbers(std, bands));
    if (!bad) return o;
    json_decref(o);
    return NULL;
}

igi_status igi_materials_save(igi_context *ctx, const igi_materials *materials,
                              const igi_scene *scene, const char *folder)
{
    igi_status status = IGI_OK;
    char *path = NULL;
    int bands = materials->bands, bad = 0;
    json_t *root = json_object(), *regions = json_object(), *lights = json_array();
    for (size_t i = 0; i < materials->count; i++)
        IGI_TRY_GOTO(region_json(ctx, &materials->materials[i], bands, regions));
    for (size_t i = 0; i < materials->light_count; i++) {
        const double *std = materials->light_std ? materials->light_std[i] : NULL;
        bad |= json_array_append_new(lights,
                                     igi_light_json(&materials->lights[i], std, bands, scene));
    }
    bad |= json_object_set_new(root, "igi", json_integer(1));
    bad |= json_object_set_new(root, "scene",
                               json_string(materials->scene ? materials->scene : ""));
    bad |= json_object_set(root, "regions", regions);
    bad |= json_object_set(root, "lights", lights);
    bad |= json_object_set_new(root, "warnings",
                               sentences(materials->warnings, materials->warning_count));
    if (bad)
        IGI_TRY_GOTO(igi_fail(ctx, IGI_E_DATA,
                              "materials.json: a name of the scene or of a light "
                              "is not UTF-8; rename it"));
    IGI_TRY_GOTO(save_maps(ctx, materials, folder));
    IGI_TRY_GOTO(igi_strprintf(ctx, &path, "%s/materials.json", folder));
    IGI_TRY_GOTO(save_json(ctx, root, path));
cleanup:
    json_decref(root);
    json_decref(regions);
    json_decref(lights);
    igi_free(path);
    return status;
}
