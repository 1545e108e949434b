/* SPDX-License-Identifier: Apache-2.0
 *
 * With residuals d_i = pi L_i - rho E_i, summed over clusters c of neighbouring places,
 *     var(rho) = n/(n-1) sum_c (sum_{i in c} w_i d_i)^2 / (sum_i w_i E_i)^2,   n clusters,
 * the sandwich of a ratio estimator that allows errors to be alike within a cluster.
 */
#include "diffuse/region_sums.h"

#include <string.h>

/* Side of a cluster in patches. */
#define CLUSTER_PATCHES 6
/* What is said of a region that nothing determines: anything in 0..1 may be true. */
#define UNKNOWN_STD 0.3

struct igi_region_sums {
    const igi_problem *problem;
    double (*reflected)[IGI_MAX_BANDS]; /* [regions] pi sum w L */
    double (*received)[IGI_MAX_BANDS];  /* [regions] sum w E */
};

igi_status igi_places_create(igi_context *ctx, const igi_problem *problem, const igi_rows *rows,
                             const float *irradiance, igi_places *places)
{
    size_t n = rows->seen_count, bands = (size_t)problem->bands;
    *places = (igi_places){.irradiance = irradiance, .point = rows->point};
    igi_status status = IGI_OK;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n, &places->region));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n, &places->weight));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, n * bands, &places->radiance));
    for (size_t i = 0; i < n; i++) {
        uint32_t side = rows->side[i];
        places->region[i] = igi_patch_region(problem->patches, side >> 1);
        if (igi_problem_seen_count(problem, side) == 0) continue;
        places->weight[i] = problem->patches->area[side >> 1];
        memcpy(places->radiance + i * bands, problem->seen + side * bands, bands * sizeof(float));
    }
    places->count = n;
cleanup:
    if (status != IGI_OK) igi_places_clear(places);
    return status;
}

void igi_places_clear(igi_places *places)
{
    igi_free(places->region);
    igi_free(places->weight);
    igi_free(places->radiance);
    *places = (igi_places){0};
}

igi_status igi_region_sums_create(igi_context *ctx, const igi_problem *problem,
                                  igi_region_sums **sums)
{
    igi_region_sums *s = NULL;
    igi_status status = IGI_OK;
    *sums = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &s));
    s->problem = problem;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, problem->scene->region_count, &s->reflected));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, problem->scene->region_count, &s->received));
    *sums = s;
    s = NULL;
cleanup:
    igi_region_sums_destroy(s);
    return status;
}

void igi_region_sums_destroy(igi_region_sums *sums)
{
    if (!sums) return;
    igi_free(sums->reflected);
    igi_free(sums->received);
    igi_free(sums);
}

static void add_up(igi_region_sums *s, const igi_places *places)
{
    size_t bands = (size_t)s->problem->bands;
    for (size_t r = 0; r < s->problem->scene->region_count; r++)
        for (size_t b = 0; b < bands; b++) s->reflected[r][b] = s->received[r][b] = 0;
    for (size_t i = 0; i < places->count; i++) {
        double w = (double)places->weight[i];
        if (w <= 0) continue;
        uint32_t r = places->region[i];
        for (size_t b = 0; b < bands; b++) {
            s->reflected[r][b] += w * IGI_PI * (double)places->radiance[i * bands + b];
            s->received[r][b] += w * (double)places->irradiance[i * bands + b];
        }
    }
}

static bool is_determined(const igi_region_sums *s, size_t region)
{
    if (s->problem->scene->regions[region].emitter) return false;
    for (int b = 0; b < s->problem->bands; b++)
        if (s->received[region][b] > 0) return true;
    return false;
}

/* The mean over determined regions: the guess for what nothing shows. */
static double common_albedo(const igi_region_sums *s, int band)
{
    double sum = 0, n = 0;
    for (size_t r = 0; r < s->problem->scene->region_count; r++)
        if (is_determined(s, r) && s->received[r][band] > 0) {
            sum += s->reflected[r][band] / s->received[r][band];
            n++;
        }
    return n > 0 ? fmin(sum / n, 1) : 0.5;
}

double igi_region_sums_albedo(igi_region_sums *sums, const igi_places *places,
                              double (*albedo)[IGI_MAX_BANDS])
{
    double change = 0;
    add_up(sums, places);
    for (int b = 0; b < sums->problem->bands; b++) {
        double common = common_albedo(sums, b);
        for (size_t r = 0; r < sums->problem->scene->region_count; r++) {
            if (sums->problem->scene->regions[r].emitter) continue;
            double received = sums->received[r][b];
            double updated = received > 0 ? sums->reflected[r][b] / received : common;
            updated = fmax(0, updated);
            change = fmax(change, fabs(updated - albedo[r][b]));
            albedo[r][b] = updated;
        }
    }
    return change;
}

typedef struct cluster {
    uint32_t region; /* UINT32_MAX: the slot is empty */
    int32_t cell[3];
    double residual[IGI_MAX_BANDS];
} cluster;

static cluster *find_cluster(cluster *table, size_t slots, uint32_t region, const int32_t cell[3])
{
    uint64_t h = igi_hash64(((uint64_t)(uint32_t)cell[0] << 32 | (uint32_t)cell[1]) ^
                            igi_hash64((uint64_t)(uint32_t)cell[2] << 32 | region));
    for (size_t i = h & (slots - 1);; i = (i + 1) & (slots - 1)) {
        cluster *c = &table[i];
        if (c->region == UINT32_MAX) {
            *c = (cluster){.region = region, .cell = {cell[0], cell[1], cell[2]}};
            return c;
        }
        if (c->region == region && c->cell[0] == cell[0] && c->cell[1] == cell[1] &&
            c->cell[2] == cell[2])
            return c;
    }
}

static igi_status make_clusters(igi_context *ctx, const igi_region_sums *s,
                                const igi_places *places, double (*albedo)[IGI_MAX_BANDS],
                                cluster **table, size_t *slots)
{
    size_t bands = (size_t)s->problem->bands;
    float side = CLUSTER_PATCHES * s->problem->patches->size_m;
    *slots = 64;
    while (*slots < 2 * places->count) *slots *= 2;
    IGI_TRY(IGI_ALLOC(ctx, *slots, table));
    for (size_t i = 0; i < *slots; i++) (*table)[i].region = UINT32_MAX;
    for (size_t i = 0; i < places->count; i++) {
        if (places->weight[i] <= 0) continue;
        int32_t cell[3];
        for (int k = 0; k < 3; k++)
            cell[k] = (int32_t)floorf(places->point[3 * i + (size_t)k] / side);
        cluster *c = find_cluster(*table, *slots, places->region[i], cell);
        for (size_t b = 0; b < bands; b++)
            c->residual[b] += (double)places->weight[i] *
                              (IGI_PI * (double)places->radiance[i * bands + b] -
                               albedo[c->region][b] * (double)places->irradiance[i * bands + b]);
    }
    return IGI_OK;
}

igi_status igi_region_sums_std(igi_context *ctx, igi_region_sums *sums, const igi_places *places,
                               igi_diffuse *diffuse)
{
    cluster *table = NULL;
    size_t slots = 0, regions = sums->problem->scene->region_count;
    uint32_t *clusters = NULL;
    igi_status status = IGI_OK;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions, &clusters));
    add_up(sums, places);
    IGI_TRY_GOTO(make_clusters(ctx, sums, places, diffuse->albedo, &table, &slots));
    for (size_t r = 0; r < regions; r++)
        for (int b = 0; b < sums->problem->bands; b++) diffuse->albedo_std[r][b] = 0;
    for (size_t i = 0; i < slots; i++) {
        if (table[i].region == UINT32_MAX) continue;
        clusters[table[i].region]++;
        for (int b = 0; b < sums->problem->bands; b++)
            diffuse->albedo_std[table[i].region][b] += table[i].residual[b] * table[i].residual[b];
    }
    for (size_t r = 0; r < regions; r++) {
        diffuse->determined[r] = is_determined(sums, r);
        double n = (double)clusters[r];
        for (int b = 0; b < sums->problem->bands; b++) {
            double received = sums->received[r][b], *std = &diffuse->albedo_std[r][b];
            *std = received > 0 && n > 1 ? sqrt(n / (n - 1) * *std) / received : UNKNOWN_STD;
            if (sums->problem->scene->regions[r].emitter) *std = 0;
        }
    }
cleanup:
    igi_free(table);
    igi_free(clusters);
    return status;
}
