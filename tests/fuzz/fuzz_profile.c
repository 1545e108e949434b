/* SPDX-License-Identifier: Apache-2.0
 *
 * libFuzzer against the readers of lamp profiles: EULUMDAT where the first byte is odd, else LM-63.
 */
#include "fuzz_file.h"
#include "light/sky.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    igi_context *ctx = fuzz_context();
    profile *p;
    const char *name = size && bytes[0] & 1 ? "p.ldt" : "p.ies";
    igi_status status = profile_load(
        ctx, fuzz_file(name, size ? bytes + 1 : bytes, size ? size - 1 : 0), &p);
    fuzz_judge(ctx, status, p);
    for (int i = 0; p && i < 64; i++) {
        float a = (float)i, z = cosf(a);
        float x = profile_intensity(p, igi_v(sinf(3 * a) * sinf(a), cosf(3 * a) * sinf(a), z));
        if (!(x >= 0)) abort();
    }
    profile_destroy(p);
    igi_context_destroy(ctx);
    return 0;
}
