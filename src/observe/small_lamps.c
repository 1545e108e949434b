/* SPDX-License-Identifier: Apache-2.0
 *
 * A lamp of radiance a that covers the share c_i of pixel i, before surroundings b_i, shows as
 *     I_i - b_i = c_i (a - b_i) + noise of variance kappa^2 v_i,   v_i = c_i (1 - c_i + LEVEL):
 * c is the area of its projected triangles in the pixel, b a plane fitted to the pixels around it.
 * Noise and a camera that is a little off change pixels on the outline most. Least squares:
 *     a - b = sum_i (I_i - b_i) / (1 - c_i + LEVEL) / sum_i c_i / (1 - c_i + LEVEL).
 * A blurred lamp is wider and dimmer. Then sum_i (I_i - b_i) / sum_i c_i is right, with
 * more noise: it is believed where light lies beyond the outline.
 */
#include "observe/small_lamps.h"

#include "base/solve.h"
#include "observe/lamp_picture.h"
#include "observe/lamp_profile.h"
#include "observe/outlines.h"

#include <string.h>

#define RING 2       /* pixels around these, for what surrounds it */
#define LEVEL 0.05   /* what v has of a pixel that the lamp fills */
#define DISAGREE 3.0 /* standard deviations */
#define BEYOND 0.005 /* of a lamp's light: less, beyond its outline, does not matter */
#define WITHIN 0.3   /* how far off the plane is as a whole, of what its pixels are */
#define TOUCHED 1e-6 /* share of a pixel; less is rounding */
#define LEAST_PX 0.5 /* of a lamp's picture */
#define LEAST 1e-3   /* relative error of one photograph */

typedef struct scan {
    const igi_scene *scene;
    const igi_image *image;
    const igi_visible *visible;
    uint32_t region;
    igi_lamp_picture picture;
    double plane[IGI_MAX_BANDS][3]; /* at the window's middle, and its slopes */
    double scatter[IGI_MAX_BANDS];  /* of the ring's pixels about it */
} scan;

static const float *pixel_at(const scan *s, int x, int y)
{
    size_t pixel = (size_t)y * (size_t)s->image->width + (size_t)x;
    return s->image->samples + pixel * (size_t)s->image->channels;
}

static bool in_window(const scan *s, int x, int y)
{
    return x >= s->picture.window[0][0] && x < s->picture.window[0][1] &&
           y >= s->picture.window[1][0] && y < s->picture.window[1][1];
}

/* Columns and rows from the window's middle. */
static void place(const scan *s, double x, double y, double terms[3])
{
    terms[0] = 1;
    terms[1] = x - 0.5 * (s->picture.window[0][0] + s->picture.window[0][1]);
    terms[2] = y - 0.5 * (s->picture.window[1][0] + s->picture.window[1][1]);
}

static double plane_at(const scan *s, int band, double x, double y)
{
    double terms[3];
    place(s, x, y, terms);
    const double *p = s->plane[band];
    return p[0] * terms[0] + p[1] * terms[1] + p[2] * terms[2];
}

/* Fits the planes to the ring; false: something there spoils them. */
static bool fit_planes(scan *s)
{
    double matrix[9] = {0}, n = 0;
    const int size[2] = {s->image->width, s->image->height};
    for (int i = 0; i < 2; i++)
        if (s->picture.window[i][0] < RING || s->picture.window[i][1] + RING > size[i])
            return false;
    int bands = s->scene->bands;
    memset(s->plane, 0, sizeof s->plane);
    memset(s->scatter, 0, sizeof s->scatter);
    for (int pass = 0; pass < 2; pass++) {
        for (int y = s->picture.window[1][0] - RING; y < s->picture.window[1][1] + RING; y++)
            for (int x = s->picture.window[0][0] - RING; x < s->picture.window[0][1] + RING; x++) {
                double terms[3];
                size_t pixel = (size_t)y * (size_t)s->image->width + (size_t)x;
                if (pass == 0 &&
                    !igi_pixel_suits_lamp(s->scene, s->image, s->visible, pixel, s->region))
                    return false;
                if (in_window(s, x, y)) continue;
                place(s, x + 0.5, y + 0.5, terms);
                for (int k = 0; k < 9 && pass == 0; k++) matrix[k] += terms[k / 3] * terms[k % 3];
                for (int b = 0; b < bands; b++) {
                    double value = (double)pixel_at(s, x, y)[b];
                    for (int k = 0; k < 3 && pass == 0; k++) s->plane[b][k] += value * terms[k];
                    double off = pass ? value - plane_at(s, b, x + 0.5, y + 0.5) : 0;
                    s->scatter[b] += off * off;
                }
                n += pass;
            }
        if (pass == 0 && !igi_solve_cholesky(matrix, 3, s->plane[0], (size_t)bands)) return false;
    }
    for (int b = 0; b < bands; b++) s->scatter[b] = sqrt(s->scatter[b] / (n - 3));
    return true;
}

/* The sums over a window that both estimates are made of, in one band. */
typedef struct sums {
    double weights, surroundings; /* sum c / (1 - c + LEVEL), and of 1 - c */
    double fitted, all;           /* a - b by least squares, and by the light of all pixels */
    double kappa2, spread;        /* the noise; sum v */
    double beyond, outside;       /* light of pixels that the lamp does not touch; their number */
} sums;

static sums add_up(const scan *s, int band, double area)
{
    sums u = {0};
    double n = 0;
    for (int pass = 0; pass < 2; pass++) {
        for (int y = s->picture.window[1][0]; y < s->picture.window[1][1]; y++)
            for (int x = s->picture.window[0][0]; x < s->picture.window[0][1]; x++) {
                double c = fmin(
                    1,
                    s->picture.covered[y - s->picture.window[1][0]][x - s->picture.window[0][0]]);
                double w = 1 / (1 - c + LEVEL),
                       off = (double)pixel_at(s, x, y)[band] - plane_at(s, band, x + 0.5, y + 0.5);
                if (pass == 0) u.all += off / area;
                if (pass == 0 && !(c > TOUCHED)) {
                    u.beyond += off;
                    u.outside++;
                }
                if (!(c > TOUCHED)) continue;
                double residual = off - c * u.fitted;
                if (pass) u.kappa2 += residual * residual * w / c / fmax(1, n - 1);
                else {
                    n++;
                    u.weights += c * w;
                    u.fitted += off * w;
                    u.surroundings += (1 - c) * w;
                    u.spread += c / w;
                }
            }
        if (pass == 0) u.fitted /= u.weights;
    }
    return u;
}

/* Does light of the lamp's lie beyond its outline, more than what surrounds it may be off by? */
static bool is_blurred(const scan *s, const sums *u, int band)
{
    double doubt = s->scatter[band] * hypot(sqrt(u->outside), WITHIN * u->outside);
    return u->beyond > fmax(DISAGREE * doubt, BEYOND * u->all * s->picture.area_px);
}

static void read_lamp(const scan *s, igi_lamp_reading *r)
{
    double area = s->picture.area_px;
    double noise = 0, bands = s->scene->bands;
    sums of[IGI_MAX_BANDS];
    bool blurred = false;
    for (int b = 0; b < s->scene->bands; b++) {
        of[b] = add_up(s, b, area);
        noise += of[b].kappa2 / (of[b].fitted * of[b].fitted) / bands;
    }
    for (int b = 0; b < s->scene->bands; b++) blurred = blurred || is_blurred(s, &of[b], b);
    for (int b = 0; b < s->scene->bands; b++) {
        const sums *u = &of[b];
        double lamp = blurred ? u->all : u->fitted;
        double variance = noise * (blurred ? u->spread / (area * area) : 1 / u->weights);
        double around = WITHIN * s->scatter[b] * u->surroundings / u->weights;
        double error = hypot(hypot(lamp * sqrt(variance), around), LEAST * lamp);
        r->radiance[b] = (lamp + s->plane[b][0]) / s->picture.profile;
        r->error[b] = error / s->picture.profile;
    }
    for (int y = s->picture.window[1][0]; y < s->picture.window[1][1]; y++)
        for (int x = s->picture.window[0][0]; x < s->picture.window[0][1]; x++)
            for (int b = 0; b < s->scene->bands; b++)
                r->highest[b] = fmaxf(r->highest[b], pixel_at(s, x, y)[b]);
    r->region = s->region;
    r->area_px = area;
}

igi_status igi_lamps_measure(igi_context *ctx, const igi_scene *scene, const igi_tracer *tracer,
                             size_t frame, const igi_image *image, const igi_visible *visible,
                             igi_lamp_reading **readings, size_t *count)
{
    size_t capacity = *count;
    scan s = {.scene = scene, .image = image, .visible = visible};
    const igi_camera *camera = &scene->frames[frame].camera;
    for (size_t l = 0; l < scene->light_count; l++) {
        const igi_light *light = &scene->lights[l];
        if (light->type != IGI_LIGHT_AREA || light->known) continue;
        s.region = (uint32_t)light->region;
        if (!igi_lamp_picture_find(scene, tracer, camera, light, &s.picture)) continue;
        if (igi_lamp_is_dim(light, s.picture.profile)) continue;
        if (!(s.picture.area_px > LEAST_PX) || !fit_planes(&s)) continue;
        igi_lamp_reading *grown = igi_grow(ctx, *readings, &capacity, *count + 1, sizeof *grown);
        if (!grown) return IGI_E_SYSTEM;
        *readings = grown;
        grown[*count] = (igi_lamp_reading){.frame = (uint32_t)frame};
        read_lamp(&s, &grown[(*count)++]);
    }
    return IGI_OK;
}

/* Weighted by their errors, alike in all bands; where they scatter more, that is the error. */
igi_lamp_value igi_lamps_sum(const igi_lamp_reading *readings, size_t count, int bands,
                             uint32_t region)
{
    igi_lamp_value value = {0};
    double weights = 0, squares[IGI_MAX_BANDS] = {0}, all[IGI_MAX_BANDS] = {0};
    for (int pass = 0; pass < 2; pass++)
        for (size_t i = 0; i < count; i++) {
            const igi_lamp_reading *r = &readings[i];
            double relative = 0;
            for (int b = 0; b < bands; b++)
                relative += r->error[b] / fmax(r->radiance[b], 1e-30) / bands;
            if (r->region != region || !isfinite(relative)) continue;
            double w = 1 / (relative * relative);
            for (int b = 0; b < bands; b++) {
                double off = r->radiance[b] - value.radiance[b];
                if (pass) squares[b] += w * off * off;
                else all[b] += w * r->radiance[b];
            }
            if (pass) continue;
            weights += w;
            value.photographs++;
            for (int b = 0; b < bands; b++) value.radiance[b] = all[b] / weights;
        }
    double free = fmax(1, (double)value.photographs - 1);
    for (int b = 0; b < bands && value.photographs > 0; b++)
        value.error[b] = sqrt(fmax(value.radiance[b] * value.radiance[b], squares[b] / free) /
                              weights);
    return value;
}
