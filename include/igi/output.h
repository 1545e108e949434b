/* SPDX-License-Identifier: Apache-2.0
 *
 * Results on disk: a folder that appears whole or not at all, and a record of what made it.
 */
#ifndef IGI_OUTPUT_H
#define IGI_OUTPUT_H

#include <igi/base.h>

#ifdef __cplusplus
extern "C" {
#endif

/* A folder in the making. It lies beside its final place until it is committed. */
typedef struct igi_output igi_output;

/* Begins the folder that shall become `path`; folders above it are made. What igi wrote there
 * before (it holds a manifest.json) will be replaced; any other folder that is not empty only
 * with `replace`, and never one that holds `input` (may be NULL) or the working directory. */
IGI_API IGI_MUST_USE igi_status igi_output_begin(igi_context *context, const char *path,
                                                 bool replace, const char *input,
                                                 igi_output **output);
/* Where to write now. */
IGI_API const char *igi_output_folder(const igi_output *output);
/* Moves the folder to its final place. The output still has to be destroyed. */
IGI_API IGI_MUST_USE igi_status igi_output_commit(igi_context *context, igi_output *output);
/* Removes what was written and not committed. */
IGI_API void igi_output_destroy(igi_output *output);

/* A name and its value, as given or by default. */
typedef struct igi_setting {
    const char *name, *value;
} igi_setting;

typedef struct igi_manifest {
    const char *command; /* the command line */
    size_t setting_count;
    const igi_setting *settings;
    size_t input_count;
    const char *const *inputs; /* paths of files */
} igi_manifest;

/* Writes FOLDER/manifest.json: version, command line, settings, size and hash (XXH64, as `xxhsum
 * -H1` prints it) of each input, and the context's stages with their time, rays and memory. The
 * one result that may differ from run to run. */
IGI_API IGI_MUST_USE igi_status igi_manifest_save(igi_context *context,
                                                  const igi_manifest *manifest, const char *folder);

/* The version of the library, "0.1.0". */
IGI_API const char *igi_version(void);

#ifdef __cplusplus
}
#endif
#endif
