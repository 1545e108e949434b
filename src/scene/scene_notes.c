/* SPDX-License-Identifier: Apache-2.0 */
#include "scene/scene_notes.h"

#include "base/context.h"

#include <stdarg.h>
#include <stdio.h>
#include <string.h>

igi_status igi_scene_warn(igi_context *ctx, igi_scene *scene, const char *format, ...)
{
    char sentence[1024];
    va_list args;
    va_start(args, format);
    vsnprintf(sentence, sizeof sentence, format, args);
    va_end(args);
    igi_warn(ctx, "%s", sentence);
    size_t n = scene->folder ? strlen(scene->folder) : 0; /* results know no path of the machine */
    bool within = n && strncmp(sentence, scene->folder, n) == 0 && sentence[n] == '/';
    char *const one = within ? sentence + n + 1 : sentence;
    return igi_copy_sentences(ctx, &one, 1, &scene->warnings, &scene->warning_count);
}

igi_status igi_scene_note_file(igi_context *ctx, igi_scene *scene, const char *path)
{
    char *copy;
    IGI_TRY(igi_strdup(ctx, path, &copy));
    return igi_add_sentence(ctx, &scene->files, &scene->file_count, copy);
}
