/* SPDX-License-Identifier: Apache-2.0
 *
 * The mesh against what the photographs show of it: lamps of another size, and light where the mesh
 * has nothing.
 */
#ifndef IGI_SRC_OBSERVE_OUTLINES_H
#define IGI_SRC_OBSERVE_OUTLINES_H

#include "observe/visible.h"

#include <igi/image.h>

/* One lamp in one photograph. */
typedef struct igi_outline {
    uint32_t region;
    double mesh_px, shown_px; /* its area in the picture, as the mesh has it and as it is seen, */
    double doubt_px;          /* and what uneven surroundings may do to the latter */
} igi_outline;

/* A lamp over all photographs: by how much its outline in the mesh is too small, in area. */
typedef struct igi_lamp_size {
    size_t photographs;
    double ratio, error; /* seen over meshed; one standard deviation, INFINITY where none tells */
} igi_lamp_size;

/* Appends the lamps of a photograph to *outlines, which igi_free frees. */
IGI_MUST_USE igi_status igi_outlines_measure(igi_context *ctx, const igi_scene *scene,
                                             const igi_tracer *tracer, const igi_camera *camera,
                                             const igi_image *image, const igi_visible *visible,
                                             igi_outline **outlines, size_t *count);
/* A pixel around a lamp: it shows no other lamp, is finite and is not marked as saturated. */
bool igi_pixel_suits_lamp(const igi_scene *scene, const igi_image *image,
                          const igi_visible *visible, size_t pixel, uint32_t lamp);
igi_lamp_size igi_outlines_sum(const igi_outline *outlines, size_t count, uint32_t region);

/* Share of a photograph's pixels that show no surface of the mesh, but light: at least a tenth of what
 * its surfaces send on average, lamps apart. */
double igi_lit_gaps(const igi_scene *scene, const igi_image *image, const igi_visible *visible);

#endif
