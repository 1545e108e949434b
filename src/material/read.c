/* SPDX-License-Identifier: Apache-2.0
 *
 * Values of materials.json: numbers, lobes.
 */
#include "material/read.h"

#include <math.h>
#include <stdio.h>
#include <string.h>

igi_status igi_read_wrong(const igi_material_reader *r, const char *owner, const char *key,
                          const char *expected)
{
    return igi_fail(r->ctx, IGI_E_DATA, "%s: '%s': \"%s\" must be %s", r->path, owner, key,
                    expected);
}

igi_status igi_read_number(const igi_material_reader *r, const char *owner, const json_t *o,
                           const char *key, double *x)
{
    const json_t *v = json_object_get(o, key);
    if (!v) return IGI_OK;
    if (json_is_null(v)) *x = HUGE_VAL;
    else if (json_is_number(v)) *x = json_number_value(v);
    else return igi_read_wrong(r, owner, key, "a number or null");
    return IGI_OK;
}

igi_status igi_read_numbers(const igi_material_reader *r, const char *owner, const json_t *o,
                            const char *key, int count, double *x, bool *present)
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
        return igi_read_wrong(r, owner, key, expected);
    for (int i = 0; i < count; i++) {
        const json_t *e = json_array_get(v, (size_t)i);
        if (!json_is_number(e) && !json_is_null(e)) return igi_read_wrong(r, owner, key, expected);
        x[i] = json_is_null(e) ? HUGE_VAL : json_number_value(e);
    }
    return IGI_OK;
}

igi_status igi_read_lobe(const igi_material_reader *r, const json_t *o, igi_material *m)
{
    const char *model = json_string_value(json_object_get(o, "model"));
    if (model && !igi_model_from_name(model, &m->model))
        return igi_read_wrong(r, m->region, "model", "lambert, ward, ggx or phong");
    if (m->model == IGI_LAMBERT) return IGI_OK;
    IGI_TRY(igi_read_number(r, m->region, o, "specular", &m->specular));
    if (m->specular < 0) return igi_read_wrong(r, m->region, "specular", "0 or above");
    IGI_TRY(igi_read_number(r, m->region, o, "specular_std", &m->specular_std));
    IGI_TRY(igi_read_numbers(r, m->region, o, "specular_rgb", r->materials->bands, m->specular_rgb,
                             &m->specular_is_rgb));
    bool stated;
    IGI_TRY(igi_read_numbers(r, m->region, o, "specular_rgb_std", r->materials->bands,
                             m->specular_rgb_std, &stated));
    const char *key = json_is_number(json_object_get(o, "alpha")) ? "alpha" : "roughness";
    IGI_TRY(igi_read_number(r, m->region, o, key, &m->alpha));
    if (!(m->alpha > 0 && m->alpha <= 1))
        return igi_read_wrong(r, m->region, "alpha", "above 0 and at most 1");
    return igi_read_number(r, m->region, o, "alpha_std", &m->alpha_std);
}

int igi_material_named(const igi_materials *materials, const char *name)
{
    for (size_t i = 0; name && i < materials->count; i++)
        if (strcmp(materials->materials[i].region, name) == 0) return (int)i;
    return -1;
}
