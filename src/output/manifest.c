/* SPDX-License-Identifier: Apache-2.0
 *
 * manifest.json: what made a result, and what it cost.
 */
#include "base/file.h"

#include <igi/output.h>

#include <dirent.h>
#include <errno.h>
#include <inttypes.h>
#include <jansson.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <time.h>
#include <xxhash.h>

const char *igi_version(void)
{
    return IGI_VERSION;
}

static igi_status hash_file(igi_context *ctx, const char *path, uint64_t *bytes, uint64_t *hash)
{
    enum { BLOCK = 1 << 16 };
    igi_status status = IGI_OK;
    unsigned char *block = NULL;
    FILE *file = fopen(path, "rb");
    XXH64_state_t *state = XXH64_createState();
    if (!file || !state)
        IGI_TRY_GOTO(igi_fail(ctx, IGI_E_SYSTEM, "%s: cannot be read (%s)", path, strerror(errno)));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, BLOCK, &block));
    XXH64_reset(state, 0);
    *bytes = 0;
    for (size_t n = fread(block, 1, BLOCK, file); n; n = fread(block, 1, BLOCK, file)) {
        XXH64_update(state, block, n);
        *bytes += n;
    }
    *hash = XXH64_digest(state);
cleanup:
    if (file) fclose(file);
    XXH64_freeState(state);
    igi_free(block);
    return status;
}

static igi_status input_json(igi_context *ctx, const char *path, json_t *array)
{
    uint64_t bytes = 0, hash = 0;
    IGI_TRY(hash_file(ctx, path, &bytes, &hash));
    char text[24];
    snprintf(text, sizeof text, "%016" PRIx64, hash);
    json_t *o = json_pack("{s:s?, s:I, s:s}", "file", path, "bytes", (json_int_t)bytes, "xxh64",
                          text);
    if (json_array_append_new(array, o))
        return igi_fail(ctx, IGI_E_DATA, "%s: the name is not UTF-8; rename it", path);
    return IGI_OK;
}

/* The files of a folder (a COLMAP model), by name. */
static igi_status folder_json(igi_context *ctx, const char *folder, json_t *array)
{
    struct dirent **entries = NULL;
    igi_status status = IGI_OK;
    int count = scandir(folder, &entries, NULL, alphasort);
    for (int i = 0; i < count; i++) {
        char *path = NULL;
        struct stat info;
        if (status == IGI_OK)
            status = igi_strprintf(ctx, &path, "%s/%s", folder, entries[i]->d_name);
        if (status == IGI_OK && stat(path, &info) == 0 && S_ISREG(info.st_mode))
            status = input_json(ctx, path, array);
        igi_free(path);
        free(entries[i]); /* as scandir's contract has it */
    }
    free(entries);
    return status;
}

static igi_status inputs_json(igi_context *ctx, const igi_manifest *m, json_t *array)
{
    for (size_t i = 0; i < m->input_count; i++) {
        struct stat info;
        bool folder = stat(m->inputs[i], &info) == 0 && S_ISDIR(info.st_mode);
        IGI_TRY(folder ? folder_json(ctx, m->inputs[i], array)
                       : input_json(ctx, m->inputs[i], array));
    }
    return IGI_OK;
}

static int stages_json(const igi_context *ctx, json_t *array)
{
    const igi_stage *stages = NULL;
    size_t count = igi_context_stages(ctx, &stages);
    int bad = 0;
    for (size_t i = 0; i < count; i++)
        bad |= json_array_append_new(array,
                                     json_pack("{s:s, s:f, s:f, s:I, s:I}", "name", stages[i].name,
                                               "cpu_s", stages[i].cpu_s, "wall_s", stages[i].wall_s,
                                               "rays", (json_int_t)stages[i].rays, "peak_bytes",
                                               (json_int_t)stages[i].peak_bytes));
    return bad;
}

static json_t *time_json(void)
{
    char text[32] = "";
    time_t now = time(NULL);
    struct tm utc;
    if (gmtime_r(&now, &utc)) strftime(text, sizeof text, "%Y-%m-%dT%H:%M:%SZ", &utc);
    return json_string(text);
}

igi_status igi_manifest_save(igi_context *ctx, const igi_manifest *m, const char *folder)
{
    igi_status status = IGI_OK;
    char *path = NULL;
    json_t *inputs = json_array(), *stages = json_array(), *settings = json_object();
    json_t *root = json_object();
    int bad = 0;
    IGI_TRY_GOTO(inputs_json(ctx, m, inputs));
    for (size_t i = 0; i < m->setting_count; i++)
        bad |= json_object_set_new(settings, m->settings[i].name,
                                   json_string(m->settings[i].value));
    bad |= stages_json(ctx, stages);
    bad |= json_object_set_new(root, "igi", json_integer(1));
    bad |= json_object_set_new(root, "version", json_string(igi_version()));
    bad |= json_object_set_new(root, "written", time_json());
    bad |= json_object_set_new(root, "command", json_string(m->command));
    bad |= json_object_set(root, "options", settings);
    bad |= json_object_set_new(root, "threads", json_integer(igi_threads(ctx)));
    bad |= json_object_set_new(root, "seed", json_integer((json_int_t)igi_seed(ctx)));
    bad |= json_object_set_new(root, "cpu_s", json_real(igi_cpu_seconds()));
    bad |= json_object_set(root, "inputs", inputs);
    bad |= json_object_set(root, "stages", stages);
    if (bad)
        IGI_TRY_GOTO(igi_fail(ctx, IGI_E_USAGE, "manifest.json: the command line is not UTF-8"));
    IGI_TRY_GOTO(igi_strprintf(ctx, &path, "%s/manifest.json", folder));
    status = igi_file_save_json(ctx, path, root, 6);
cleanup:
    json_decref(root);
    json_decref(inputs);
    json_decref(stages);
    json_decref(settings);
    igi_free(path);
    return status;
}
