/* SPDX-License-Identifier: Apache-2.0
 *
 * Materials changed by hand: a file with "regions" as in materials.json, and of them what changes.
 */
#include "material/read.h"

#include "base/spectrum.h"
#include "material/result.h"
#include "scene/file_text.h"

#include <string.h>

/* The keys that are there; an albedo without a map takes the place of the map. */
static igi_status edit_region(const igi_material_reader *r, const char *name, json_t *o,
                              igi_material *m)
{
    static const char *const known[] = {"model",        "albedo", "albedo_map", "specular",
                                        "specular_rgb", "alpha",  "albedo_hsv"};
    enum { KNOWN = sizeof known / sizeof known[0] };
    const char *map = json_string_value(json_object_get(o, "albedo_map"));
    if (!json_is_object(o) || m->emitter)
        return igi_read_wrong(r, name, name, "an object, and of a region that is no lamp");
    const char *key;
    json_t *value;
    json_object_foreach (o, key, value) {
        size_t k = 0;
        while (k < KNOWN && strcmp(known[k], key) != 0) k++;
        if (k == KNOWN)
            return igi_read_wrong(
                r, name, key,
                "left out; known are model, albedo, albedo_hsv, albedo_map, specular, "
                "specular_rgb and alpha");
    }
    bool present = false, coloured = m->specular_is_rgb;
    IGI_TRY(igi_read_numbers(r, name, o, "albedo", r->materials->bands, m->albedo, &present));
    if (json_object_get(o, "albedo_hsv")) {
        double hsv[3];
        if (present || r->materials->bands != 3)
            return igi_read_wrong(r, name, "albedo_hsv", "in place of \"albedo\", and of 3 bands");
        IGI_TRY(igi_read_numbers(r, name, o, "albedo_hsv", 3, hsv, &present));
        igi_rgb_of_hsv(hsv, m->albedo);
    }
    for (int b = 0; b < r->materials->bands; b++)
        if (present && !(m->albedo[b] >= 0 && m->albedo[b] <= 1))
            return igi_read_wrong(r, name, "albedo", "numbers from 0 to 1");
    if (present || map) {
        igi_image_destroy(m->map);
        igi_image_destroy(m->map_std);
        m->map = m->map_std = NULL;
        m->textured = map != NULL;
        memset(m->albedo_std, 0, sizeof m->albedo_std); /* what is given is known */
    }
    if (json_object_get(o, "specular") || json_object_get(o, "specular_rgb")) m->specular_std = 0;
    if (json_object_get(o, "alpha")) m->alpha_std = 0;
    if (map) IGI_TRY(igi_read_map(r, map, 1, &m->map));
    if (m->model == IGI_LAMBERT && !json_object_get(o, "model") && json_object_get(o, "specular"))
        return igi_read_wrong(r, name, "model", "given: it is lambert, which has no lobe");
    IGI_TRY(igi_read_lobe(r, o, m));
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
    igi_material_reader r = {.ctx = ctx, .path = path, .folder = folder, .materials = materials};
    json_t *regions = json_object_get(root, "regions");
    if (!json_is_object(regions))
        IGI_TRY_GOTO(igi_read_wrong(&r, "regions", "regions", "an object"));
    json_object_foreach (regions, name, region) {
        int at = igi_material_named(materials, name);
        if (at < 0)
            IGI_TRY_GOTO(igi_fail(ctx, IGI_E_DATA, "%s: the scene has no region '%s'", path, name));
        IGI_TRY_GOTO(edit_region(&r, name, region, &materials->materials[at]));
    }
cleanup:
    json_decref(root);
    igi_free(folder);
    return status;
}
