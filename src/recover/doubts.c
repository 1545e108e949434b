/* SPDX-License-Identifier: Apache-2.0
 *
 * Sentences for what the residuals say, and wider error bars for what they leave open: a common
 * error e of the photographs against the lamps (their exposures, vignetting, the lamps' stated
 * power) moves an albedo rho by about (1 - rho) e, since light between surfaces is measured with it.
 */
#include "recover/doubts.h"

#include "recover/doubt.h"
#include "recover/residuals.h"

#include "base/order.h"

#include <stdlib.h>

/* Limits: several times what rooms show where nothing is wrong (igi chart stability). */
#define MOST_ALBEDO 1.0
#define TREND 0.03
#define FEWEST_REGIONS 3 /* that tell of one */
#define USUAL_TREND 0.005
#define VIEWS_DIFFER 0.006
#define VIEWS_DIFFER_TIMES 3.0 /* what the calmest regions have */
/* A lobe that was missed adds to the mean so many times what photographs differ by: of measured
 * materials in random rooms 3 to 5, more where it is broad (scripts/random_rooms). */
#define SHINES 4.0
#define VIGNETTING 0.008
#define GLARE 0.0015
#define DRIFT 0.01
#define CAMERA_SIGMAS 6.0
#define CORNER_MEAN (1 / 3.0) /* of r^2 over a picture */
#define FEWEST_SIDES 12

/* The lesser of two medians over the calm regions, of their surface and of their number: light that is
 * wrong shows on most of both, and a lobe that was missed looks like a trend, too. `pairs` is scratch. */
static double typical_trend(const igi_residuals *r, double (*pairs)[2])
{
    size_t n = 0;
    for (size_t i = 0; i < r->region_count; i++) {
        if (r->regions[i].sides < FEWEST_SIDES || !r->regions[i].calm) continue;
        pairs[n][0] = r->regions[i].trend;
        pairs[n++][1] = r->regions[i].sides;
    }
    if (n < FEWEST_REGIONS) return 0;
    double of_surface = igi_weighted_median(pairs, n); /* which sorts */
    return fmin(of_surface, pairs[(n - 1) / 2][0]);
}

static igi_status doubt_lights(igi_context *ctx, double trend, igi_materials *m)
{
    char *sentence;
    if (trend < TREND) return IGI_OK;
    IGI_TRY(igi_strprintf(ctx, &sentence,
                          "the lights do not explain the photographs: over a typical surface the "
                          "light received is off by %.0f %% from end to end; check the lights' "
                          "places, kinds and powers, and that none is missing (or a "
                          "surface shines, and no lobe was found)",
                          fmax(1, 200 * trend)));
    return igi_doubt_say(ctx, m, sentence);
}

static igi_status doubt_camera(igi_context *ctx, const igi_residuals *r, igi_materials *m)
{
    char *sentence;
    if (fabs(r->vignetting) > fmax(VIGNETTING, CAMERA_SIGMAS * r->vignetting_error)) {
        IGI_TRY(igi_strprintf(ctx, &sentence,
                              "the photographs are %.1f %% %s toward their corners: vignetting was "
                              "left in, or taken out twice; igi calibrate --overlap, then igi "
                              "correct",
                              100 * fabs(r->vignetting),
                              r->vignetting > 0 ? "darker" : "brighter"));
        IGI_TRY(igi_doubt_say(ctx, m, sentence));
    }
    if (r->drift > DRIFT) {
        IGI_TRY(
            igi_strprintf(ctx, &sentence,
                          "the photographs' exposures still differ by %.1f %%; lock exposure and "
                          "white balance, or merge brackets again",
                          100 * r->drift));
        IGI_TRY(igi_doubt_say(ctx, m, sentence));
    }
    if (!(r->glare > fmax(GLARE, CAMERA_SIGMAS * r->glare_error))) return IGI_OK;
    IGI_TRY(igi_strprintf(ctx, &sentence,
                          "%.1f %% of the light strays over the photographs (glare): dark places "
                          "are brighter where the picture is; shade the lens from the lamps",
                          100 * r->glare));
    return igi_doubt_say(ctx, m, sentence);
}

static igi_status warn(igi_context *ctx, igi_material *region, char *sentence)
{
    return igi_add_sentence(ctx, &region->warnings, &region->warning_count, sentence);
}

static igi_status doubt_region(igi_context *ctx, const igi_region_residual *r, double usual,
                               int bands, igi_material *region)
{
    char *sentence;
    double most = 0, std = 0;
    for (int b = 0; b < bands; b++)
        if (region->albedo[b] > most) {
            most = region->albedo[b];
            std = region->albedo_std[b];
        }
    if (most > MOST_ALBEDO + 2 * std) {
        IGI_TRY(
            igi_strprintf(ctx, &sentence,
                          "it reflects %.3g times the light that reaches it: a light is missing "
                          "or too weak, or photographs and lights differ in unit",
                          most));
        IGI_TRY(warn(ctx, region, sentence));
    }
    if (region->model != IGI_LAMBERT ||
        !(r->differ > hypot(fmax(VIEWS_DIFFER, VIEWS_DIFFER_TIMES * usual), r->by_chance)))
        return IGI_OK;
    IGI_TRY(
        igi_strprintf(ctx, &sentence,
                      "photographs of the same places differ by %.1f %%, more than of a diffuse "
                      "surface: it shines, but no lobe could be fitted, or something moved; "
                      "its albedo may be too high",
                      100 * r->differ));
    return warn(ctx, region, sentence);
}

/* What photographs of a region disagree about, beyond what they do anywhere, is the sign of a lobe that
 * was missed; of a region with a lobe, the fit has seen to that. */
static double misfit_of(const igi_region_residual *r, double usual, const igi_material *m)
{
    if (m->model != IGI_LAMBERT) return 0;
    double noise = usual * usual + r->by_chance * r->by_chance;
    return hypot(r->mean_error, SHINES * sqrt(fmax(0, r->differ * r->differ - noise)));
}

/* By what is wrong with the region itself, by what all photographs may share, and by light that is
 * missing or too much there. */
static void widen(double own, double common, double alone, int bands, igi_material *m)
{
    for (int b = 0; b < bands; b++) {
        double rho = m->albedo[b], shared = common * fmax(0, 1 - rho);
        double all = hypot(hypot(own, shared), alone);
        m->albedo_std[b] = hypot(m->albedo_std[b], rho * all);
    }
}

igi_status igi_doubts_add(igi_context *ctx, const igi_problem *p, const igi_field *field,
                          igi_materials *m)
{
    igi_status status = IGI_OK;
    igi_residuals *r = NULL;
    igi_light_shares *survey = NULL;
    double(*pairs)[2] = NULL, lamps_off = 0, outlines_off = 0, gaps = 0;
    double *powers_off = NULL;
    bool *diffuse = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, m->count, &pairs));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, m->count, &powers_off));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, m->count, &diffuse));
    for (size_t i = 0; i < m->count; i++)
        diffuse[i] = !m->materials[i].emitter && m->materials[i].model == IGI_LAMBERT;
    IGI_TRY_GOTO(igi_residuals_create(ctx, p, field, m, diffuse, &r));
    IGI_TRY_GOTO(igi_doubt_method(ctx, p, m));
    IGI_TRY_GOTO(igi_doubt_lamps(ctx, p, m, &lamps_off));
    IGI_TRY_GOTO(igi_doubt_profiles(ctx, p, m));
    for (size_t i = 0; i < m->count; i++) diffuse[i] = r->regions[i].calm; /* no lobe was missed */
    if (!(p->options->target_error > 0))
        IGI_TRY_GOTO(igi_light_shares_create(ctx, p, field, m, diffuse, &survey));
    if (survey) IGI_TRY_GOTO(igi_doubt_powers(ctx, survey, m, powers_off));
    if (survey) IGI_TRY_GOTO(igi_doubt_missing(ctx, survey, m, powers_off));
    if (survey) IGI_TRY_GOTO(igi_doubt_shape(ctx, survey, m, powers_off));
    IGI_TRY_GOTO(igi_doubt_outlines(ctx, p, m, &outlines_off));
    IGI_TRY_GOTO(igi_doubt_gaps(ctx, p, m, &gaps));
    IGI_TRY_GOTO(doubt_camera(ctx, r, m));
    double trend = typical_trend(r, pairs);
    IGI_TRY_GOTO(doubt_lights(ctx, trend, m));
    double drift = r->drift / sqrt(fmax(1, (double)p->observations->frame_count));
    double unexplained = sqrt(fmax(0, trend * trend - USUAL_TREND * USUAL_TREND));
    double lamps = hypot(lamps_off, outlines_off);
    /* Of lamps it is common to all surfaces; of a surface it is its own, as bright as it is. */
    double response = p->observations->response_deviation;
    double corners = igi_doubt_sure(r->vignetting, r->vignetting_error);
    double camera = hypot(hypot(drift, CORNER_MEAN * corners), response);
    double common = hypot(hypot(lamps, unexplained), camera);
    for (size_t i = 0; i < m->count; i++) {
        igi_material *region = &m->materials[i];
        if (region->emitter || !region->determined) continue;
        double own = hypot(misfit_of(&r->regions[i], r->usual_differ, region), response);
        widen(own, common, hypot(gaps, powers_off[i]), p->bands, region);
        IGI_TRY_GOTO(doubt_region(ctx, &r->regions[i], r->usual_differ, p->bands, region));
    }
cleanup:
    igi_residuals_destroy(r);
    igi_light_shares_destroy(survey);
    igi_free(pairs);
    igi_free(diffuse);
    igi_free(powers_off);
    return status;
}
