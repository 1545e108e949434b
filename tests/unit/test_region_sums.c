/* SPDX-License-Identifier: Apache-2.0
 *
 * The stated errors of regions of many and of few places, against the scatter of their albedos
 * over many draws of the photographs' noise.
 */
#include "room.h"

#include "base/rng.h"
#include "diffuse/region_sums.h"

enum { WALL = 2400, TINY = 24, SHEET = 800, PLACES = WALL + TINY + SHEET, DRAWS = 400 };
#define ALBEDO 0.4

static double normal(igi_rng *rng)
{
    double sum = -6;
    for (int k = 0; k < 12; k++) sum += (double)igi_rng_float(rng);
    return sum;
}

typedef struct draw {
    uint32_t region[PLACES];
    float weight[PLACES], radiance[PLACES], irradiance[PLACES], point[PLACES][3];
} draw;

/* A wall, a thing of 24 places in two cells, and a sheet whose texture is alike in neighbours.
 * `shared`: the part of the noise that the places of a cell of .6 m have in common. */
static void fill(draw *d, igi_rng *rng, double shared)
{
    double common = 0;
    for (int i = 0; i < PLACES; i++) {
        int r = i < WALL          ? 0
                : i < WALL + TINY ? 1
                                  : 2,
            k = r == 0   ? i
                : r == 1 ? i - WALL
                         : i - WALL - TINY;
        int cell = r == 1 ? k / 18 : k / 24; /* 18 and 6; otherwise 24 each */
        if (r == 1 ? k % 18 == 0 : k % 24 == 0) common = normal(rng);
        double noise = sqrt(1 - shared) * normal(rng) + sqrt(shared) * common;
        d->region[i] = (uint32_t)r;
        d->weight[i] = .01f;
        d->irradiance[i] = 1 + .5f * igi_rng_float(rng);
        d->point[i][0] = .6f * (float)cell + .3f;
        d->point[i][1] = d->point[i][2] = .3f;
        double albedo = r == 2 ? ALBEDO + .2 * common : ALBEDO;
        d->radiance[i] = (float)(albedo / IGI_PI * (double)d->irradiance[i] * (1 + .05 * noise));
    }
}

/* The root mean square of the errors in standard deviations, and the largest. */
static void errors_in_sigmas(double shared, size_t region, double *usual, double *largest)
{
    room *r = room_new(1);
    for (int k = 0; k < 3; k++) room_region(r, "surface", .5);
    igi_patches patches = {.size_m = .1f};
    igi_problem problem = {.scene = &r->scene, .patches = &patches, .bands = 1};
    double albedo[3][IGI_MAX_BANDS], std[3][IGI_MAX_BANDS], squares = 0;
    bool determined[3];
    igi_diffuse diffuse = {.albedo = albedo, .albedo_std = std, .determined = determined};
    draw *d = calloc(1, sizeof *d);
    igi_region_sums *sums = NULL;
    if (!d) abort();
    *largest = 0;
    igi_places places = {PLACES, d->region, d->weight, d->radiance, d->irradiance, d->point[0]};
    CHECK_OK(r->ctx, igi_region_sums_create(r->ctx, &problem, &sums));
    for (uint64_t k = 0; k < DRAWS && sums; k++) {
        igi_rng rng = igi_rng_make(7, k);
        fill(d, &rng, shared);
        (void)igi_region_sums_albedo(sums, &places, albedo);
        CHECK_OK(r->ctx, igi_region_sums_std(r->ctx, sums, &places, &diffuse));
        double z = (albedo[region][0] - ALBEDO) / std[region][0];
        squares += z * z;
        *largest = fmax(*largest, fabs(z));
    }
    *usual = sqrt(squares / DRAWS);
    igi_region_sums_destroy(sums);
    free(d);
    room_free(r);
}

/* The sheet's texture is told from its noise, and no other region has any. */
static void pattern(void)
{
    room *r = room_new(1);
    for (int k = 0; k < 3; k++) room_region(r, "surface", .5);
    igi_patches patches = {.size_m = .1f};
    igi_problem problem = {.scene = &r->scene, .patches = &patches, .bands = 1};
    double albedo[3][IGI_MAX_BANDS], std[3][IGI_MAX_BANDS], part[3][IGI_MAX_BANDS] = {{0}};
    bool determined[3];
    igi_diffuse diffuse = {
        .albedo = albedo, .albedo_std = std, .pattern_std = part, .determined = determined};
    draw *d = calloc(1, sizeof *d);
    igi_region_sums *sums = NULL;
    igi_rng rng = igi_rng_make(9, 1);
    if (!d) abort();
    fill(d, &rng, 0);
    igi_places places = {PLACES, d->region, d->weight, d->radiance, d->irradiance, d->point[0]};
    CHECK_OK(r->ctx, igi_region_sums_create(r->ctx, &problem, &sums));
    (void)igi_region_sums_albedo(sums, &places, albedo);
    CHECK_OK(r->ctx, igi_region_sums_std(r->ctx, sums, &places, &diffuse));
    double even = sqrt(std[2][0] * std[2][0] - part[2][0] * part[2][0]);
    CHECK_NEAR(even / albedo[2][0], .05 / sqrt(SHEET), .3 * .05 / sqrt(SHEET));
    CHECK(std[2][0] > 10 * even);
    CHECK(part[0][0] < .5 * std[0][0]);
    igi_region_sums_destroy(sums);
    free(d);
    room_free(r);
}

/* 400 draws: the root mean square is known to 3.5 %, and the largest of a normal law lies near 3.0. */
static void independent_noise(void)
{
    double usual, largest;
    for (size_t region = 0; region < 2; region++) {
        errors_in_sigmas(0, region, &usual, &largest);
        CHECK_NEAR(usual, 1, .15);
        CHECK(largest < 4.2);
    }
}

/* What neighbours share is found in the wall's cells, and believed of the two that are too few. */
static void shared_noise(void)
{
    double usual, largest;
    errors_in_sigmas(.5, 0, &usual, &largest);
    CHECK_NEAR(usual, 1, .15);
    errors_in_sigmas(.5, 1, &usual, &largest);
    CHECK_NEAR(usual, 1, .25);
    CHECK(largest < 5);
    errors_in_sigmas(.5, 2, &usual, &largest); /* the texture widens its own region's error alone */
    CHECK_NEAR(usual, 1, .15);
}

/* Half of the places show in one pixel, half in 64: with noise alone, an area's mean has 3.2 times the error of one
 * that listens to the pixels. */
static void few_pixels(void)
{
    enum { SIDES = 200 };
    room *r = room_new(1);
    room_region(r, "surface", .5);
    uint32_t side[SIDES], region[SIDES] = {0};
    size_t begin[SIDES + 2] = {0};
    float weight[SIDES], radiance[SIDES], irradiance[SIDES], point[SIDES][3] = {{0}};
    double albedo[1][IGI_MAX_BANDS], squares[2] = {0};
    for (uint32_t i = 0; i < SIDES; i++) {
        side[i] = i;
        irradiance[i] = 1;
        begin[i + 1] = begin[i] + (i % 2 ? 64 : 1);
    }
    igi_patches patches = {.size_m = .1f};
    igi_problem problem = {
        .scene = &r->scene, .patches = &patches, .bands = 1, .site_begin = begin};
    igi_rows rows = {.side = side, .count = SIDES, .seen_count = SIDES};
    igi_places places = {SIDES, region, weight, radiance, irradiance, point[0]};
    igi_region_sums *sums = NULL;
    CHECK_OK(r->ctx, igi_region_sums_create(r->ctx, &problem, &sums));
    for (uint64_t k = 0; k < DRAWS && sums; k++) {
        igi_rng rng = igi_rng_make(11, k);
        for (int i = 0; i < SIDES; i++) {
            weight[i] = .01f;
            radiance[i] = (float)(ALBEDO / IGI_PI * (1 + .3 * normal(&rng) / (i % 2 ? 8 : 1)));
        }
        for (int weighs = 0; weighs < 2; weighs++) {
            if (weighs) igi_places_weigh_by_pixels(&problem, &rows, &places);
            (void)igi_region_sums_albedo(sums, &places, albedo);
            squares[weighs] += (albedo[0][0] - ALBEDO) * (albedo[0][0] - ALBEDO);
        }
    }
    CHECK(squares[0] > 2.5 * 2.5 * squares[1]);
    igi_region_sums_destroy(sums);
    room_free(r);
}

TEST_MAIN({"pattern", pattern}, {"few_pixels", few_pixels},
          {"independent_noise", independent_noise}, {"shared_noise", shared_noise})
