/* SPDX-License-Identifier: Apache-2.0
 *
 * A folder of results is written beside its final place and renamed when it is whole, so that an
 * error, a full disk or Ctrl-C leaves what was there before.
 */
#define _XOPEN_SOURCE 700 /* realpath, nftw */
#include "base/file.h"

#include <igi/output.h>

#include <dirent.h>
#include <errno.h>
#include <ftw.h>
#include <limits.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

struct igi_output {
    igi_context *ctx;
    char *path;   /* final, without a slash at its end */
    char *folder; /* where it is written */
    char *old;    /* where what it replaces waits */
    bool committed;
};

static igi_status system_error(igi_context *ctx, const char *path, const char *what)
{
    return igi_fail(ctx, IGI_E_SYSTEM, "%s: %s (%s); check the name, the rights and the disk", path,
                    what, strerror(errno));
}

static bool has_entry(const char *folder, const char *name)
{
    char path[PATH_MAX];
    struct stat info;
    int length = snprintf(path, sizeof path, "%s/%s", folder, name);
    return length > 0 && (size_t)length < sizeof path && stat(path, &info) == 0;
}

static bool is_empty_folder(const char *path)
{
    DIR *folder = opendir(path);
    if (!folder) return false;
    int entries = 0;
    for (struct dirent *e = readdir(folder); e; e = readdir(folder))
        entries += strcmp(e->d_name, ".") != 0 && strcmp(e->d_name, "..") != 0;
    closedir(folder);
    return entries == 0;
}

static int remove_entry(const char *path, const struct stat *info, int kind, struct FTW *place)
{
    (void)info;
    (void)kind;
    (void)place;
    return remove(path);
}

/* Errors are let pass: there is nobody to act on them. */
static void remove_tree(const char *path)
{
    nftw(path, remove_entry, 16, FTW_DEPTH | FTW_PHYS);
}

/* Is `inner`, where it exists, `outer` or within it? */
static bool lies_within(const char *inner, const char *outer)
{
    char a[PATH_MAX], b[PATH_MAX];
    if (!realpath(inner, a) || !realpath(outer, b)) return false;
    size_t length = strlen(b);
    if (length == 1) return true; /* the root */
    return strncmp(a, b, length) == 0 && (a[length] == '/' || a[length] == 0);
}

static igi_status check_place(igi_context *ctx, const char *path, bool replace, const char *input)
{
    struct stat info;
    if (stat(path, &info)) return IGI_OK;
    if (!S_ISDIR(info.st_mode))
        return igi_fail(ctx, IGI_E_SYSTEM, "%s: is a file; name a folder for the output", path);
    if (lies_within(".", path) || (input && lies_within(input, path)))
        return igi_fail(ctx, IGI_E_USAGE,
                        "%s: holds the input or the working directory and would be replaced; name "
                        "another folder for the output",
                        path);
    if (is_empty_folder(path) || replace || has_entry(path, "manifest.json")) return IGI_OK;
    return igi_fail(ctx, IGI_E_SYSTEM,
                    "%s: holds files that igi did not write; name another folder, or replace it "
                    "with -f",
                    path);
}

/* A sibling that nothing else uses. */
static igi_status make_sibling(igi_output *o)
{
    for (int n = 0; n < 100; n++) {
        igi_free(o->folder);
        IGI_TRY(igi_strprintf(o->ctx, &o->folder, "%s.part-%ld-%d", o->path, (long)getpid(), n));
        if (mkdir(o->folder, 0777) == 0) return igi_strprintf(o->ctx, &o->old, "%s.old", o->folder);
        if (errno != EEXIST) break;
    }
    igi_status status = system_error(o->ctx, o->path, "cannot be written");
    igi_free(o->folder);
    o->folder = NULL;
    return status;
}

igi_status igi_output_begin(igi_context *ctx, const char *path, bool replace, const char *input,
                            igi_output **output)
{
    *output = NULL;
    igi_output *o = NULL;
    igi_status status = IGI_OK;
    if (!path[0]) return igi_fail(ctx, IGI_E_USAGE, "-o: the name of the output folder is empty");
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &o));
    o->ctx = ctx;
    IGI_TRY_GOTO(igi_strdup(ctx, path, &o->path));
    for (size_t n = strlen(o->path); n > 1 && o->path[n - 1] == '/'; n--) o->path[n - 1] = 0;
    IGI_TRY_GOTO(check_place(ctx, o->path, replace, input));
    IGI_TRY_GOTO(igi_make_parents(ctx, o->path));
    IGI_TRY_GOTO(make_sibling(o));
    *output = o;
cleanup:
    if (status != IGI_OK) igi_output_destroy(o);
    return status;
}

const char *igi_output_folder(const igi_output *output)
{
    return output->folder;
}

igi_status igi_output_commit(igi_context *ctx, igi_output *o)
{
    bool replaces = rename(o->path, o->old) == 0;
    if (!replaces && errno != ENOENT)
        return system_error(ctx, o->path, "cannot be moved out of the way");
    if (rename(o->folder, o->path)) {
        igi_status status = system_error(ctx, o->path, "cannot be written");
        if (replaces && rename(o->old, o->path)) igi_warn(ctx, "%s: lies in %s", o->path, o->old);
        return status;
    }
    o->committed = true;
    if (replaces) remove_tree(o->old);
    return IGI_OK;
}

void igi_output_destroy(igi_output *o)
{
    if (!o) return;
    if (!o->committed && o->folder) remove_tree(o->folder);
    igi_free(o->path);
    igi_free(o->folder);
    igi_free(o->old);
    igi_free(o);
}
