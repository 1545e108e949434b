/* SPDX-License-Identifier: Apache-2.0
 *
 * The mesh against what the photographs show of it. A lamp that is drawn too large sends too much
 * light; light goes where the mesh has gaps, and none is gathered from there.
 */
#include "recover/doubts_private.h"

#define OUTLINE 0.01 /* of a lamp's area */
#define OUTLINE_SIGMAS 4.0
#define GAPS 0.002 /* of the photographs' pixels */

double igi_lamp_area(const igi_mesh *mesh, int region)
{
    double area = 0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++)
        if ((int)mesh->regions[t] == region) area += (double)igi_triangle_area(mesh, t);
    return area;
}

igi_status igi_doubt_outlines(igi_context *ctx, const igi_problem *p, igi_materials *m, double *off)
{
    const igi_observations *o = p->observations;
    double all = 0, sum = 0;
    for (size_t k = 0; k < p->light_count; k++) {
        const igi_light *light = &p->lights[k];
        if (light->type != IGI_LIGHT_AREA) continue;
        double power = 0, area = igi_lamp_area(&p->scene->mesh, light->region);
        for (int b = 0; b < p->bands; b++) power += light->value[b] * area;
        all += power;
        igi_lamp_size size = igi_outlines_sum(o->outlines, o->outline_count,
                                              (uint32_t)light->region);
        double wrong = fabs(size.ratio - 1);
        if (!isfinite(size.error)) continue;
        if (wrong < IGI_LAMP_WRONG) sum += power * wrong;
        if (!(wrong > fmax(OUTLINE, OUTLINE_SIGMAS * size.error))) continue;
        char *sentence;
        IGI_TRY(igi_strprintf(ctx, &sentence,
                              "lights[%zu]: '%s' is %.1f +- %.1f %% %s in the mesh than in the %zu "
                              "photographs that tell, in area: its light is off by as much; mend "
                              "its outline",
                              p->light_of[k], p->scene->regions[light->region].name, 100 * wrong,
                              100 * size.error, size.ratio < 1 ? "larger" : "smaller",
                              size.photographs));
        IGI_TRY(igi_doubt_say(ctx, m, sentence));
    }
    *off = all > 0 ? sum / all : 0;
    return IGI_OK;
}

static bool has_sky(const igi_scene *scene)
{
    for (size_t l = 0; l < scene->light_count; l++)
        if (scene->lights[l].type == IGI_LIGHT_ENV || scene->lights[l].type == IGI_LIGHT_AMBIENT)
            return true;
    return false;
}

igi_status igi_doubt_gaps(igi_context *ctx, const igi_problem *p, igi_materials *m, double *off)
{
    char *sentence;
    double gaps = p->observations->lit_gaps;
    *off = 0;
    if (has_sky(p->scene)) return IGI_OK;
    *off = gaps;
    if (gaps <= GAPS) return IGI_OK;
    IGI_TRY(igi_strprintf(ctx, &sentence,
                          "%.1f %% of the photographs' pixels show light where the mesh has a gap: "
                          "what comes from there is missing, and albedos come out too high; close "
                          "its cracks and holes, or give an env or ambient light for what is "
                          "outside",
                          100 * gaps));
    return igi_doubt_say(ctx, m, sentence);
}
