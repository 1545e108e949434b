/* SPDX-License-Identifier: Apache-2.0
 *
 * Every uncertain number p (the albedo of a region, all bands as one, its rho_s, its alpha, the power
 * of a light that was solved) goes up or down by its sigma in each of K renderings of the whole
 * scene, along the rows of a Hadamard matrix: signs s_kp with sum_k s_kp s_kq = 0. To first order
 * the pixels' variance over the K renderings is sum_p (dL/dp sigma_p)^2 exactly, no matter how
 * one number's errors hang together across the picture; numbers count as independent of each
 * other. All K draw the same random numbers, so that the noise of paths cancels. Beyond K - 1
 * numbers, rows are used again.
 *
 * The texels' own errors are independent and stay where they are seen: they are added in squares.
 */
#include "render/doubt.h"

#include "base/rng.h"
#include "render/cache.h"

#include <math.h>
#include <string.h>

enum { MOST_VARIANTS = 32, SAMPLES = 4, RAYS = 8 };
#define LEAST_ALPHA 0.002f

struct igi_doubt {
    const igi_renderer *base;
    const igi_materials *materials;
    double (*light_std)[IGI_MAX_BANDS];
    int variant_count;
    igi_renderer *variants[MOST_VARIANTS];
    igi_light *lights[MOST_VARIANTS];
    igi_renderer *texels; /* albedos are the standard deviations of texels; NULL: no maps */
};

static const igi_material *material_at(const igi_doubt *d, size_t region)
{
    return &d->materials->materials[region]; /* in the scene's order */
}

/* Sign of a number in a variant. */
static float sign_of(int variant, size_t number)
{
    unsigned bits = (unsigned)variant & (unsigned)(number % (MOST_VARIANTS - 1) + 1);
    float sign = 1;
    for (; bits; bits &= bits - 1) sign = -sign;
    return sign;
}

static void move(float *x, double by, float low, float high)
{
    *x = fminf(high, fmaxf(low, *x + (float)by));
}

static bool is_uncertain(const double *std, int bands)
{
    bool uncertain = false;
    for (int b = 0; b < bands; b++) uncertain |= std[b] > 0;
    return uncertain;
}

/* Moves one region's numbers; `number` counts them. With variant < 0 they are only counted. */
static void move_region(const igi_doubt *d, int variant, size_t region, finish *f, size_t *number)
{
    const igi_material *m = material_at(d, region);
    int bands = d->base->bands;
    if (f->absorbs) return;
    if (is_uncertain(m->albedo_std, bands)) {
        float sign = sign_of(variant, (*number)++);
        for (int b = 0; b < bands && variant >= 0; b++) {
            double change = (double)sign * m->albedo_std[b];
            f->map_scale[b] = fmaxf(0, 1 + (float)(change / fmax(m->albedo[b], 1e-3)));
            move(&f->albedo[b], change, 0, 0.99f);
        }
    }
    if (m->model == IGI_LAMBERT) return;
    if (m->specular_std > 0) {
        double change = (double)sign_of(variant, (*number)++) * m->specular_std;
        for (int b = 0; b < bands && variant >= 0; b++) move(&f->specular[b], change, 0, 1);
        if (variant >= 0) move(&f->specular_mean, change, 0, 1);
    }
    if (m->alpha_std > 0) {
        float sign = sign_of(variant, (*number)++);
        if (variant < 0) return;
        f->alpha *= expf(sign * fminf(1, (float)(m->alpha_std / m->alpha)));
        f->alpha = fminf(1, fmaxf(LEAST_ALPHA, f->alpha));
    }
}

static size_t move_all(const igi_doubt *d, int variant, finish *finishes, igi_light *lights)
{
    size_t number = 0, light_count = igi_lighting_count(d->base->lighting);
    for (size_t i = 0; i < d->base->scene->region_count; i++)
        move_region(d, variant, i, &finishes[i], &number);
    for (size_t l = 0; l < light_count && d->light_std; l++) {
        if (!is_uncertain(d->light_std[l], d->base->bands)) continue;
        float sign = sign_of(variant, number++);
        for (int b = 0; b < d->base->bands && variant >= 0; b++)
            lights[l].value[b] = fmax(0, lights[l].value[b] + (double)sign * d->light_std[l][b]);
    }
    return number;
}

static igi_status add_variant(igi_context *ctx, igi_doubt *d, int k)
{
    const igi_cache_options rough = {.rays = RAYS, .light_points = 4, .patch_share = 0.02f};
    size_t light_count = igi_lighting_count(d->base->lighting);
    IGI_TRY(IGI_ALLOC(ctx, light_count, &d->lights[k]));
    if (light_count) memcpy(d->lights[k], d->base->lights, light_count * sizeof **d->lights);
    IGI_TRY(igi_renderer_vary(ctx, d->base, d->lights[k], &d->variants[k]));
    igi_renderer *r = d->variants[k];
    (void)move_all(d, k, r->finishes, d->lights[k]);
    IGI_TRY(igi_cache_create(ctx, r, &rough, &r->cache));
    r->cache_edge = 2;
    return IGI_OK;
}

/* Maps of standard deviations in the place of maps. */
static igi_status add_texels(igi_context *ctx, igi_doubt *d)
{
    bool any = false;
    for (size_t i = 0; i < d->base->scene->region_count; i++)
        any |= d->base->finishes[i].map && material_at(d, i)->map_std;
    if (!any) return IGI_OK;
    IGI_TRY(igi_renderer_vary(ctx, d->base, d->base->lights, &d->texels));
    for (size_t i = 0; i < d->base->scene->region_count; i++) {
        finish *f = &d->texels->finishes[i];
        f->map = f->map ? material_at(d, i)->map_std : NULL;
        memset(f->albedo, 0, sizeof f->albedo);
    }
    return IGI_OK;
}

igi_status igi_doubt_create(igi_context *ctx, const igi_renderer *base,
                            const igi_materials *materials, double (*light_std)[IGI_MAX_BANDS],
                            igi_doubt **doubt)
{
    igi_status status = IGI_OK;
    IGI_TRY(IGI_ALLOC(ctx, 1, doubt));
    igi_doubt *d = *doubt;
    *d = (igi_doubt){.base = base, .materials = materials, .light_std = light_std};
    size_t numbers = move_all(d, -1, base->finishes, NULL);
    for (d->variant_count = 2;
         (size_t)d->variant_count <= numbers && d->variant_count < MOST_VARIANTS;)
        d->variant_count *= 2;
    for (int k = 0; k < d->variant_count; k++) {
        IGI_TRY_GOTO(add_variant(ctx, d, k));
        IGI_TRY_GOTO(igi_progress(ctx, (double)k / d->variant_count));
    }
    IGI_TRY_GOTO(add_texels(ctx, d));
cleanup:
    if (status != IGI_OK) {
        igi_doubt_destroy(d);
        *doubt = NULL;
    }
    return status;
}

void igi_doubt_destroy(igi_doubt *d)
{
    if (!d) return;
    for (int k = 0; k < MOST_VARIANTS; k++) {
        igi_renderer_destroy(d->variants[k]);
        igi_free(d->lights[k]);
    }
    igi_renderer_destroy(d->texels);
    igi_free(d);
}

/* Sums over the variants: of a pixel and of its square; of the mean pixel and of its square. */
typedef struct sums {
    double *pixel, *square; /* [values] */
    double mean, mean_square;
} sums;

static igi_status add_up(igi_context *ctx, const igi_doubt *d, const igi_camera *camera,
                         uint64_t key, sums *sum)
{
    igi_status status = IGI_OK;
    igi_image *picture = NULL;
    igi_render_options options;
    igi_render_options_init(&options);
    options.samples = SAMPLES;
    IGI_TRY(igi_image_create(ctx, camera->width, camera->height, d->base->bands, &picture));
    size_t count = (size_t)camera->width * (size_t)camera->height * (size_t)d->base->bands;
    igi_layers layers = {.pictures = &picture};
    for (int k = 0; k < d->variant_count; k++) {
        double mean = 0;
        IGI_TRY_GOTO(igi_renderer_frames(ctx, d->variants[k], camera, 1, &options, key, &layers));
        for (size_t i = 0; i < count; i++) {
            double x = (double)picture->samples[i];
            mean += x / (double)count;
            sum->pixel[i] += x;
            sum->square[i] += x * x;
        }
        sum->mean += mean;
        sum->mean_square += mean * mean;
    }
cleanup:
    igi_image_destroy(picture);
    return status;
}

/* Adds, in squares, the error of the texels that a pixel shows, relative to their albedo. */
static igi_status add_texel_errors(igi_context *ctx, const igi_doubt *d, const igi_camera *camera,
                                   uint64_t key, igi_image *relative)
{
    igi_status status = IGI_OK;
    igi_image *images[3] = {NULL, NULL, NULL}; /* a picture that nobody looks at, std, albedo */
    igi_render_options options;
    igi_render_options_init(&options);
    options.samples = SAMPLES;
    options.max_depth = 2;
    size_t count = (size_t)camera->width * (size_t)camera->height * (size_t)d->base->bands;
    for (int k = 0; k < 3; k++)
        IGI_TRY_GOTO(
            igi_image_create(ctx, camera->width, camera->height, d->base->bands, &images[k]));
    for (int k = 1; k < 3; k++) {
        igi_layers layers = {.pictures = &images[0], .albedos = &images[k]};
        IGI_TRY_GOTO(igi_renderer_frames(ctx, k == 1 ? d->texels : d->base, camera, 1, &options,
                                         key, &layers));
    }
    for (size_t i = 0; i < count; i++) {
        float std = images[1]->samples[i], albedo = images[2]->samples[i];
        if (albedo > 0) relative->samples[i] = hypotf(relative->samples[i], std / albedo);
    }
cleanup:
    for (int k = 0; k < 3; k++) igi_image_destroy(images[k]);
    return status;
}

static double deviation(double sum, double squares, double n)
{
    return sqrt(fmax(0, squares / n - sum / n * (sum / n)));
}

igi_status igi_doubt_picture(igi_context *ctx, const igi_doubt *d, const igi_camera *camera,
                             uint64_t key, const igi_image *picture, igi_image **sigma,
                             igi_picture_doubt *summary)
{
    igi_status status = IGI_OK;
    sums sum = {NULL, NULL, 0, 0};
    size_t count = (size_t)camera->width * (size_t)camera->height * (size_t)d->base->bands;
    double total = 0, doubt = 0, n = d->variant_count;
    *sigma = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, count, &sum.pixel));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, count, &sum.square));
    IGI_TRY_GOTO(igi_image_create(ctx, camera->width, camera->height, d->base->bands, sigma));
    IGI_TRY_GOTO(add_up(ctx, d, camera, key, &sum));
    for (size_t i = 0; i < count; i++)
        if (sum.pixel[i] > 0)
            (*sigma)->samples[i] = (float)(deviation(sum.pixel[i], sum.square[i], n) * n /
                                           sum.pixel[i]);
    if (d->texels) IGI_TRY_GOTO(add_texel_errors(ctx, d, camera, key, *sigma));
    for (size_t i = 0; i < count; i++) {
        (*sigma)->samples[i] *= picture->samples[i];
        total += (double)picture->samples[i];
        doubt += (double)(*sigma)->samples[i];
    }
    summary->pixel = total > 0 ? doubt / total : 0;
    summary->picture = sum.mean > 0 ? deviation(sum.mean, sum.mean_square, n) * n / sum.mean : 0;
cleanup:
    igi_free(sum.pixel);
    igi_free(sum.square);
    if (status != IGI_OK) igi_image_destroy(*sigma);
    if (status != IGI_OK) *sigma = NULL;
    return status;
}
