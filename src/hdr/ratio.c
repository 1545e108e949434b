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
static tile measure_tile(const igi_photo *a, const igi_motion *motion, const igi_response *response,
                         double expected, int x0, int y0)
{
    const igi_photo *b = motion->b;
    double sum_a = 0, sum_b = 0;
    double low = fmax(WELL_LOW, LEAST * exp(expected));
    size_t channels = (size_t)a->channels;
    for (int y = y0; y < y0 + TILE && y < a->height; y++)
        for (int x = x0; x < x0 + TILE && x < a->width; x++) {
            size_t at = igi_motion_pixel(motion, x, y);
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
    const igi_motion motion = igi_motion_of(b, shift);
    *log_ratio = (double)NAN;
    IGI_TRY(IGI_ALLOC(ctx, rows * columns, &tiles));
    for (size_t i = 0; i < rows * columns; i++) {
        tile t = measure_tile(a, &motion, response, expected, (int)(i % columns) * TILE,
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
 * less the correlation ratio): small where the pictures lie on each other, whatever the response. Of the
 * green codes on a grid of some places; those at the ends say nothing. *share is the part of the
 * places that count. */
#define END 24
#define PLACES 2e5
static double disagreement(const igi_photo *a, const igi_photo *b, const igi_shift *shift,
                           double *share)
{
    double counts[IGI_HDR_BINS] = {0}, sums[IGI_HDR_BINS] = {0};
    double within = 0, total = 0, all = 0, sum = 0, squares = 0;
    size_t channels = (size_t)a->channels, green = channels == 3;
    const igi_motion motion = igi_motion_of(b, shift);
    int drop = a->levels == IGI_HDR_BINS ? 0 : 8;
    int step = (int)ceil(sqrt((double)a->width * a->height / PLACES));
    for (int y = step / 2; y < a->height; y += step)
        for (int x = step / 2; x < a->width; x += step) {
            size_t at = igi_motion_pixel(&motion, x, y);
            if (at == SIZE_MAX) continue;
            size_t from = (size_t)y * (size_t)a->width + (size_t)x;
            int code = a->codes[from * channels + green] >> drop;
            int met = b->codes[at * channels + green] >> drop;
            all++;
            if (code < END || met < END || code >= IGI_HDR_BINS - END || met >= IGI_HDR_BINS - END)
                continue;
            counts[code]++;
            sums[code] += met;
            squares += (double)met * met;
        }
    for (int z = END; z < IGI_HDR_BINS - END; z++) {
        if (counts[z] == 0) continue;
        within -= sums[z] * sums[z] / counts[z];
        total += counts[z];
        sum += sums[z];
    }
    *share = all > 0 ? total / all : 0;
    double variance = total > 0 ? squares - sum * sum / total : 0;
    return variance > 0 ? (squares + within) / variance : HUGE_VAL;
}

/* Of all samples; fewer that are well exposed in both photographs cannot tell a shift. */
#define LEAST_SHARE .05

void igi_hdr_align(const igi_photo *a, const igi_photo *b, igi_shift *shift)
{
    /* Coarse to fine around the best so far. A shift must earn its place: a tenth less
     * disagreement than none at all. */
    static const int steps[] = {8, 4, 2, 1};
    igi_shift best = {0};
    double share, none = disagreement(a, b, &best, &share), least = none;
    *shift = best;
    for (size_t i = 0; share > LEAST_SHARE && i < sizeof steps / sizeof steps[0]; i++) {
        igi_shift centre = best;
        for (int k = 0; k < 9; k++) {
            igi_shift tried = {.x = centre.x + (k % 3 - 1) * steps[i],
                               .y = centre.y + (k / 3 - 1) * steps[i]};
            double ignored, value = k == 4 ? HUGE_VAL : disagreement(a, b, &tried, &ignored);
            if (value < least) least = value, best = tried;
        }
    }
    if (least < .9 * none) *shift = best;
}
