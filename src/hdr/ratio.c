/* SPDX-License-Identifier: Apache-2.0
 *
 * How two photographs of one bracket relate: their exposure ratio by a known response, and how far
 * one is shifted against the other.
 */
#include "base/context.h"
#include "hdr/hdr_private.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define TILE 32
/* Of full scale: what counts as well exposed in the longer photograph, and the least that the
 * shorter one then must have. */
#define WELL_LOW .05
#define WELL_HIGH .85
#define LEAST .002

typedef struct tile {
    double ratio, weight;
} tile;

static int by_ratio(const void *a, const void *b)
{
    double x = ((const tile *)a)->ratio, y = ((const tile *)b)->ratio;
    return (x > y) - (x < y);
}

/* Sums of exposures over one tile. Only the longer photograph, the surer one, decides which
 * pixels count: choosing by the shorter one's noise would bias the ratio. */
static tile measure_tile(const igi_photo *a, const igi_photo *b, const igi_shift *shift,
                         const igi_response *response, double expected, int x0, int y0)
{
    double sum_a = 0, sum_b = 0;
    double low = fmax(WELL_LOW, LEAST * exp(expected));
    size_t channels = (size_t)a->channels;
    for (int y = y0; y < y0 + TILE && y < a->height; y++)
        for (int x = x0; x < x0 + TILE && x < a->width; x++) {
            size_t at = igi_hdr_shifted(b, x, y, shift);
            if (at == SIZE_MAX) continue;
            size_t from = (size_t)y * (size_t)a->width + (size_t)x;
            for (size_t c = 0; c < channels; c++) {
                const float *curve = response->exposure + c * (size_t)response->levels;
                double xb = (double)curve[b->codes[at * channels + c]];
                if (xb < low || xb > WELL_HIGH) continue;
                sum_b += xb;
                sum_a += (double)curve[a->codes[from * channels + c]];
            }
        }
    tile t = {sum_a > 0 ? sum_b / sum_a : 0, sum_a > 0 ? sum_a : 0};
    return t;
}

igi_status igi_hdr_measure_ratio(igi_context *ctx, const igi_photo *a, const igi_photo *b,
                                 const igi_shift *shift, const igi_response *response,
                                 double expected, double *log_ratio)
{
    size_t columns = ((size_t)a->width + TILE - 1) / TILE;
    size_t rows = ((size_t)a->height + TILE - 1) / TILE;
    size_t count = 0;
    double total = 0, sum = 0;
    tile *tiles = NULL;
    *log_ratio = (double)NAN;
    IGI_TRY(IGI_ALLOC(ctx, rows * columns, &tiles));
    for (size_t i = 0; i < rows * columns; i++) {
        tile t = measure_tile(a, b, shift, response, expected, (int)(i % columns) * TILE,
                              (int)(i / columns) * TILE);
        if (!(t.weight > 0)) continue;
        total += t.weight;
        tiles[count++] = t;
    }
    qsort(tiles, count, sizeof *tiles, by_ratio);
    /* The weighted median: things that moved, and highlights that clip, are outvoted. */
    for (size_t i = 0; i < count && isnan(*log_ratio); i++) {
        sum += tiles[i].weight;
        if (sum >= total / 2 && total > .01) *log_ratio = log(tiles[i].ratio);
    }
    igi_free(tiles);
    return IGI_OK;
}

/* The part of the variance of b's codes that is left among the pixels where a has one code (one
 * less the correlation ratio): small where the pictures lie on each other, whatever the response.
 * Codes at the ends say nothing; *share is the part of the samples that count. */
#define END 24
static double disagreement(const uint32_t *counts, size_t channels, double *share)
{
    double within = 0, total = 0, all = 0, sum = 0, squares = 0;
    for (size_t row = 0; row < channels * IGI_HDR_BINS; row++) {
        size_t a = row % IGI_HDR_BINS;
        double n = 0, first = 0, second = 0;
        for (size_t b = 0; b < IGI_HDR_BINS; b++) {
            double k = counts[row * IGI_HDR_BINS + b];
            all += k;
            if (a < END || b < END || a >= IGI_HDR_BINS - END || b >= IGI_HDR_BINS - END) continue;
            n += k;
            first += k * (double)b;
            second += k * (double)b * (double)b;
        }
        if (n < 2) continue;
        within += second - first * first / n;
        total += n;
        sum += first;
        squares += second;
    }
    *share = all > 0 ? total / all : 0;
    double variance = total > 0 ? squares - sum * sum / total : 0;
    return variance > 0 ? within / variance : HUGE_VAL;
}

static igi_status disagree_at(igi_context *ctx, const igi_photo *a, const igi_photo *b,
                              const igi_shift *shift, igi_comparagram *scratch, double *value,
                              double *share)
{
    IGI_TRY(igi_comparagram_fill(ctx, a, b, shift, 2e5, scratch));
    *value = disagreement(scratch->counts, (size_t)a->channels, share);
    return IGI_OK;
}

/* Of all samples; fewer that are well exposed in both photographs cannot tell a shift. */
#define LEAST_SHARE .05

igi_status igi_hdr_align(igi_context *ctx, const igi_photo *a, const igi_photo *b, igi_shift *shift)
{
    /* Coarse to fine around the best so far. A shift must earn its place: a tenth less
     * disagreement than none at all. */
    static const int steps[] = {8, 4, 2, 1};
    igi_status status = IGI_OK;
    igi_comparagram scratch = {0};
    igi_shift best = {0};
    double least, none, share;
    *shift = best;
    IGI_TRY_GOTO(disagree_at(ctx, a, b, &best, &scratch, &none, &share));
    least = none;
    for (size_t i = 0; share > LEAST_SHARE && i < sizeof steps / sizeof steps[0]; i++) {
        igi_shift centre = best;
        for (int k = 0; k < 9; k++) {
            igi_shift tried = {.x = centre.x + (k % 3 - 1) * steps[i],
                               .y = centre.y + (k / 3 - 1) * steps[i]};
            double value, ignored;
            if (k == 4) continue;
            IGI_TRY_GOTO(disagree_at(ctx, a, b, &tried, &scratch, &value, &ignored));
            if (value < least) least = value, best = tried;
        }
    }
    if (least < .9 * none) *shift = best;
cleanup:
    igi_free(scratch.counts);
    return status;
}
