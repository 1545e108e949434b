/* SPDX-License-Identifier: Apache-2.0
 *
 * The response of a camera, recovered from a bracket.
 *
 * Debevec and Malik (1997) find g = ln(exposure as a function of the code) and the radiance of a
 * few dozen pixels at once. Here the radiances are eliminated: a pixel with code a in one
 * photograph and b in the next says g(b) - g(a) = r, the logarithm of their exposure ratio. All
 * pixels then fit in one 256 x 256 count a pair (Mann's comparagram), and
 *
 *     sum_pairs sum_ab N_ab w(a) w(b) (g(b) - g(a) - r)^2 + lambda sum g''^2  ->  min
 *
 * is a linear system. Whether the stated ratios are true is then read off the curve: each pair's
 * median of g(b) - g(a). A pair far from its stated ratio loses its weight, the curve is solved
 * again, until the false ones no longer bend it. (Ratios and curve cannot be solved at once: one
 * factor on all logarithms, a gamma, changes no picture, and scatter pulls it to 0.)
 *
 * Trap: film and sensors have a floor. Two dark pixels of the same code then seem to say r = 0, by
 * the thousand. Codes count only where the codes of the partner differ clearly on average.
 */
#include "base/context.h"
#include "base/solve.h"
#include "hdr/comparagram.h"

#include <math.h>
#include <string.h>

#define BINS IGI_HDR_BINS
/* Logarithms of exposure ratios, 0 to 8. */
#define STEP_WIDTH .001
#define STEP_BINS 8000

/* The normal equations of one channel: A g = b. */
typedef struct equations {
    double a[BINS * BINS], b[BINS], total; /* the weight on all codes */
    igi_log_curve *curve;
} equations;

static void add_pair(equations *e, const uint32_t *n, double log_ratio, double trust)
{
    bool valid_a[BINS], valid_b[BINS];
    igi_comparagram_find_valid(n, valid_a, valid_b);
    for (size_t a = 0; a < BINS; a++)
        for (size_t b = 0; b < BINS; b++) {
            double w = trust * igi_comparagram_weight(n, valid_a, valid_b, a, b);
            if (!(w > 0)) continue;
            e->a[a * BINS + a] += w;
            e->a[b * BINS + b] += w;
            /* Only the lower triangle is read. */
            if (a > b) e->a[a * BINS + b] -= w;
            else e->a[b * BINS + a] -= w;
            e->b[b] += w * log_ratio;
            e->b[a] -= w * log_ratio;
            e->curve->used[a] += w;
            e->curve->used[b] += w;
            e->total += w;
        }
}

/* Smoothness, and g = 0 in the middle. Smooth is what bends little over u = ln(code): gammas are
 * straight there. It has to be firm: exposures that are all a factor apart leave every ripple of
 * just that period in ln(exposure) undetermined. */
/* Codes are counted from here: sRGB-like curves have a straight foot. */
#define U_OFFSET 8.0
#define SMOOTHNESS 1e-4
static void regularise(equations *e, double smoothness)
{
    for (size_t z = 1; z + 1 < BINS; z++) {
        double before = log(((double)z + U_OFFSET) / ((double)z - 1 + U_OFFSET));
        double after = log(((double)z + 1 + U_OFFSET) / ((double)z + U_OFFSET));
        double step = (before + after) / 2, w = sqrt(smoothness * e->total * step);
        const double second[3] = {w / (before * step), -w * (1 / before + 1 / after) / step,
                                  w / (after * step)};
        for (size_t i = 0; i < 3; i++)
            for (size_t j = 0; j <= i; j++)
                e->a[(z - 1 + i) * BINS + z - 1 + j] += second[i] * second[j];
    }
    e->a[(BINS / 2) * (BINS + 1)] += e->total;
}

/* The square of g's slope: the variance that one code of noise means for g. Steep near the floor,
 * where a pair's few bright pixels meet codes that say nothing. */
static double squared_slope(const double g[BINS], size_t z)
{
    size_t z0 = z > 3 ? z - 3 : 0, z1 = z + 3 < BINS ? z + 3 : BINS - 1;
    double slope = (g[z1] - g[z0]) / (double)(z1 - z0);
    return slope * slope + 1e-6;
}

/* The median of g(b) - g(a) over a pair's cells, all channels, weighted by how sure each is, and
 * the sum of these weights. */
static double median_step(const igi_bracket *bracket, size_t pair, const equations *channels,
                          double *histogram, double *weight)
{
    double total = 0, sum = 0, slopes[BINS];
    memset(histogram, 0, STEP_BINS * sizeof *histogram);
    for (int c = 0; c < bracket->channels; c++) {
        const uint32_t *n = bracket->pairs[pair].counts + (size_t)c * BINS * BINS;
        bool valid_a[BINS], valid_b[BINS];
        igi_comparagram_find_valid(n, valid_a, valid_b);
        for (size_t z = 0; z < BINS; z++) slopes[z] = squared_slope(channels[c].curve->g, z);
        for (size_t a = 0; a < BINS; a++)
            for (size_t b = 0; b < BINS; b++) {
                double w = igi_comparagram_weight(n, valid_a, valid_b, a, b);
                if (!(w > 0)) continue;
                w *= 2e-4 / (slopes[a] + slopes[b]); /* about 1 in the middle */
                double bin = (channels[c].curve->g[b] - channels[c].curve->g[a]) / STEP_WIDTH;
                histogram[bin < 0 ? 0 : bin < STEP_BINS - 1 ? (size_t)bin : STEP_BINS - 1] += w;
                total += w;
            }
    }
    *weight = total;
    if (!(total > 0)) return (double)NAN;
    size_t bin = 0;
    while (bin + 1 < STEP_BINS && sum + histogram[bin] < total / 2) sum += histogram[bin++];
    return ((double)bin + (total / 2 - sum) / histogram[bin]) * STEP_WIDTH;
}

/* Solves for the curves with each pair trusted as far as `trust` says. */
static igi_status solve_curves(igi_context *ctx, const igi_bracket *bracket, const double *trust,
                               double smoothness, equations *channels)
{
    for (int c = 0; c < bracket->channels; c++) {
        equations *e = &channels[c];
        igi_log_curve *curve = e->curve;
        memset(e, 0, sizeof *e);
        memset(curve, 0, sizeof *curve);
        e->curve = curve;
        for (size_t p = 0; p + 1 < bracket->count; p++)
            add_pair(e, bracket->pairs[p].counts + (size_t)c * BINS * BINS,
                     bracket->log_h[p + 1] - bracket->log_h[p], trust[p]);
        if (!(e->total > 0))
            return igi_fail(ctx, IGI_E_DATA,
                            "response: no pixel is well exposed in two neighbouring photographs; "
                            "take exposures a stop or two apart, or give the response");
        regularise(e, smoothness);
        memcpy(curve->g, e->b, sizeof curve->g);
        if (!igi_solve_cholesky(e->a, BINS, curve->g, 1))
            return igi_fail(ctx, IGI_E_NO_ANSWER,
                            "response: the bracket does not determine it; give the response");
    }
    return IGI_OK;
}

/* A pair with less than this part of all weight is a few highlights, and says nothing. */
#define LEAST_SHARE 5e-4
/* How far, in natural logarithms, a pair may be off before it loses half its weight. */
#define TRUST_WIDTH .1

static igi_status solve_robustly(igi_context *ctx, igi_bracket *bracket, equations *channels,
                                 double *trust, double *histogram)
{
    size_t pairs = bracket->count - 1;
    for (size_t p = 0; p < pairs; p++) trust[p] = 1;
    for (int round = 0; round < 6; round++) {
        double total = 0, *weight = trust; /* first the weights, then the trust */
        IGI_TRY(solve_curves(ctx, bracket, trust, SMOOTHNESS, channels));
        for (size_t p = 0; p < pairs; p++) {
            bracket->log_ratio[p] = median_step(bracket, p, channels, histogram, &weight[p]);
            total += weight[p];
        }
        for (size_t p = 0; p < pairs; p++) {
            double stated = bracket->log_h[p + 1] - bracket->log_h[p],
                   *seen = &bracket->log_ratio[p];
            if (weight[p] < LEAST_SHARE * total)
                *seen = stated > .17 && igi_comparagram_looks_equal(bracket, p) ? 0 : (double)NAN;
            double off = isnan(*seen) ? 0 : (*seen - stated) / TRUST_WIDTH;
            trust[p] = 1 / (1 + off * off);
        }
    }
    return IGI_OK;
}

/* How the curve changes, as its codes agree with each other: mean square, for a halved weight. */
#define HALVING .693147
static double change_between(const igi_log_curve *is, const igi_log_curve *was)
{
    double weight = 0, mean = 0, square = 0;
    for (int z = 0; z < BINS; z++) {
        double d = (is->g[z] - was->g[z]) / HALVING;
        weight += was->used[z];
        mean += was->used[z] * d;
        square += was->used[z] * d * d;
    }
    mean /= weight;
    return fmax(0, square / weight - mean * mean);
}

/* What pulls at the curve, each seen by halving its weight: a pair (the infinitesimal jackknife: exposures
 * that are not as stated) and smoothness (which bends it where it is none). */
static igi_status find_deviation(igi_context *ctx, const igi_bracket *bracket, double *trust,
                                 equations *channels, const igi_log_curve *curves,
                                 double *deviation)
{
    igi_status status = IGI_OK;
    igi_log_curve *changed = NULL;
    double square = 0;
    size_t count = (size_t)bracket->channels;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, count, &changed));
    for (size_t c = 0; c < count; c++) channels[c].curve = &changed[c];
    for (size_t p = 0; p < bracket->count; p++) { /* the last one is smoothness */
        bool pair = p + 1 < bracket->count;
        if (pair) trust[p] /= 2;
        IGI_TRY_GOTO(
            solve_curves(ctx, bracket, trust, pair ? SMOOTHNESS : SMOOTHNESS / 2, channels));
        if (pair) trust[p] *= 2;
        for (size_t c = 0; c < count; c++)
            square += change_between(&changed[c], &curves[c]) / (double)count;
    }
    *deviation = sqrt(square);
cleanup:
    igi_free(changed);
    return status;
}

igi_status igi_hdr_solve_response(igi_context *ctx, igi_bracket *bracket, igi_log_curve *curves,
                                  double *deviation)
{
    igi_status status = IGI_OK;
    equations *channels = NULL;
    double *trust = NULL, *histogram = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, (size_t)bracket->channels, &channels));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, bracket->count, &trust));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, STEP_BINS, &histogram));
    for (int c = 0; c < bracket->channels; c++) channels[c].curve = &curves[c];
    IGI_TRY_GOTO(solve_robustly(ctx, bracket, channels, trust, histogram));
    IGI_TRY_GOTO(find_deviation(ctx, bracket, trust, channels, curves, deviation));
cleanup:
    igi_free(channels);
    igi_free(trust);
    igi_free(histogram);
    return status;
}
