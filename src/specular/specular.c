/* SPDX-License-Identifier: Apache-2.0 */
#include "specular/specular.h"

#include "diffuse/methods.h"
#include "specular/correction.h"
#include "specular/lobe_rounds.h"

#include <math.h>

#define MIRRORED 0.01 /* what is mirrored is known no better (scripts/random_rooms) */
#define SHARP 0.03    /* a sharper lobe's light falls on few places, */
#define SHOWN 2.0     /* whose residuals show its error but for so many times */

static bool any_lobe(const igi_specular *s, size_t regions)
{
    for (size_t r = 0; r < regions; r++)
        if (s->lobes[r].model != IGI_LAMBERT) return true;
    return false;
}

static void set_total(const igi_problem *p, const igi_diffuse *d, const igi_correction *c,
                      float *total)
{
    size_t n = 2 * p->patches->count * (size_t)p->bands;
    for (size_t k = 0; k < n; k++) total[k] = d->radiance[k] + c->seen[k];
}

/* Search, correct, refine, correct: the corrections after the first change less than the noise. */
static igi_status run(igi_context *ctx, const igi_problem *p, igi_diffuse *diffuse, igi_specular *s,
                      float *total)
{
    igi_status status = IGI_OK;
    igi_radiance_field field = {p, diffuse->radiance, total, NULL};
    igi_lobe_round st = {&field, diffuse, NULL, s, {NULL, NULL, NULL}};
    IGI_TRY_GOTO(igi_candidates_create(ctx, p, &st.candidates));
    for (uint64_t round = 0; round < 2; round++) {
        igi_stage_begin(ctx, round == 0 ? "search lobes" : "refine lobes");
        set_total(p, diffuse, &s->correction, total);
        IGI_TRY_GOTO(igi_field_create(ctx, p, diffuse, &st.irradiance));
        IGI_TRY_GOTO(round == 0 ? igi_lobes_search(ctx, &st) : igi_lobes_refine(ctx, &st));
        bool none = round == 0 && !any_lobe(s, p->scene->region_count);
        if (none || round == 1) IGI_TRY_GOTO(igi_lobes_doubt(ctx, &st));
        if (none) {
            s->irradiance = st.irradiance; /* nothing will change it */
            st.irradiance = NULL;
            break;
        }
        igi_field_destroy(st.irradiance);
        st.irradiance = NULL;
        igi_stage_begin(ctx, "correct");
        field.lobes = s->lobes;
        IGI_TRY_GOTO(igi_correction_find(ctx, &field, diffuse, round, &s->correction));
        IGI_TRY_GOTO(igi_patches_solve(ctx, p, &s->correction, diffuse));
    }
cleanup:
    igi_candidates_clear(&st.candidates);
    igi_field_destroy(st.irradiance);
    return status;
}

/* Of an albedo whose residuals say `std`, what a lobe that was found leaves open with its share of the light
 * in a band: alpha moves its light about, rho_s says how much it is. */
static double lobe_std(const igi_lobe_estimate *e, int band, double share, double std)
{
    double known = igi_lobe_coefficient_std(e, band) / igi_lobe_coefficient(e, band);
    double off = share * fmin(1, hypot(known, MIRRORED));
    return e->alpha < SHARP ? fmin(off, SHOWN * std) : off;
}

/* Adds to the standard deviations of albedos what is not known of lobes: theirs where one was found, the
 * doubt elsewhere. Sides count as they do in the albedo. */
static igi_status widen_albedos(igi_context *ctx, const igi_problem *p, igi_diffuse *d,
                                const igi_specular *s)
{
    size_t regions = p->scene->region_count, bands = (size_t)p->bands;
    double(*lobe)[IGI_MAX_BANDS] = NULL, (*received)[IGI_MAX_BANDS] = NULL;
    igi_status status = IGI_OK;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions, &lobe));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions, &received));
    for (size_t i = 0; i < d->rows->seen_count; i++) {
        uint32_t side = d->rows->side[i];
        size_t r = igi_patch_region(p->patches, side >> 1);
        float direct[IGI_MAX_BANDS], indirect[IGI_MAX_BANDS];
        double area = (double)p->patches->area[side >> 1] * (double)s->correction.trust[side];
        igi_row_direct(d->rows, i, p->lights, p->bands, direct);
        igi_row_indirect(d->rows, i, d->radiance, p->bands, indirect);
        for (size_t b = 0; b < bands && igi_problem_seen_count(p, side) > 0; b++) {
            lobe[r][b] += area * IGI_PI * (double)s->correction.seen[side * bands + b];
            received[r][b] += area * ((double)direct[b] + (double)indirect[b]);
        }
    }
    for (size_t r = 0; r < regions; r++) {
        const igi_lobe_estimate *e = &s->estimates[r];
        double *std = d->albedo_std[r];
        bool found = s->lobes[r].model != IGI_LAMBERT && e->specular > 0;
        for (size_t b = 0; b < bands && received[r][b] > 0; b++)
            std[b] = hypot(std[b], found ? lobe_std(e, (int)b, lobe[r][b] / received[r][b], std[b])
                                         : s->doubts[r].share[b] * d->albedo[r][b]);
    }
cleanup:
    igi_free(lobe);
    igi_free(received);
    return status;
}

igi_status igi_specular_create(igi_context *ctx, const igi_problem *problem, igi_diffuse *diffuse,
                               igi_specular **specular)
{
    igi_status status = IGI_OK;
    igi_specular *s = NULL;
    float *total = NULL;
    size_t regions = problem->scene->region_count, sides = 2 * problem->patches->count;
    size_t bands = (size_t)problem->bands;
    *specular = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &s));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions, &s->estimates));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions, &s->doubts));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions, &s->evidence));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions, &s->lobes));
    IGI_TRY_GOTO(igi_correction_create(ctx, problem, diffuse->rows, &s->correction));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, sides * bands, &total));
    IGI_TRY_GOTO(run(ctx, problem, diffuse, s, total));
    IGI_TRY_GOTO(widen_albedos(ctx, problem, diffuse, s));
    *specular = s;
    s = NULL;
cleanup:
    igi_free(total);
    igi_specular_destroy(s);
    return status;
}

igi_lobe_view igi_specular_view(const igi_specular *specular, const igi_diffuse *diffuse)
{
    return (igi_lobe_view){diffuse->rows, specular->lobes, &specular->correction};
}

void igi_specular_destroy(igi_specular *specular)
{
    if (!specular) return;
    igi_field_destroy(specular->irradiance);
    igi_free(specular->estimates);
    igi_free(specular->doubts);
    igi_free(specular->evidence);
    igi_free(specular->lobes);
    igi_correction_clear(&specular->correction);
    igi_free(specular);
}
