/* SPDX-License-Identifier: Apache-2.0
 *
 * Environment maps. Row j spans the polar angles pi j/h to pi (j+1)/h from +Z; the solid angle of
 * its pixels is (2 pi/w) (cos of the one - cos of the other). Pixels are drawn in proportion to
 * their flux, rows first, then columns.
 */
#include "light/sky.h"

#include <igi/image.h>

#include <math.h>
#include <string.h>

struct sky {
    int width, height, bands;
    float rotation;  /* radians */
    float *radiance; /* [height][width][bands] */
    float *columns;  /* [height][width], running flux along each row */
    float *rows;     /* [height], running flux of rows */
};

static float row_cosine(const sky *s, int row)
{
    return cosf(IGI_PIF * (float)row / (float)s->height);
}

static float solid_angle(const sky *s, int row)
{
    return 2 * IGI_PIF / (float)s->width * (row_cosine(s, row) - row_cosine(s, row + 1));
}

static float pixel_mean(const sky *s, size_t pixel)
{
    float sum = 0;
    for (int b = 0; b < s->bands; b++) sum += s->radiance[pixel * (size_t)s->bands + (size_t)b];
    return sum / (float)s->bands;
}

static igi_status fill(igi_context *ctx, sky *s, const igi_image *image, int file_bands,
                       const char *path)
{
    size_t pixels = (size_t)s->width * (size_t)s->height;
    for (size_t i = 0; i < pixels; i++)
        for (int b = 0; b < s->bands; b++) {
            size_t from = i * (size_t)image->channels + (size_t)(file_bands == 1 ? 0 : b);
            float x = image->samples[from];
            if (!(x >= 0 && x < 1e30f))
                return igi_fail(
                    ctx, IGI_E_DATA,
                    "%s: pixel (%zu,%zu) is %g; an environment map holds numbers from 0", path,
                    i % (size_t)s->width, i / (size_t)s->width, (double)x);
            s->radiance[i * (size_t)s->bands + (size_t)b] = x;
        }
    return IGI_OK;
}

float *sky_pixels(sky *s)
{
    return s->radiance;
}

void sky_finish(sky *s, double rotation_deg)
{
    s->rotation = (float)(rotation_deg * IGI_PI / 180);
    double all = 0;
    for (int j = 0; j < s->height; j++) {
        double row = 0, omega = (double)solid_angle(s, j);
        for (int i = 0; i < s->width; i++) {
            size_t pixel = (size_t)j * (size_t)s->width + (size_t)i;
            row += (double)pixel_mean(s, pixel) * omega;
            s->columns[pixel] = (float)row;
        }
        all += row;
        s->rows[j] = (float)all;
    }
}

igi_status sky_create(igi_context *ctx, int width, int height, int bands, sky **result)
{
    size_t pixels = (size_t)width * (size_t)height;
    igi_status status = IGI_OK;
    sky *s = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &s));
    s->width = width;
    s->height = height;
    s->bands = bands;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, pixels * (size_t)bands, &s->radiance));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, pixels, &s->columns));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, (size_t)height, &s->rows));
cleanup:
    if (status != IGI_OK) {
        sky_destroy(s);
        s = NULL;
    }
    *result = s;
    return status;
}

igi_status sky_load(igi_context *ctx, const char *path, int bands, double rotation_deg,
                    sky **result)
{
    igi_status status = IGI_OK;
    igi_image *image = NULL;
    sky *s = NULL;
    IGI_TRY_GOTO(igi_image_load_exr(ctx, path, &image));
    int file_bands = image->channels - (strcmp(image->names[image->channels - 1], "A") == 0);
    if (file_bands != bands && file_bands != 1)
        IGI_TRY_GOTO(igi_fail(ctx, IGI_E_DATA, "%s: has %d bands, but the scene has %d", path,
                              file_bands, bands));
    IGI_TRY_GOTO(sky_create(ctx, image->width, image->height, bands, &s));
    IGI_TRY_GOTO(fill(ctx, s, image, file_bands, path));
    sky_finish(s, rotation_deg);
cleanup:
    igi_image_destroy(image);
    if (status != IGI_OK) {
        sky_destroy(s);
        s = NULL;
    }
    *result = s;
    return status;
}

void sky_destroy(sky *s)
{
    if (!s) return;
    igi_free(s->radiance);
    igi_free(s->columns);
    igi_free(s->rows);
    igi_free(s);
}

static size_t pixel_of(const sky *s, igi_vec d)
{
    float turn = (atan2f(d.y, d.x) - s->rotation) / (2 * IGI_PIF);
    float u = 0.5f - turn, v = acosf(fminf(1.0f, fmaxf(-1.0f, d.z))) / IGI_PIF;
    int x = (int)((u - floorf(u)) * (float)s->width), y = (int)(v * (float)s->height);
    if (x >= s->width) x = s->width - 1;
    if (y >= s->height) y = s->height - 1;
    return (size_t)y * (size_t)s->width + (size_t)x;
}

const float *sky_radiance(const sky *s, igi_vec direction)
{
    return s->radiance + pixel_of(s, direction) * (size_t)s->bands;
}

/* Index of the running sum that first exceeds `target`, and where within its step that lies. */
static int find_step(const float *running, int count, float target, float *within)
{
    int low = 0, high = count - 1;
    while (low < high) {
        int middle = (low + high) / 2;
        if (running[middle] > target) high = middle;
        else low = middle + 1;
    }
    float before = low ? running[low - 1] : 0, step = running[low] - before;
    *within = step > 0 ? fminf(0.999999f, fmaxf(0.0f, (target - before) / step)) : 0.5f;
    return low;
}

igi_vec sky_sample(const sky *s, float u, float v, float *pdf)
{
    float all = s->rows[s->height - 1], within_row, within_column;
    *pdf = 0;
    if (!(all > 0)) return igi_v(0, 0, 1);
    int row = find_step(s->rows, s->height, v * all, &within_row);
    const float *columns = s->columns + (size_t)row * (size_t)s->width;
    int column = find_step(columns, s->width, u * columns[s->width - 1], &within_column);
    float z = row_cosine(s, row) + within_row * (row_cosine(s, row + 1) - row_cosine(s, row));
    float across = ((float)column + within_column) / (float)s->width;
    float phi = (0.5f - across) * 2 * IGI_PIF + s->rotation, rim = sqrtf(fmaxf(0.0f, 1 - z * z));
    igi_vec d = {rim * cosf(phi), rim * sinf(phi), z};
    size_t pixel = (size_t)row * (size_t)s->width + (size_t)column;
    *pdf = pixel_mean(s, pixel) / all;
    return d;
}

float sky_pdf(const sky *s, igi_vec direction)
{
    float all = s->rows[s->height - 1];
    return all > 0 ? pixel_mean(s, pixel_of(s, direction)) / all : 0;
}
