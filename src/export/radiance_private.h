/* SPDX-License-Identifier: Apache-2.0 */
#ifndef IGI_SRC_EXPORT_RADIANCE_PRIVATE_H
#define IGI_SRC_EXPORT_RADIANCE_PRIVATE_H

#include "export/export_private.h"

/* A light that is no lamp of the mesh. */
IGI_MUST_USE igi_status igi_radiance_light(const igi_exporter *e, size_t light);

#endif
