/* SPDX-License-Identifier: Apache-2.0
 *
 * Lights in the words of renderers that have no tubes and no profiles.
 */
#include "export/export_private.h"
#include "light/sky.h"

const igi_light *igi_export_lamp(const igi_exporter *e, size_t region)
{
    for (size_t i = 0; i < e->materials->light_count; i++) {
        const igi_light *l = &e->materials->lights[i];
        if (l->type == IGI_LIGHT_AREA && l->region == (int)region) return l;
    }
    return NULL;
}

void igi_export_target(const igi_light *light, double target[3], double up[3])
{
    bool steep = fabs(light->direction[2]) > 0.9;
    for (int k = 0; k < 3; k++) {
        target[k] = light->position[k] + light->direction[k];
        up[k] = k == (steep ? 1 : 2);
    }
}

void igi_export_line_point(const igi_light *line, int k, int bands, double at[3], double rgb[3])
{
    double squared = 0, t = (k + 0.5) / IGI_LINE_POINTS;
    for (int i = 0; i < 3; i++) {
        double along = line->end[i] - line->position[i];
        at[i] = line->position[i] + t * along;
        squared += along * along;
    }
    igi_export_rgb(line->value, bands, rgb);
    for (int i = 0; i < 3; i++) rgb[i] *= sqrt(squared) / IGI_LINE_POINTS;
}

void igi_export_warn_lights(const igi_exporter *e, const char *program)
{
    int lines = 0, profiles = 0;
    for (size_t i = 0; i < e->materials->light_count; i++) {
        lines += e->materials->lights[i].type == IGI_LIGHT_LINE;
        profiles += e->materials->lights[i].type == IGI_LIGHT_GONIOMETRIC;
    }
    if (lines)
        igi_warn(e->ctx, "%s has no line lights: each becomes %d points", program,
                 (int)IGI_LINE_POINTS);
    if (profiles)
        igi_warn(e->ctx,
                 "goniometric lights are exported to %s as points of their mean intensity: their "
                 "profile is lost",
                 program);
}

/* Directions of a Fibonacci lattice: equal areas. */
igi_status igi_export_mean_intensity(const igi_exporter *e, const igi_light *light, double *mean)
{
    enum { DIRECTIONS = 4096 };
    profile *p = NULL;
    *mean = 0;
    IGI_TRY(profile_load(e->ctx, light->file ? light->file : "", &p));
    for (int k = 0; k < DIRECTIONS; k++) {
        float z = 1 - 2 * ((float)k + 0.5f) / DIRECTIONS, r = sqrtf(1 - z * z);
        float phi = 2.39996323f * (float)k;
        *mean += (double)profile_intensity(p, igi_v(r * cosf(phi), r * sinf(phi), z)) / DIRECTIONS;
    }
    profile_destroy(p);
    return IGI_OK;
}
