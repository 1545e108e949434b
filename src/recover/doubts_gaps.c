/* SPDX-License-Identifier: Apache-2.0
 *
 * Light goes where the mesh has gaps, and none is gathered from there.
 */
#include "recover/doubt.h"

#define GAPS 0.002 /* of the photographs' pixels */

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
