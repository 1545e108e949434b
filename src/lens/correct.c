/* SPDX-License-Identifier: Apache-2.0
 *
 * Undoing distortion and vignetting, with one resampling.
 *
 * The result is what a pinhole of the same focal lengths and principal point would have seen, or
 * another camera that the caller names: for each of its pixels the direction is known (for a
 * pinhole at once), the distorted place is closed-form, and is read there by Catmull and Rom's
 * bicubic, held within the four pixels around (no overshoot at lamps). Vignetting belongs to the
 * sensor, so it is divided out at the distorted place, before interpolating, pixel by pixel.
 * Variances interpolate with the squares of the weights.
 */
#include "base/context.h"
#include "base/parallel.h"
#include "image/resample.h"
#include "lens/lens_private.h"

#include "scene/camera.h"

#include <math.h>
#include <string.h>

typedef enum channel_kind { COLOUR, VARIANCE, SATURATED, ALPHA } channel_kind;

typedef struct job {
    const igi_calibration *calibration;
    const igi_image *image;
    igi_image *out;
    igi_camera distorted, wanted; /* look along -z, from the origin */
    channel_kind kinds[IGI_MAX_BANDS + 1];
} job;

static channel_kind kind_of(const char *name)
{
    if (strncmp(name, "variance.", 9) == 0) return VARIANCE;
    if (strcmp(name, "saturated") == 0) return SATURATED;
    return strcmp(name, "A") == 0 ? ALPHA : COLOUR;
}

/* One channel at the place whose surrounding pixels are given by index and weight. */
static float read_channel(const job *j, int channel, const size_t at[4][4],
                          const double weights[4][4], const double gains[4][4])
{
    const float *samples = j->image->samples + channel;
    size_t stride = (size_t)j->image->channels;
    channel_kind kind = j->kinds[channel];
    double sum = 0, low = HUGE_VAL, high = -HUGE_VAL;
    for (int y = 0; y < 4; y++)
        for (int x = 0; x < 4; x++) {
            double value = (double)samples[at[y][x] * stride], w = weights[y][x], g = gains[y][x];
            bool inner = x > 0 && x < 3 && y > 0 && y < 3;
            if (w == 0) continue; /* NaN beside an exact hit stays there */
            if (kind == COLOUR) value *= g;
            if (kind == VARIANCE) value *= g * g, w *= w;
            sum += w * value;
            if (inner) low = fmin(low, value), high = fmax(high, value);
        }
    if (kind == SATURATED) return (float)high;
    if (kind == ALPHA) return (float)low;
    if (kind == VARIANCE) return (float)sum;
    /* NaN and Inf pass through: the caller of the corrected image decides. */
    return (float)(sum < low ? low : sum > high ? high : sum);
}

static igi_status correct_row(igi_context *ctx, void *user, size_t row, int worker)
{
    const job *j = user;
    int width = j->out->width, height = j->out->height;
    const int size[2] = {width, height};
    const igi_camera *lens = &j->distorted;
    (void)ctx;
    (void)worker;
    for (int column = 0; column < width; column++) {
        float *to = j->out->samples +
                    (row * (size_t)width + (size_t)column) * (size_t)j->out->channels;
        igi_vec p = igi_camera_direction(&j->wanted, column + .5, (double)row + .5);
        double x = column + .5, y = (double)row + .5, wx[4], wy[4], weights[4][4], gains[4][4];
        size_t at[4][4];
        if (j->calibration->has_lens && (!igi_camera_project(lens, p, &x, &y) ||
                                         !(x >= 0 && y >= 0 && x <= width && y <= height))) {
            /* The photograph does not reach there, which black would not say. */
            for (int c = 0; c < j->out->channels; c++) to[c] = NAN;
            continue;
        }
        int x0 = (int)floor(x - .5), y0 = (int)floor(y - .5);
        igi_cubic_weights(x - .5 - x0, wx);
        igi_cubic_weights(y - .5 - y0, wy);
        for (int v = 0; v < 4; v++)
            for (int u = 0; u < 4; u++) {
                int px = igi_clamp_index(x0 + u - 1, width),
                    py = igi_clamp_index(y0 + v - 1, height);
                at[v][u] = (size_t)py * (size_t)width + (size_t)px;
                weights[v][u] = wx[u] * wy[v];
                gains[v][u] = 1 / igi_vignetting_at(&j->calibration->vignetting, px + .5, py + .5,
                                                    size);
            }
        for (int c = 0; c < j->out->channels; c++)
            to[c] = read_channel(j, c, (const size_t(*)[4])at, (const double(*)[4])weights,
                                 (const double(*)[4])gains);
    }
    return IGI_OK;
}

static void put_at_origin(igi_camera *camera)
{
    memset(camera->camera_to_world, 0, sizeof camera->camera_to_world);
    for (int i = 0; i < 3; i++) camera->camera_to_world[i][i] = 1;
}

static igi_camera lens_at_origin(const igi_calibration *c)
{
    igi_camera lens = c->lens;
    if (!c->has_lens) {
        lens.fl_x = lens.fl_y = c->width;
        lens.cx = c->width / 2.;
        lens.cy = c->height / 2.;
    }
    put_at_origin(&lens);
    return lens;
}

static igi_camera pinhole_of(igi_camera lens)
{
    lens.k1 = lens.k2 = lens.k3 = lens.p1 = lens.p2 = 0;
    return lens;
}

igi_status igi_correct_for(igi_context *ctx, const igi_calibration *calibration,
                           const igi_image *image, const igi_camera *wanted, igi_image **corrected)
{
    igi_status status = IGI_OK;
    igi_camera lens = lens_at_origin(calibration);
    job j = {calibration, image, NULL, lens, wanted ? *wanted : pinhole_of(lens), {COLOUR}};
    put_at_origin(&j.wanted);
    *corrected = NULL;
    if (image->width != calibration->width || image->height != calibration->height)
        return igi_fail(ctx, IGI_E_DATA,
                        "image: %d x %d pixels, and the calibration is for %d x %d; use the full "
                        "size, uncropped",
                        image->width, image->height, calibration->width, calibration->height);
    igi_stage_begin(ctx, "correct");
    IGI_TRY_GOTO(igi_image_create(ctx, image->width, image->height, image->channels, &j.out));
    memcpy(j.out->names, image->names, sizeof image->names);
    j.out->deviation = image->deviation;
    for (int c = 0; c < image->channels; c++) j.kinds[c] = kind_of(image->names[c]);
    IGI_TRY_GOTO(igi_parallel_for(ctx, (size_t)image->height, correct_row, &j));
    *corrected = j.out;
    j.out = NULL;
cleanup:
    igi_stage_begin(ctx, NULL);
    igi_image_destroy(j.out);
    return status;
}

igi_status igi_correct(igi_context *ctx, const igi_calibration *calibration, const igi_image *image,
                       igi_image **corrected, igi_camera *camera)
{
    IGI_TRY(igi_correct_for(ctx, calibration, image, NULL, corrected));
    if (camera) *camera = pinhole_of(lens_at_origin(calibration));
    return IGI_OK;
}
