/* SPDX-License-Identifier: Apache-2.0
 *
 * What a luminaire's data sheet says, as a value per band:
 *     point      I = power / 4 pi, or intensity         line  I' = power / (4 pi length)
 *     area       L = power / (pi area), or luminance    (Lambertian, its front)
 * then divided by 179 lm/W and given the colour of the light, whose luminance is 1 (base/spectrum.h).
 */
#include "scene/light_units.h"

#include "base/spectrum.h"
#include "base/vec.h"
#include "scene/file_text.h"

#include <math.h>

static const char *const unit_keys[][IGI_LIGHT_UNIT_KEYS] = {
    [IGI_LIGHT_AREA] = {"power_lm", "luminance_cd_m2", "temperature_k", "spectrum"},
    [IGI_LIGHT_POINT] = {"power_lm", "intensity_cd", "temperature_k", "spectrum"},
    [IGI_LIGHT_SPOT] = {"intensity_cd", "temperature_k", "spectrum"},
    [IGI_LIGHT_LINE] = {"power_lm", "temperature_k", "spectrum"},
    [IGI_LIGHT_GONIOMETRIC] = {NULL},
    [IGI_LIGHT_DIRECTIONAL] = {"illuminance_lx", "temperature_k", "spectrum"},
    [IGI_LIGHT_ENV] = {NULL},
    [IGI_LIGHT_AMBIENT] = {"luminance_cd_m2", "temperature_k", "spectrum"},
};

const char *const *igi_light_unit_keys(igi_light_type type)
{
    return unit_keys[type];
}

/* A table of wavelengths in nm, rising, and relative powers. */
typedef struct table {
    size_t count;
    double (*row)[2];
} table;

static double look_up(const void *user, double nm)
{
    const table *t = user;
    if (t->count == 0 || nm < t->row[0][0] || nm > t->row[t->count - 1][0]) return 0;
    size_t i = 0;
    while (i + 2 < t->count && t->row[i + 1][0] <= nm) i++;
    if (i + 1 >= t->count) return t->row[i][1];
    double share = (nm - t->row[i][0]) / (t->row[i + 1][0] - t->row[i][0]);
    return t->row[i][1] + share * (t->row[i + 1][1] - t->row[i][1]);
}

/* Lines of two numbers; lines that begin with none (a heading, a comment) are passed over. */
static igi_status read_table(igi_context *ctx, const char *path, table *t)
{
    igi_text text = {NULL, 0};
    size_t capacity = 0;
    int line = 0;
    igi_status status = IGI_OK;
    IGI_TRY_GOTO(igi_text_load(ctx, path, (size_t)1 << 20, &text));
    for (char *at = text.bytes, *end; *at; at = end) {
        const char *number = at;
        double row[2];
        line++;
        for (end = at; *end && *end != '\n';) end++;
        if (*end) *end++ = 0;
        if (!igi_scan_number(&number, &row[0])) continue;
        while (*number == ',' || *number == ';' || *number == ' ' || *number == '\t') number++;
        bool good = igi_scan_number(&number, &row[1]) && row[1] >= 0 && row[1] < 1e30;
        if (!good || !(row[0] > (t->count ? t->row[t->count - 1][0] : 0) && row[0] < 1e6))
            IGI_TRY_GOTO(igi_fail(ctx, IGI_E_DATA,
                                  "%s:%d: no wavelength in nm above the last one with a power from "
                                  "0 behind it",
                                  path, line));
        double(*grown)[2] = igi_grow(ctx, t->row, &capacity, t->count + 1, sizeof *grown);
        if (!grown) {
            status = IGI_E_SYSTEM;
            goto cleanup;
        }
        t->row = grown;
        t->row[t->count][0] = row[0];
        t->row[t->count++][1] = row[1];
    }
    if (t->count < 2)
        status = igi_fail(ctx, IGI_E_DATA, "%s: no spectrum: lines of a wavelength and a power",
                          path);
cleanup:
    igi_free(text.bytes);
    return status;
}

static igi_status read_spectrum(igi_context *ctx, const igi_json *at, double rgb[3])
{
    const char *name;
    char *folder = NULL, *path = NULL;
    table t = {0, NULL};
    igi_status status = IGI_OK;
    IGI_TRY_GOTO(igi_json_string(ctx, at, &name));
    IGI_TRY_GOTO(igi_path_folder(ctx, at->file->path, &folder));
    IGI_TRY_GOTO(igi_path_join(ctx, folder, name, &path));
    IGI_TRY_GOTO(read_table(ctx, path, &t));
    igi_colour_of_spectrum(look_up, &t, rgb);
cleanup:
    igi_free(folder);
    igi_free(path);
    igi_free(t.row);
    return status;
}

/* Of luminance 1. */
static igi_status read_colour(igi_context *ctx, const igi_json *object, int bands, double *colour)
{
    igi_json kelvin = igi_json_member(object, "temperature_k");
    igi_json spectrum = igi_json_member(object, "spectrum");
    const igi_json *said = kelvin.value ? &kelvin : &spectrum;
    for (int b = 0; b < bands; b++) colour[b] = 1;
    if (!said->value) return IGI_OK;
    if (kelvin.value && spectrum.value)
        return igi_json_fail(ctx, &spectrum, "stands beside \"temperature_k\"; keep one of them");
    if (bands != 3)
        return igi_json_fail(ctx, said, "is for images of 3 bands (RGB), these have %d", bands);
    if (spectrum.value) return read_spectrum(ctx, &spectrum, colour);
    double temperature;
    IGI_TRY(igi_json_number(ctx, &kelvin, &temperature));
    if (!(temperature >= 500 && temperature <= 1e5))
        return igi_json_fail(ctx, &kelvin, "is %g; give 500 to 100000 kelvin", temperature);
    igi_colour_of_temperature(temperature, colour);
    return IGI_OK;
}

static double area_of(const igi_scene *scene, int region)
{
    const igi_mesh *mesh = &scene->mesh;
    double sum = 0;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        if ((int)mesh->regions[t] != region) continue;
        igi_vec p[3];
        for (size_t k = 0; k < 3; k++) {
            const float *x = mesh->positions + 3 * mesh->triangles[3 * t + k];
            p[k] = igi_v(x[0], x[1], x[2]);
        }
        sum += 0.5 * (double)igi_length(igi_cross(igi_sub(p[1], p[0]), igi_sub(p[2], p[0])));
    }
    return sum;
}

/* What one lumen of the light's power is of its photometric value. */
static double per_lumen(const igi_scene *scene, const igi_light *light)
{
    double squared = 0;
    switch (light->type) {
    case IGI_LIGHT_AREA: return 1 / (IGI_PI * area_of(scene, light->region));
    case IGI_LIGHT_LINE:
        for (int k = 0; k < 3; k++)
            squared += (light->end[k] - light->position[k]) * (light->end[k] - light->position[k]);
        return 1 / (4 * IGI_PI * sqrt(squared));
    default: return 1 / (4 * IGI_PI);
    }
}

igi_status igi_light_read_units(igi_context *ctx, const igi_json *at, const igi_scene *scene,
                                const char *value_key, igi_light *light)
{
    static const char *const strengths[] = {"power_lm", "intensity_cd", "luminance_cd_m2",
                                            "illuminance_lx"};
    igi_json value = igi_json_member(at, value_key), said = {0};
    const char *which = NULL;
    for (size_t i = 0; i < sizeof strengths / sizeof *strengths; i++) {
        igi_json member = igi_json_member(at, strengths[i]);
        if (!member.value) continue;
        if (which || value.value)
            return igi_json_fail(ctx, &member, "stands beside \"%s\"; keep one of them",
                                 which ? which : value_key);
        which = strengths[i];
        said = member;
    }
    double strength = 0, colour[IGI_MAX_BANDS];
    IGI_TRY(read_colour(ctx, at, scene->bands, colour));
    if (!which) {
        igi_json kelvin = igi_json_member(at, "temperature_k");
        igi_json spectrum = igi_json_member(at, "spectrum");
        if (kelvin.value || spectrum.value)
            return igi_json_fail(ctx, kelvin.value ? &kelvin : &spectrum,
                                 "is a colour without a strength; give \"%s\"",
                                 igi_light_unit_keys(light->type)[0]);
        return IGI_OK;
    }
    said = igi_json_member(at, which);
    IGI_TRY(igi_json_number(ctx, &said, &strength));
    if (!(strength >= 0 && strength < 1e30))
        return igi_json_fail(ctx, &said, "is %g; light cannot be negative", strength);
    if (which == strengths[0]) strength *= per_lumen(scene, light);
    for (int b = 0; b < scene->bands; b++)
        light->value[b] = strength / IGI_LUMENS_PER_WATT * colour[b];
    light->known = true;
    return IGI_OK;
}
