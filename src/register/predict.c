/* SPDX-License-Identifier: Apache-2.0
 *
 * Is it the camera that is off, or a piece of the mesh? If it is the camera, edges of some things
 * predict where those of the others are seen; a thing that was moved predicts nothing. The edges of
 * each region in turn are left out of the fit and predicted by it. The distance of a site is told by the
 * others where their prediction's standard deviation is well below what the prior leaves.
 */
#include "base/context.h"
#include "register/lines.h"

#include <math.h>

#define FEWEST 5 /* sites of a region that is left out */
#define TOLD .5  /* standard deviation of a prediction, of what is expected */

static bool is_told(const edge_lines *f, const edge_line *l, const motion *p)
{
    double variance = 0;
    for (int a = 0; a < MOTION_NUMBERS; a++)
        for (int b = 0; b < MOTION_NUMBERS; b++)
            variance += l->jacobian[a] * l->jacobian[b] * p->covariance[MOTION_NUMBERS * a + b];
    return variance < TOLD * TOLD * f->expected_px * f->expected_px;
}

igi_status pose_predict(igi_context *ctx, const igi_edge_sites *sites, const igi_camera *before,
                        double spread, double expected_px, pose_prediction *prediction)
{
    igi_status status = IGI_OK;
    motion all, others;
    uint32_t highest = 0;
    size_t *counts = NULL;
    edge_lines f = {.as_one = fmax(1, IGI_SITES_AS_ONE * before->height),
                    .expected_px = expected_px};
    *prediction = (pose_prediction){0};
    for (size_t i = 0; i < sites->count; i++)
        if (sites->sites[i].region > highest) highest = sites->sites[i].region;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, sites->count, &f.lines));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, highest + 1, &counts));
    if (!lines_of_camera(sites, before, fmax(1, spread), &f) || !lines_solve(&f, NO_REGION, &all))
        goto cleanup;
    for (size_t i = 0; i < f.count; i++) counts[f.lines[i].region]++;
    for (uint32_t r = 0; r <= highest; r++) {
        if (counts[r] < FEWEST || f.count - counts[r] < FEWEST || !lines_solve(&f, r, &others))
            continue;
        for (size_t i = 0; i < f.count; i++) {
            const edge_line *l = &f.lines[i];
            if (l->region != r) continue;
            double gain = line_gain(l, others.x) / f.as_one, most = line_gain(l, all.x) / f.as_one;
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
