/* SPDX-License-Identifier: Apache-2.0
 *
 * Every patch gathers from every other; unseen ones are solved.
 *
 * For row i (a side of a patch) with rays k = 1..K, per band,
 *     E_i = sum_l G_il value_l + (pi / K) sum_k L(hit_ik)
 * where L of a seen side is what the photographs show. The albedo of region r is the ratio
 *     rho_r = pi sum_i a_i L_i / sum_i a_i E_i        over the seen sides i of r, a_i their areas:
 * a ratio of sums, not a mean of ratios, because E_i is noisy and its reciprocal would be biased;
 * and not least squares, because noise in the regressor E_i biases those low (errors in variables).
 * L of an unseen side is rho_r E_i / pi. Sweeps over both until they settle: the fixed point of
 * (I - rho F) b = e restricted to the unseen, which contracts by rho times the unseen share.
 *
 * Lights whose value nobody knows are solved for in each sweep: see powers.h.
 *
 * Uncertainty: the residuals d_i = pi L_i - rho E_i hold the noise of photographs and of sampling
 * alike. Neighbours share errors (a shadow edge, a bright hit), so residuals are summed over cells
 * of a coarse grid before they are squared (a cluster-robust sandwich; White 1980, Liang & Zeger
 * 1986).
 */
#include "diffuse/methods.h"

#include "diffuse/positions.h"
#include "diffuse/powers.h"
#include "diffuse/region_sums.h"

#include <float.h>

#define DEFAULT_RAYS 64
#define FEWEST_RAYS 8
#define RAYS_TIMES_ERROR 0.16 /* what usually suffices */
#define STUCK 0.9             /* of the stated error with half the rays: more would not help */
#define HOPELESS 10 /* so many times the target after the first rays: it is not for want of rays */
#define SKY_POINTS 4
#define MOST_RAYS 1024
#define REGION_FOLD 256  /* rays of a small region's rows together, in units of one row's */
#define DARK_ALBEDO 0.02 /* errors of darker surfaces are judged as if they were this bright */
#define MAX_SWEEPS 200
/* Relative change of the unseen radiances at which the sweeps end. The albedos settle far sooner:
 * by then they change by less than a millionth. */
#define SETTLED 1e-3
#define ALBEDO_COUNTS 1000
#define FAINT 1e-3 /* of the mean radiance */

typedef struct solver {
    const igi_problem *problem;
    const igi_rows *rows;
    size_t bands;
    float *radiance;   /* [2 patches][bands] of every side; seen ones stay as they are */
    float *direct;     /* [rows][bands] irradiance by the lights */
    float *irradiance; /* [rows][bands] */
    igi_places places; /* of the seen rows */
    double (*albedo)[IGI_MAX_BANDS];
    igi_powers *powers; /* of lights whose value is solved for; NULL: none is */
    const igi_correction *correction;
    double faint; /* radiance beside which changes of unseen sides are judged */
} solver;

static void gather_row(const solver *s, size_t row)
{
    float *irradiance = s->irradiance + row * s->bands;
    igi_row_indirect(s->rows, row, s->radiance, (int)s->bands, irradiance);
    for (size_t b = 0; b < s->bands; b++) irradiance[b] += s->direct[row * s->bands + b];
}

/* Radiance of an unseen side from what it gathers; its relative change. */
static double update_unseen(const solver *s, size_t row)
{
    uint32_t side = s->rows->side[row];
    const double *albedo = s->albedo[igi_patch_region(s->problem->patches, side >> 1)];
    double change = 0;
    for (size_t b = 0; b < s->bands; b++) {
        float *radiance = &s->radiance[side * s->bands + b];
        float updated = (float)(albedo[b] / IGI_PI) * s->irradiance[row * s->bands + b];
        change = fmax(change, fabs((double)(updated - *radiance)) / (s->faint + (double)updated));
        *radiance = updated;
    }
    return change;
}

/* Irradiance of the lamps and the lobes. */
static void fill_direct(const solver *s)
{
    for (size_t i = 0; i < s->rows->count; i++) {
        float *direct = s->direct + i * s->bands;
        igi_row_direct(s->rows, i, s->problem->lights, (int)s->bands, direct);
        for (size_t b = 0; s->correction && b < s->bands; b++)
            direct[b] += s->correction->received[i * s->bands + b];
    }
}

/* The lights' values for what the rows gathered; relative change, times ALBEDO_COUNTS. */
static double solve_powers(const solver *s)
{
    if (!s->powers) return 0;
    double change = igi_powers_step(s->powers, &s->places) * ALBEDO_COUNTS;
    for (size_t i = 0; i < s->rows->seen_count * s->bands; i++) s->irradiance[i] -= s->direct[i];
    fill_direct(s);
    for (size_t i = 0; i < s->rows->seen_count * s->bands; i++) s->irradiance[i] += s->direct[i];
    return change;
}

/* One sweep of Gauss and Seidel; the largest relative change of a radiance, or ALBEDO_COUNTS times
 * that of an albedo. */
static double sweep(const solver *s, igi_region_sums *sums)
{
    const igi_rows *r = s->rows;
    for (size_t i = 0; i < r->seen_count; i++) gather_row(s, i);
    double change = solve_powers(s);
    change = fmax(change, igi_region_sums_albedo(sums, &s->places, s->albedo) * ALBEDO_COUNTS);
    for (size_t i = r->seen_count; i < r->count; i++) {
        gather_row(s, i);
        change = fmax(change, update_unseen(s, i));
    }
    return change;
}

/* What was seen, less the lobes' part of it. */
static void fill_seen(solver *s)
{
    double sum = 0, values = (double)(s->rows->seen_count * s->bands);
    for (size_t i = 0; i < s->rows->seen_count; i++) {
        uint32_t side = s->rows->side[i];
        if (s->correction) s->places.weight[i] *= s->correction->trust[side];
        for (size_t b = 0; b < s->bands; b++) {
            size_t k = side * s->bands + b;
            s->radiance[k] = s->problem->seen[k] - (s->correction ? s->correction->seen[k] : 0);
            s->places.radiance[i * s->bands + b] = s->radiance[k];
            sum += (double)s->problem->seen[k];
        }
    }
    s->faint = FAINT * fmax(sum / fmax(values, 1), DBL_MIN);
}

/* By how much irradiance is off where all guesses are, by one standard deviation, together: of each
 * unseen side of a region that nothing determines. false: there is no such side. */
static bool fill_guessed(const solver *s, const igi_diffuse *d, float *guessed)
{
    bool any = false;
    for (size_t i = s->rows->seen_count; i < s->rows->count; i++) {
        uint32_t side = s->rows->side[i], region = igi_patch_region(s->problem->patches, side >> 1);
        if (d->determined[region]) continue;
        for (size_t b = 0; b < s->bands; b++)
            guessed[side * s->bands + b] = (float)(d->albedo_std[region][b] / IGI_PI) *
                                           s->irradiance[i * s->bands + b];
        any = true;
    }
    return any;
}

/* What no photograph shows sends light of which nobody knows how much; it is the same for all places
 * of a region, so their residuals do not tell. */
static igi_status widen_by_guesses(igi_context *ctx, const solver *s, igi_diffuse *d)
{
    igi_status status = IGI_OK;
    size_t bands = s->bands, regions = s->problem->scene->region_count;
    float *guessed = NULL, off[IGI_MAX_BANDS];
    double(*sums)[IGI_MAX_BANDS][2] = NULL; /* [regions] light off, light received */
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 2 * s->problem->patches->count * bands, &guessed));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions, &sums));
    if (!fill_guessed(s, d, guessed)) goto cleanup;
    for (size_t i = 0; i < s->places.count; i++) {
        igi_row_indirect(s->rows, i, guessed, (int)bands, off);
        for (size_t b = 0; b < bands; b++) {
            double *sum = sums[s->places.region[i]][b], weight = (double)s->places.weight[i];
            sum[0] += weight * (double)off[b];
            sum[1] += weight * (double)s->irradiance[i * bands + b];
        }
    }
    for (size_t r = 0; r < regions; r++)
        for (size_t b = 0; b < bands && d->determined[r]; b++)
            d->albedo_std[r][b] = hypot(d->albedo_std[r][b], d->albedo[r][b] * sums[r][b][0] /
                                                                 fmax(sums[r][b][1], 1e-30));
cleanup:
    igi_free(guessed);
    igi_free(sums);
    return status;
}

igi_status igi_patches_solve(igi_context *ctx, const igi_problem *problem,
                             const igi_correction *correction, igi_diffuse *diffuse)
{
    igi_status status = IGI_OK;
    igi_region_sums *sums = NULL;
    solver s = {.problem = problem,
                .rows = diffuse->rows,
                .bands = (size_t)problem->bands,
                .radiance = diffuse->radiance,
                .albedo = diffuse->albedo,
                .correction = correction};
    IGI_TRY_GOTO(IGI_ALLOC(ctx, s.rows->count * s.bands, &s.direct));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, s.rows->count * s.bands, &s.irradiance));
    IGI_TRY_GOTO(igi_places_create(ctx, problem, s.rows, s.irradiance, &s.places));
    if (igi_powers_are_wanted(problem)) igi_places_weigh_by_pixels(problem, s.rows, &s.places);
    diffuse->received = correction ? correction->received : NULL;
    fill_direct(&s);
    fill_seen(&s);
    IGI_TRY_GOTO(igi_region_sums_create(ctx, problem, &sums));
    IGI_TRY_GOTO(igi_powers_create(ctx, problem, s.rows, &s.places, &s.powers));
    for (int i = 0; i < MAX_SWEEPS; i++)
        if (sweep(&s, sums) < SETTLED) break;
    IGI_TRY_GOTO(igi_region_sums_std(ctx, sums, &s.places, diffuse));
    igi_region_sums_share(problem, diffuse);
    IGI_TRY_GOTO(widen_by_guesses(ctx, &s, diffuse));
    IGI_TRY_GOTO(igi_powers_finish(ctx, s.powers, &s.places, diffuse));
    igi_positions_widen(problem->positions, problem, diffuse);
cleanup:
    igi_free(s.direct);
    igi_free(s.irradiance);
    igi_places_clear(&s.places);
    igi_region_sums_destroy(sums);
    igi_powers_destroy(s.powers);
    return status;
}

/* More for environments: sun and sky are found by samples alone, without a closed form. */
static int light_points(const igi_problem *problem, int rays)
{
    int points = rays > 4 ? rays / 5 : 1;
    for (size_t l = 0; l < problem->light_count; l++)
        if (problem->lights[l].type == IGI_LIGHT_ENV) return points * SKY_POINTS;
    return points;
}

static igi_status gather_and_solve(igi_context *ctx, const igi_problem *problem, int rays,
                                   igi_diffuse *diffuse)
{
    igi_gather_options options = {.rays = rays,
                                  .light_points = light_points(problem, rays),
                                  .region_rays = REGION_FOLD * rays};
    igi_sites sites = igi_problem_sites(problem);
    igi_rows_destroy(diffuse->rows);
    diffuse->rows = NULL;
    igi_stage_begin(ctx, "gather");
    IGI_TRY(igi_rows_create(ctx, problem->scene, problem->patches, problem->tracer,
                            problem->lighting, &sites, &options, &diffuse->rows));
    igi_stage_begin(ctx, "solve");
    return igi_patches_solve(ctx, problem, NULL, diffuse);
}

double igi_stated_error(const igi_problem *p, const igi_diffuse *d)
{
    double sum = 0, n = 0;
    for (size_t r = 0; r < p->scene->region_count; r++)
        for (int b = 0; b < p->bands && d->determined[r]; b++) {
            sum += d->albedo_std[r][b] / fmax(d->albedo[r][b], DARK_ALBEDO);
            n++;
        }
    return n > 0 ? sum / n : 0;
}

/* Where doubling begins. */
static int first_rays(double target_error)
{
    int rays = FEWEST_RAYS;
    while (target_error > 0 && rays < DEFAULT_RAYS && rays * target_error < RAYS_TIMES_ERROR)
        rays *= 2;
    return rays;
}

int igi_patches_rays(double target_error)
{
    return 2 * first_rays(target_error);
}

/* Without a target or a budget: once, with the default rays. With them: rays are doubled from few
 * until the stated error is below the target, or no longer falls, or the next doubling would not
 * fit into the budget. */
igi_status igi_method_patches(igi_context *ctx, const igi_problem *problem, igi_diffuse *diffuse)
{
    const igi_recover_options *o = problem->options;
    bool adapts = o->rays == 0 && (o->target_error > 0 || o->time_budget_s > 0);
    int rays = o->rays ? o->rays : adapts ? first_rays(o->target_error) : DEFAULT_RAYS;
    for (double error = HUGE_VAL, last;; rays *= 2) {
        double before = igi_cpu_seconds();
        IGI_TRY(gather_and_solve(ctx, problem, rays, diffuse));
        if (!adapts || 2 * rays > MOST_RAYS) return IGI_OK;
        last = error;
        error = igi_stated_error(problem, diffuse);
        bool stuck = error > STUCK * last || error > HOPELESS * o->target_error;
        if (o->target_error > 0 && (error <= o->target_error || stuck)) return IGI_OK;
        double next = 2 * (igi_cpu_seconds() - before);
        if (o->time_budget_s > 0 && igi_cpu_seconds() + next > o->time_budget_s) return IGI_OK;
    }
}
