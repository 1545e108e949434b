/* SPDX-License-Identifier: Apache-2.0
 *
 * libFuzzer against the OpenEXR reader. Seeds: any small EXR files.
 */
#include "image/image_private.h"

#include <stdlib.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    igi_context *ctx = NULL;
    igi_image *image = NULL;
    if (igi_context_create(NULL, &ctx) != IGI_OK) return 0;
    igi_status status = igi_exr_load_memory(ctx, "fuzz.exr", bytes, size, &image);
    if (status != IGI_OK && status != IGI_E_DATA) abort();
    igi_image_destroy(image);
    igi_context_destroy(ctx);
    return 0;
}
