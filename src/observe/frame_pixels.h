/* SPDX-License-Identifier: Apache-2.0
 *
 * What is kept of each photograph until all are joined, for the files that make observations.
 */
#ifndef IGI_SRC_OBSERVE_FRAME_PIXELS_H
#define IGI_SRC_OBSERVE_FRAME_PIXELS_H

#include "lens/photographs.h"
#include "observe/observations.h"

typedef struct frame_pixels {
    size_t count;
    uint8_t *grade; /* how near an edge of the mesh: igi_visible */
    uint32_t *surface, *pixel;
    float *uv, *radiance;
    size_t broken;
    uint32_t first_broken;
    char *warning;     /* about the photograph; NULL: none */
    size_t hits, back; /* pixels that show a surface, and its clockwise side */
    size_t outline_count;
    igi_outline *outlines;
    size_t reading_count;
    igi_lamp_reading *readings;
    double lit_gaps, deviation; /* the image's */
} frame_pixels;

typedef struct observing {
    const igi_scene *scene;
    igi_photographs *photographs;
    const igi_tracer *tracer;
    uint32_t keep_below; /* of a 32-bit hash; UINT32_MAX: all */
    frame_pixels *frames;
    igi_registration *registrations;
    double *saturated, *mean;
    float *glow;
    bool *scarce; /* [regions] */
    int preview_side;
    igi_image **previews; /* [frames]; NULL: none */
} observing;

/* A task for each photograph; user: an `observing`. */
igi_status observe_frame(igi_context *ctx, void *user, size_t frame, int worker);

/* Pixels near edges go, but for regions that have no others to speak of. */
IGI_MUST_USE igi_status drop_edges(igi_context *ctx, observing *j);

#endif
