/* SPDX-License-Identifier: Apache-2.0
 *
 * No interreflection: rho = pi sum w L / sum w E with E from the lamps alone. What is done where
 * global illumination is ignored; everything that light has reached over other surfaces comes out
 * as albedo.
 */
#include "diffuse/methods.h"
#include "diffuse/region_sums.h"

#define LIGHT_POINTS 8

igi_status igi_method_direct(igi_context *ctx, const igi_problem *problem, igi_diffuse *diffuse)
{
    igi_status status = IGI_OK;
    igi_rows *rows = NULL;
    float *irradiance = NULL;
    size_t bands = (size_t)problem->bands;
    igi_gather_options options = {.rays = 0, .light_points = LIGHT_POINTS};
    igi_sites sites = igi_problem_sites(problem);
    igi_stage_begin(ctx, "gather");
    IGI_TRY_GOTO(igi_rows_create(ctx, problem->scene, problem->patches, problem->tracer,
                                 problem->lighting, &sites, &options, &rows));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, rows->count * bands, &irradiance));
    for (size_t i = 0; i < rows->count; i++)
        igi_row_direct(rows, i, problem->lights, problem->bands, irradiance + i * bands);
    IGI_TRY_GOTO(igi_albedo_of_rows(ctx, problem, rows, irradiance, diffuse));
    diffuse->ignores_indirect = true;
cleanup:
    igi_free(irradiance);
    igi_rows_destroy(rows);
    return status;
}
