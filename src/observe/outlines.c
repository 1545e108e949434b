/* SPDX-License-Identifier: Apache-2.0
 *
 * A lamp of radiance a before surroundings of radiance b covers the share c of a pixel, which then
 * shows b + c (a - b). Summed over a window around the lamp,
 *     sum (I - b) / (a - b)
 * is the lamp's area in pixels, whatever the shape of the pixel's filter and wherever in the window
 * the lamp lies. The mesh has an area there, too: rays through the parts of pixels on its outline.
 * Their ratio is that of the lamps' powers.
 */
#include "observe/outlines.h"

#include "base/order.h"
#include "scene/camera.h"

#include <string.h>

#define MARGIN 3     /* pixels around the lamp */
#define PARTS 4      /* rays across a pixel on the outline */
#define CLEAN_PX 9   /* of the lamp's middle and of its surroundings, at least */
#define FEWEST_PX 40 /* of the whole lamp */
#define CONTRAST 4.0
#define SIMPLE 1.6
#define WITHIN 0.3  /* how uneven a quarter is, of how uneven they are together */
#define SINGLE 0.01 /* error of one photograph, when there are too few for their scatter to tell */
#define LIT 0.1

typedef struct scan {
    const igi_scene *scene;
    const igi_tracer *tracer;
    const igi_camera *camera;
    const igi_image *image;
    const igi_visible *visible;
    uint32_t region;
    int low[2], high[2]; /* the window: columns and rows, ends excluded */
    double *values;      /* scratch, of the window's size */
} scan;

static bool shows_lamp(const scan *s, const igi_hit *hit)
{
    return hit->triangle != IGI_NO_HIT && !hit->back &&
           s->scene->mesh.regions[hit->triangle] == s->region;
}

static const igi_hit *hit_at(const scan *s, int x, int y)
{
    return &s->visible->hits[(size_t)y * (size_t)s->visible->width + (size_t)x];
}

static bool is_lamp(const scan *s, int x, int y)
{
    const igi_visible *v = s->visible;
    return x >= 0 && y >= 0 && x < v->width && y < v->height && shows_lamp(s, hit_at(s, x, y));
}

/* Chebyshev distance to the lamp's nearest pixel; above MARGIN: farther. */
static int distance_to_lamp(const scan *s, int x, int y)
{
    for (int d = 0; d <= MARGIN; d++)
        for (int k = -d; k <= d; k++)
            if (is_lamp(s, x + k, y - d) || is_lamp(s, x + k, y + d) || is_lamp(s, x - d, y + k) ||
                is_lamp(s, x + d, y + k))
                return d;
    return MARGIN + 1;
}

static double brightness(const igi_image *image, int bands, size_t pixel)
{
    double sum = 0;
    for (int b = 0; b < bands; b++)
        sum += (double)image->samples[pixel * (size_t)image->channels + (size_t)b] / bands;
    return sum;
}

/* The share of the pixel that the mesh's lamp covers. */
static double covered(const scan *s, int x, int y)
{
    bool own = is_lamp(s, x, y), mixed = false;
    for (int k = 0; k < 9; k++) {
        int u = x + k % 3 - 1, v = y + k / 3 - 1;
        bool inside = u >= 0 && v >= 0 && u < s->visible->width && v < s->visible->height;
        mixed = mixed || (inside && is_lamp(s, u, v) != own);
    }
    if (!mixed) return own;
    int hits = 0;
    igi_vec centre = igi_camera_centre(s->camera);
    for (int k = 0; k < PARTS * PARTS; k++) {
        double u = x + (k % PARTS + .5) / PARTS, v = y + (double)(k / PARTS + .5) / PARTS;
        igi_hit hit = igi_trace(s->tracer, centre, igi_camera_direction(s->camera, u, v));
        hits += shows_lamp(s, &hit);
    }
    return (double)hits / (PARTS * PARTS);
}

bool igi_pixel_suits_lamp(const igi_scene *scene, const igi_image *image,
                          const igi_visible *visible, size_t pixel, uint32_t lamp)
{
    const igi_hit *hit = &visible->hits[pixel];
    const float *p = image->samples + pixel * (size_t)image->channels;
    for (int c = 0; c < image->channels; c++) {
        bool marks = c >= scene->bands && strcmp(image->names[c], "saturated") == 0;
        if (c < scene->bands ? !isfinite(p[c]) : marks && !(p[c] <= 0)) return false;
    }
    if (hit->triangle == IGI_NO_HIT) return false;
    uint32_t region = scene->mesh.regions[hit->triangle];
    return region == lamp || !scene->regions[region].emitter;
}

static bool is_usable(const scan *s, int x, int y)
{
    size_t pixel = (size_t)y * (size_t)s->visible->width + (size_t)x;
    return igi_pixel_suits_lamp(s->scene, s->image, s->visible, pixel, s->region);
}

static int quarter_of(const scan *s, int x, int y)
{
    return 2 * (2 * y >= s->low[1] + s->high[1]) + (2 * x >= s->low[0] + s->high[0]);
}

/* Into s->values: the radiances of the clean part of the lamp (quarter -1), or of the surroundings in
 * a quarter of the window (0 to 3) or all of it (4). */
static size_t collect(const scan *s, int quarter)
{
    size_t n = 0;
    for (int y = s->low[1]; y < s->high[1]; y++)
        for (int x = s->low[0]; x < s->high[0]; x++) {
            size_t pixel = (size_t)y * (size_t)s->visible->width + (size_t)x;
            int d = distance_to_lamp(s, x, y);
            bool wanted = quarter < 0 ? d == 0 && s->visible->near_edge[pixel] == 0
                                      : d >= 2 && d <= MARGIN;
            if (!wanted || (quarter >= 0 && quarter < 4 && quarter != quarter_of(s, x, y)))
                continue;
            s->values[n++] = brightness(s->image, s->scene->bands, pixel);
        }
    return n;
}

typedef struct levels {
    double lamp, around[4], uneven; /* radiances: of the surroundings in each quarter */
} levels;

/* False: they cannot be told. */
static bool find_levels(const scan *s, levels *l)
{
    size_t n = collect(s, -1);
    if (n < CLEAN_PX) return false;
    l->lamp = igi_median(s->values, n);
    n = collect(s, 4);
    if (n < CLEAN_PX) return false;
    double squares = 0, quarters = 0, all = igi_median(s->values, n);
    for (int quarter = 0; quarter < 4; quarter++) {
        n = collect(s, quarter);
        l->around[quarter] = n ? igi_median(s->values, n) : all;
        squares += n ? (l->around[quarter] - all) * (l->around[quarter] - all) : 0;
        quarters += n > 0;
    }
    l->uneven = sqrt(squares / quarters);
    return l->lamp > CONTRAST * fmax(0, all);
}

/* Around one simple outline, hardly fewer pixels lie two or three away than twice those beside it; bars
 * before a window show light of their own. */
static bool is_simple(const scan *s)
{
    double beside = 0, around = 0;
    for (int y = s->low[1]; y < s->high[1]; y++)
        for (int x = s->low[0]; x < s->high[0]; x++) {
            int d = distance_to_lamp(s, x, y);
            if (d <= MARGIN && !is_usable(s, x, y)) return false;
            beside += d == 1;
            around += d >= 2 && d <= MARGIN;
        }
    return around > SIMPLE * beside;
}

static bool measure(const scan *s, igi_outline *out)
{
    levels l;
    *out = (igi_outline){.region = s->region};
    if (!is_simple(s) || !find_levels(s, &l)) return false;
    for (int y = s->low[1]; y < s->high[1]; y++)
        for (int x = s->low[0]; x < s->high[0]; x++) {
            size_t pixel = (size_t)y * (size_t)s->visible->width + (size_t)x;
            if (distance_to_lamp(s, x, y) > MARGIN) continue;
            double share = covered(s, x, y), around = l.around[quarter_of(s, x, y)];
            double seen = brightness(s->image, s->scene->bands, pixel);
            out->shown_px += (seen - around) / (l.lamp - around);
            out->mesh_px += share;
            out->doubt_px += WITHIN * (1 - share) * l.uneven / (l.lamp - around);
        }
    return true;
}

/* The lamp's window; how many pixels show it. */
static size_t find_window(scan *s)
{
    const igi_visible *v = s->visible;
    size_t count = 0;
    s->low[0] = v->width, s->low[1] = v->height, s->high[0] = s->high[1] = 0;
    for (int y = 0; y < v->height; y++)
        for (int x = 0; x < v->width; x++) {
            if (!is_lamp(s, x, y)) continue;
            count++;
            const int at[2] = {x, y}, size[2] = {v->width, v->height};
            for (int k = 0; k < 2; k++) {
                if (at[k] - MARGIN < s->low[k]) s->low[k] = at[k] > MARGIN ? at[k] - MARGIN : 0;
                if (at[k] + MARGIN + 1 > s->high[k])
                    s->high[k] = at[k] + MARGIN + 1 < size[k] ? at[k] + MARGIN + 1 : size[k];
            }
        }
    return count;
}

/* Darker to one side, or to all: its outline is not where it has half its brightness. */
static bool has_profile(const igi_scene *scene, size_t region)
{
    for (size_t l = 0; l < scene->light_count; l++)
        if (scene->lights[l].region == (int)region && scene->lights[l].profile > 0) return true;
    return false;
}

igi_status igi_outlines_measure(igi_context *ctx, const igi_scene *scene, const igi_tracer *tracer,
                                const igi_camera *camera, const igi_image *image,
                                const igi_visible *visible, igi_outline **outlines, size_t *count)
{
    igi_status status = IGI_OK;
    size_t capacity = *count;
    scan s = {
        .scene = scene, .tracer = tracer, .camera = camera, .image = image, .visible = visible};
    for (size_t r = 0; r < scene->region_count; r++) {
        igi_outline one;
        if (!scene->regions[r].emitter || has_profile(scene, r)) continue;
        s.region = (uint32_t)r;
        if (find_window(&s) < FEWEST_PX) continue;
        size_t window = (size_t)(s.high[0] - s.low[0]) * (size_t)(s.high[1] - s.low[1]);
        IGI_TRY_GOTO(IGI_ALLOC(ctx, window, &s.values));
        bool good = measure(&s, &one);
        igi_free(s.values);
        s.values = NULL;
        if (!good) continue;
        igi_outline *grown = igi_grow(ctx, *outlines, &capacity, *count + 1, sizeof *grown);
        IGI_TRY_GOTO(grown ? IGI_OK : IGI_E_SYSTEM);
        *outlines = grown;
        grown[(*count)++] = one;
    }
cleanup:
    igi_free(s.values);
    return status;
}

igi_lamp_size igi_outlines_sum(const igi_outline *outlines, size_t count, uint32_t region)
{
    igi_lamp_size lamp = {.ratio = 1, .error = HUGE_VAL};
    double shown = 0, mesh = 0, doubt = 0, squares = 0;
    for (size_t i = 0; i < count; i++) {
        if (outlines[i].region != region) continue;
        shown += outlines[i].shown_px;
        mesh += outlines[i].mesh_px;
        doubt += outlines[i].doubt_px;
        lamp.photographs++;
    }
    if (!(mesh > 0)) return lamp;
    lamp.ratio = shown / mesh;
    for (size_t i = 0; i < count; i++) {
        double off = outlines[i].shown_px - lamp.ratio * outlines[i].mesh_px;
        if (outlines[i].region == region) squares += off * off;
    }
    double n = (double)lamp.photographs;
    double scatter = n > 2 ? sqrt(squares * n / (n - 1)) / mesh : SINGLE / sqrt(n);
    lamp.error = hypot(scatter, doubt / mesh);
    return lamp;
}

double igi_lit_gaps(const igi_scene *scene, const igi_image *image, const igi_visible *visible)
{
    size_t pixels = (size_t)visible->width * (size_t)visible->height, surfaces = 0, lit = 0;
    double sum = 0;
    for (size_t i = 0; i < pixels; i++) {
        uint32_t t = visible->hits[i].triangle;
        if (t == IGI_NO_HIT || scene->regions[scene->mesh.regions[t]].emitter) continue;
        double x = brightness(image, scene->bands, i);
        if (!isfinite(x)) continue;
        sum += x;
        surfaces++;
    }
    for (size_t i = 0; surfaces && i < pixels; i++)
        lit += visible->hits[i].triangle == IGI_NO_HIT &&
               brightness(image, scene->bands, i) > LIT * sum / (double)surfaces;
    return (double)lit / (double)pixels;
}
