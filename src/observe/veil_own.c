/* SPDX-License-Identifier: Apache-2.0
 *
 * The share that one photograph has more than the others, as of a lamp that shines into its lens. Of
 * places with the mean B_p over all their photographs, and B_p' over the others,
 *     (B_pf - B_p') / B_p = g B_p' / B_p + s M_f / B_p,
 * g for its exposure, which nobody knows to a per cent: surfaces of different brightness tell the two
 * apart. (Residuals over the mean of all: over B_p' alone, places whose others
 * are dark by chance would weigh most, and pass for a veil.)
 *
 * A dark surface that shines toward this camera looks like a veil on that surface. A veil spares none:
 * each region has one voice, of which its places' scatter is the error, and regions are left out in turn.
 */
#include "observe/glare.h"

#include <math.h>

#define FEWEST_FRAMES 3
#define FEWEST_PLACES 5 /* of a region, to have a voice */
#define FEWEST_VOICES 4 /* two numbers, and one to spare when a region is left out */
#define ROUNDS 4
#define LEAST_SCATTER .01 /* of a region's places */

typedef struct normal {
    double count, gg, gx, xx, gy, xy, yy; /* sums of weights, and of products */
} normal;

static void add(normal *to, const normal *n, double weight)
{
    to->count += weight * n->count;
    to->gg += weight * n->gg;
    to->gx += weight * n->gx;
    to->xx += weight * n->xx;
    to->gy += weight * n->gy;
    to->xy += weight * n->xy;
    to->yy += weight * n->yy;
}

/* g and s; false where they cannot be told apart. */
static bool solve(const normal *n, double line[2])
{
    double determinant = n->gg * n->xx - n->gx * n->gx;
    if (!(determinant > 1e-3 * n->gg * n->xx)) return false;
    line[0] = (n->xx * n->gy - n->gx * n->xy) / determinant;
    line[1] = (n->gg * n->xy - n->gx * n->gy) / determinant;
    return true;
}

static double mean_square(const normal *n, const double line[2])
{
    double square = n->yy - 2 * line[0] * n->gy - 2 * line[1] * n->xy + line[0] * line[0] * n->gg +
                    2 * line[0] * line[1] * n->gx + line[1] * line[1] * n->xx;
    return fmax(0, square) / n->count;
}

/* Means over a region's places, for it is one voice; weighted by how far it lies off the line. */
static igi_glare estimate(const normal *regions, size_t count, double *weights)
{
    igi_glare none = {0, (double)INFINITY, 1};
    double line[2], jackknife = 0, left[2];
    normal all = {0};
    size_t voices = 0;
    for (size_t r = 0; r < count; r++) {
        weights[r] = regions[r].count >= FEWEST_PLACES ? 1 / regions[r].count : 0;
        voices += weights[r] > 0;
    }
    if (voices < FEWEST_VOICES) return none;
    for (int round = 0; round < ROUNDS; round++) {
        all = (normal){0};
        for (size_t r = 0; r < count; r++) add(&all, &regions[r], weights[r]);
        if (!solve(&all, line)) return none;
        for (size_t r = 0; r < count && round + 1 < ROUNDS; r++)
            if (weights[r] > 0)
                weights[r] = 1 / (regions[r].count *
                                  (mean_square(&regions[r], line) + LEAST_SCATTER * LEAST_SCATTER));
    }
    for (size_t r = 0; r < count; r++) {
        normal rest = all;
        if (!(weights[r] > 0)) continue;
        add(&rest, &regions[r], -weights[r]);
        if (!solve(&rest, left)) return none;
        jackknife += (left[1] - line[1]) * (left[1] - line[1]);
    }
    double n = (double)voices, fit = all.gg / (all.gg * all.xx - all.gx * all.gx);
    return (igi_glare){line[1], sqrt(fmax(jackknife * (n - 1) / n, fit)), 1 + line[0]};
}

static void look(const igi_glimpses *g, size_t place, const double *bright, size_t regions,
                 normal *frames)
{
    size_t begin = g->begin[place], n = g->begin[place + 1] - begin;
    double mean = 0;
    if (n < FEWEST_FRAMES) return;
    for (size_t i = begin; i < begin + n; i++)
        mean += exp((double)g->glimpses[i].value) / (double)n;
    for (size_t i = begin; i < begin + n; i++) {
        size_t frame = g->glimpses[i].frame;
        double b = exp((double)g->glimpses[i].value) / mean, x = bright[frame] / mean;
        double others = ((double)n - b) / (double)(n - 1), y = b - others;
        const normal here = {1, others * others, others * x, x * x, others * y, x * y, y * y};
        add(&frames[frame * regions + g->region[place]], &here, 1);
    }
}

igi_status igi_glare_own(igi_context *ctx, const igi_glimpses *glimpses, size_t regions,
                         const double *bright, size_t frames, igi_glare *glares)
{
    igi_status status = IGI_OK;
    normal *sums = NULL;
    double *weights = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, frames * regions, &sums));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions, &weights));
    for (size_t p = 0; p < glimpses->place_count; p++) look(glimpses, p, bright, regions, sums);
    for (size_t f = 0; f < frames; f++) glares[f] = estimate(sums + f * regions, regions, weights);
cleanup:
    igi_free(sums);
    igi_free(weights);
    return status;
}
