/* SPDX-License-Identifier: Apache-2.0
 *
 * For fuzz targets of readers that take a path: the bytes go through a file.
 */
#ifndef IGI_TESTS_FUZZ_FILE_H
#define IGI_TESTS_FUZZ_FILE_H

#include <igi/igi.h>

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size);

/* Made once a process, left behind. */
static inline const char *fuzz_folder(void)
{
    static char folder[] = "/tmp/igi-fuzz-XXXXXX";
    static bool made;
    if (!made && !mkdtemp(folder)) abort();
    made = true;
    return folder;
}

/* FOLDER/NAME, with these bytes in it. */
static inline const char *fuzz_file(const char *name, const void *bytes, size_t size)
{
    static char path[256];
    snprintf(path, sizeof path, "%s/%s", fuzz_folder(), name);
    FILE *file = fopen(path, "wb");
    if (!file || fwrite(bytes, 1, size, file) != size || fclose(file) != 0) abort();
    return path;
}

static inline igi_context *fuzz_context(void)
{
    igi_context *ctx = NULL;
    if (igi_context_create(NULL, &ctx) != IGI_OK) abort();
    return ctx;
}

/* Success, or a sentence about the data. */
static inline void fuzz_judge(const igi_context *ctx, igi_status status, const void *result)
{
    if (status != IGI_OK && status != IGI_E_DATA) abort();
    if ((status == IGI_OK) != (result != NULL)) abort();
    if (status != IGI_OK && !igi_context_message(ctx)[0]) abort();
}

#endif
