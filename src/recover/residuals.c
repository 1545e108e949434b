/* SPDX-License-Identifier: Apache-2.0
 *
 * Each side i of a patch has an albedo of its own, a_i = pi (L_i - S_i) / E_i: what left it, less the
 * lobe's part, over what reached it; bands together, each by its region's albedo, or the colour of the
 * light would pass for a trend.
 */
#include "recover/residuals.h"

#include "base/order.h"
#include "specular/lobe_view.h"

double igi_residual_albedo(const igi_problem *p, const igi_field *field, const igi_materials *m,
                           uint32_t side)
{
    float irradiance[IGI_MAX_BANDS];
    size_t at = (size_t)side * (size_t)p->bands;
    const double *albedo = m->materials[igi_patch_region(p->patches, side >> 1)].albedo;
    if (igi_problem_seen_count(p, side) == 0 || !igi_field_of_side(field, side, irradiance))
        return -1;
    double returned = 0, mean = 0, left = igi_mean(p->seen + at, (size_t)p->bands);
    for (int b = 0; b < p->bands; b++) {
        returned += albedo[b] * (double)irradiance[b] / p->bands;
        mean += albedo[b] / p->bands;
    }
    if (p->lobes) left -= igi_mean(p->lobes->correction->seen + at, (size_t)p->bands);
    return returned > 0 ? fmax(0, mean * IGI_PI * left / returned) : -1;
}

igi_status igi_residuals_create(igi_context *ctx, const igi_problem *problem,
                                const igi_field *field, const igi_materials *materials,
                                const bool *diffuse, igi_residuals **residuals)
{
    igi_status status = IGI_OK;
    igi_residuals *r = NULL;
    *residuals = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &r));
    r->region_count = problem->scene->region_count;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, r->region_count, &r->regions));
    IGI_TRY_GOTO(igi_residuals_find_trends(ctx, problem, field, materials, r));
    IGI_TRY_GOTO(igi_residuals_compare_views(ctx, problem, diffuse, r));
    *residuals = r;
    r = NULL;
cleanup:
    igi_residuals_destroy(r);
    return status;
}

void igi_residuals_destroy(igi_residuals *residuals)
{
    if (!residuals) return;
    igi_free(residuals->regions);
    igi_free(residuals);
}
