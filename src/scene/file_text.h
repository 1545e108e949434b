/* SPDX-License-Identifier: Apache-2.0
 *
 * Files in memory, paths, and numbers out of text.
 */
#ifndef IGI_SRC_SCENE_FILE_TEXT_H
#define IGI_SRC_SCENE_FILE_TEXT_H

#include "base/context.h"

/* A whole file; a NUL that `size` does not count follows the last byte. */
typedef struct igi_text {
    char *bytes;
    size_t size;
} igi_text;

/* IGI_E_DATA when there is no such file or it is larger than `limit` bytes, IGI_E_SYSTEM when it
 * cannot be read. The text is the caller's, to be freed with igi_free(text->bytes). */
IGI_MUST_USE igi_status igi_text_load(igi_context *ctx, const char *path, size_t limit,
                                      igi_text *text);

/* Reads a decimal number at *at and moves *at behind it; "nan" and "inf" are numbers here, so that
 * they can be refused with a sentence of their own. False when there is none. Independent of the
 * locale; within 1 ulp or so of the nearest double. The text must end with a NUL. */
bool igi_scan_number(const char **at, double *value);

/* Is there such a file that can be opened for reading, and is it none of a folder? */
bool igi_file_exists(const char *path);
bool igi_is_folder(const char *path);

/* Does `path` end so, whatever the case of its letters? */
bool igi_ends_with(const char *path, const char *ending);

/* folder/name, or name alone when it is absolute. */
IGI_MUST_USE igi_status igi_path_join(igi_context *ctx, const char *folder, const char *name,
                                      char **path);
/* The folder of a path, "." if it names none; the last part of a path without its ending. */
IGI_MUST_USE igi_status igi_path_folder(igi_context *ctx, const char *path, char **folder);
IGI_MUST_USE igi_status igi_path_stem(igi_context *ctx, const char *path, char **stem);

/* The candidate that `word` was probably meant to be, or NULL. */
const char *igi_closest(const char *word, const char *const *candidates, size_t count);

#endif
