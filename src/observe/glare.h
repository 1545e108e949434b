/* SPDX-License-Identifier: Apache-2.0
 *
 * Light that strays in a lens lays a veil over the photograph, which shows where the scene is dark. Of
 * the light that enters, the share s falls evenly onto the picture, and its mean M stays:
 *     B = (1 - s) L + s M.
 */
#ifndef IGI_SRC_OBSERVE_GLARE_H
#define IGI_SRC_OBSERVE_GLARE_H

#include "observe/glimpses.h"

typedef struct igi_glare {
    double share; /* s */
    double sigma; /* of it; INFINITY: too little tells */
    double
        gain; /* of the rest; 1 - s where the light is the picture's own, 1 where it comes from outside */
} igi_glare;

/* What all photographs have, by how much more of it the brighter ones have; bright[frames]: M, of all
 * bands together; NULL: what shines around each place in its picture. */
IGI_MUST_USE igi_status igi_glare_common(igi_context *ctx, const igi_glimpses *glimpses,
                                         size_t regions, const double *bright, size_t frames,
                                         igi_glare *glare);
/* What each has more than the others: glares[frames]. */
IGI_MUST_USE igi_status igi_glare_own(igi_context *ctx, const igi_glimpses *glimpses,
                                      size_t regions, const double *bright, size_t frames,
                                      igi_glare *glares);

/* These subtract veils that are clear, and add a warning for each that says what remains; as the glimpses
 * of the observations show them. */
IGI_MUST_USE igi_status igi_observations_lift_common_veil(igi_context *ctx, const igi_scene *scene,
                                                          const igi_glimpses *glimpses,
                                                          igi_observations *observations,
                                                          bool *lifted);
IGI_MUST_USE igi_status igi_observations_lift_own_veils(igi_context *ctx, const igi_scene *scene,
                                                        const igi_glimpses *glimpses,
                                                        igi_observations *observations,
                                                        bool *lifted);
/* Light that strays unevenly is not subtracted, but said. */
IGI_MUST_USE igi_status igi_observations_tell_uneven_veil(igi_context *ctx, const igi_scene *scene,
                                                          const igi_glimpses *glimpses,
                                                          igi_observations *observations);
/* What a picture of a frame, of o->bands bands of `channels`, becomes by what was subtracted. */
void igi_glare_lift_image(const igi_observations *o, size_t frame, igi_image *image);

#endif
