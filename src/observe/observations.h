/* SPDX-License-Identifier: Apache-2.0
 *
 * Photographs turned into observations: this point of that surface was seen with this radiance.
 */
#ifndef IGI_SRC_OBSERVE_OBSERVATIONS_H
#define IGI_SRC_OBSERVE_OBSERVATIONS_H

#include "observe/edges.h"
#include "observe/glow.h"
#include "observe/outlines.h"
#include "observe/small_lamps.h"

/* One side of one triangle, in one number. */
static inline uint32_t igi_surface_of(const igi_hit *hit)
{
    return hit->triangle << 1 | (hit->back ? 1u : 0u);
}
static inline uint32_t igi_surface_triangle(uint32_t surface)
{
    return surface >> 1;
}
static inline bool igi_surface_is_back(uint32_t surface)
{
    return (surface & 1) != 0;
}

/* Of a picture's radiance x and its mean m, (x - share m) / kept is without the veil. */
typedef struct igi_veil {
    double share, kept; /* 0, 1: none */
} igi_veil;

/* Pixels that show one surface point each; in the order of frames, then of pixels. */
typedef struct igi_observations {
    int bands;
    size_t count;
    size_t frame_count;
    size_t *frame_begin; /* [frame_count + 1] */
    uint32_t *surface;   /* [count] */
    float *uv;           /* [count][2] barycentric */
    uint32_t *pixel;     /* [count] row * width + column in its frame */
    float *radiance;     /* [count][bands], W m^-2 sr^-1 */
    bool *scarce;        /* [regions] few clean pixels, or none but those near its edges */
    igi_registration *registrations; /* [frame_count] */
    double *mean;                    /* [frame_count][bands] of each whole picture */
    float *glow;       /* [frame_count][IGI_GLOW_CELLS] of each picture; NULL: not measured */
    igi_veil *veils;   /* [frame_count] that were taken off */
    double *saturated; /* [frame_count] share of its pixels that were left out as saturated */
    size_t outline_count;
    igi_outline *outlines; /* [outline_count] */
    size_t reading_count;
    igi_lamp_reading *readings; /* [reading_count] of lamps whose radiance nobody gave */
    double response_deviation;  /* the largest of the photographs' */
    double lit_gaps;            /* mean over the photographs */
    igi_image **previews;       /* [frame_count] small pictures; NULL: nobody asked for them */
    size_t warning_count;
    char **warnings;
} igi_observations;

/* Reads every photograph of the scene once, finds what each pixel shows, and leaves out pixels near
 * edges, pixels that show nothing, pixels that a merge marks as saturated, and pixels that are not
 * finite or clearly negative (with a warning that names the first). Of more than `limit` pixels an even share is kept (0: 8 million).
 * IGI_E_DATA when a photograph has no usable pixel because its camera sees no surface, or too many
 * of its pixels are broken. */
IGI_MUST_USE igi_status igi_observe(igi_context *ctx, const igi_scene *scene,
                                    const igi_tracer *tracer, size_t limit,
                                    igi_observations **observations);
/* The same, and keeps a picture of each photograph, at most `side` pixels wide and high. */
IGI_MUST_USE igi_status igi_observe_with_previews(igi_context *ctx, const igi_scene *scene,
                                                  const igi_tracer *tracer, int side,
                                                  igi_observations **observations);
/* The observation of a pixel (row * width + column) of a frame; SIZE_MAX: it was left out. */
size_t igi_observation_at(const igi_observations *observations, size_t frame, uint32_t pixel);
/* The frame of an observation. */
size_t igi_observation_frame(const igi_observations *observations, size_t observation);
/* The same, when that of one nearby is known. */
static inline size_t igi_observation_frame_near(const igi_observations *o, size_t observation,
                                                size_t frame)
{
    bool same = observation >= o->frame_begin[frame] && observation < o->frame_begin[frame + 1];
    return same ? frame : igi_observation_frame(o, observation);
}

void igi_observations_destroy(igi_observations *observations);

#endif
