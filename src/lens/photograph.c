/* SPDX-License-Identifier: Apache-2.0
 *
 * What a camera makes of light: x = V L h, electrons, codes.
 */
#include "base/context.h"
#include "base/parallel.h"
#include "base/rng.h"
#include "base/vec.h"
#include "hdr/hdr.h"
#include "lens/lens_private.h"

#include <math.h>
#include <stdio.h>

typedef struct job {
    const igi_image *radiance;
    const igi_calibration *calibration;
    const igi_sensor *sensor;
    igi_photo *photo;
    double h;
    uint64_t seed;
} job;

/* Two independent standard normals (Box and Muller 1958). */
static void draw_normals(igi_rng *rng, double out[2])
{
    double u = 1 - (double)igi_rng_float(rng), angle = 2 * IGI_PI * (double)igi_rng_float(rng);
    double r = sqrt(-2 * log(u));
    out[0] = r * cos(angle);
    out[1] = r * sin(angle);
}

/* A Poisson variate: by products of uniforms when small (Knuth), else by the normal. */
static double draw_electrons(igi_rng *rng, double mean, double normal)
{
    if (mean > 50) return fmax(0, mean + sqrt(mean) * normal);
    double limit = exp(-mean), product = 1 - (double)igi_rng_float(rng);
    int count = 0;
    while (product > limit && count < 500) {
        product *= 1 - (double)igi_rng_float(rng);
        count++;
    }
    return count;
}

/* The code whose exposure is nearest below x: the response is rising. */
static int respond(const igi_response *response, int channel, int levels, double x)
{
    if (!response) return (int)(x * (levels - 1) + .5);
    const float *curve = response->exposure + (size_t)channel * (size_t)levels;
    int low = 0, high = levels - 1;
    while (low < high) {
        int middle = (low + high + 1) / 2;
        if ((double)curve[middle] <= x) low = middle;
        else high = middle - 1;
    }
    return low;
}

static igi_status expose_row(igi_context *ctx, void *user, size_t row, int worker)
{
    const job *j = user;
    const igi_sensor *sensor = j->sensor;
    igi_photo *photo = j->photo;
    const int size[2] = {photo->width, photo->height};
    int drop = (photo->levels == 256 ? 8 : 16) - sensor->bits;
    igi_rng rng = igi_rng_make(j->seed, row);
    (void)ctx;
    (void)worker;
    for (int column = 0; column < photo->width; column++) {
        size_t at = row * (size_t)photo->width + (size_t)column;
        double v = igi_vignetting_at(&j->calibration->vignetting, column + .5, (double)row + .5,
                                     size);
        for (int c = 0; c < photo->channels; c++) {
            double light = (double)
                               j->radiance->samples[at * (size_t)j->radiance->channels + (size_t)c];
            double x = fmax(0, light * v * j->h), normals[2];
            draw_normals(&rng, normals);
            double e = draw_electrons(&rng, fmin(x, 4) * sensor->full_well_e, normals[0]);
            x = (e + sensor->read_noise_e * normals[1]) / sensor->full_well_e;
            x = fmax(0, fmin(1, x));
            int code = respond(j->calibration->response, c, photo->levels, x) >> drop;
            /* The upper bits again below: the highest code is the file's highest. */
            int filled = code << drop;
            if (drop > 0) filled |= code >> (sensor->bits - drop);
            photo->codes[at * (size_t)photo->channels + (size_t)c] = (uint16_t)filled;
        }
    }
    return IGI_OK;
}

igi_status igi_photograph(igi_context *ctx, const igi_image *radiance,
                          const igi_calibration *calibration, const igi_sensor *sensor,
                          const igi_exposure *exposure, uint64_t seed, igi_photo **photo)
{
    igi_status status = IGI_OK;
    igi_photo *made = NULL;
    int levels = sensor->bits > 8 ? 65536 : 256, channels = radiance->channels < 3 ? 1 : 3;
    const igi_response *response = calibration->response;
    *photo = NULL;
    if (sensor->bits < 8 || sensor->bits > 16 || !(sensor->full_well_e > 0) ||
        (response && (response->levels != levels || response->channels < channels)) ||
        radiance->width != calibration->width || radiance->height != calibration->height)
        return igi_fail(ctx, IGI_E_USAGE,
                        "photograph: a sensor of 8 to 16 bits, a response of the file's levels and "
                        "a calibration for %d x %d pixels, please",
                        radiance->width, radiance->height);
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &made));
    made->width = radiance->width;
    made->height = radiance->height;
    made->channels = channels;
    made->levels = levels;
    made->time_s = exposure->time_s;
    made->f_number = exposure->f_number;
    made->iso = exposure->iso;
    snprintf(made->camera, sizeof made->camera, "%.63s", calibration->camera);
    size_t count = (size_t)made->width * (size_t)made->height * (size_t)channels;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, count, &made->codes));
    job j = {radiance, calibration, sensor, made, igi_hdr_exposure(exposure), seed};
    IGI_TRY_GOTO(igi_parallel_for(ctx, (size_t)made->height, expose_row, &j));
    *photo = made;
    made = NULL;
cleanup:
    igi_photo_destroy(made);
    return status;
}
