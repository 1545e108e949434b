/* SPDX-License-Identifier: Apache-2.0
 *
 * Inside src/lens.
 */
#ifndef IGI_SRC_LENS_PRIVATE_H
#define IGI_SRC_LENS_PRIVATE_H

#include <igi/lens.h>

/* Makes *calibration when it is NULL, else checks that it is for photographs of this size. */
IGI_MUST_USE igi_status igi_calibration_for(igi_context *ctx, const char *path,
                                            const igi_photo *photo, igi_calibration **calibration);

#endif
