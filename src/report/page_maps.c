/* SPDX-License-Identifier: Apache-2.0
 *
 * The regions' maps: albedo and its uncertainty.
 */
#include "report/page.h"

#include "image/resample.h"

#include "base/order.h"

#include <math.h>
#include <stdlib.h>

/* Of each map a picture, smaller where there are many, so that the page stays a few megabytes. */
enum { MAP_SIDE = 192, MANY = 32, SMALL_SIDE = 64 };

/* A grey chequer marks texels that no photograph determines. */
static void paint_albedo(const igi_page *page, const igi_image *map, uint8_t *pixels)
{
    int bands = map->channels - 1, side = map->width > 64 ? map->width / 48 : 1;
    for (int y = 0; y < map->height; y++)
        for (int x = 0; x < map->width; x++) {
            size_t p = (size_t)y * (size_t)map->width + (size_t)x;
            const float *texel = map->samples + p * (size_t)map->channels;
            bool chequered = texel[bands] < .5f && (x / side + y / side) % 2 == 0;
            for (int c = 0; c < 3; c++) {
                uint8_t byte = igi_srgb_byte(&page->srgb, texel[igi_band_of(c, bands)]);
                pixels[3 * p + (size_t)c] = chequered ? (uint8_t)((byte + 3 * 128) / 4) : byte;
            }
        }
}

static float mean_of(const float *x, int count)
{
    float sum = 0;
    for (int i = 0; i < count; i++) sum += x[i];
    return sum / (float)count;
}

/* A round number that 98 % of the sigmas of determined texels do not exceed: 1, 2 or 5 times a
 * power of ten. */
static igi_status find_top(const igi_page *page, const igi_image *map, const igi_image *sigma,
                           float *top)
{
    size_t texels = (size_t)sigma->width * (size_t)sigma->height, count = 0;
    float *values = NULL;
    IGI_TRY(IGI_ALLOC(page->ctx, texels + 1, &values));
    for (size_t p = 0; p < texels; p++) {
        float x = mean_of(sigma->samples + p * (size_t)sigma->channels, sigma->channels);
        bool determined = map->samples[(p + 1) * (size_t)map->channels - 1] >= .5f;
        if (determined && isfinite(x)) values[count++] = x;
    }
    qsort(values, count, sizeof *values, igi_compare_floats);
    double most = fmax((double)values[count * 98 / 100], 1e-4);
    double power = pow(10, floor(log10(most))), digits = most / power;
    *top = (float)(power * (digits <= 1 ? 1 : digits <= 2 ? 2 : digits <= 5 ? 5 : 10));
    igi_free(values);
    return IGI_OK;
}

static void paint_sigma(const igi_image *sigma, float top, uint8_t *pixels)
{
    size_t count = (size_t)sigma->width * (size_t)sigma->height;
    for (size_t p = 0; p < count; p++) {
        float x = mean_of(sigma->samples + p * (size_t)sigma->channels, sigma->channels);
        igi_ramp_colour(igi_ramp_heat, isfinite(x) ? x / top : 1, pixels + 3 * p);
    }
}

static igi_status print_sigma(const igi_page *page, const char *region, const igi_image *map,
                              const igi_image *map_std, uint8_t *pixels)
{
    igi_status status = IGI_OK;
    igi_image *small = NULL;
    char *label = NULL;
    float top = 1;
    IGI_TRY_GOTO(igi_image_resample(page->ctx, map_std, map->width, map->height, &small));
    IGI_TRY_GOTO(find_top(page, map, small, &top));
    paint_sigma(small, top, pixels);
    fputs("<figure>", page->file);
    IGI_TRY_GOTO(
        igi_strprintf(page->ctx, &label, "one standard deviation of the albedo of %s", region));
    IGI_TRY_GOTO(igi_page_pixels(page, pixels, small->width, small->height, 3, label));
    fprintf(page->file,
            "<div class=\"ramp\" style=\"background:linear-gradient(90deg,#440154,#472c7a,#3b518b,"
            "#2c718e,#21908d,#27ad81,#5cc863,#aadc32,#fde725)\"></div><div class=\"ends\">"
            "<span>0</span><span>1&thinsp;&sigma; of &rho;</span><span>%.2g</span></div></figure>",
            (double)top);
cleanup:
    igi_image_destroy(small);
    igi_free(label);
    return status;
}

static igi_status print_card(const igi_page *page, const igi_material *m, int side)
{
    igi_status status = IGI_OK;
    igi_image *small = NULL;
    uint8_t *pixels = NULL;
    char *label = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(page->ctx, 3 * (size_t)side * (size_t)side, &pixels));
    IGI_TRY_GOTO(igi_image_reduce(page->ctx, m->map, side, &small));
    paint_albedo(page, small, pixels);
    fputs("<div class=\"card\"><h3>", page->file);
    igi_page_text(page, m->region);
    fputs("</h3><div class=\"pair\"><figure>", page->file);
    IGI_TRY_GOTO(igi_strprintf(page->ctx, &label, "albedo of %s", m->region));
    IGI_TRY_GOTO(igi_page_pixels(page, pixels, small->width, small->height, 3, label));
    fprintf(page->file,
            "<figcaption>albedo, %d &times; %d texels; %.0f&nbsp;%% observed in %d "
            "view%s</figcaption></figure>",
            m->map->width, m->map->height, 100 * m->observed, m->views, m->views == 1 ? "" : "s");
    if (m->map_std) IGI_TRY_GOTO(print_sigma(page, m->region, small, m->map_std, pixels));
    fputs("</div></div>\n", page->file);
cleanup:
    igi_image_destroy(small);
    igi_free(pixels);
    igi_free(label);
    return status;
}

bool igi_page_has_map(const igi_material *material)
{
    return material->map && !material->emitter;
}

igi_status igi_page_maps(const igi_page *page)
{
    int side = page->materials->count > MANY ? SMALL_SIDE : MAP_SIDE;
    fputs("<section id=\"maps\"><h2>Maps</h2><p class=\"soft\">Albedo over each region's texture "
          "square, and one standard deviation of it. Chequered texels are seen by no photograph: "
          "they are filled in from their neighbours and their region, and their error bar says "
          "so.</p><div class=\"grid\">\n",
          page->file);
    for (size_t i = 0; i < page->materials->count; i++) {
        const igi_material *m = &page->materials->materials[i];
        if (igi_page_has_map(m)) IGI_TRY(print_card(page, m, side));
    }
    fputs("</div></section>\n", page->file);
    return IGI_OK;
}
