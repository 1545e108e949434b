/* SPDX-License-Identifier: Apache-2.0
 *
 * libFuzzer against materials.json; what loads is saved and shown.
 */
#include "fuzz_file.h"

#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    igi_context *ctx = fuzz_context();
    igi_materials *materials;
    char folder[512];
    snprintf(folder, sizeof folder, "%s", fuzz_file("materials.json", bytes, size));
    *strrchr(folder, '/') = 0;
    igi_status status = igi_materials_load(ctx, folder, &materials);
    if (status != IGI_E_SYSTEM) fuzz_judge(ctx, status, materials);
    if (materials && igi_report(ctx, folder, NULL) != IGI_OK) abort();
    igi_materials_destroy(materials);
    igi_context_destroy(ctx);
    return 0;
}
