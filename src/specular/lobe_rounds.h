/* SPDX-License-Identifier: Apache-2.0
 *
 * The looks at every region: a search, a closer fit where it found a lobe, and what may have been
 * overlooked where none is.
 */
#ifndef IGI_SRC_SPECULAR_LOBE_ROUNDS_H
#define IGI_SRC_SPECULAR_LOBE_ROUNDS_H

#include "specular/specular.h"

/* What a round needs; found lobes go to `specular`. */
typedef struct igi_lobe_round {
    const igi_radiance_field *field;
    const igi_diffuse *diffuse;
    igi_field *irradiance;
    igi_specular *specular;
    igi_candidates candidates;
} igi_lobe_round;

/* First a search everywhere with few pixels; what the cameras saw stands for what leaves. */
IGI_MUST_USE igi_status igi_lobes_search(igi_context *ctx, const igi_lobe_round *round);
/* Then, where one was found, with directions about it. */
IGI_MUST_USE igi_status igi_lobes_refine(igi_context *ctx, const igi_lobe_round *round);
/* What may have been overlooked where no lobe was found. */
IGI_MUST_USE igi_status igi_lobes_doubt(igi_context *ctx, const igi_lobe_round *round);

#endif
