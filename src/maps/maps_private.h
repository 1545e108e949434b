/* SPDX-License-Identifier: Apache-2.0
 *
 * What maps*.c share.
 */
#ifndef IGI_SRC_MAPS_MAPS_PRIVATE_H
#define IGI_SRC_MAPS_MAPS_PRIVATE_H

#include "maps/maps.h"

/* Sums of a texel, over what was seen in it: weight 1 is one pixel about as large as a texel. */
typedef struct igi_texels {
    int size, bands;
    bool wraps;
    float albedo;      /* of the region, about: mean over bands; the caller's */
    float *weight;     /* [size][size] */
    float *weight2;    /* of the squares */
    float *reflected;  /* [size][size][bands] pi w L */
    float *received;   /* [size][size][bands] w E */
    float *ratio2;     /* w (reflected / received)^2, bands summed before the ratio */
    float *common_var; /* w (relative standard deviation that the texel's pixels share)^2 */
    size_t pixel_count;
    float *pixels; /* [pixel_count][3 + 2 bands] x, y, w, pi L, E of each pixel, or NULL */
} igi_texels;

IGI_MUST_USE igi_status igi_texels_create(igi_context *ctx, int size, int bands, bool wraps,
                                          igi_texels *texels);
void igi_texels_clear(igi_texels *texels);

/* Sorted by region: sides that photographs show. */
typedef struct igi_region_sides {
    size_t *begin; /* [regions + 1] */
    uint32_t *sides;
} igi_region_sides;

/* Do the photographs show a texture, or one albedo and noise? `found` may be NULL. */
IGI_MUST_USE igi_status igi_find_texture(igi_context *ctx, const igi_problem *problem,
                                         const igi_field *field, const igi_region_sides *sides,
                                         uint32_t region, bool *textured,
                                         igi_texture_evidence *found);

/* The four texels about a place, and its bilinear weights among them. */
typedef struct igi_taps {
    float weight[4];
    size_t texel[4];
} igi_taps;

void igi_taps_at(const igi_texels *texels, float x, float y, igi_taps *taps);

/* Adds every observation of the region, and sharpens what comes out. */
IGI_MUST_USE igi_status igi_texels_add_pixels(igi_context *ctx, igi_texels *texels,
                                              const igi_problem *problem, const igi_field *field,
                                              const igi_layout *layout,
                                              const igi_region_sides *sides, uint32_t region);
/* Sharpens the sums' ratio by the pixels that were kept. */
IGI_MUST_USE igi_status igi_texels_sharpen(igi_context *ctx, igi_texels *texels);
/* Adds the means of the region's patches: for maps whose texels are no smaller. */
void igi_texels_add_patches(igi_texels *texels, const igi_problem *problem, const igi_field *field,
                            const igi_layout *layout, const igi_region_sides *sides,
                            uint32_t region);
/* Turns the sums into the material's maps; texels without weight are filled in from their
 * neighbours and the region's albedo. */
IGI_MUST_USE igi_status igi_texels_finish(igi_context *ctx, const igi_texels *texels,
                                          igi_material *material);

/* Fills pixels of weight 0 of image[size][size][channels] from the others by push and pull. */
IGI_MUST_USE igi_status igi_fill_holes(igi_context *ctx, float *image, const float *weight,
                                       int size, int channels, const float *fallback);

#endif
