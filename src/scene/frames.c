/* SPDX-License-Identifier: Apache-2.0
 *
 * Cameras out of files: which reader, and what a failure leaves.
 */
#include "scene/frame.h"

igi_status igi_frames_load(igi_context *context, const char *path, igi_frame **frames,
                           size_t *count)
{
    *frames = NULL;
    *count = 0;
    igi_status status = igi_is_folder(path) ? igi_colmap_read(context, path, frames, count)
                                            : igi_transforms_read(context, path, frames, count);
    if (status == IGI_OK) return IGI_OK;
    igi_frames_destroy(*frames, *count);
    *frames = NULL;
    *count = 0;
    return status;
}

void igi_frames_destroy(igi_frame *frames, size_t count)
{
    for (size_t i = 0; frames && i < count; i++) {
        igi_free(frames[i].name);
        igi_free(frames[i].path);
        igi_exposures_destroy(frames[i].exposures, frames[i].exposure_count);
    }
    igi_free(frames);
}
