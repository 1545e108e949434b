/* SPDX-License-Identifier: Apache-2.0
 *
 * Is it the camera that is off, or a piece of the mesh? If it is the camera, edges of some things
 * predict where those of the others are seen; a thing that was moved predicts nothing. The edges of
 * each region in turn are left out of the fit and predicted by it. About the given camera, distances
 * are linear in the change of the pose:
 *     d_i(x) = d_i(0) + J_i x,
 * and a pose is a robust least-squares solution with a prior on x. The distance of a site is told by the
 * others where their prediction's standard deviation is well below what the prior leaves.
 */
#include "base/context.h"
#include "base/solve.h"
#include "register/register_private.h"

#include <math.h>
#include <string.h>

#define NUMBERS 6
#define FEWEST 5 /* sites of a region that is left out */
#define HUBER 2.0
#define CUT 3.5
#define ROUNDS 4
#define STEP_PX 1e-2
#define TOLD .5 /* standard deviation of a prediction, of what is expected */
#define NO_REGION UINT32_MAX

typedef struct line {
    double d, jacobian[NUMBERS], weight; /* of a site */
    uint32_t region;
} line;

typedef struct fit {
    line *lines;
    size_t count;
    double unit;   /* weighted distance that is usual */
    double as_one; /* so many sites count as one */
    double expected_px;
} fit;

static bool linearise(const igi_edge_sites *sites, const igi_camera *camera, fit *f)
{
    igi_camera ends[2 * NUMBERS];
    pose_units units;
    if (!pose_units_of(sites, camera, &units)) return false;
    for (int k = 0; k < 2 * NUMBERS; k++) {
        double change[NUMBERS] = {0};
        change[k / 2] = k & 1 ? STEP_PX : -STEP_PX;
        pose_change(camera, &units, change, &ends[k]);
    }
    for (size_t i = 0; i < sites->count; i++) {
        const igi_edge_site *s = &sites->sites[i];
        line *l = &f->lines[f->count];
        l->d = pose_distance(s, camera);
        bool finite = isfinite(l->d);
        for (int k = 0; k < NUMBERS; k++) {
            l->jacobian[k] = (pose_distance(s, &ends[2 * k + 1]) - pose_distance(s, &ends[2 * k])) /
                             (2 * STEP_PX);
            finite = finite && isfinite(l->jacobian[k]);
        }
        l->weight = 1 / (hypot(s->sigma, IGI_SITE_ERROR) * f->unit);
        l->region = s->region;
        f->count += finite;
    }
    return f->count > 0;
}

static double distance_after(const line *l, const double *x)
{
    double d = l->d;
    for (int k = 0; k < NUMBERS; k++) d += l->jacobian[k] * x[k];
    return d * l->weight;
}

typedef struct pose {
    double x[NUMBERS], covariance[NUMBERS * NUMBERS];
} pose;

/* From all sites but those of a region. */
static bool solve_without(const fit *f, uint32_t region, pose *p)
{
    *p = (pose){0};
    for (int round = 0; round < ROUNDS; round++) {
        double m[NUMBERS * NUMBERS] = {0}, v[(1 + NUMBERS) * NUMBERS] = {0};
        for (int k = 0; k < NUMBERS; k++) {
            m[NUMBERS * k + k] = f->as_one / (f->expected_px * f->expected_px);
            v[NUMBERS * (1 + k) + k] = f->as_one;
        }
        for (size_t i = 0; i < f->count; i++) {
            const line *l = &f->lines[i];
            if (l->region == region) continue;
            double off = fabs(distance_after(l, p->x)), w = l->weight * l->weight;
            if (round > 0 && off > HUBER) w *= HUBER / off;
            for (int a = 0; a < NUMBERS; a++) {
                for (int b = 0; b <= a; b++)
                    m[NUMBERS * a + b] += w * l->jacobian[a] * l->jacobian[b];
                v[a] -= w * l->jacobian[a] * l->d;
            }
        }
        if (!igi_solve_cholesky(m, NUMBERS, v, 1 + NUMBERS)) return false;
        memcpy(p->x, v, sizeof p->x);
        memcpy(p->covariance, v + NUMBERS, sizeof p->covariance);
    }
    return true;
}

static bool is_told(const fit *f, const line *l, const pose *p)
{
    double variance = 0;
    for (int a = 0; a < NUMBERS; a++)
        for (int b = 0; b < NUMBERS; b++)
            variance += l->jacobian[a] * l->jacobian[b] * p->covariance[NUMBERS * a + b];
    return variance < TOLD * TOLD * f->expected_px * f->expected_px;
}

static double gain_of(const line *l, const double x[NUMBERS])
{
    const double none[NUMBERS] = {0};
    double before = fmin(fabs(distance_after(l, none)), CUT);
    double after = fmin(fabs(distance_after(l, x)), CUT);
    return before * before - after * after;
}

igi_status pose_predict(igi_context *ctx, const igi_edge_sites *sites, const igi_camera *before,
                        double spread, double expected_px, pose_prediction *prediction)
{
    igi_status status = IGI_OK;
    pose all, others;
    uint32_t highest = 0;
    size_t *counts = NULL;
    fit f = {.unit = fmax(1, spread),
             .as_one = fmax(1, IGI_SITES_AS_ONE * before->height),
             .expected_px = expected_px};
    *prediction = (pose_prediction){0};
    for (size_t i = 0; i < sites->count; i++)
        if (sites->sites[i].region > highest) highest = sites->sites[i].region;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, sites->count, &f.lines));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, highest + 1, &counts));
    if (!linearise(sites, before, &f) || !solve_without(&f, NO_REGION, &all)) goto cleanup;
    for (size_t i = 0; i < f.count; i++) counts[f.lines[i].region]++;
    for (uint32_t r = 0; r <= highest; r++) {
        if (counts[r] < FEWEST || f.count - counts[r] < FEWEST || !solve_without(&f, r, &others))
            continue;
        for (size_t i = 0; i < f.count; i++) {
            const line *l = &f.lines[i];
            if (l->region != r) continue;
            double gain = gain_of(l, others.x) / f.as_one, most = gain_of(l, all.x) / f.as_one;
            prediction->gain += gain;
            prediction->most += most;
            if (!is_told(&f, l, &others)) continue;
            prediction->told_gain += gain;
            prediction->told_most += most;
        }
    }
cleanup:
    igi_free(f.lines);
    igi_free(counts);
    return status;
}
