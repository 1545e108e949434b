/* SPDX-License-Identifier: Apache-2.0 */
#include "scene/scene_parts.h"

#include "scene/light_place.h"
#include "scene/light_profile.h"
#include "scene/light_units.h"
#include "scene/sun.h"

#include <math.h>
#include <string.h>

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

/* The number of the region that the value names. */
static igi_status find_region(igi_context *ctx, const igi_json *at, const char *name,
                              const igi_scene *scene, int *region)
{
    for (size_t i = 0; i < scene->region_count; i++)
        if (strcmp(scene->regions[i].name, name) == 0) {
            *region = (int)i;
            return IGI_OK;
        }
    const char *meant = NULL, **names;
    IGI_TRY(IGI_ALLOC(ctx, scene->region_count, &names));
    for (size_t i = 0; i < scene->region_count; i++) names[i] = scene->regions[i].name;
    meant = igi_closest(name, names, scene->region_count);
    igi_free(names);
    if (meant)
        return igi_json_fail(ctx, at, "the mesh has no region \"%s\"; did you mean \"%s\"?", name,
                             meant);
    return igi_json_fail(ctx, at,
                         "the mesh has no region \"%s\" with any area; its first is \"%s\"", name,
                         scene->regions[0].name);
}

/* Beyond those of igi_light_place_key. */
typedef enum light_key {
    KEY_REGION = 16,
    KEY_PROFILE = 32,
    KEY_IMAGE = 64,
    KEY_SCALE = 128, /* the value is one number */
    KEY_SKY = 256,
    KEY_VOLUME = 512,
    KEY_COSINE = 1024 /* the profile is an exponent */
} light_key;

static const struct {
    const char *name;
    igi_light_type type;
    const char *value; /* key of its strength */
    unsigned keys;
} kinds[] = {
    {"area", IGI_LIGHT_AREA, "radiance", KEY_REGION | KEY_COSINE},
    {"volume", IGI_LIGHT_AREA, "emission", KEY_REGION | KEY_VOLUME},
    {"point", IGI_LIGHT_POINT, "intensity", IGI_PLACE_POSITION},
    {"spot", IGI_LIGHT_SPOT, "intensity",
     IGI_PLACE_POSITION | IGI_PLACE_DIRECTION | IGI_PLACE_CONE},
    {"line", IGI_LIGHT_LINE, "intensity", IGI_PLACE_FROM_TO},
    {"goniometric", IGI_LIGHT_GONIOMETRIC, "scale", IGI_PLACE_POSITION | KEY_PROFILE | KEY_SCALE},
    {"directional", IGI_LIGHT_DIRECTIONAL, "irradiance", IGI_PLACE_DIRECTION},
    {"env", IGI_LIGHT_ENV, "scale", KEY_IMAGE | KEY_SCALE},
    {"sky", IGI_LIGHT_ENV, "scale", KEY_SKY | KEY_SCALE},
    {"ambient", IGI_LIGHT_AMBIENT, "radiance", 0},
};

static const char *const sky_keys[] = {"latitude_deg",      "longitude_deg",   "time",
                                       "sun_elevation_deg", "sun_azimuth_deg", "turbidity",
                                       "cloudiness"};

static igi_status check_light_keys(igi_context *ctx, const igi_json *at, size_t kind)
{
    const char *known[13 + IGI_LIGHT_UNIT_KEYS];
    size_t count = 0;
    unsigned keys = kinds[kind].keys;
    const char *const *units = igi_light_unit_keys(kinds[kind].type);
    for (size_t i = 0; i < IGI_LIGHT_UNIT_KEYS && units[i]; i++) known[count++] = units[i];
    known[count++] = "type";
    known[count++] = kinds[kind].value;
    if (keys & KEY_REGION) known[count++] = "region";
    count += igi_light_place_keys(keys, known + count);
    if (keys & (KEY_PROFILE | KEY_COSINE)) known[count++] = "profile";
    if (keys & KEY_IMAGE) known[count++] = "image";
    if (keys & (KEY_IMAGE | KEY_SKY)) known[count++] = "rotation_deg";
    for (size_t i = 0; keys & KEY_SKY && i < COUNT(sky_keys); i++) known[count++] = sky_keys[i];
    return igi_json_check_keys(ctx, at, known, count);
}

static igi_status read_file(igi_context *ctx, const igi_json *at, const char *key, char **file)
{
    igi_json member = igi_json_member(at, key);
    const char *name;
    char *folder;
    IGI_TRY(igi_json_string(ctx, &member, &name));
    IGI_TRY(igi_path_folder(ctx, at->file->path, &folder));
    igi_status status = igi_path_join(ctx, folder, name, file);
    igi_free(folder);
    if (status == IGI_OK && !igi_file_exists(*file))
        return igi_json_fail(ctx, &member, "no readable file %s; correct the name", *file);
    return status;
}

static igi_status read_profile(igi_context *ctx, const igi_json *at, igi_light *light)
{
    igi_json member = igi_json_member(at, "profile");
    if (!member.value) return IGI_OK;
    IGI_TRY(igi_json_number(ctx, &member, &light->profile));
    if (light->profile >= 0 && light->profile <= IGI_MOST_PROFILE) return IGI_OK;
    return igi_json_fail(ctx, &member,
                         "is %g; give the exponent n of cos^n, 0 (alike in all directions) to %d",
                         light->profile, IGI_MOST_PROFILE);
}

static igi_status check_values(igi_context *ctx, const igi_json *at, const double *value,
                               size_t count)
{
    for (size_t i = 0; i < count; i++)
        if (!(value[i] >= 0 && value[i] < 1e30))
            return igi_json_fail(ctx, at, "is %g in band %zu; light cannot be negative", value[i],
                                 i);
    return IGI_OK;
}

static igi_status read_value(igi_context *ctx, const igi_json *at, size_t kind,
                             const igi_scene *scene, igi_light *light)
{
    igi_json member = igi_json_member(at, kinds[kind].value);
    size_t count = (size_t)scene->bands;
    IGI_TRY(igi_light_read_units(ctx, at, scene, kinds[kind].value, light));
    if (light->known) return IGI_OK;
    light->known = member.value != NULL;
    if (!member.value) {
        if (light->type != IGI_LIGHT_ENV) return IGI_OK;
        light->known = true; /* an image of the surroundings says how bright they are */
        for (size_t i = 0; i < count; i++) light->value[i] = 1;
        return IGI_OK;
    }
    if (kinds[kind].keys & KEY_SCALE) {
        IGI_TRY(igi_json_number(ctx, &member, &light->value[0]));
        for (size_t i = 1; i < count; i++) light->value[i] = light->value[0];
        return check_values(ctx, &member, light->value, count);
    }
    size_t got;
    IGI_TRY(igi_json_array(ctx, &member, &got));
    if (got != count)
        return igi_json_fail(ctx, &member, "has %zu bands, but the images have %d; give %d numbers",
                             got, scene->bands, scene->bands);
    IGI_TRY(igi_json_numbers(ctx, &member, count, light->value));
    return check_values(ctx, &member, light->value, count);
}

static igi_status find_kind(igi_context *ctx, const igi_json *at, size_t *kind)
{
    igi_json type = igi_json_member(at, "type");
    const char *name, *known[COUNT(kinds)];
    IGI_TRY(igi_json_object(ctx, at));
    IGI_TRY(igi_json_string(ctx, &type, &name));
    for (*kind = 0; *kind < COUNT(kinds); ++*kind) {
        known[*kind] = kinds[*kind].name;
        if (strcmp(name, kinds[*kind].name) == 0) return IGI_OK;
    }
    const char *meant = igi_closest(name, known, COUNT(kinds));
    if (meant)
        return igi_json_fail(ctx, &type, "no kind of light is \"%s\"; did you mean \"%s\"?", name,
                             meant);
    return igi_json_fail(ctx, &type,
                         "no kind of light is \"%s\"; there are area, volume, point, spot, line, "
                         "goniometric, directional, env, sky and ambient",
                         name);
}

static igi_status read_light(igi_context *ctx, const igi_json *at, const igi_scene *scene,
                             igi_light *light)
{
    size_t kind;
    IGI_TRY(find_kind(ctx, at, &kind));
    IGI_TRY(check_light_keys(ctx, at, kind));
    light->type = kinds[kind].type;
    light->region = -1;
    unsigned keys = kinds[kind].keys;
    if (keys & KEY_REGION) {
        igi_json region = igi_json_member(at, "region");
        const char *name;
        IGI_TRY(igi_json_string(ctx, &region, &name));
        IGI_TRY(find_region(ctx, &region, name, scene, &light->region));
    }
    IGI_TRY(igi_light_read_place(ctx, at, keys, light));
    if (keys & KEY_PROFILE) IGI_TRY(read_file(ctx, at, "profile", &light->file));
    if (keys & KEY_COSINE) IGI_TRY(read_profile(ctx, at, light));
    if (keys & KEY_SKY) IGI_TRY(igi_sky_read(ctx, at, &light->sky));
    if (keys & KEY_IMAGE) IGI_TRY(read_file(ctx, at, "image", &light->file));
    if (keys & (KEY_IMAGE | KEY_SKY)) {
        igi_json rotation = igi_json_member(at, "rotation_deg");
        if (rotation.value) IGI_TRY(igi_json_number(ctx, &rotation, &light->rotation_deg));
    }
    IGI_TRY(read_value(ctx, at, kind, scene, light));
    return keys & KEY_VOLUME ? igi_light_spread_volume(ctx, at, scene, light) : IGI_OK;
}

igi_status igi_lights_read(igi_context *ctx, const igi_json *array, const igi_scene *scene,
                           igi_light **lights, size_t *count)
{
    size_t length;
    *lights = NULL;
    *count = 0;
    IGI_TRY(igi_json_array(ctx, array, &length));
    IGI_TRY(IGI_ALLOC(ctx, length, lights));
    *count = length;
    bool *lit;
    IGI_TRY(IGI_ALLOC(ctx, scene->region_count, &lit));
    igi_status status = IGI_OK;
    for (size_t i = 0; i < length; i++) {
        igi_json at = igi_json_element(array, i);
        igi_light *light = &(*lights)[i];
        IGI_TRY_GOTO(read_light(ctx, &at, scene, light));
        if (light->region < 0) continue;
        if (lit[light->region]) {
            status = igi_json_fail(ctx, &at, "another light is region \"%s\" already; remove one",
                                   scene->regions[light->region].name);
            goto cleanup;
        }
        lit[light->region] = true;
    }
cleanup:
    igi_free(lit);
    return status;
}

igi_status igi_regions_read(igi_context *ctx, const igi_json *object, igi_scene *scene)
{
    static const char *const known[] = {"textured", "emitter"};
    IGI_TRY(igi_json_object(ctx, object));
    const char *name;
    json_t *unused;
    json_object_foreach (object->value, name, unused) {
        igi_json at = igi_json_member(object, name);
        int number;
        IGI_TRY(find_region(ctx, &at, name, scene, &number));
        IGI_TRY(igi_json_check_keys(ctx, &at, known, COUNT(known)));
        igi_region *region = &scene->regions[number];
        igi_json textured = igi_json_member(&at, "textured");
        igi_json emitter = igi_json_member(&at, "emitter");
        if (textured.value) {
            bool yes;
            IGI_TRY(igi_json_bool(ctx, &textured, &yes));
            region->textured = yes ? IGI_YES : IGI_NO;
        }
        if (emitter.value) IGI_TRY(igi_json_bool(ctx, &emitter, &region->emitter));
    }
    return IGI_OK;
}
