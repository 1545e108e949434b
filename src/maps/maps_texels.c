/* SPDX-License-Identifier: Apache-2.0
 *
 * rho = pi sum w L / sum w E of each texel, over the pixels in it: a ratio of sums, since a mean of
 * ratios would be biased by noise in E. A pixel is shared by the four texels about it. Its weight
 * falls with its footprint: a pixel that covers many texels tells little of each.
 */
#include "maps/maps_private.h"

#include "specular/effort.h"
#include "specular/lobe_view.h"
#include "scene/camera.h"

#define SITES_A_SIDE 8
/* Relative errors: of a pixel; of the lobe's light from lamps, which a few samples and a mean share
 * of shadow give; of that from surfaces, a mean over a patch. */
#define PIXEL_NOISE 0.05f
#define LAMP_ERROR 0.1f
#define SURFACE_ERROR 0.3f
#define MOST_STRIDE 4 /* where an error is asked for that needs no more */
/* Pixels of a region are kept for sharpening up to this; of more, there are many in each texel. */
#define KEPT_BYTES ((size_t)48 << 20)

igi_status igi_texels_create(igi_context *ctx, int size, int bands, bool wraps, igi_texels *texels)
{
    size_t n = (size_t)size * (size_t)size;
    igi_status status = IGI_OK;
    *texels = (igi_texels){.size = size, .bands = bands, .wraps = wraps};
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n, &texels->weight));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n, &texels->weight2));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n * (size_t)bands, &texels->reflected));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n * (size_t)bands, &texels->received));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n, &texels->ratio2));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n, &texels->common_var));
cleanup:
    if (status != IGI_OK) igi_texels_clear(texels);
    return status;
}

void igi_texels_clear(igi_texels *texels)
{
    igi_free(texels->weight);
    igi_free(texels->weight2);
    igi_free(texels->reflected);
    igi_free(texels->received);
    igi_free(texels->ratio2);
    igi_free(texels->common_var);
    igi_free(texels->pixels);
    *texels = (igi_texels){0};
}

typedef struct sample {
    const float *radiance;   /* [bands] */
    const float *irradiance; /* [bands] */
    float ratio2, common_var;
} sample;

static sample make_sample(const igi_texels *t, const float *radiance, const float *irradiance,
                          float std)
{
    float l = 0, e = 0;
    for (int b = 0; b < t->bands; b++) {
        l += radiance[b];
        e += irradiance[b];
    }
    float ratio = e > 0 ? IGI_PIF * l / e : 0;
    return (sample){radiance, irradiance, ratio * ratio, std * std};
}

static void add_to_texel(igi_texels *t, size_t texel, float w, const sample *s)
{
    size_t first = texel * (size_t)t->bands;
    t->weight[texel] += w;
    t->weight2[texel] += w * w;
    t->ratio2[texel] += w * s->ratio2;
    t->common_var[texel] += w * s->common_var;
    for (size_t b = 0; b < (size_t)t->bands; b++) {
        t->reflected[first + b] += w * IGI_PIF * s->radiance[b];
        t->received[first + b] += w * s->irradiance[b];
    }
}

static void splat(igi_texels *t, float x, float y, float weight, const sample *s)
{
    igi_taps taps;
    igi_taps_at(t, x, y, &taps);
    for (int k = 0; k < 4; k++)
        if (weight * taps.weight[k] > 0) add_to_texel(t, taps.texel[k], weight * taps.weight[k], s);
}

/* Keeps the pixel for sharpening. */
static void keep(igi_texels *t, float x, float y, float weight, const sample *s)
{
    size_t bands = (size_t)t->bands;
    float *to = t->pixels + t->pixel_count++ * (3 + 2 * bands);
    to[0] = x;
    to[1] = y;
    to[2] = weight;
    for (size_t b = 0; b < bands; b++) {
        to[3 + b] = IGI_PIF * s->radiance[b];
        to[3 + bands + b] = s->irradiance[b];
    }
}

/* Side of a texel on the surface, metres; without end where the texture's coordinates are collapsed. */
static float texel_side(const igi_layout *layout, uint32_t triangle, int size)
{
    const float *t = layout->uvs + 6 * (size_t)triangle;
    float area = 0.5f * fabsf((t[2] - t[0]) * (t[5] - t[1]) - (t[3] - t[1]) * (t[4] - t[0]));
    return area > 0 ? sqrtf(igi_triangle_area(&layout->scene->mesh, triangle) / area) / (float)size
                    : HUGE_VALF;
}

static float mean_of(const float *x, size_t bands)
{
    float sum = 0;
    for (size_t b = 0; b < bands; b++) sum += x[b];
    return sum / (float)bands;
}

/* The photographed radiance without the region's lobe. What is left has noise and the errors of the
 * lobe's two parts, which are shares of them. Returns its trust beside a view without a highlight, one
 * over the variance; *error: of the lobe, relative to the diffuse part. */
static float without_lobe(const igi_problem *problem, size_t observation, size_t frame,
                          float diffuse, float *radiance, float *error)
{
    const igi_observations *o = problem->observations;
    size_t bands = (size_t)o->bands;
    igi_lobe_parts lobe = {.lit = 0};
    igi_hit hit = {.triangle = igi_surface_triangle(o->surface[observation]),
                   .u = o->uv[2 * observation],
                   .v = o->uv[2 * observation + 1],
                   .back = igi_surface_is_back(o->surface[observation])};
    int half = (int)(observation % 2);
    if (problem->lobes) igi_lobe_view_parts(problem->lobes, problem, frame, &hit, half, &lobe);
    for (size_t b = 0; b < bands; b++)
        radiance[b] = o->radiance[observation * bands + b] - lobe.radiance[b];
    diffuse = fmaxf(diffuse, 1e-9f);
    *error = fminf(hypotf(LAMP_ERROR * lobe.lit, SURFACE_ERROR * lobe.mirrored) / diffuse, 1e6f);
    float noise = PIXEL_NOISE * (1 + (lobe.lit + lobe.mirrored) / diffuse);
    return PIXEL_NOISE * PIXEL_NOISE / (noise * noise + *error * *error);
}

/* Of so many pixels one will do for the error that was asked for. */
static size_t one_of(const igi_recover_options *options)
{
    double stride = floor(1 / igi_lobe_effort(options));
    return stride < MOST_STRIDE ? (size_t)stride : MOST_STRIDE;
}

static void add_pixels_of_side(igi_texels *texels, const igi_problem *problem,
                               const igi_field *field, const igi_layout *layout, uint32_t side)
{
    const igi_observations *o = problem->observations;
    float std = igi_field_std(field, side), texel = 0;
    uint32_t triangle = IGI_NO_HIT;
    size_t frame = 0, stride = one_of(problem->options);
    size_t first = problem->site_begin[side] + side % stride;
    for (size_t n = first; n < problem->site_begin[side + 1]; n += stride) {
        size_t i = problem->order[n];
        float u = o->uv[2 * i], v = o->uv[2 * i + 1], x, y, irradiance[IGI_MAX_BANDS];
        while (i >= o->frame_begin[frame + 1]) frame++;
        if (igi_surface_triangle(o->surface[i]) != triangle) {
            triangle = igi_surface_triangle(o->surface[i]);
            texel = texel_side(layout, triangle, texels->size);
        }
        float share = texel / fmaxf(igi_footprint(problem, frame, o->surface[i], u, v), 1e-9f);
        float weight = fminf(1, share * share), radiance[IGI_MAX_BANDS], error;
        igi_field_irradiance(field, o->surface[i], u, v, irradiance);
        float diffuse = texels->albedo / IGI_PIF * mean_of(irradiance, (size_t)problem->bands);
        weight *= without_lobe(problem, i, frame, diffuse, radiance, &error);
        igi_layout_place(layout, triangle, u, v, texels->size, &x, &y);
        sample s = make_sample(texels, radiance, irradiance, hypotf(std, error));
        splat(texels, x, y, weight, &s);
        if (texels->pixels) keep(texels, x, y, weight, &s);
    }
}

igi_status igi_texels_add_pixels(igi_context *ctx, igi_texels *texels, const igi_problem *problem,
                                 const igi_field *field, const igi_layout *layout,
                                 const igi_region_sides *sides, uint32_t region)
{
    size_t begin = sides->begin[region], end = sides->begin[region + 1], pixels = 0;
    size_t stride = 3 + 2 * (size_t)texels->bands;
    for (size_t k = begin; k < end; k++) pixels += igi_problem_seen_count(problem, sides->sides[k]);
    if (pixels * stride * sizeof(float) <= KEPT_BYTES)
        IGI_TRY(IGI_ALLOC(ctx, pixels * stride, &texels->pixels));
    for (size_t k = begin; k < end; k++)
        add_pixels_of_side(texels, problem, field, layout, sides->sides[k]);
    return igi_texels_sharpen(ctx, texels);
}

void igi_texels_add_patches(igi_texels *texels, const igi_problem *problem, const igi_field *field,
                            const igi_layout *layout, const igi_region_sides *sides,
                            uint32_t region)
{
    const igi_observations *o = problem->observations;
    for (size_t k = sides->begin[region]; k < sides->begin[region + 1]; k++) {
        uint32_t side = sides->sides[k];
        float irradiance[IGI_MAX_BANDS];
        float radiance[IGI_MAX_BANDS];
        for (size_t b = 0; b < (size_t)problem->bands; b++) {
            size_t at = side * (size_t)problem->bands + b;
            radiance[b] = problem->seen[at] -
                          (problem->lobes ? problem->lobes->correction->seen[at] : 0);
        }
        if (!igi_field_of_side(field, side, irradiance)) continue;
        sample s = make_sample(texels, radiance, irradiance, igi_field_std(field, side));
        size_t begin = problem->site_begin[side], sites = igi_problem_seen_count(problem, side);
        size_t taken = sites < SITES_A_SIDE ? sites : SITES_A_SIDE;
        for (size_t n = 0; n < taken; n++) {
            size_t i = problem->order[begin + n * sites / taken];
            float x, y;
            igi_layout_place(layout, igi_surface_triangle(o->surface[i]), o->uv[2 * i],
                             o->uv[2 * i + 1], texels->size, &x, &y);
            splat(texels, x, y, (float)sites / (float)taken, &s);
        }
    }
}
