/* SPDX-License-Identifier: Apache-2.0
 *
 * Vignetting from photographs of an evenly lit surface: means over blocks of pixels, averaged over
 * the photographs, then the polynomial.
 */
#include "base/context.h"
#include "lens/lens_private.h"

#include <math.h>
#include <string.h>

#define COLUMNS 64
#define ROWS 48
#define BLOCKS (COLUMNS * ROWS)
/* Of the highest code. */
#define SATURATED .98

/* Exposure by the response, or by the code itself where that is linear. */
static double exposure_of(const igi_photo *photo, const igi_response *response, size_t channel,
                          uint16_t code)
{
    if (response) return (double)response->exposure[channel * (size_t)response->levels + code];
    return (double)code / (photo->levels - 1);
}

static double mean_of_block(const igi_photo *photo, const igi_response *response, int block)
{
    int x0 = block % COLUMNS * photo->width / COLUMNS, y0 = block / COLUMNS * photo->height / ROWS;
    int x1 = (block % COLUMNS + 1) * photo->width / COLUMNS;
    int y1 = (block / COLUMNS + 1) * photo->height / ROWS;
    double sum = 0, count = 0;
    for (int y = y0; y < y1; y++)
        for (int x = x0; x < x1; x++) {
            const uint16_t *p = photo->codes + ((size_t)y * (size_t)photo->width + (size_t)x) *
                                                   (size_t)photo->channels;
            for (size_t c = 0; c < (size_t)photo->channels; c++)
                sum += exposure_of(photo, response, c, p[c]);
            count += photo->channels;
        }
    return count > 0 ? sum / count : 0;
}

static bool is_saturated(const igi_photo *photo)
{
    size_t count = (size_t)photo->width * (size_t)photo->height * (size_t)photo->channels, high = 0;
    for (size_t i = 0; i < count; i++) high += photo->codes[i] > SATURATED * (photo->levels - 1);
    return high > count / 1000;
}

/* Adds one photograph, scaled by its mean: lamps may have differed between photographs. */
static igi_status add_flat(igi_context *ctx, const char *path, igi_calibration **calibration,
                           double sums[BLOCKS])
{
    igi_status status = IGI_OK;
    igi_photo *photo = NULL;
    double blocks[BLOCKS], mean = 0;
    IGI_TRY_GOTO(igi_photo_load(ctx, path, &photo));
    IGI_TRY_GOTO(igi_calibration_for(ctx, path, photo, calibration));
    const igi_response *response = (*calibration)->response;
    if (photo->linear ||
        (response && (response->levels != photo->levels || response->channels != photo->channels)))
        response = NULL;
    if (photo->levels == 256 && !response) {
        status = igi_fail(ctx, IGI_E_DATA,
                          "%s: 8-bit codes tell light only through the camera's response; merge a "
                          "bracket with --save-response first, or photograph raw",
                          path);
    } else if (photo->width < 2 * COLUMNS || photo->height < 2 * ROWS) {
        status = igi_fail(ctx, IGI_E_DATA,
                          "%s: %d x %d pixels are too few for a flat field; use "
                          "the full size",
                          path, photo->width, photo->height);
    } else if (is_saturated(photo)) {
        status = igi_fail(ctx, IGI_E_DATA, "%s: it is saturated in places; expose less", path);
    }
    if (status != IGI_OK) goto cleanup;
    for (int i = 0; i < BLOCKS; i++) mean += (blocks[i] = mean_of_block(photo, response, i));
    for (int i = 0; i < BLOCKS; i++) sums[i] += mean > 0 ? blocks[i] / mean : 0;
    (*calibration)->vignetting.f_number = photo->f_number;
    (*calibration)->vignetting.focal_mm = photo->focal_mm;
cleanup:
    igi_photo_destroy(photo);
    return status;
}

igi_status igi_calibrate_flat(igi_context *ctx, const char *const *paths, size_t count,
                              igi_calibration **calibration)
{
    igi_status status = IGI_OK;
    igi_calibration *own = NULL, **target = *calibration ? calibration : &own;
    double sums[BLOCKS] = {0}, (*places)[2] = NULL;
    igi_vignetting fitted;
    if (count < 1) return igi_fail(ctx, IGI_E_USAGE, "flat: no photographs; name at least one");
    igi_stage_begin(ctx, "flat field");
    for (size_t i = 0; i < count; i++) {
        IGI_TRY_GOTO(igi_progress(ctx, (double)i / (double)count));
        IGI_TRY_GOTO(add_flat(ctx, paths[i], target, sums));
    }
    IGI_TRY_GOTO(IGI_ALLOC(ctx, BLOCKS, &places));
    const int size[2] = {(*target)->width, (*target)->height};
    for (int i = 0; i < BLOCKS; i++) {
        int x = i % COLUMNS, y = i / COLUMNS;
        places[i][0] = (x * size[0] / COLUMNS + (x + 1) * size[0] / COLUMNS) / 2.;
        places[i][1] = (y * size[1] / ROWS + (y + 1) * size[1] / ROWS) / 2.;
    }
    IGI_TRY_GOTO(igi_vignetting_fit(ctx, (const double(*)[2])places, sums, BLOCKS, size, &fitted));
    fitted.f_number = (*target)->vignetting.f_number;
    fitted.focal_mm = (*target)->vignetting.focal_mm;
    (*target)->vignetting = fitted;
    *calibration = *target;
    own = NULL;
cleanup:
    igi_stage_begin(ctx, NULL);
    igi_calibration_destroy(own);
    igi_free(places);
    return status;
}
