/* SPDX-License-Identifier: Apache-2.0
 *
 * The images of a scene as recovery wants them: merged from their exposures where the manifest
 * names brackets, and as the frames' cameras would have seen them, distortion and vignetting
 * undone, where it names a calibration.
 */
#ifndef IGI_SRC_LENS_PHOTOGRAPHS_H
#define IGI_SRC_LENS_PHOTOGRAPHS_H

#include <igi/lens.h>

typedef struct igi_photographs igi_photographs;

/* Reads the calibration, if any, and checks it against the cameras and the exposures. The scene
 * must outlive the result. */
IGI_MUST_USE igi_status igi_photographs_open(igi_context *ctx, const igi_scene *scene,
                                             igi_photographs **photographs);
/* The same as the lens threw them: merged, and neither corrected nor scaled, for who wants to know the
 * lens. */
IGI_MUST_USE igi_status igi_photographs_open_as_taken(igi_context *ctx, const igi_scene *scene,
                                                      igi_photographs **photographs);
/* The camera that such an image shows, by the calibration's lens if there is one. */
igi_camera igi_photographs_camera(const igi_photographs *photographs, size_t frame);
/* The image of a frame; any thread may ask. Each call costs the merge anew, so that memory holds
 * only what is asked for. *warning: what is odd about it, the caller's, or NULL. */
IGI_MUST_USE igi_status igi_photographs_load(igi_context *ctx, const igi_photographs *photographs,
                                             size_t frame, igi_image **image, char **warning);
void igi_photographs_close(igi_photographs *photographs);

#endif
