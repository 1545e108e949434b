/* SPDX-License-Identifier: Apache-2.0
 *
 * Inside src/lens.
 */
#ifndef IGI_SRC_LENS_PRIVATE_H
#define IGI_SRC_LENS_PRIVATE_H

#include <igi/lens.h>

/* The intrinsics in the order of igi_calibration.deviations. */
extern const char *const igi_lens_keys[9];
double *igi_lens_field(igi_camera *lens, int i);

/* By its name: OpenCV's or COLMAP's, to be imported. */
bool igi_calibration_is_opencv(const char *path);
bool igi_calibration_is_foreign(const char *path);

/* Makes *calibration when it is NULL, else checks that it is for photographs of this size. */
IGI_MUST_USE igi_status igi_calibration_for(igi_context *ctx, const char *path,
                                            const igi_photo *photo, igi_calibration **calibration);

void igi_calibration_forget_views(igi_calibration *calibration);

/* The image that `wanted` would have seen (of the calibration's size; its pose does not matter),
 * made from the one that the calibration's lens threw. NULL: the lens' own pinhole. */
IGI_MUST_USE igi_status igi_correct_for(igi_context *ctx, const igi_calibration *calibration,
                                        const igi_image *image, const igi_camera *wanted,
                                        igi_image **corrected);

/* Places that show the same light: log_ratios are of what was seen at `a` over that at `b`. */
typedef struct igi_vignetting_pairs {
    size_t count, capacity[3];
    double (*a)[2], (*b)[2], *log_ratios;
} igi_vignetting_pairs;

IGI_MUST_USE igi_status igi_vignetting_fit_pairs(igi_context *ctx,
                                                 const igi_vignetting_pairs *pairs,
                                                 const int size[2], igi_vignetting *vignetting);

#endif
