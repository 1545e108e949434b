/* SPDX-License-Identifier: Apache-2.0 */
#include "base/file.h"

#include <errno.h>
#include <jansson.h>
#include <string.h>
#include <sys/stat.h>
#include <unistd.h>

igi_status igi_fail_writing(igi_context *ctx, const char *path)
{
    return igi_fail(ctx, IGI_E_SYSTEM,
                    "%s: cannot be written (%s); check the folder, its permissions and the room on "
                    "the disk",
                    path, strerror(errno ? errno : EIO));
}

igi_status igi_make_parents(igi_context *ctx, const char *path)
{
    char *part;
    igi_status status = IGI_OK;
    if (!strchr(path, '/')) return IGI_OK;
    IGI_TRY(igi_strdup(ctx, path, &part));
    for (char *slash = strchr(part + 1, '/'); slash && status == IGI_OK;
         slash = strchr(slash + 1, '/')) {
        *slash = 0;
        if (mkdir(part, 0777) && errno != EEXIST && errno != EISDIR)
            status = igi_fail(ctx, IGI_E_SYSTEM,
                              "%s: cannot be made (%s); check the name, the rights and the disk",
                              part, strerror(errno));
        *slash = '/';
    }
    igi_free(part);
    return status;
}

static void forget(igi_file *file)
{
    igi_free(file->path);
    igi_free(file->beside);
    *file = (igi_file){0};
}

igi_status igi_file_begin(igi_context *ctx, const char *path, igi_file *file)
{
    *file = (igi_file){0};
    igi_status status = igi_strdup(ctx, path, &file->path);
    if (status == IGI_OK) status = igi_make_parents(ctx, path);
    if (status == IGI_OK)
        status = igi_strprintf(ctx, &file->beside, "%s.%ld.part", path, (long)getpid());
    if (status == IGI_OK && !(file->stream = fopen(file->beside, "wb")))
        status = igi_fail_writing(ctx, path);
    if (status != IGI_OK) forget(file);
    return status;
}

igi_status igi_file_end(igi_context *ctx, igi_file *file, igi_status status)
{
    if (!file->stream) return status;
    bool whole = !ferror(file->stream);
    if (fclose(file->stream) != 0) whole = false;
    if (status == IGI_OK && (!whole || rename(file->beside, file->path) != 0))
        status = igi_fail_writing(ctx, file->path);
    if (status != IGI_OK) (void)unlink(file->beside);
    forget(file);
    return status;
}

igi_status igi_file_save(igi_context *ctx, const char *path, const void *bytes, size_t size)
{
    igi_file file;
    IGI_TRY(igi_file_begin(ctx, path, &file));
    (void)fwrite(bytes, 1, size, file.stream); /* the stream remembers a failure */
    return igi_file_end(ctx, &file, IGI_OK);
}

igi_status igi_file_save_json(igi_context *ctx, const char *path, const struct json_t *root,
                              int digits)
{
    igi_file file;
    if (!root) return igi_fail(ctx, IGI_E_SYSTEM, "%s: no memory to write it", path);
    IGI_TRY(igi_file_begin(ctx, path, &file));
    igi_status status = IGI_OK;
    if (json_dumpf(root, file.stream, JSON_INDENT(1) | JSON_REAL_PRECISION((size_t)digits)) != 0)
        status = igi_fail_writing(ctx, path);
    fputc('\n', file.stream);
    return igi_file_end(ctx, &file, status);
}

void igi_put_escaped(FILE *stream, const char *text)
{
    for (; *text; text++) switch (*text) {
        case '<': fputs("&lt;", stream); break;
        case '>': fputs("&gt;", stream); break;
        case '&': fputs("&amp;", stream); break;
        case '"': fputs("&quot;", stream); break;
        default:
            if ((unsigned char)*text >= ' ' || strchr("\t\n\r", *text)) putc(*text, stream);
        }
}

const char *igi_file_name(const char *path)
{
    const char *slash = strrchr(path, '/');
    return slash ? slash + 1 : path;
}
