/* SPDX-License-Identifier: Apache-2.0 */
#include "light/profile.h"

#include "scene/file_text.h"

igi_status profile_load(igi_context *ctx, const char *path, profile **result)
{
    igi_text text = {NULL, 0};
    igi_status status = IGI_OK;
    *result = NULL;
    IGI_TRY_GOTO(igi_text_load(ctx, path, (size_t)16 << 20, &text));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, result));
    IGI_TRY_GOTO(igi_ends_with(path, ".ldt") ? profile_read_ldt(ctx, path, text.bytes, *result)
                                             : profile_read_ies(ctx, path, text.bytes, *result));
cleanup:
    igi_free(text.bytes);
    if (status != IGI_OK) {
        profile_destroy(*result);
        *result = NULL;
    }
    return status;
}
