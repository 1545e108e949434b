/* SPDX-License-Identifier: Apache-2.0
 *
 * Names of models, lights and files; the end of a set of materials.
 */
#include "material/material.h"

#include "base/rng.h"

#include <inttypes.h>
#include <stdio.h>
#include <string.h>

static const char *const model_names[] = {
    [IGI_LAMBERT] = "lambert", [IGI_WARD] = "ward", [IGI_GGX] = "ggx", [IGI_PHONG] = "phong"};

static const struct {
    const char *type, *value;
} light_names[] = {
    [IGI_LIGHT_AREA] = {"area", "radiance"},
    [IGI_LIGHT_POINT] = {"point", "intensity"},
    [IGI_LIGHT_SPOT] = {"spot", "intensity"},
    [IGI_LIGHT_LINE] = {"line", "intensity"},
    [IGI_LIGHT_GONIOMETRIC] = {"goniometric", "scale"},
    [IGI_LIGHT_DIRECTIONAL] = {"directional", "irradiance"},
    [IGI_LIGHT_ENV] = {"env", "scale"},
    [IGI_LIGHT_AMBIENT] = {"ambient", "radiance"},
};

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

const char *igi_model_name(igi_model model)
{
    return (size_t)model < COUNT(model_names) ? model_names[model] : "unknown";
}

bool igi_model_from_name(const char *name, igi_model *model)
{
    for (size_t i = 0; i < COUNT(model_names); i++) {
        if (strcmp(name, model_names[i]) != 0) continue;
        *model = (igi_model)i;
        return true;
    }
    return false;
}

const char *igi_light_type_name(igi_light_type type)
{
    return (size_t)type < COUNT(light_names) ? light_names[type].type : "unknown";
}

const char *igi_light_value_key(igi_light_type type)
{
    return (size_t)type < COUNT(light_names) ? light_names[type].value : "value";
}

bool igi_light_type_from_name(const char *name, igi_light_type *type)
{
    for (size_t i = 0; i < COUNT(light_names); i++) {
        if (strcmp(name, light_names[i].type) != 0) continue;
        *type = (igi_light_type)i;
        return true;
    }
    return false;
}

static uint64_t hash_text(const char *text)
{
    uint64_t hash = 0;
    for (; *text; text++) hash = igi_hash64(hash ^ (unsigned char)*text);
    return hash;
}

igi_status igi_region_file_name(igi_context *ctx, const char *region, char **name)
{
    enum { LONGEST = 160 };
    size_t length = strlen(region), at = 0;
    IGI_TRY(IGI_ALLOC(ctx, 3 * LONGEST + 32, name));
    for (size_t i = 0; i < length && i < LONGEST; i++) {
        unsigned char c = (unsigned char)region[i];
        bool unfit = c < 32 || c == 127 || strchr("/\\:*?\"<>|%", c) || (i == 0 && c == '.');
        if (unfit) at += (size_t)snprintf(*name + at, 4, "%%%02X", c);
        else (*name)[at++] = (char)c;
    }
    if (length == 0 || length > LONGEST)
        snprintf(*name + at, 24, "%%%016" PRIx64, hash_text(region));
    return IGI_OK;
}

static void destroy_sentences(char **sentences, size_t count)
{
    for (size_t i = 0; sentences && i < count; i++) igi_free(sentences[i]);
    igi_free(sentences);
}

void igi_material_clear(igi_material *m)
{
    igi_free(m->region);
    igi_image_destroy(m->map);
    igi_image_destroy(m->map_std);
    destroy_sentences(m->warnings, m->warning_count);
}

void igi_materials_destroy(igi_materials *materials)
{
    if (!materials) return;
    for (size_t i = 0; materials->materials && i < materials->count; i++)
        igi_material_clear(&materials->materials[i]);
    for (size_t i = 0; materials->lights && i < materials->light_count; i++)
        igi_free(materials->lights[i].file);
    destroy_sentences(materials->warnings, materials->warning_count);
    igi_free(materials->materials);
    igi_free(materials->lights);
    igi_free(materials->light_std);
    igi_free(materials->scene);
    igi_free(materials);
}
