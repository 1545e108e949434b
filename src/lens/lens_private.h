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

/* Places that show the same light: log_ratios are of what was seen at `a` over that at `b`. */
typedef struct igi_vignetting_pairs {
    size_t count, capacity[3];
    double (*a)[2], (*b)[2], *log_ratios;
} igi_vignetting_pairs;

IGI_MUST_USE igi_status igi_vignetting_fit_pairs(igi_context *ctx,
                                                 const igi_vignetting_pairs *pairs,
                                                 const int size[2], igi_vignetting *vignetting);

#endif
