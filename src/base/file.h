/* SPDX-License-Identifier: Apache-2.0
 *
 * Writing a file: whole, or not at all.
 */
#ifndef IGI_SRC_BASE_FILE_H
#define IGI_SRC_BASE_FILE_H

#include "base/context.h"

#include <stdio.h>

struct json_t;

/* What is being written lies beside its place until it is whole. */
typedef struct igi_file {
    FILE *stream; /* of bytes; the caller's to write to. NULL: nothing is open */
    char *path, *beside;
} igi_file;

/* Makes the folders that `path` lies in, where they are missing. */
IGI_MUST_USE igi_status igi_make_parents(igi_context *ctx, const char *path);

/* Opens. Folders that are missing are made. After a failure there is nothing to end. */
IGI_MUST_USE igi_status igi_file_begin(igi_context *ctx, const char *path, igi_file *file);
/* Puts the file in its place, or takes it away where `status`, how the writing went, is no
 * IGI_OK or where some of it did not reach the disk. Gives `status`, or that failure. */
IGI_MUST_USE igi_status igi_file_end(igi_context *ctx, igi_file *file, igi_status status);

/* All at once. */
IGI_MUST_USE igi_status igi_file_save(igi_context *ctx, const char *path, const void *bytes,
                                      size_t size);
/* `root` may be NULL, where there was no memory to make it; `digits` significant ones a number. */
IGI_MUST_USE igi_status igi_file_save_json(igi_context *ctx, const char *path,
                                           const struct json_t *root, int digits);

/* Leaves the sentence on a file that cannot be written, with errno's reason; for files that
 * libraries write. */
igi_status igi_fail_writing(igi_context *ctx, const char *path);

/* Text as XML and HTML hold it, in quotes or outside; what no XML may hold is left out. */
void igi_put_escaped(FILE *stream, const char *text);

/* A path's last part. */
const char *igi_file_name(const char *path);

#endif
