/* SPDX-License-Identifier: Apache-2.0
 *
 * Errors against truth. A relative error is |got - want| / max(want, .02): the floor keeps black
 * surfaces from ruling the mean.
 */
#include "image/resample.h"

#include "base/order.h"

#include <igi/report.h>

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define FLOOR 0.02
#define LEAST_SEEN 0.2  /* of a region's area, to be judged */
#define DETERMINED 0.5f /* a map's A, to be judged */

static double relative(double got, double want)
{
    return fabs(got - want) / fmax(want, FLOOR);
}

static double mean(const double *x, size_t count)
{
    double sum = 0;
    for (size_t i = 0; i < count; i++) sum += x[i];
    return count ? sum / (double)count : (double)NAN;
}

typedef struct albedos {
    double got[IGI_MAX_BANDS], want[IGI_MAX_BANDS];
} albedos;

/* Texel by texel over what the photographs determine; the albedos become the means over it. */
static igi_status compare_texels(igi_context *ctx, const igi_image *got, const igi_image *want,
                                 int bands, igi_region_error *error, albedos *means)
{
    size_t texels = (size_t)want->width * (size_t)want->height, seen = 0, count = 0;
    size_t step = (size_t)bands + 1; /* maps have their A last */
    double *errors = NULL, sums[2][IGI_MAX_BANDS] = {{0}};
    IGI_TRY(IGI_ALLOC(ctx, texels * (size_t)bands, &errors));
    for (size_t i = 0; i < texels; i++) {
        const float *g = got->samples + i * step, *w = want->samples + i * step;
        if (!(g[bands] > DETERMINED)) continue;
        seen++;
        for (int b = 0; b < bands; b++) {
            errors[count++] = relative((double)g[b], (double)w[b]);
            sums[0][b] += (double)g[b];
            sums[1][b] += (double)w[b];
        }
    }
    for (int b = 0; seen && b < bands; b++) {
        means->got[b] = sums[0][b] / (double)seen;
        means->want[b] = sums[1][b] / (double)seen;
    }
    error->texture_mean = mean(errors, count);
    error->texture_median = igi_median(errors, count);
    error->texture_seen = (double)seen / (double)texels;
    igi_free(errors);
    return IGI_OK;
}

static igi_status compare_maps(igi_context *ctx, const igi_material *got, const igi_material *want,
                               int bands, igi_region_error *error, albedos *means)
{
    const igi_image *target = want->map, *map = got->map;
    igi_image *resampled = NULL;
    if (map->width != target->width || map->height != target->height)
        IGI_TRY(igi_image_resample(ctx, map, target->width, target->height, &resampled));
    igi_status status = compare_texels(ctx, resampled ? resampled : map, target, bands, error,
                                       means);
    igi_image_destroy(resampled);
    return status;
}

static double in_sigmas(double got, double want, double std)
{
    return std > 0 && !isinf(std) ? (got - want) / std : (double)NAN;
}

static double coefficient(const igi_material *m, int band)
{
    return m->specular_is_rgb ? m->specular_rgb[band] : m->specular;
}

static igi_status compare_region(igi_context *ctx, const igi_material *got,
                                 const igi_material *want, int bands, igi_region_error *error)
{
    albedos a;
    memcpy(a.got, got->albedo, sizeof a.got);
    memcpy(a.want, want->albedo, sizeof a.want);
    if (got->map && got->textured && want->map)
        IGI_TRY(compare_maps(ctx, got, want, bands, error, &a));
    error->albedo = 0;
    for (int b = 0; b < bands; b++) error->albedo += relative(a.got[b], a.want[b]) / bands;
    for (int b = 0; b < bands; b++) {
        error->albedo_z[b] = in_sigmas(a.got[b], a.want[b], got->albedo_std[b]);
        error->sigmas = fmax(error->sigmas, fabs(error->albedo_z[b])); /* fmax passes over NaN */
    }
    error->got = got->model;
    error->coloured = got->model != IGI_LAMBERT && got->specular_is_rgb;
    error->want_coloured = want->model != IGI_LAMBERT && want->specular_is_rgb;
    if (got->model != IGI_LAMBERT) {
        error->specular_values[0] = got->specular;
        error->specular_values[1] = got->specular_std;
        error->alpha_values[0] = got->alpha;
        error->alpha_values[1] = got->alpha_std;
    }
    if (want->model != IGI_LAMBERT) {
        error->specular_values[2] = want->specular;
        error->alpha_values[2] = want->alpha;
    }
    if (want->model == IGI_LAMBERT) return IGI_OK;
    error->specular = 0;
    for (int b = 0; b < bands; b++)
        error->specular += fabs(coefficient(got, b) - coefficient(want, b)) / want->specular /
                           bands;
    for (int b = 0; b < bands && error->coloured && error->want_coloured; b++)
        error->specular_rgb_z[b] = in_sigmas(got->specular_rgb[b], want->specular_rgb[b],
                                             got->specular_rgb_std[b]);
    error->specular_z = in_sigmas(got->specular, want->specular, got->specular_std);
    error->alpha_z = in_sigmas(got->alpha, want->alpha, got->alpha_std);
    error->alpha = got->alpha > 0 ? fabs(got->alpha - want->alpha) / want->alpha : 1;
    return IGI_OK;
}

static const igi_material *find(const igi_materials *materials, const char *region)
{
    for (size_t i = 0; i < materials->count; i++)
        if (strcmp(materials->materials[i].region, region) == 0) return &materials->materials[i];
    return NULL;
}

static igi_status compare_all(igi_context *ctx, const igi_materials *got, const igi_materials *want,
                              igi_validation *v)
{
    for (size_t i = 0; i < want->count; i++) {
        const igi_material *w = &want->materials[i], *g = find(got, w->region);
        igi_region_error *error = &v->regions[v->region_count++];
        const double none = (double)NAN;
        *error = (igi_region_error){.albedo = none,
                                    .texture_median = none,
                                    .texture_mean = none,
                                    .texture_seen = none,
                                    .specular = none,
                                    .alpha = none,
                                    .sigmas = none,
                                    .specular_z = none,
                                    .alpha_z = none,
                                    .want = w->model};
        for (int b = 0; b < IGI_MAX_BANDS; b++)
            error->albedo_z[b] = error->specular_rgb_z[b] = none;
        for (int k = 0; k < 3; k++) error->specular_values[k] = error->alpha_values[k] = none;
        IGI_TRY(igi_strdup(ctx, w->region, &error->region));
        error->judged = !w->emitter && w->observed >= LEAST_SEEN;
        error->missing = error->judged && !g;
        if (error->missing) error->albedo = 1;
        if (error->judged && g) IGI_TRY(compare_region(ctx, g, w, want->bands, error));
    }
    return IGI_OK;
}

static void collect(const igi_validation *v, size_t field, double *values, size_t *count)
{
    *count = 0;
    for (size_t i = 0; i < v->region_count; i++) {
        const char *region = (const char *)&v->regions[i];
        double x;
        memcpy(&x, region + field, sizeof x);
        if (v->regions[i].judged && !isnan(x)) values[(*count)++] = x;
    }
}

static igi_status summarise(igi_context *ctx, igi_validation *v)
{
    double *x = NULL;
    size_t n = 0;
    IGI_TRY(IGI_ALLOC(ctx, v->region_count, &x));
    collect(v, offsetof(igi_region_error, specular), x, &n);
    v->specular_mean = mean(x, n);
    collect(v, offsetof(igi_region_error, alpha), x, &n);
    v->alpha_mean = mean(x, n);
    collect(v, offsetof(igi_region_error, texture_median), x, &n);
    v->texture_median = mean(x, n);
    collect(v, offsetof(igi_region_error, albedo), x, &n);
    v->albedo_mean = mean(x, n);
    v->albedo_median = igi_median(x, n);
    v->albedo_max = n ? x[n - 1] : (double)NAN; /* the median has sorted them */
    igi_free(x);
    for (size_t i = 0; i < v->region_count; i++) {
        const igi_region_error *r = &v->regions[i];
        if (!r->judged || r->missing) continue;
        bool got = r->got != IGI_LAMBERT, want = r->want != IGI_LAMBERT;
        v->models++;
        v->models_right += r->got == r->want;
        v->glossy_right += got && want;
        v->glossy_false += got && !want;
        v->glossy_missed += !got && want;
    }
    return IGI_OK;
}

igi_status igi_validate_materials(igi_context *ctx, const igi_materials *got,
                                  const igi_materials *truth, igi_validation **validation)
{
    igi_status status = IGI_OK;
    igi_validation *v = NULL;
    *validation = NULL;
    if (got->bands != truth->bands)
        return igi_fail(ctx, IGI_E_DATA, "the result has %d bands, the truth %d", got->bands,
                        truth->bands);
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &v));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, truth->count, &v->regions));
    v->bands = truth->bands;
    IGI_TRY_GOTO(compare_all(ctx, got, truth, v));
    IGI_TRY_GOTO(summarise(ctx, v));
    *validation = v;
    v = NULL;
cleanup:
    igi_validation_destroy(v);
    return status;
}

igi_status igi_validate(igi_context *ctx, const char *folder, const char *truth_folder,
                        igi_validation **validation)
{
    igi_status status = IGI_OK;
    igi_materials *got = NULL, *want = NULL;
    *validation = NULL;
    IGI_TRY_GOTO(igi_materials_load(ctx, folder, &got));
    IGI_TRY_GOTO(igi_materials_load(ctx, truth_folder, &want));
    if (got->bands != want->bands)
        IGI_TRY_GOTO(igi_fail(ctx, IGI_E_DATA,
                              "%s: has %d bands, the truth in %s has %d; compare "
                              "results of the same scene",
                              folder, got->bands, truth_folder, want->bands));
    IGI_TRY_GOTO(igi_validate_materials(ctx, got, want, validation));
cleanup:
    igi_materials_destroy(got);
    igi_materials_destroy(want);
    return status;
}

void igi_validation_destroy(igi_validation *validation)
{
    if (!validation) return;
    for (size_t i = 0; validation->regions && i < validation->region_count; i++)
        igi_free(validation->regions[i].region);
    igi_free(validation->regions);
    igi_free(validation);
}
