/* SPDX-License-Identifier: Apache-2.0
 *
 * A folder of results appears whole or not at all, and nothing of others' is replaced unasked.
 */
#define _XOPEN_SOURCE 700
#include "test.h"

#include "base/file.h"

#include <dirent.h>
#include <sys/stat.h>
#include <unistd.h>

/* A place of its own: "output_test.XXXXXX". */
static void make_place(char *place)
{
    strcpy(place, "output_test.XXXXXX");
    if (!mkdtemp(place)) abort();
}

static void put(const char *folder, const char *name, const char *text)
{
    char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    FILE *file = fopen(path, "w");
    if (!file) abort();
    fputs(text, file);
    fclose(file);
}

static bool there(const char *folder, const char *name)
{
    char path[512];
    snprintf(path, sizeof path, "%s/%s", folder, name);
    return access(path, F_OK) == 0;
}

static int entries(const char *path)
{
    int count = 0;
    DIR *folder = opendir(path);
    if (!folder) return -1;
    while (readdir(folder)) count++;
    closedir(folder);
    return count - 2;
}

static void whole_or_not_at_all(void)
{
    igi_context *ctx = test_context(1);
    char place[32], path[64];
    make_place(place);
    snprintf(path, sizeof path, "%s/a/out/", place);
    igi_output *output = NULL;
    CHECK_OK(ctx, igi_output_begin(ctx, path, false, NULL, &output));
    put(igi_output_folder(output), "x", "1");
    CHECK(!there(place, "a/out"));
    igi_output_destroy(output);
    snprintf(path, sizeof path, "%s/a", place);
    CHECK(entries(path) == 0);

    snprintf(path, sizeof path, "%s/a/out", place);
    CHECK_OK(ctx, igi_output_begin(ctx, path, false, NULL, &output));
    put(igi_output_folder(output), "x", "1");
    CHECK_OK(ctx, igi_output_commit(ctx, output));
    igi_output_destroy(output);
    CHECK(there(place, "a/out/x"));
    snprintf(path, sizeof path, "%s/a", place);
    CHECK(entries(path) == 1);
    igi_context_destroy(ctx);
}

static void others_work_is_kept(void)
{
    igi_context *ctx = test_context(1);
    char place[32], path[64], inside[80];
    make_place(place);
    snprintf(path, sizeof path, "%s/out", place);
    mkdir(path, 0777);
    put(path, "letter", "dear");
    igi_output *output = NULL;
    CHECK(igi_output_begin(ctx, path, false, NULL, &output) == IGI_E_SYSTEM);
    CHECK_CONTAINS(igi_context_message(ctx), "with -f");
    snprintf(inside, sizeof inside, "%s/letter", path);
    CHECK(igi_output_begin(ctx, path, true, inside, &output) == IGI_E_USAGE);
    CHECK(igi_output_begin(ctx, ".", true, NULL, &output) == IGI_E_USAGE);
    CHECK(igi_output_begin(ctx, "/", true, NULL, &output) == IGI_E_USAGE);
    CHECK(igi_output_begin(ctx, inside, true, NULL, &output) == IGI_E_SYSTEM);
    CHECK(igi_output_begin(ctx, "/proc/none/out", true, NULL, &output) == IGI_E_SYSTEM);
    CHECK(!output);
    CHECK_OK(ctx, igi_output_begin(ctx, path, true, NULL, &output));
    put(igi_output_folder(output), "manifest.json", "{}");
    CHECK_OK(ctx, igi_output_commit(ctx, output));
    igi_output_destroy(output);
    CHECK(there(path, "manifest.json") && !there(path, "letter"));
    CHECK_OK(ctx, igi_output_begin(ctx, path, false, NULL, &output)); /* igi's own: no -f needed */
    igi_output_destroy(output);
    CHECK(there(path, "manifest.json") && entries(place) == 1);
    igi_context_destroy(ctx);
}

static void manifest_names_its_inputs(void)
{
    igi_context *ctx = test_context(1);
    char place[32], path[64], text[4096] = "";
    make_place(place);
    put(place, "input", "abc");
    snprintf(path, sizeof path, "%s/input", place);
    const char *inputs[] = {path};
    igi_setting settings[] = {{"method", "patches"}};
    igi_manifest manifest = {"igi recover \"x\"", 1, settings, 1, inputs};
    igi_stage_begin(ctx, "trying");
    igi_count_rays(ctx, 7);
    igi_stage_begin(ctx, NULL);
    CHECK_OK(ctx, igi_manifest_save(ctx, &manifest, place));
    snprintf(path, sizeof path, "%s/manifest.json", place);
    FILE *file = fopen(path, "r");
    CHECK(file && fread(text, 1, sizeof text - 1, file) > 0);
    if (file) fclose(file);
    CHECK_CONTAINS(text, "44bc2cf5ad770999"); /* XXH64("abc"), as published with the algorithm */
    CHECK_CONTAINS(text, "\"method\": \"patches\"");
    CHECK_CONTAINS(text, "igi recover \\\"x\\\"");
    CHECK_CONTAINS(text, "\"rays\": 7");
    inputs[0] = "/nonexistent";
    CHECK(igi_manifest_save(ctx, &manifest, place) == IGI_E_SYSTEM);
    igi_context_destroy(ctx);
}

/* A file that fails, by its writer's word or the disk's, leaves what was there before. */
static void a_file_is_whole(void)
{
    igi_context *ctx = test_context(1);
    char place[32], path[64], text[8] = "";
    igi_file file;
    make_place(place);
    snprintf(path, sizeof path, "%s/x", place);
    CHECK_OK(ctx, igi_file_save(ctx, path, "old", 3));
    CHECK_OK(ctx, igi_file_begin(ctx, path, &file));
    fputs("new", file.stream);
    CHECK(igi_file_end(ctx, &file, IGI_E_DATA) == IGI_E_DATA);
    CHECK(!file.stream && entries(place) == 1);
    CHECK_OK(ctx, igi_file_begin(ctx, path, &file));
    CHECK(freopen("/dev/full", "w", file.stream) != NULL);
    fputs("new", file.stream);
    CHECK(igi_file_end(ctx, &file, IGI_OK) == IGI_E_SYSTEM);
    CHECK_CONTAINS(igi_context_message(ctx), "x: cannot be written (No space left on device)");
    CHECK(entries(place) == 1);
    FILE *old = fopen(path, "r");
    CHECK(old && fread(text, 1, sizeof text - 1, old) == 3 && strcmp(text, "old") == 0);
    if (old) fclose(old);
    snprintf(path, sizeof path, "%s/x/y", place); /* x is a file */
    CHECK(igi_file_begin(ctx, path, &file) == IGI_E_SYSTEM && !file.stream);
    snprintf(path, sizeof path, "%s/none/at/all", place);
    CHECK_OK(ctx, igi_file_save(ctx, path, "new", 3));
    CHECK((old = fopen(path, "r")) != NULL);
    if (old) fclose(old);
    CHECK(igi_file_save_json(ctx, path, NULL, 9) == IGI_E_SYSTEM);
    igi_context_destroy(ctx);
}

TEST_MAIN({"whole_or_not_at_all", whole_or_not_at_all},
          {"others_work_is_kept", others_work_is_kept},
          {"manifest_names_its_inputs", manifest_names_its_inputs},
          {"a_file_is_whole", a_file_is_whole})
