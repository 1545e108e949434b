/* SPDX-License-Identifier: Apache-2.0
 *
 * How often codes of neighbours meet (Mann's comparagram), and which of it says something about the
 * response.
 */
#include "base/context.h"
#include "hdr/comparagram.h"

#include <math.h>
#include <string.h>

#define BINS IGI_HDR_BINS
/* Codes whose partners lie at least this far away on average say something about the ratio. */
#define CLEAR_STEP 4.0

igi_status igi_comparagram_fill(igi_context *ctx, const igi_photo *a, const igi_photo *b,
                                const igi_shift *shift, double most, igi_comparagram *out)
{
    size_t channels = (size_t)a->channels;
    int drop = a->levels == BINS ? 0 : 8;
    int step = (int)ceil(sqrt((double)a->width * a->height / most));
    if (!out->counts) IGI_TRY(IGI_ALLOC(ctx, channels * BINS * BINS, &out->counts));
    memset(out->counts, 0, channels * BINS * BINS * sizeof *out->counts);
    const igi_motion motion = igi_motion_of(b, shift);
    for (int y = step / 2; y < a->height; y += step)
        for (int x = step / 2; x < a->width; x += step) {
            size_t at = igi_motion_pixel(&motion, x, y);
            if (at == SIZE_MAX) continue;
            const uint16_t *p = a->codes + ((size_t)y * (size_t)a->width + (size_t)x) * channels;
            const uint16_t *q = b->codes + at * channels;
            for (size_t c = 0; c < channels; c++)
                out->counts[(c * BINS + (size_t)(p[c] >> drop)) * BINS + (size_t)(q[c] >> drop)]++;
        }
    return IGI_OK;
}

void igi_comparagram_find_valid(const uint32_t *n, bool valid_a[BINS], bool valid_b[BINS])
{
    double sum_a[BINS] = {0}, sum_b[BINS] = {0}, partner_a[BINS] = {0}, partner_b[BINS] = {0};
    for (size_t a = 0; a < BINS; a++)
        for (size_t b = 0; b < BINS; b++) {
            double count = n[a * BINS + b];
            sum_a[a] += count;
            sum_b[b] += count;
            partner_a[a] += count * (double)b;
            partner_b[b] += count * (double)a;
        }
    for (size_t z = 0; z < BINS; z++) {
        valid_a[z] = sum_a[z] > 0 && partner_a[z] / sum_a[z] - (double)z >= CLEAR_STEP;
        valid_b[z] = sum_b[z] > 0 && (double)z - partner_b[z] / sum_b[z] >= CLEAR_STEP;
    }
}

bool igi_comparagram_looks_equal(const igi_bracket *bracket, size_t pair)
{
    const uint32_t *n = bracket->pairs[pair].counts;
    double count = 0, step = 0;
    for (size_t i = 0; i < (size_t)bracket->channels * BINS; i++) {
        size_t a = i % BINS;
        for (size_t b = 0; a >= BINS / 4 && a < 3 * BINS / 4 && b < BINS; b++) {
            count += n[i * BINS + b];
            step += n[i * BINS + b] * ((double)b - (double)a);
        }
    }
    return count > 1000 && fabs(step) < CLEAR_STEP * count;
}
