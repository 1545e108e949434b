/* SPDX-License-Identifier: Apache-2.0
 *
 * The pixels that tell most about a region's lobe, and the light that reaches them.
 *
 * Each chosen pixel has a fixed set of directions with the radiance that arrives along each. For any
 * model and roughness
 *     S(alpha) = sum_m incident_m f_s(in_m, out_m; alpha) cos_m / p_m
 * is then a smooth function of alpha that costs no further ray. Lamps and surfaces are kept apart.
 * Lamps are bright and known: many directions over each, few of them tested for shadow while the
 * tests agree; and directions from lobes narrower than a lamp's points lie apart, weighed together
 * with them (balance heuristic: a narrow lobe finds a lamp always or never, a broad one by chance,
 * which is noise). Surfaces are dim and smooth: directions from lobes of four roughnesses
 * (balance heuristic; Veach 1997). An environment is both: bright as the sun, and smooth. The lobes'
 * directions that leave the scene carry its light, weighed together with directions of its own. Each direction has its own place within the pixel, so that S is
 * the mean over the pixel's footprint.
 */
#ifndef IGI_SRC_SPECULAR_HIGHLIGHTS_H
#define IGI_SRC_SPECULAR_HIGHLIGHTS_H

#include "specular/highlight_scores.h"

typedef struct igi_direction_sample {
    igi_vec in, out; /* unit, in the frame of the surface */
    float weight;    /* cos(in) over the density of the whole set; 0: carries nothing */
    int around;      /* 1 or 2, by half of its set: what it carries comes from around the scene */
    float patches;   /* distance to the surface that it meets, in sides of a patch; 0: meets none */
} igi_direction_sample;

typedef struct igi_highlights {
    size_t count;      /* pixels */
    uint64_t rays;     /* that were sent for them */
    int samples;       /* directions of each, */
    int lobe_samples;  /* of which the first are to surfaces, the others to lamps */
    float pixel_angle; /* radians across a pixel, of the cameras' mean */
    int bands;
    const double
        *tint;       /* [bands] of the lobe that is looked for, 1 on average; NULL: it has none */
    size_t groups;   /* pixels of one group show one albedo: a region, or one of its points */
    uint32_t *group; /* [count] rising */
    uint32_t *observation;            /* [count] */
    uint32_t *piece;                  /* [count] pixels of one piece of the surface share errors */
    float *radiance;                  /* [count][bands] as photographed */
    float *irradiance;                /* [count][bands] */
    igi_direction_sample *directions; /* [count][samples] */
    float *incident;                  /* [count][samples][bands] */
} igi_highlights;

typedef struct igi_highlight_options {
    size_t pixels;     /* about how many to choose */
    int lobe_samples;  /* directions from lobes, a multiple of 4 */
    int lamp_samples;  /* directions to each lamp */
    int lamp_tests;    /* shadow rays to each lamp as long as they agree */
    int sharp_samples; /* directions from narrow lobes to any lamp, an even number */
    float sharp[2];    /* roughnesses of the narrow lobes */
    float alphas[4];   /* of the lobes that directions are drawn from */
    bool per_point;    /* the region is textured: albedo is eliminated point by point */
} igi_highlight_options;

/* fewer: the same with fewer pixels, which are among the new ones; their light is known, and is not
 * looked for again. NULL: there are none. */
IGI_MUST_USE igi_status igi_highlights_create(igi_context *ctx, const igi_highlight_source *source,
                                              const igi_highlight_scores *scores,
                                              const igi_highlight_options *options,
                                              const igi_highlights *fewer,
                                              igi_highlights **highlights);
void igi_highlights_destroy(igi_highlights *highlights);

#endif
