/* SPDX-License-Identifier: Apache-2.0
 *
 * libFuzzer against COLMAP's models: the first byte says text or binary, the second how long the
 * cameras' file is; the rest is the images'.
 */
#include "fuzz_file.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    if (size < 2) return 0;
    igi_context *ctx = fuzz_context();
    igi_frame *frames;
    size_t count, cameras = bytes[1] < size - 2 ? bytes[1] : size - 2;
    const char *ending = bytes[0] & 1 ? "bin" : "txt";
    char name[32], other[64];
    snprintf(other, sizeof other, "%s/images.%s", fuzz_folder(), bytes[0] & 1 ? "txt" : "bin");
    (void)remove(other);
    snprintf(name, sizeof name, "cameras.%s", ending);
    (void)fuzz_file(name, bytes + 2, cameras);
    snprintf(name, sizeof name, "images.%s", ending);
    (void)fuzz_file(name, bytes + 2 + cameras, size - 2 - cameras);
    fuzz_judge(ctx, igi_frames_load(ctx, fuzz_folder(), &frames, &count), frames);
    igi_frames_destroy(frames, count);
    igi_context_destroy(ctx);
    return 0;
}
