/* SPDX-License-Identifier: Apache-2.0
 *
 * One shot: a few hundred points of each region gather light from what the photographs show, and
 * nothing is solved. What a ray meets is looked up on the patches; a side that no photograph shows
 * is given the mean of what the other rays of its row met. Cheaper than all patches, and biased
 * where much is unseen.
 */
#include "recover/methods.h"
#include "recover/region_sums.h"

#define POINTS_A_REGION 512
#define DEFAULT_RAYS 64

/* Marks about POINTS_A_REGION seen sides of each region, evenly through their order. */
static igi_status choose_sides(igi_context *ctx, const igi_problem *p, uint8_t *wanted)
{
    size_t regions = p->scene->region_count, sides = 2 * p->patches->count;
    size_t *seen, *met;
    IGI_TRY(IGI_ALLOC(ctx, 2 * regions, &seen));
    met = seen + regions;
    for (int pass = 0; pass < 2; pass++)
        for (uint32_t side = 0; side < sides; side++) {
            if (igi_problem_seen_count(p, side) == 0) continue;
            uint32_t r = igi_patch_region(p->patches, side >> 1);
            if (pass == 0) {
                seen[r]++;
                continue;
            }
            /* the k-th of n is taken when k * points / n passes a whole number */
            size_t k = met[r]++, n = seen[r] > POINTS_A_REGION ? seen[r] : POINTS_A_REGION;
            wanted[side] = (k + 1) * POINTS_A_REGION / n > k * POINTS_A_REGION / n;
        }
    igi_free(seen);
    return IGI_OK;
}

static void gather_row(const igi_problem *p, const igi_rows *rows, size_t row, float *irradiance)
{
    size_t bands = (size_t)p->bands;
    const uint32_t *hits = rows->hits + row * (size_t)rows->rays;
    float direct[IGI_MAX_BANDS];
    int unseen = 0;
    for (int k = 0; k < rows->rays; k++)
        unseen += hits[k] != IGI_NO_SIDE && igi_problem_seen_count(p, hits[k]) == 0;
    igi_row_indirect(rows, row, p->seen, p->bands, irradiance);
    igi_row_direct(rows, row, p->lights, p->bands, direct);
    float share = rows->rays > unseen ? (float)rows->rays / (float)(rows->rays - unseen) : 0;
    for (size_t b = 0; b < bands; b++) irradiance[b] = irradiance[b] * share + direct[b];
}

igi_status igi_method_gather(igi_context *ctx, const igi_problem *problem, igi_diffuse *diffuse)
{
    igi_status status = IGI_OK;
    igi_rows *rows = NULL;
    igi_region_sums *sums = NULL;
    igi_places places = {0};
    float *irradiance = NULL;
    uint8_t *wanted = NULL;
    size_t bands = (size_t)problem->bands;
    int rays = problem->options->rays ? problem->options->rays : DEFAULT_RAYS;
    igi_sites sites = igi_problem_sites(problem);
    igi_stage_begin(ctx, "gather");
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 2 * problem->patches->count, &wanted));
    IGI_TRY_GOTO(choose_sides(ctx, problem, wanted));
    igi_gather_options options = {
        .rays = rays, .light_points = rays > 3 ? rays / 3 : 1, .wanted = wanted};
    IGI_TRY_GOTO(igi_rows_create(ctx, problem->scene, problem->patches, problem->tracer,
                                 problem->lighting, &sites, &options, &rows));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, rows->count * bands, &irradiance));
    for (size_t i = 0; i < rows->count; i++) gather_row(problem, rows, i, irradiance + i * bands);
    IGI_TRY_GOTO(igi_places_create(ctx, problem, rows, irradiance, &places));
    IGI_TRY_GOTO(igi_region_sums_create(ctx, problem, &sums));
    (void)igi_region_sums_albedo(sums, &places, diffuse->albedo);
    IGI_TRY_GOTO(igi_region_sums_std(ctx, sums, &places, diffuse));
cleanup:
    igi_free(wanted);
    igi_free(irradiance);
    igi_places_clear(&places);
    igi_region_sums_destroy(sums);
    igi_rows_destroy(rows);
    return status;
}
