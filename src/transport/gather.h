/* SPDX-License-Identifier: Apache-2.0
 *
 * Rows of gathered light: for a side of a patch, which other sides its rays meet, and what the
 * lights give it directly.
 *
 *     E_i = sum_l G_il value_l + (pi / K) sum_k L(hit_ik)
 *
 * with K cosine-distributed rays: a sparse row of the form-factor matrix, F_ij = (hits of j) / K.
 * The rays start at the points of the side that the photographs show, so that irradiance and
 * radiance are means over the same places; of a side that none shows, at points of all of it.
 */
#ifndef IGI_SRC_TRANSPORT_GATHER_H
#define IGI_SRC_TRANSPORT_GATHER_H

#include "light/light.h"
#include "transport/patches.h"

/* Points on surfaces, sorted by side of patch: those of side s are order[begin[s]..begin[s + 1]),
 * each an index into surface (triangle << 1 | back) and uv. */
typedef struct igi_sites {
    const size_t *begin;
    const uint32_t *order;
    const uint32_t *surface;
    const float *uv;
} igi_sites;

typedef struct igi_gather_options {
    int rays;              /* K, rays of each row; 0: only the lights are looked for */
    int light_points;      /* points of each row from which the lights are looked for; >= 1 */
    int region_rays;       /* what the rows of a region with sites send together at least, so that
                              a small region is known as well as a large one; rows without sites
                              then send together about as many as the others. 0: K each */
    const uint8_t *wanted; /* [2 patches] non-zero: a side that gets a row; NULL: every side with
                              sites, every side that their rays meet, and so on until no new side
                              is met */
    bool keep_met;         /* of wanted sides: fill in igi_rows.met */
} igi_gather_options;

#define IGI_NO_ROW UINT32_MAX
#define IGI_NO_SIDE UINT32_MAX

typedef struct igi_rows {
    size_t count;
    size_t seen_count; /* rows 0..seen_count-1 are sides with sites; the others were met by rays */
    size_t lights;
    size_t *begin;      /* [count + 1] rays of a row: hits[begin[row]...] */
    uint32_t *side;     /* [count] 2 patch + back */
    uint32_t *row_of;   /* [2 * patches] row of a side, or IGI_NO_ROW */
    uint32_t *hits;     /* [begin[count]] side met, or IGI_NO_SIDE: nothing, or a lamp */
    igi_hit *met;       /* [begin[count]] the hits themselves; NULL unless asked for */
    float *direct;      /* [count][lights] irradiance per unit of the light's value */
    float *open;        /* [count][lights] the same, as if nothing were in between: equal to direct
                         where each shadow ray arrived */
    float *visible_var; /* [count][lights] variance of direct / open, as the shadow rays scatter */
    float *point;       /* [count][3] mean place of what it starts from */
} igi_rows;

/* Emitters reflect nothing and get no row. */
IGI_MUST_USE igi_status igi_rows_create(igi_context *ctx, const igi_scene *scene,
                                        const igi_patches *patches, const igi_tracer *tracer,
                                        const igi_lighting *lighting, const igi_sites *sites,
                                        const igi_gather_options *options, igi_rows **rows);
void igi_rows_destroy(igi_rows *rows);

/* (pi / K) sum_k L(hit_k) of a row, per band, from radiance[2 patches][bands]. */
void igi_row_indirect(const igi_rows *rows, size_t row, const float *radiance, int bands,
                      float *irradiance);
/* Variance of that in one band, as the rays scatter: an upper bound, since they are well spread. */
double igi_row_variance(const igi_rows *rows, size_t row, const float *radiance, int bands,
                        int band);
/* sum_l G_l value_l of a row, per band. */
void igi_row_direct(const igi_rows *rows, size_t row, const igi_light *lights, int bands,
                    float *irradiance);

#endif
