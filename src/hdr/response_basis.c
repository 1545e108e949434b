/* SPDX-License-Identifier: Apache-2.0
 *
 * Responses from few numbers.
 *
 * A polynomial (Mitsunaga and Nayar, "Radiometric self calibration", 1999): of the code u in [0,1],
 *     x(u) = u + sum_k c_k (u^k - u),   x(0) = 0, x(1) = 1.
 * A pixel of code a in one photograph and b in the next says x(b) = R x(a), linear in c. The noise
 * of its two codes gives its variance, x'(b)^2 + R^2 x'(a)^2, by the slope of the curve that was
 * found without a model: weighted least squares, once. The fewest powers are taken that leave about
 * as little misfit as all.
 *
 * The space of known responses (Grossberg and Nayar, "What is the space of camera response
 * functions?", 2003): the mean of two hundred films' and cameras' inverse responses and their first
 * components, read from their table. Fitted to pairs directly these few curves run along what a
 * bracket leaves open (any ripple whose period is the exposures' ratio), so the curve that was
 * found without a model is brought to the nearest curve of that space instead, by relative distance where its codes are
 * known, each component held to about the size it has among real cameras. Outside of the known
 * codes the space then says what cameras do there.
 */
#include "base/context.h"
#include "base/solve.h"
#include "hdr/hdr_private.h"

#include <math.h>
#include <string.h>

#define BINS IGI_HDR_BINS
/* Powers above the first. */
#define MOST_FUNCTIONS 7
/* Components of the table beyond these are of single films; their usual sizes. */
#define COMPONENTS IGI_HDR_COMPONENTS
static const double usual[COMPONENTS] = {5, 1.5, .6, .3};
/* Relative error of the curve found before, as if each bin were independent. */
#define PROJECTED .1
/* A pair's weight halves when it shows a ratio this far (natural logarithm) from the stated one. */
#define TRUST_WIDTH .1
/* More powers must take away this share of the misfit. */
#define WORTH .02
#define RIDGE 1e-7

typedef struct basis {
    int count;                               /* of powers above the first */
    double at_bin[MOST_FUNCTIONS + 1][BINS]; /* u, then u^k - u, at the middle of each bin */
    double slope[BINS];                      /* of the curve found before, a bin */
} basis;

/* The code of a bin: 16-bit codes were put there by their high byte. */
static double code_of(int bin, int levels)
{
    return levels == BINS ? bin / 255. : (bin + .498) / 255.996;
}

static void tabulate(basis *b, int levels)
{
    for (int k = 0; k <= MOST_FUNCTIONS; k++)
        for (int z = 0; z < BINS; z++) {
            double u = code_of(z, levels);
            b->at_bin[k][z] = k == 0 ? u : pow(u, k + 1) - u;
        }
}

static void find_slopes(basis *b, const igi_response *response, int channel)
{
    int width = response->levels / BINS;
    const float *x = response->exposure + (size_t)channel * (size_t)response->levels;
    for (int z = 0; z < BINS; z++) {
        int z0 = z > 2 ? z - 2 : 0, z1 = z + 2 < BINS ? z + 2 : BINS - 1;
        b->slope[z] = ((double)x[z1 * width] - (double)x[z0 * width]) / (z1 - z0);
    }
}

static double hat(size_t z)
{
    return (double)(z < BINS - 1 - z ? z : BINS - 1 - z) / (BINS / 2 - .5);
}

/* Codes that the floor or the top of the other photograph does not reach, in its mean partner. */
static bool is_clear(const uint32_t *row, size_t stride, size_t z, bool longer)
{
    double count = 0, sum = 0;
    for (size_t k = 0; k < BINS; k++) {
        count += row[k * stride];
        sum += row[k * stride] * (double)k;
    }
    double step = count > 0 ? sum / count - (double)z : 0;
    return longer ? step >= 4 : step <= -4;
}

static double trust_in(const igi_bracket *bracket, size_t pair)
{
    double stated = bracket->log_h[pair + 1] - bracket->log_h[pair];
    double off = (bracket->log_ratio[pair] - stated) / TRUST_WIDTH;
    return isnan(off) ? 1 : 1 / (1 + off * off);
}

typedef struct sums {
    double a[MOST_FUNCTIONS * MOST_FUNCTIONS], b[MOST_FUNCTIONS], squares;
} sums;

static void add_pair(const basis *b, const igi_bracket *bracket, size_t pair, int channel, sums *s)
{
    const uint32_t *n = bracket->pairs[pair].counts + (size_t)channel * BINS * BINS;
    double ratio = exp(bracket->log_h[pair + 1] - bracket->log_h[pair]);
    double trust = trust_in(bracket, pair);
    bool clear_b[BINS];
    for (size_t z = 0; z < BINS; z++) clear_b[z] = is_clear(n + z, BINS, z, false);
    for (size_t y = 0; y < BINS; y++) {
        if (!is_clear(n + y * BINS, 1, y, true)) continue;
        for (size_t z = 0; z < BINS; z++) {
            double count = n[y * BINS + z], row[MOST_FUNCTIONS];
            if (!(count > 0) || !clear_b[z]) continue;
            double w = trust * count * hat(y) * hat(z) /
                       (ratio * ratio * b->slope[y] * b->slope[y] + b->slope[z] * b->slope[z] +
                        1e-10);
            double target = ratio * b->at_bin[0][y] - b->at_bin[0][z];
            for (int k = 0; k < b->count; k++) {
                row[k] = b->at_bin[k + 1][z] - ratio * b->at_bin[k + 1][y];
            }
            for (int i = 0; i < b->count; i++) {
                for (int k = 0; k < b->count; k++) s->a[i * b->count + k] += w * row[i] * row[k];
                s->b[i] += w * row[i] * target;
            }
            s->squares += w * target * target;
        }
    }
}

/* The coefficients of one channel; *misfit: the weighted sum of squares that is left. */
static bool fit_channel(const basis *b, const igi_bracket *bracket, int channel, double *c,
                        double *misfit)
{
    sums s = {0};
    double a[MOST_FUNCTIONS * MOST_FUNCTIONS], trace = 0;
    size_t count = (size_t)b->count;
    for (size_t p = 0; p + 1 < bracket->count; p++) add_pair(b, bracket, p, channel, &s);
    for (size_t k = 0; k < count; k++) trace += s.a[k * (count + 1)] / (double)count;
    for (size_t k = 0; k < count; k++) s.a[k * (count + 1)] += RIDGE * trace;
    memcpy(a, s.a, sizeof a);
    memcpy(c, s.b, count * sizeof *c);
    if (!(trace > 0) || !igi_solve_cholesky(a, count, c, 1)) return false;
    *misfit = s.squares;
    for (size_t k = 0; k < count; k++) *misfit -= c[k] * s.b[k];
    return isfinite(*misfit);
}

/* Rising, from 0 to 1. */
static void normalise(int channel, igi_response *response)
{
    size_t levels = (size_t)response->levels;
    float *x = response->exposure + (size_t)channel * levels, top;
    x[0] = fmaxf(0, x[0]);
    for (size_t z = 1; z < levels; z++) x[z] = fmaxf(x[z], x[z - 1]);
    top = x[levels - 1];
    for (size_t z = 0; z < levels; z++) x[z] /= top;
}

static bool fit_polynomial(basis *b, const igi_bracket *bracket, int channel,
                           igi_response *response)
{
    double best[MOST_FUNCTIONS] = {0}, least = HUGE_VAL;
    int chosen = 0;
    for (b->count = 1; b->count <= MOST_FUNCTIONS; b->count++) {
        double c[MOST_FUNCTIONS] = {0}, misfit;
        if (!fit_channel(b, bracket, channel, c, &misfit)) continue;
        if (chosen && !(misfit < (1 - WORTH) * least)) continue;
        least = misfit;
        chosen = b->count;
        memcpy(best, c, sizeof best);
    }
    for (int z = 0; z < response->levels; z++) {
        double u = (double)z / (response->levels - 1), x = u;
        for (int k = 0; k < chosen; k++) x += best[k] * (pow(u, k + 2) - u);
        response->exposure[(size_t)channel * (size_t)response->levels + (size_t)z] = (float)x;
    }
    if (chosen) normalise(channel, response);
    return chosen > 0;
}

static double table_at(const double values[IGI_HDR_TABLE], double u)
{
    double at = u * (IGI_HDR_TABLE - 1);
    size_t i = at < IGI_HDR_TABLE - 2 ? (size_t)at : IGI_HDR_TABLE - 2;
    return values[i] + (at - (double)i) * (values[i + 1] - values[i]);
}

/* The nearest curve s x = f0 + sum c_k f_k: unknown are s and c. */
static bool project(const double (*table)[IGI_HDR_TABLE], int channel, igi_response *response)
{
    enum { N = COMPONENTS + 1 };
    double a[N * N] = {0}, p[N] = {0};
    int levels = response->levels, width = levels / BINS;
    float *x = response->exposure + (size_t)channel * (size_t)levels;
    for (int z = response->low[channel] / width; z <= response->high[channel] / width; z++) {
        double u = code_of(z, levels), row[N], target = table_at(table[0], u);
        row[0] = (double)x[z * width + width / 2];
        double w = 1 / (fmax(row[0], 1e-4) * PROJECTED);
        for (int k = 0; k < COMPONENTS; k++) row[k + 1] = -table_at(table[k + 1], u);
        for (int i = 0; i < N; i++) {
            for (int k = 0; k < N; k++) a[i * N + k] += w * w * row[i] * row[k];
            p[i] += w * w * row[i] * target;
        }
    }
    for (int k = 0; k < COMPONENTS; k++) a[(k + 1) * (N + 1)] += 1 / (usual[k] * usual[k]);
    if (!igi_solve_cholesky(a, N, p, 1)) return false;
    for (int z = 0; z < levels; z++) {
        double u = (double)z / (levels - 1), value = table_at(table[0], u);
        for (int k = 0; k < COMPONENTS; k++) value += p[k + 1] * table_at(table[k + 1], u);
        x[z] = (float)value;
    }
    normalise(channel, response);
    return true;
}

/* How far the new curve runs from the one before, but for a factor: mean square of the logarithm over the
 * codes that were known, as the few numbers cannot follow it or it was wrong. */
static double square_between(const igi_response *response, int channel, const float *before)
{
    const float *x = response->exposure + (size_t)channel * (size_t)response->levels;
    double sum = 0, square = 0;
    int count = 0, step = response->levels / BINS;
    for (int z = response->low[channel]; z <= response->high[channel]; z += step) {
        if (!(x[z] > 0) || !(before[z] > 0)) continue;
        double d = log((double)x[z] / (double)before[z]);
        sum += d, square += d * d, count++;
    }
    return count ? fmax(0, square / count - sum * sum / count / count) : 0;
}

igi_status igi_hdr_fit_basis(igi_context *ctx, const igi_bracket *bracket,
                             const double (*table)[IGI_HDR_TABLE], igi_response *response)
{
    igi_status status = IGI_OK;
    basis *b = NULL;
    float *before = NULL;
    bool good = true;
    double square = 0;
    size_t levels = (size_t)response->levels;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &b));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, levels, &before));
    tabulate(b, bracket->levels);
    for (int c = 0; good && c < bracket->channels; c++) {
        memcpy(before, response->exposure + (size_t)c * levels, levels * sizeof *before);
        find_slopes(b, response, c);
        good = table ? project(table, c, response) : fit_polynomial(b, bracket, c, response);
        square += square_between(response, c, before) / bracket->channels;
    }
    response->deviation = hypot(response->deviation, sqrt(square));
    if (!good)
        status = igi_fail(ctx, IGI_E_NO_ANSWER,
                          "response: the bracket does not determine it; give the response");
cleanup:
    igi_free(b);
    igi_free(before);
    return status;
}
