/* SPDX-License-Identifier: Apache-2.0
 *
 * The share that one photograph has more than the others, as of a lamp that shines into its lens. Of
 * places with the mean B_p over all their photographs, and B_p' over the others,
 *     (B_pf - B_p') / B_p = gain + s M_f / B_p,
 * since nobody knows its exposure to a per cent: the intercept and the slope of a line, which surfaces of
 * different brightness tell apart. (Residuals over the mean of all: over B_p' alone, places whose others
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
    double one, x, xx, y, xy, yy; /* sums of weight, x, ... */
} normal;

static void add(normal *to, const normal *n, double weight)
{
    to->one += weight * n->one;
    to->x += weight * n->x;
    to->xx += weight * n->xx;
    to->y += weight * n->y;
    to->xy += weight * n->xy;
    to->yy += weight * n->yy;
}

/* Intercept and slope; false where x hardly varies. */
static bool solve(const normal *n, double line[2])
{
    double determinant = n->one * n->xx - n->x * n->x;
    if (!(determinant > 1e-3 * n->one * n->xx)) return false;
    line[0] = (n->xx * n->y - n->x * n->xy) / determinant;
    line[1] = (n->one * n->xy - n->x * n->y) / determinant;
    return true;
}

static double mean_square(const normal *n, const double line[2])
{
    double square = n->yy - 2 * line[0] * n->y - 2 * line[1] * n->xy + line[0] * line[0] * n->one +
                    2 * line[0] * line[1] * n->x + line[1] * line[1] * n->xx;
    return fmax(0, square) / n->one;
}

/* Means over a region's places, for it is one voice; weighted by how far it lies off the line. */
static igi_glare estimate(const normal *regions, size_t count, double *weights)
{
    igi_glare none = {0, (double)INFINITY};
    double line[2], jackknife = 0, left[2];
    normal all = {0};
    size_t voices = 0;
    for (size_t r = 0; r < count; r++) {
        weights[r] = regions[r].one >= FEWEST_PLACES ? 1 / regions[r].one : 0;
        voices += weights[r] > 0;
    }
    if (voices < FEWEST_VOICES) return none;
    for (int round = 0; round < ROUNDS; round++) {
        all = (normal){0};
        for (size_t r = 0; r < count; r++) add(&all, &regions[r], weights[r]);
        if (!solve(&all, line)) return none;
        for (size_t r = 0; r < count && round + 1 < ROUNDS; r++)
            if (weights[r] > 0)
                weights[r] = 1 / (regions[r].one *
                                  (mean_square(&regions[r], line) + LEAST_SCATTER * LEAST_SCATTER));
    }
    for (size_t r = 0; r < count; r++) {
        normal rest = all;
        if (!(weights[r] > 0)) continue;
        add(&rest, &regions[r], -weights[r]);
        if (!solve(&rest, left)) return none;
        jackknife += (left[1] - line[1]) * (left[1] - line[1]);
    }
    double n = (double)voices, fit = all.one / (all.one * all.xx - all.x * all.x);
    return (igi_glare){line[1], sqrt(fmax(jackknife * (n - 1) / n, fit))};
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
        double b = exp((double)g->glimpses[i].value), x = bright[frame] / mean;
        double y = (b / mean - 1) * (double)n / (double)(n - 1);
        const normal here = {1, x, x * x, y, x * y, y * y};
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
