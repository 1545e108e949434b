/* SPDX-License-Identifier: Apache-2.0
 *
 * The pictures as a camera would have delivered them.
 */
#ifndef IGI_SRC_SYNTH_PHOTOS_H
#define IGI_SRC_SYNTH_PHOTOS_H

#include <igi/lens.h>

/* Gives a camera the lens that photographs are taken through. */
void photos_distort(igi_camera *camera);

/* Writes a bracket NNNN_E.png for each picture, taken through photos_distort(lens); brackets.json,
 * which names them; flat_N.png, an evenly lit wall; lens.json, the distortion. basis:
 * the table of known responses to take the camera's from, or NULL. */
IGI_MUST_USE igi_status photos_save(igi_context *ctx, const char *folder, const igi_camera *lens,
                                    const char *basis, igi_image **pictures, size_t count);

#endif
