/* SPDX-License-Identifier: Apache-2.0
 *
 * Lamps of so few pixels that each of them shows something else as well.
 */
#ifndef IGI_SRC_OBSERVE_SMALL_LAMPS_H
#define IGI_SRC_OBSERVE_SMALL_LAMPS_H

#include "observe/visible.h"

#include <igi/image.h>

/* One lamp in one photograph. */
typedef struct igi_lamp_reading {
    uint32_t region, frame;
    double area_px;                 /* of its picture */
    double radiance[IGI_MAX_BANDS]; /* W m^-2 sr^-1 */
    double error[IGI_MAX_BANDS];    /* one standard deviation, by the surroundings; INFINITY: it
                                       does not count */
    float highest[IGI_MAX_BANDS];   /* of the pixels that it was read from */
} igi_lamp_reading;

/* A lamp over all photographs. */
typedef struct igi_lamp_value {
    size_t photographs;
    double radiance[IGI_MAX_BANDS], error[IGI_MAX_BANDS];
} igi_lamp_value;

/* Appends what a photograph says of area lights whose radiance the scene leaves out to *readings,
 * which igi_free frees; of lamps that are seen whole, with their surroundings, and no other lamp in
 * these. */
IGI_MUST_USE igi_status igi_lamps_measure(igi_context *ctx, const igi_scene *scene,
                                          const igi_tracer *tracer, size_t frame,
                                          const igi_image *image, const igi_visible *visible,
                                          igi_lamp_reading **readings, size_t *count);
igi_lamp_value igi_lamps_sum(const igi_lamp_reading *readings, size_t count, int bands,
                             uint32_t region);

#endif
