/* SPDX-License-Identifier: Apache-2.0
 *
 * libFuzzer against transforms.json.
 */
#include "fuzz_file.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    igi_context *ctx = fuzz_context();
    igi_frame *frames;
    size_t count;
    fuzz_judge(ctx, igi_frames_load(ctx, fuzz_file("t.json", bytes, size), &frames, &count),
               frames);
    igi_frames_destroy(frames, count);
    igi_context_destroy(ctx);
    return 0;
}
