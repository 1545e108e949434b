/* SPDX-License-Identifier: Apache-2.0
 *
 * From sums to maps: rho of each texel and its standard deviation, which holds two things: how the
 * pixels of a texel scatter about it (pooled with the region's, where they are few), which more of them
 * average out, and the errors of E and of the lobe, which all pixels of a texel share, so that they stay.
 */
#include "maps/maps_private.h"

/* The pixels of a texel count as much as the region's when they are this many. */
#define POOLED 4.0f
/* Share of the difference between neighbours that a texel's error is made of (measured on rooms
 * with known textures). */
#define BLUR 0.25f
#define DARK_SHARE 0.02

/* Relative variance of one pixel (weight 1) about its texel, over the region. */
static float pixel_variance(const igi_texels *t)
{
    double sum = 0, count = 0;
    for (size_t i = 0; i < (size_t)t->size * (size_t)t->size; i++) {
        if (!(t->weight[i] > 0)) continue;
        float n = t->weight[i] * t->weight[i] / t->weight2[i], l = 0, e = 0;
        if (n < 2) continue;
        for (size_t b = 0; b < (size_t)t->bands; b++) {
            l += t->reflected[i * (size_t)t->bands + b];
            e += t->received[i * (size_t)t->bands + b];
        }
        if (!(l > 0) || !(e > 0)) continue;
        float variance = fmaxf(0.0f, t->ratio2[i] / t->weight[i] * e * e / (l * l) - 1);
        sum += (double)(variance * n);
        count += (double)(n - 1);
    }
    return count > 0 ? (float)(sum / count) : 0.01f;
}

static float relative_variance(const igi_texels *t, size_t i, float pooled)
{
    float n = t->weight[i] * t->weight[i] / t->weight2[i], l = 0, e = 0, variance = pooled;
    for (size_t b = 0; b < (size_t)t->bands; b++) {
        l += t->reflected[i * (size_t)t->bands + b];
        e += t->received[i * (size_t)t->bands + b];
    }
    if (l > 0 && e > 0) {
        float own = fmaxf(0.0f, t->ratio2[i] / t->weight[i] * e * e / (l * l) - 1);
        variance = (n * own + POOLED * pooled) / (n - 1 + POOLED);
    }
    return variance / fmaxf(n, 1) + t->common_var[i] / t->weight[i];
}

/* Light below which a texel tells nothing: a share of what the region's texels get on average. */
static void find_darkness(const igi_texels *t, float *darkness)
{
    size_t bands = (size_t)t->bands;
    double sum[IGI_MAX_BANDS] = {0}, weight = 0;
    for (size_t i = 0; i < (size_t)t->size * (size_t)t->size; i++) {
        weight += (double)t->weight[i];
        for (size_t b = 0; b < bands; b++) sum[b] += (double)t->received[i * bands + b];
    }
    for (size_t b = 0; b < bands; b++)
        darkness[b] = weight > 0 ? (float)(DARK_SHARE * sum[b] / weight) : 0;
}

/* Albedo, its standard deviation, and how far the texel is determined. false: it is not. */
static bool finish_texel(const igi_texels *t, size_t i, float pooled, const float *darkness,
                         float *albedo, float *std)
{
    size_t bands = (size_t)t->bands;
    if (!(t->weight[i] > 0)) return false;
    for (size_t b = 0; b < bands; b++)
        if (!(t->received[i * bands + b] > darkness[b] * t->weight[i])) return false;
    float relative = sqrtf(relative_variance(t, i, pooled));
    for (size_t b = 0; b < bands; b++) {
        albedo[b] = fmaxf(0.0f, t->reflected[i * bands + b] / t->received[i * bands + b]);
        std[b] = relative * fmaxf(albedo[b], 1e-3f);
    }
    albedo[bands] = t->weight[i] / (t->weight[i] + 1) / (1 + t->common_var[i] / t->weight[i]);
    return true;
}

/* Where the texture changes from texel to texel, what lies between is a guess: adds the mean square
 * difference to the four neighbours, in part. */
static void add_blur(const igi_texels *t, const igi_image *map, const float *known, igi_image *std)
{
    size_t bands = (size_t)t->bands, size = (size_t)t->size;
    for (size_t i = 0; i < size * size; i++) {
        if (!(known[i] > 0)) continue;
        size_t near[4] = {i % size > 0 ? i - 1 : i, i % size < size - 1 ? i + 1 : i,
                          i >= size ? i - size : i, i + size < size * size ? i + size : i};
        for (size_t b = 0; b < bands; b++) {
            float squares = 0, *s = &std->samples[i * bands + b];
            for (int k = 0; k < 4; k++) {
                if (!(known[near[k]] > 0)) continue;
                float d = map->samples[near[k] * (bands + 1) + b] -
                          map->samples[i * (bands + 1) + b];
                squares += 0.25f * d * d;
            }
            *s = sqrtf(*s * *s + BLUR * BLUR * squares);
        }
    }
}

/* How far a filled-in texel may be off: as much as determined ones differ from the region's mean. */
static void spread_of(const igi_texels *t, const igi_image *map, const igi_material *m,
                      float *spread)
{
    for (int b = 0; b < t->bands; b++) {
        double sum = 0, count = 0;
        for (size_t i = 0; i < (size_t)t->size * (size_t)t->size; i++) {
            const float *texel = map->samples + i * (size_t)map->channels;
            if (!(texel[t->bands] > 0)) continue;
            double d = (double)texel[b] - m->albedo[b];
            sum += d * d;
            count++;
        }
        spread[b] = (float)sqrt((count > 0 ? sum / count : 0) +
                                m->albedo_std[b] * m->albedo_std[b]);
    }
}

igi_status igi_texels_finish(igi_context *ctx, const igi_texels *texels, igi_material *material)
{
    igi_status status = IGI_OK;
    const igi_texels *t = texels;
    size_t n = (size_t)t->size * (size_t)t->size, bands = (size_t)t->bands;
    float *known = NULL, fallback[IGI_MAX_BANDS + 1] = {0}, spread[IGI_MAX_BANDS];
    float pooled = pixel_variance(t), darkness[IGI_MAX_BANDS];
    find_darkness(t, darkness);
    IGI_TRY_GOTO(igi_image_create(ctx, t->size, t->size, t->bands + 1, &material->map));
    IGI_TRY_GOTO(igi_image_create(ctx, t->size, t->size, t->bands, &material->map_std));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n, &known));
    for (size_t i = 0; i < n; i++)
        known[i] = finish_texel(t, i, pooled, darkness, material->map->samples + i * (bands + 1),
                                material->map_std->samples + i * bands);
    for (size_t b = 0; b < bands; b++) fallback[b] = (float)material->albedo[b];
    if (material->textured) add_blur(t, material->map, known, material->map_std);
    spread_of(t, material->map, material, spread);
    for (size_t i = 0; i < n; i++)
        for (size_t b = 0; b < bands && !(known[i] > 0); b++)
            material->map_std->samples[i * bands + b] = spread[b];
    IGI_TRY_GOTO(
        igi_fill_holes(ctx, material->map->samples, known, t->size, t->bands + 1, fallback));
    for (size_t i = 0; i < n; i++)
        if (!(known[i] > 0)) material->map->samples[i * (bands + 1) + bands] = 0;
cleanup:
    igi_free(known);
    return status;
}
