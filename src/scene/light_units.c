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
#include "scene/light_colour.h"

#include <math.h>

#define COLOURS IGI_LIGHT_COLOUR_KEYS
static const char *const unit_keys[][IGI_LIGHT_UNIT_KEYS] = {
    [IGI_LIGHT_AREA] = {"power_lm", "luminance_cd_m2", COLOURS},
    [IGI_LIGHT_POINT] = {"power_lm", "intensity_cd", COLOURS},
    [IGI_LIGHT_SPOT] = {"intensity_cd", COLOURS},
    [IGI_LIGHT_LINE] = {"power_lm", COLOURS},
    [IGI_LIGHT_GONIOMETRIC] = {NULL},
    [IGI_LIGHT_DIRECTIONAL] = {"illuminance_lx", COLOURS},
    [IGI_LIGHT_ENV] = {NULL},
    [IGI_LIGHT_AMBIENT] = {"luminance_cd_m2", COLOURS},
};

const char *const *igi_light_unit_keys(igi_light_type type)
{
    return unit_keys[type];
}

typedef struct body {
    double area, volume;
    double open; /* length of the sum of its area vectors: 0 of a closed surface */
} body;

static body measure_body(const igi_scene *scene, int region)
{
    const igi_mesh *mesh = &scene->mesh;
    body sum = {0};
    double vectors[3] = {0};
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        if ((int)mesh->regions[t] != region) continue;
        igi_vec p[3];
        for (size_t k = 0; k < 3; k++) {
            const float *x = mesh->positions + 3 * mesh->triangles[3 * t + k];
            p[k] = igi_v(x[0], x[1], x[2]);
        }
        igi_vec n = igi_cross(igi_sub(p[1], p[0]), igi_sub(p[2], p[0]));
        sum.area += 0.5 * (double)igi_length(n);
        sum.volume += (double)igi_dot(p[0], n) / 6; /* divergence theorem */
        vectors[0] += 0.5 * (double)n.x;
        vectors[1] += 0.5 * (double)n.y;
        vectors[2] += 0.5 * (double)n.z;
    }
    sum.open = sqrt(vectors[0] * vectors[0] + vectors[1] * vectors[1] + vectors[2] * vectors[2]);
    return sum;
}

/* It sends 4 pi j V, its surface pi L A: L = j 4V/A, and 4V/A is the mean chord (Cauchy), which is to
 * say that L is the mean of what rays through it gather. */
igi_status igi_light_spread_volume(igi_context *ctx, const igi_json *at, const igi_scene *scene,
                                   igi_light *light)
{
    body b = measure_body(scene, light->region);
    const char *name = scene->regions[light->region].name;
    if (b.open > 1e-3 * b.area)
        return igi_json_fail(ctx, at, "region \"%s\" is open, and has no volume; close its surface",
                             name);
    if (!(b.volume > 0))
        return igi_json_fail(ctx, at,
                             "region \"%s\" is inside out; turn its triangles around "
                             "(counter-clockwise is the front)",
                             name);
    if (!igi_json_member(at, "emission").value) return IGI_OK;
    for (int k = 0; k < scene->bands; k++) light->value[k] *= 4 * b.volume / b.area;
    return IGI_OK;
}

/* What one lumen of the light's power is of its photometric value. */
static double per_lumen(const igi_scene *scene, const igi_light *light)
{
    double squared = 0;
    switch (light->type) {
    case IGI_LIGHT_AREA: return 1 / (IGI_PI * measure_body(scene, light->region).area);
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
    igi_json stated;
    IGI_TRY(igi_light_read_colour(ctx, at, scene->bands, colour, &stated));
    if (!which && stated.value)
        return igi_json_fail(ctx, &stated, "is a colour without a strength; give \"%s\"",
                             igi_light_unit_keys(light->type)[0]);
    if (!which) return IGI_OK;
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
