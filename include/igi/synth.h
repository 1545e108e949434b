/* SPDX-License-Identifier: Apache-2.0
 *
 * Synthetic scenes: a short spec becomes a scene folder with photographs and truth.
 */
#ifndef IGI_SYNTH_H
#define IGI_SYNTH_H

#include <igi/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Reads the spec (datasets-synthetic/README.md) and writes a complete scene folder: scene.json,
 * scene.obj, transforms.json, images/, truth/, and heldout/ and relit/ where the spec asks for
 * them. The same spec and the context's seed give the same bytes. */
IGI_API IGI_MUST_USE igi_status igi_synth(igi_context *context, const char *spec_path,
                                          const char *folder);

/* The same scene, but its photographs as a camera would have delivered them: photos/NNNN_E.png,
 * brackets of five exposures (12 bits in 16, clipped, noisy, EXIF) behind a lens that distorts and
 * shades; photos/flat_N.png, an evenly lit wall; photos/lens.json, the distortion. images/ stays
 * empty: igi merge and igi correct fill it, and transforms.json is for what they write.
 * basis_path: the EMoR model's invemor.txt, for a response of that space; NULL: gamma 2.2 with a
 * shoulder. */
IGI_API IGI_MUST_USE igi_status igi_synth_photos(igi_context *context, const char *spec_path,
                                                 const char *folder, const char *basis_path);

#ifdef __cplusplus
}
#endif
#endif
