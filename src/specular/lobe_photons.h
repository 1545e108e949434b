/* SPDX-License-Identifier: Apache-2.0
 *
 * What lamps send by way of lobes.
 */
#ifndef IGI_SRC_SPECULAR_LOBE_PHOTONS_H
#define IGI_SRC_SPECULAR_LOBE_PHOTONS_H

#include "specular/incident.h"

/* Adds to received[rows][bands] the irradiance by the lamps' light that the field's lobes send on.
 * `round`: of the random streams. */
IGI_MUST_USE igi_status igi_lobe_photons_add(igi_context *ctx, const igi_radiance_field *field,
                                             const igi_rows *rows, uint64_t round, float *received);

#endif
