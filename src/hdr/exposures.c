/* SPDX-License-Identifier: Apache-2.0
 *
 * Which exposure each photograph had: from a list, or from EXIF.
 */
#include "base/context.h"
#include "hdr/hdr_private.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_LINE 4096
#define MAX_EXPOSURES 10000

double igi_hdr_exposure(const igi_exposure *exposure)
{
    double n = exposure->f_number > 0 ? exposure->f_number : 1;
    return exposure->time_s * (exposure->iso > 0 ? exposure->iso / 100 : 1) / (n * n);
}

void igi_exposures_destroy(igi_exposure *exposures, size_t count)
{
    for (size_t i = 0; exposures && i < count; i++) igi_free(exposures[i].path);
    igi_free(exposures);
}

/* A positive number, or a fraction of two; moves *text behind it. */
static bool read_number(char **text, double *value)
{
    char *end;
    *value = strtod(*text, &end);
    if (end == *text) return false;
    if (*end == '/') {
        char *denominator = end + 1;
        double below = strtod(denominator, &end);
        if (end == denominator || !(below > 0)) return false;
        *value /= below;
    }
    if (*end && !strchr(" \t\r\n", *end)) return false;
    *text = end + strspn(end, " \t\r\n");
    return isfinite(*value) && *value > 0;
}

static igi_status read_line(igi_context *ctx, const char *list, int line, char *text,
                            igi_exposure *out)
{
    const char *slash = strrchr(list, '/');
    int folder = slash ? (int)(slash - list) + 1 : 0;
    size_t length = strcspn(text, " \t\r\n");
    char *rest = text + length + strspn(text + length, " \t\r\n");
    memset(out, 0, sizeof *out);
    text[length] = '\0';
    if (!read_number(&rest, &out->time_s))
        return igi_fail(ctx, IGI_E_DATA,
                        "%s:%d: no exposure time for '%s'; write NAME SECONDS [F-NUMBER [ISO]]",
                        list, line, text);
    if ((*rest && !read_number(&rest, &out->f_number)) ||
        (*rest && !read_number(&rest, &out->iso)) || *rest)
        return igi_fail(ctx, IGI_E_DATA,
                        "%s:%d: '%s' is followed by what is no number, or by too many; write NAME "
                        "SECONDS [F-NUMBER [ISO]]",
                        list, line, text);
    if (out->f_number > 0 && (out->f_number < .5 || out->f_number > 1024))
        return igi_fail(ctx, IGI_E_DATA,
                        "%s:%d: %g is no f-number; write NAME SECONDS [F-NUMBER [ISO]]", list, line,
                        out->f_number);
    return igi_strprintf(ctx, &out->path, "%.*s%s", text[0] == '/' ? 0 : folder, list, text);
}

static igi_status read_lines(igi_context *ctx, const char *list, FILE *file,
                             igi_exposure **exposures, size_t *count)
{
    char text[MAX_LINE];
    size_t capacity = 0;
    for (int line = 1; fgets(text, sizeof text, file); line++) {
        if (strlen(text) + 1 == sizeof text)
            return igi_fail(ctx, IGI_E_DATA, "%s:%d: the line is too long; one image a line", list,
                            line);
        text[strcspn(text, "#")] = '\0';
        char *start = text + strspn(text, " \t\r\n");
        if (!*start) continue;
        if (*count >= MAX_EXPOSURES)
            return igi_fail(ctx, IGI_E_DATA, "%s:%d: more than %d images; list one bracket", list,
                            line, MAX_EXPOSURES);
        igi_exposure *grown = igi_grow(ctx, *exposures, &capacity, *count + 1, sizeof **exposures);
        if (!grown) return IGI_E_SYSTEM;
        *exposures = grown;
        IGI_TRY(read_line(ctx, list, line, start, &grown[*count]));
        (*count)++;
    }
    if (*count == 0)
        return igi_fail(ctx, IGI_E_DATA, "%s: it lists no image; write NAME SECONDS on each line",
                        list);
    return IGI_OK;
}

igi_status igi_exposures_read(igi_context *ctx, const char *list, igi_exposure **exposures,
                              size_t *count)
{
    *exposures = NULL;
    *count = 0;
    FILE *file = fopen(list, "r");
    if (!file)
        return igi_fail(ctx, errno == ENOENT ? IGI_E_DATA : IGI_E_SYSTEM,
                        "%s: cannot be opened (%s); check the name and the permissions", list,
                        strerror(errno));
    igi_status status = read_lines(ctx, list, file, exposures, count);
    fclose(file);
    if (status != IGI_OK) {
        igi_exposures_destroy(*exposures, *count);
        *exposures = NULL;
        *count = 0;
    }
    return status;
}

static igi_status probe(igi_context *ctx, const char *path, igi_exposure *out)
{
    igi_photo *photo = NULL;
    IGI_TRY(igi_photo_probe(ctx, path, &photo));
    igi_status status = IGI_OK;
    if (!(photo->time_s > 0))
        status = igi_fail(ctx, IGI_E_DATA,
                          "%s: no EXIF states its exposure time; list the exposures with --list",
                          path);
    else status = igi_strdup(ctx, path, &out->path);
    out->time_s = photo->time_s;
    out->f_number = photo->f_number;
    out->iso = photo->iso;
    out->from_camera = true;
    igi_photo_destroy(photo);
    return status;
}

igi_status igi_exposures_probe(igi_context *ctx, const char *const *paths, size_t count,
                               igi_exposure **exposures)
{
    igi_exposure *made = NULL;
    *exposures = NULL;
    IGI_TRY(IGI_ALLOC(ctx, count, &made));
    for (size_t i = 0; i < count; i++) {
        igi_status status = probe(ctx, paths[i], &made[i]);
        if (status != IGI_OK) {
            igi_exposures_destroy(made, count);
            return status;
        }
    }
    *exposures = made;
    return IGI_OK;
}
