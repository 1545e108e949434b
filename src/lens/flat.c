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

/* By what a photograph's codes are read; NULL: they are linear. */
static igi_status choose_response(igi_context *ctx, const char *path, const igi_photo *photo,
                                  const igi_calibration *c, const igi_response **response)
{
    const igi_response *given = c->response;
    *response = NULL;
    if (photo->linear) return IGI_OK;
    if (given && (given->levels != photo->levels || given->channels != photo->channels))
        return igi_fail(ctx, IGI_E_DATA,
                        "%s: %d channels of %d levels, and the calibration's response is for %d of "
                        "%d; photograph as for the response",
                        path, photo->channels, photo->levels, given->channels, given->levels);
    if (photo->levels == 256 && !given)
        return igi_fail(ctx, IGI_E_DATA,
                        "%s: 8-bit codes tell light only through the camera's response; merge a "
                        "bracket with --save-response first, or photograph raw",
                        path);
    *response = given;
    return IGI_OK;
}

static igi_status check_flat(igi_context *ctx, const char *path, const igi_photo *photo)
{
    if (photo->width < 2 * COLUMNS || photo->height < 2 * ROWS)
        return igi_fail(ctx, IGI_E_DATA,
                        "%s: %d x %d pixels are too few for a flat field; use the full size", path,
                        photo->width, photo->height);
    if (is_saturated(photo))
        return igi_fail(ctx, IGI_E_DATA, "%s: it is saturated in places; expose less", path);
    return IGI_OK;
}

/* Adds one photograph, scaled by its mean: lamps may have differed between photographs. `doubtful`: its
 * codes are taken as linear without anybody having said so. */
static igi_status add_flat(igi_context *ctx, const char *path, igi_calibration **calibration,
                           double sums[BLOCKS], bool *doubtful)
{
    igi_status status = IGI_OK;
    igi_photo *photo = NULL;
    const igi_response *response;
    double blocks[BLOCKS], mean = 0;
    IGI_TRY_GOTO(igi_photo_load(ctx, path, &photo));
    IGI_TRY_GOTO(igi_calibration_for(ctx, path, photo, calibration));
    IGI_TRY_GOTO(choose_response(ctx, path, photo, *calibration, &response));
    IGI_TRY_GOTO(check_flat(ctx, path, photo));
    *doubtful = !photo->linear && !response;
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
    bool warned = false;
    if (count < 1) return igi_fail(ctx, IGI_E_USAGE, "flat: no photographs; name at least one");
    igi_stage_begin(ctx, "flat field");
    for (size_t i = 0; i < count; i++) {
        IGI_TRY_GOTO(igi_progress(ctx, (double)i / (double)count));
        bool doubtful;
        IGI_TRY_GOTO(add_flat(ctx, paths[i], target, sums, &doubtful));
        if (doubtful && !warned)
            igi_warn(ctx,
                     "%s: its codes of 16 bits are taken as proportional to light; a developed "
                     "picture has a tone curve: merge a bracket of such with --save-response "
                     "first, or name the raw file",
                     paths[i]);
        warned |= doubtful;
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
