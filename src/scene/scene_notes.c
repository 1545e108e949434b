/* SPDX-License-Identifier: Apache-2.0 */
#include "scene/scene_notes.h"

#include "base/context.h"

#include <stdarg.h>
#include <stdio.h>

igi_status igi_scene_warn(igi_context *ctx, igi_scene *scene, const char *format, ...)
{
    char sentence[1024];
    va_list args;
    va_start(args, format);
    vsnprintf(sentence, sizeof sentence, format, args);
    va_end(args);
    igi_warn(ctx, "%s", sentence);
    size_t capacity = scene->warning_count;
    char **grown = igi_grow(ctx, scene->warnings, &capacity, scene->warning_count + 1,
                            sizeof *scene->warnings);
    if (!grown) return IGI_E_SYSTEM;
    scene->warnings = grown;
    IGI_TRY(igi_strdup(ctx, sentence, &scene->warnings[scene->warning_count]));
    scene->warning_count++;
    return IGI_OK;
}

igi_status igi_scene_note_file(igi_context *ctx, igi_scene *scene, const char *path)
{
    size_t capacity = scene->file_count;
    char **grown = igi_grow(ctx, scene->files, &capacity, scene->file_count + 1,
                            sizeof *scene->files);
    if (!grown) return IGI_E_SYSTEM;
    scene->files = grown;
    IGI_TRY(igi_strdup(ctx, path, &scene->files[scene->file_count]));
    scene->file_count++;
    return IGI_OK;
}
