/* SPDX-License-Identifier: Apache-2.0
 *
 * Maps, the evidence for textures and the predicted photographs on rooms with known truth, every
 * region taken as lambert. Judged as maps are elsewhere: median relative error of the texels that
 * the photographs determine (A > 0.5), a floor of 0.02 below.
 */
#include "test.h"

#include <igi/igi.h>
#include <stdlib.h>
#include <string.h>

typedef struct result {
    igi_context *ctx;
    igi_scene *scene;
    igi_recovery *recovery;
    igi_materials *truth;
} result;

/* Nothing is said of textures: the photographs have to. */
static bool recover_room(const char *name, result *r)
{
    char path[1024], truth[1100];
    *r = (result){0};
    if (!test_shared_data(name, path, sizeof path)) return false;
    r->ctx = test_context(0);
    snprintf(truth, sizeof truth, "%s/truth", path);
    CHECK_OK(r->ctx, igi_scene_load(r->ctx, path, &r->scene));
    CHECK_OK(r->ctx, igi_materials_load(r->ctx, truth, &r->truth));
    if (!r->scene || !r->truth) return false;
    for (size_t i = 0; i < r->scene->region_count; i++) r->scene->regions[i].textured = IGI_AUTO;
    CHECK_OK(r->ctx, igi_recover(r->ctx, r->scene, NULL, &r->recovery));
    return r->recovery != NULL;
}

static void finish(result *r)
{
    igi_recovery_destroy(r->recovery);
    igi_materials_destroy(r->truth);
    igi_scene_destroy(r->scene);
    igi_context_destroy(r->ctx);
}

static const igi_material *named(const igi_materials *m, const char *name)
{
    for (size_t i = 0; i < m->count; i++)
        if (strcmp(m->materials[i].region, name) == 0) return &m->materials[i];
    return NULL;
}

/* Textures are found where there are any, and nowhere else. */
static void check_textures(const result *r)
{
    for (size_t i = 0; i < r->recovery->materials->count; i++) {
        const igi_material *got = &r->recovery->materials->materials[i];
        const igi_material *want = named(r->truth, got->region);
        if (got->emitter) continue;
        if (want && got->textured != (want->map != NULL)) printf("region %s\n", got->region);
        CHECK(want && got->textured == (want->map != NULL));
        CHECK((got->map != NULL) == got->determined && (got->map_std != NULL) == got->determined);
    }
}

static int compare_doubles(const void *pa, const void *pb)
{
    double a = *(const double *)pa, b = *(const double *)pb;
    return a < b ? -1 : a > b;
}

/* Median error of the map against the truth's, which is coarser by a whole number or as fine. */
static double median_error(const igi_image *map, const igi_image *truth)
{
    int step = map->width / truth->width, bands = map->channels - 1;
    size_t n = 0, texels = (size_t)truth->width * (size_t)truth->height;
    double *errors = calloc(texels * (size_t)bands, sizeof *errors), median;
    if (!errors) abort();
    for (size_t t = 0; t < texels; t++) {
        double sum[IGI_MAX_BANDS + 1] = {0};
        for (int k = 0; k < step * step; k++) {
            size_t x = t % (size_t)truth->width * (size_t)step + (size_t)(k % step);
            size_t y = t / (size_t)truth->width * (size_t)step + (size_t)(k / step);
            const float *texel = map->samples +
                                 (y * (size_t)map->width + x) * (size_t)map->channels;
            for (int b = 0; b <= bands; b++) sum[b] += (double)texel[b] / (step * step);
        }
        if (!(sum[bands] > 0.5)) continue;
        for (int b = 0; b < bands; b++) {
            double want = (double)truth->samples[t * (size_t)truth->channels + (size_t)b];
            errors[n++] = fabs(sum[b] - want) / fmax(want, 0.02);
        }
    }
    qsort(errors, n, sizeof *errors, compare_doubles);
    median = n > 0 ? errors[n / 2] : 1;
    free(errors);
    return median;
}

/* Share of texels within two standard deviations of the region's true albedo. */
static double covered(const igi_material *got, const igi_material *want, int bands)
{
    double in = 0, all = 0;
    for (size_t i = 0; i < (size_t)got->map->width * (size_t)got->map->height; i++) {
        const float *texel = got->map->samples + i * (size_t)got->map->channels;
        if (texel[bands] < 0.5f) continue;
        for (int b = 0; b < bands; b++) {
            double d = fabs((double)texel[b] - want->albedo[b]);
            in += d < 2 * (double)got->map_std->samples[i * (size_t)bands + (size_t)b];
            all++;
        }
    }
    return all > 0 ? in / all : 0;
}

/* Mean over the pixels of prediction / photograph, of all comparisons. */
static double mean_ratio(const igi_recovery *r)
{
    double got = 0, want = 0;
    for (size_t c = 0; c < r->comparison_count; c++) {
        const igi_comparison *p = &r->comparisons[c];
        size_t n = (size_t)p->photo->width * (size_t)p->photo->height * (size_t)p->photo->channels;
        CHECK(p->photo->width == p->prediction->width && p->photo->height == p->prediction->height);
        for (size_t i = 0; i < n; i++) {
            got += (double)p->prediction->samples[i];
            want += (double)p->photo->samples[i];
        }
    }
    return got / want;
}

static void cornell(void)
{
    result r;
    if (!recover_room("scenes/cornell-diffuse", &r)) return;
    check_textures(&r);
    for (size_t i = 0; i < r.recovery->materials->count; i++) {
        const igi_material *m = &r.recovery->materials->materials[i];
        if (!m->map) continue;
        CHECK(m->map->width <= 64);
        CHECK(covered(m, named(r.truth, m->region), 3) > 0.85);
    }
    CHECK(r.recovery->comparison_count == 4);
    CHECK_NEAR(mean_ratio(r.recovery), 1, 0.01);
    finish(&r);
}

static void office(void)
{
    result r;
    if (!recover_room("scenes/office", &r)) return;
    check_textures(&r);
    const igi_material *floor_ = named(r.recovery->materials, "floor");
    const igi_material *picture = named(r.recovery->materials, "picture");
    CHECK(median_error(floor_->map, named(r.truth, "floor")->map) < 0.02);
    CHECK(picture->map && picture->map->width == 64); /* its pixels are that large */
    CHECK_NEAR(floor_->albedo[0] / 0.46069, 1, 0.01);
    CHECK_NEAR(picture->albedo[0] / 0.43053, 1, 0.015);
    CHECK_NEAR(mean_ratio(r.recovery), 1, 0.01);
    finish(&r);
}

/* Glossy: what highlights leave in the albedo is the next step's to take out. */
static void cubical_room(void)
{
    result r;
    if (!recover_room("scenes/cubical-room", &r)) return;
    check_textures(&r);
    const igi_material *floor_ = named(r.recovery->materials, "floor");
    const igi_material *wall = named(r.recovery->materials, "wall_n");
    CHECK(median_error(floor_->map, named(r.truth, "floor")->map) < 0.16);
    CHECK(median_error(wall->map, named(r.truth, "wall_n")->map) < 0.13);
    finish(&r);
}

TEST_MAIN({"cornell", cornell}, {"office", office}, {"cubical_room", cubical_room})
