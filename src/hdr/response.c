/* SPDX-License-Identifier: Apache-2.0
 *
 * A camera's response: from logarithms at 256 codes, which the bracket tells, to exposures of all codes.
 */
#include "base/context.h"
#include "hdr/hdr_private.h"

#include <math.h>

#define BINS IGI_HDR_BINS

igi_status igi_response_create(igi_context *ctx, int channels, int levels, igi_response **response)
{
    igi_status status = IGI_OK;
    igi_response *made = NULL;
    *response = NULL;
    IGI_TRY(IGI_ALLOC(ctx, 1, &made));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, (size_t)channels * (size_t)levels, &made->exposure));
    made->channels = channels;
    made->levels = levels;
    for (int c = 0; c < channels; c++) {
        made->high[c] = levels - 1;
        for (int z = 0; z < levels; z++)
            made->exposure[(size_t)c * (size_t)levels + (size_t)z] = (float)z / (float)(levels - 1);
    }
    *response = made;
    made = NULL;
cleanup:
    igi_response_destroy(made);
    return status;
}

void igi_response_destroy(igi_response *response)
{
    if (!response) return;
    igi_free(response->exposure);
    igi_free(response);
}

/* The codes between which nearly all weight lies. */
static void find_range(const double used[BINS], int *low, int *high)
{
    double total = 0, sum = 0;
    for (size_t z = 0; z < BINS; z++) total += used[z];
    *low = -1;
    *high = BINS - 1;
    for (int z = 0; z < BINS; z++) {
        sum += used[z];
        if (*low < 0 && sum > 1e-3 * total) *low = z;
        if (sum > (1 - 1e-4) * total) {
            *high = z;
            break;
        }
    }
    if (*low < 0) *low = 0;
}

/* From g to exposures: below the lowest known code straight down to 0 (a floor is a floor), never
 * falling, 1 at the top. */
static void fill_curve(const double *g, int low, int high, double x[BINS])
{
    int near = low + 3 < high ? low + 3 : high;
    for (int z = 0; z < BINS; z++) x[z] = exp(g[z] - g[BINS - 1]);
    double slope = near > low ? (x[near] - x[low]) / (near - low) : 0;
    for (int z = low - 1; z >= 0; z--) x[z] = fmax(0, x[low] - slope * (low - z));
    for (int z = 1; z < BINS; z++)
        if (x[z] < x[z - 1]) x[z] = x[z - 1];
    for (int z = BINS; z-- > 0;) x[z] /= x[BINS - 1];
}

/* The curve at every code: 16-bit codes lie between the bins that their high bytes were put in. */
static void spread_curve(const double x[BINS], int channel, igi_response *response)
{
    size_t levels = (size_t)response->levels;
    float *exposure = response->exposure + (size_t)channel * levels;
    for (size_t z = 0; z < levels; z++) {
        double at = levels == BINS ? (double)z : fmax(0, ((double)z - 127.5) / 256);
        size_t bin = (size_t)at < BINS - 2 ? (size_t)at : BINS - 2;
        exposure[z] = (float)(x[bin] + (at - (double)bin) * (x[bin + 1] - x[bin]));
    }
    response->low[channel] *= (int)levels / BINS;
    response->high[channel] = (response->high[channel] + 1) * ((int)levels / BINS) - 1;
}

igi_status igi_hdr_recover_response(igi_context *ctx, igi_bracket *bracket, igi_response **response)
{
    igi_status status = IGI_OK;
    igi_log_curve *curves = NULL;
    double deviation;
    *response = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, (size_t)bracket->channels, &curves));
    IGI_TRY_GOTO(igi_hdr_solve_response(ctx, bracket, curves, &deviation));
    IGI_TRY_GOTO(igi_response_create(ctx, bracket->channels, bracket->levels, response));
    (*response)->deviation = deviation;
    for (int c = 0; c < bracket->channels; c++) {
        double x[BINS];
        find_range(curves[c].used, &(*response)->low[c], &(*response)->high[c]);
        fill_curve(curves[c].g, (*response)->low[c], (*response)->high[c], x);
        spread_curve(x, c, *response);
    }
cleanup:
    igi_free(curves);
    return status;
}
