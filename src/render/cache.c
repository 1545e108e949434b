/* SPDX-License-Identifier: Apache-2.0
 *
 * E_i = sum_l G_il value_l + sum_j F_ij rho_j E_j over the sides of patches, by Gauss and Seidel on
 * sparse rows of rays (transport/gather.c). The largest change of a sweep is below TOLERANCE of the
 * largest E when it ends: what is left is that times rho/(1 - rho).
 */
#include "render/cache.h"

#include "brdf/brdf.h"
#include "transport/gather.h"

#define TOLERANCE 1e-4f
#define MOST_SWEEPS 500
#define ALBEDO_POINTS 4 /* of a textured patch */
#define LOBE_SAMPLES 1024

typedef struct lobe_albedo {
    float scale, base;
} lobe_albedo;

struct igi_cache {
    lobe_albedo *lobes; /* of each region */
    const igi_renderer *renderer;
    igi_patches *patches;
    float *irradiance; /* [2 patches][bands] */
};

/* What a lobe reflects of light from everywhere, rho_s scale + base: its mean over cosine-distributed
 * directions, by samples of it. */
static void measure_lobe(const finish *f, lobe_albedo *lobe)
{
    if (f->absorbs || f->model == IGI_LAMBERT) return;
    for (uint32_t k = 0; k < LOBE_SAMPLES; k++) {
        igi_rng rng = igi_rng_make(k, 1);
        float u = igi_rng_float(&rng), v = igi_rng_float(&rng), scale, base;
        igi_vec out = igi_cosine_direction(igi_v(0, 0, 1), u, v);
        u = igi_rng_float(&rng);
        v = igi_rng_float(&rng);
        igi_vec in = igi_lobe_sample(f->model, f->alpha, out, u, v);
        float pdf = igi_lobe_pdf(f->model, f->alpha, in, out);
        igi_lobe_terms(f->model, f->alpha, in, out, &scale, &base);
        if (!(in.z > 0 && pdf > 0)) continue;
        lobe->scale += scale * in.z / pdf / LOBE_SAMPLES;
        lobe->base += base * in.z / pdf / LOBE_SAMPLES;
    }
}

/* All of what a surface reflects, its lobe as if it were diffuse. */
static void whole_albedo(const igi_cache *c, const finish *f, const float *diffuse, float *albedo)
{
    const lobe_albedo *lobe = &c->lobes[f - c->renderer->finishes];
    for (int b = 0; b < c->renderer->bands; b++)
        albedo[b] = fminf(diffuse[b] + f->specular[b] * lobe->scale + lobe->base, 0.99f);
}

static void patch_albedo(const igi_cache *c, uint32_t patch, float *albedo)
{
    const igi_renderer *r = c->renderer;
    const finish *f = &r->finishes[igi_patch_region(c->patches, patch)];
    float mean[IGI_MAX_BANDS] = {0}, at[IGI_MAX_BANDS];
    int points = f->map ? ALBEDO_POINTS : 1;
    igi_rng rng = igi_rng_make(patch, 0);
    for (int k = 0; k < points; k++) {
        uint32_t triangle;
        float u, v;
        igi_patch_sample(c->patches, patch, &rng, &triangle, &u, &v);
        surface_albedo(r, f, triangle, u, v, at);
        for (int b = 0; b < r->bands; b++) mean[b] += at[b] / (float)points;
    }
    whole_albedo(c, f, mean, albedo);
}

/* One sweep; the largest change over the largest irradiance. radiance[2 patches][bands]. */
static float sweep(igi_cache *c, const igi_rows *rows, const float *albedo, float *radiance)
{
    int bands = c->renderer->bands;
    float largest = 0, change = 0;
    for (size_t row = 0; row < rows->count; row++) {
        uint32_t side = rows->side[row];
        float direct[IGI_MAX_BANDS], indirect[IGI_MAX_BANDS];
        igi_row_direct(rows, row, c->renderer->lights, bands, direct);
        igi_row_indirect(rows, row, radiance, bands, indirect);
        for (int b = 0; b < bands; b++) {
            size_t at = (size_t)side * (size_t)bands + (size_t)b;
            float now = direct[b] + indirect[b];
            change = fmaxf(change, fabsf(now - c->irradiance[at]));
            largest = fmaxf(largest, now);
            c->irradiance[at] = now;
            radiance[at] = now * albedo[(size_t)(side >> 1) * (size_t)bands + (size_t)b] / IGI_PIF;
        }
    }
    return largest > 0 ? change / largest : 0;
}

/* The row with the most unshot power of all bands; the sum of all into *total. */
static size_t brightest(const igi_cache *c, const igi_rows *rows, const float *unshot,
                        double *total)
{
    size_t bands = (size_t)c->renderer->bands, best = 0;
    float most = -1;
    *total = 0;
    for (size_t row = 0; row < rows->count; row++) {
        uint32_t side = rows->side[row];
        float power = 0;
        for (size_t b = 0; b < bands; b++) power += unshot[side * bands + b];
        power *= c->patches->area[side >> 1];
        *total += (double)power;
        if (power > most) {
            most = power;
            best = row;
        }
    }
    return best;
}

/* Each ray of the brightest side takes its share of the unshot power to the side it meets: progressive
 * refinement (Cohen et al. 1988). unshot[2 patches][bands] is radiosity that is not yet shot. */
static igi_status shoot(igi_context *ctx, igi_cache *c, const igi_rows *rows, const float *albedo,
                        float *unshot)
{
    size_t bands = (size_t)c->renderer->bands;
    double total, first = 0;
    for (size_t row = 0; row < rows->count; row++) {
        float *direct = unshot + rows->side[row] * bands;
        igi_row_direct(rows, row, c->renderer->lights, (int)bands, direct);
        for (size_t b = 0; b < bands; b++) {
            c->irradiance[rows->side[row] * bands + b] = direct[b];
            direct[b] *= albedo[(rows->side[row] >> 1) * bands + b];
        }
    }
    for (size_t shots = 0; shots < 100 * rows->count; shots++) {
        size_t row = brightest(c, rows, unshot, &total);
        uint32_t side = rows->side[row];
        if (shots == 0) first = total;
        if (!(total > (double)TOLERANCE * 10 * first)) break;
        size_t begin = rows->begin[row], end = rows->begin[row + 1];
        for (size_t k = begin; k < end; k++) {
            uint32_t met = rows->hits[k];
            if (met == IGI_NO_SIDE) continue;
            float share = c->patches->area[side >> 1] /
                          ((float)(end - begin) * c->patches->area[met >> 1]);
            for (size_t b = 0; b < bands; b++) {
                float arrives = unshot[side * bands + b] * share;
                c->irradiance[met * bands + b] += arrives;
                if (met != side)
                    unshot[met * bands + b] += arrives * albedo[(met >> 1) * bands + b];
            }
        }
        for (size_t b = 0; b < bands; b++) unshot[side * bands + b] = 0;
        if (shots % 256 == 0) IGI_TRY(igi_progress(ctx, 1 - total / fmax(first, 1e-30)));
    }
    return IGI_OK;
}

static igi_status solve(igi_context *ctx, igi_cache *c, const igi_rows *rows, bool by_shooting)
{
    igi_status status = IGI_OK;
    size_t bands = (size_t)c->renderer->bands, patches = c->patches->count;
    float *albedo = NULL, *radiance = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, patches * bands, &albedo));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 2 * patches * bands, &radiance));
    for (uint32_t p = 0; p < patches; p++)
        if (c->patches->triangle[p] != IGI_NO_HIT) patch_albedo(c, p, albedo + p * bands);
    if (by_shooting) IGI_TRY_GOTO(shoot(ctx, c, rows, albedo, radiance));
    for (int k = 0; k < MOST_SWEEPS && !by_shooting; k++) {
        if (sweep(c, rows, albedo, radiance) < TOLERANCE) break;
        IGI_TRY_GOTO(igi_progress(ctx, (double)k / MOST_SWEEPS));
    }
cleanup:
    igi_free(albedo);
    igi_free(radiance);
    return status;
}

igi_status igi_cache_create(igi_context *ctx, const igi_renderer *renderer,
                            const igi_cache_options *how, igi_cache **cache)
{
    igi_status status = IGI_OK;
    igi_cache *c = NULL;
    igi_rows *rows = NULL;
    size_t *begin = NULL;
    uint8_t *wanted = NULL;
    *cache = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &c));
    c->renderer = renderer;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, renderer->scene->region_count, &c->lobes));
    for (size_t i = 0; i < renderer->scene->region_count; i++)
        measure_lobe(&renderer->finishes[i], &c->lobes[i]);
    float size = how->patch_share * igi_tracer_size(renderer->tracer, NULL, NULL);
    IGI_TRY_GOTO(igi_patches_create(ctx, &renderer->scene->mesh, size, &c->patches));
    size_t sides = 2 * c->patches->count;
    if (how->most_sides && sides > how->most_sides) goto cleanup;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, sides + 1, &begin)); /* no sites: rows start anywhere */
    IGI_TRY_GOTO(IGI_ALLOC(ctx, sides, &wanted));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, sides * (size_t)renderer->bands, &c->irradiance));
    for (size_t i = 0; i < sides; i++) wanted[i] = c->patches->triangle[i / 2] != IGI_NO_HIT;
    igi_sites sites = {.begin = begin};
    igi_gather_options options = {
        .rays = how->rays, .light_points = how->light_points, .wanted = wanted};
    IGI_TRY_GOTO(igi_rows_create(ctx, renderer->scene, c->patches, renderer->tracer,
                                 renderer->lighting, &sites, &options, &rows));
    IGI_TRY_GOTO(solve(ctx, c, rows, how->shoot));
    *cache = c;
    c = NULL;
cleanup:
    igi_rows_destroy(rows);
    igi_cache_destroy(c);
    igi_free(begin);
    igi_free(wanted);
    return status;
}

void igi_cache_destroy(igi_cache *cache)
{
    if (!cache) return;
    igi_patches_destroy(cache->patches);
    igi_free(cache->irradiance);
    igi_free(cache->lobes);
    igi_free(cache);
}

void igi_cache_add(const igi_cache *cache, const surface *s, const igi_hit *hit,
                   const float *throughput, float *radiance)
{
    float albedo[IGI_MAX_BANDS];
    int bands = cache->renderer->bands;
    uint32_t side = igi_side_at(cache->patches, hit->triangle, hit->u, hit->v, hit->back);
    const float *irradiance = cache->irradiance + (size_t)side * (size_t)bands;
    whole_albedo(cache, s->finish, s->albedo, albedo);
    for (int b = 0; b < bands; b++)
        radiance[b] += throughput[b] * albedo[b] * irradiance[b] / IGI_PIF;
}
