/* SPDX-License-Identifier: Apache-2.0
 *
 * A scene folder is whole in itself: what its lights name (profiles, environment maps, spectra) is
 * copied from beside the spec, and named as it lies in the folder.
 */
#include "synth/synth.h"

#include "base/file.h"
#include "scene/file_text.h"

#include <string.h>

#define MOST_BYTES ((size_t)1 << 30)

static const char *const file_keys[] = {"profile", "image", "spectrum"};
enum { FILE_KEYS = sizeof file_keys / sizeof file_keys[0] };

/* Two files of one name cannot lie in one folder, but one may be named twice. */
static bool is_taken(const igi_json *array, const char *name)
{
    for (size_t i = 0; i < json_array_size(array->value); i++)
        for (size_t k = 0; k < FILE_KEYS; k++) {
            const char *other = json_string_value(
                json_object_get(json_array_get(array->value, i), file_keys[k]));
            if (other && strcmp(other, name) != 0 &&
                strcmp(igi_file_name(other), igi_file_name(name)) == 0)
                return true;
        }
    return false;
}

static igi_status copy(igi_context *ctx, const igi_json *array, const igi_json *at,
                       const char *folder)
{
    igi_status status = IGI_OK;
    igi_text text = {NULL, 0};
    char *beside = NULL, *from = NULL, *to = NULL;
    const char *name = json_string_value(at->value);
    if (is_taken(array, name))
        IGI_TRY_GOTO(igi_json_fail(ctx, at,
                                   "\"%s\" is the name of another light's file, too; "
                                   "rename one of the two",
                                   igi_file_name(name)));
    IGI_TRY_GOTO(igi_path_folder(ctx, at->file->path, &beside));
    IGI_TRY_GOTO(igi_path_join(ctx, beside, name, &from));
    IGI_TRY_GOTO(igi_path_join(ctx, folder, igi_file_name(name), &to));
    IGI_TRY_GOTO(igi_text_load(ctx, from, MOST_BYTES, &text));
    IGI_TRY_GOTO(igi_file_save(ctx, to, text.bytes, text.size));
cleanup:
    igi_free(text.bytes);
    igi_free(beside);
    igi_free(from);
    igi_free(to);
    return status;
}

igi_status lights_keep(igi_context *ctx, const igi_json *array, const char *folder, json_t **lights)
{
    igi_status status = IGI_OK;
    *lights = json_deep_copy(array->value);
    if (!*lights) return igi_fail(ctx, IGI_E_SYSTEM, "%s: no memory for its lights", folder);
    for (size_t i = 0; i < json_array_size(*lights); i++) {
        igi_json light = igi_json_element(array, i);
        for (size_t k = 0; k < FILE_KEYS; k++) {
            igi_json at = igi_json_member(&light, file_keys[k]);
            if (!json_is_string(at.value)) continue;
            IGI_TRY_GOTO(copy(ctx, array, &at, folder));
            json_object_set_new(json_array_get(*lights, i), file_keys[k],
                                json_string(igi_file_name(json_string_value(at.value))));
        }
    }
cleanup:
    if (status != IGI_OK) {
        json_decref(*lights);
        *lights = NULL;
    }
    return status;
}
