/* SPDX-License-Identifier: Apache-2.0
 *
 * The rooms that sweeps start from. A room is known by what it is made of: the same spec, settings
 * and seed lie in the same folder, so that sweeps share it and a cache can keep it.
 */
#include "chart/sweep.h"
#include "base/file.h"

#include <igi/output.h>
#include <igi/synth.h>

#include <stdlib.h>
#include <string.h>

/* The value with "$" replaced by the severity; NULL when memory ends. */
static json_t *with_severity(json_t *value, double severity)
{
    if (json_is_string(value) && strcmp(json_string_value(value), "$") == 0)
        return json_real(severity);
    if (json_is_object(value)) {
        const char *key;
        json_t *member, *object = json_object();
        json_object_foreach (value, key, member)
            if (json_object_set_new(object, key, with_severity(member, severity))) break;
        return object;
    }
    if (!json_is_array(value)) return json_deep_copy(value);
    json_t *array = json_array();
    for (size_t i = 0; i < json_array_size(value); i++)
        if (json_array_append_new(array, with_severity(json_array_get(value, i), severity))) break;
    return array;
}

/* Sets the value at "a.b.0.c": keys and indices that must be there; the last may be new. */
static bool set_at(json_t *root, const char *path, json_t *value)
{
    char key[256];
    json_t *at = root;
    for (;;) {
        size_t length = strcspn(path, ".");
        if (length >= sizeof key) break;
        memcpy(key, path, length);
        key[length] = 0;
        bool last = !path[length];
        size_t index = (size_t)strtoul(key, NULL, 10);
        if (last && json_is_object(at)) return json_object_set_new(at, key, value) == 0;
        if (last && json_is_array(at) && index < json_array_size(at))
            return json_array_set_new(at, index, value) == 0;
        if (last && json_is_array(at) && index == json_array_size(at))
            return json_array_append_new(at, value) == 0;
        at = json_is_array(at) ? json_array_get(at, index) : json_object_get(at, key);
        if (last || !at) break;
        path += length + 1;
    }
    json_decref(value);
    return false;
}

static igi_status apply_set(igi_context *ctx, const igi_json *set, double severity, json_t *spec)
{
    const char *path;
    json_t *value;
    if (!set->value) return IGI_OK;
    json_object_foreach (set->value, path, value) {
        igi_json at = igi_json_member(set, path);
        if (!set_at(spec, path, with_severity(value, severity)))
            return igi_json_fail(ctx, &at, "leads to nothing in the spec");
    }
    return IGI_OK;
}

/* The small edition: photographs that take a blink to render. */
static void shrink(json_t *spec)
{
    static const struct {
        const char *path;
        int value;
    } views[] = {
        {"views.width", 64}, {"views.height", 48}, {"views.count", 10}, {"views.samples", 12}};
    for (size_t i = 0; i < sizeof views / sizeof views[0]; i++) {
        bool set = set_at(spec, views[i].path, json_integer(views[i].value));
        (void)set; /* a spec without "views" has the defaults */
    }
}

static uint64_t hash_text(uint64_t hash, const char *text)
{
    for (; *text; text++) hash = igi_hash64(hash ^ (unsigned char)*text);
    return hash;
}

static igi_status plan_spec(igi_context *ctx, json_t *spec, const char *base, const char *cache,
                            chart_room *room)
{
    char *stem = NULL, *text = json_dumps(spec, JSON_INDENT(1) | JSON_REAL_PRECISION(9));
    igi_status status = IGI_OK;
    if (!text) return igi_fail(ctx, IGI_E_SYSTEM, "%s: no memory to change it", base);
    IGI_TRY_GOTO(igi_strdup(ctx, text, &room->spec));
    IGI_TRY_GOTO(igi_path_stem(ctx, base, &stem));
    uint64_t hash = hash_text(hash_text(igi_hash64(room->seed), text), igi_version());
    IGI_TRY_GOTO(
        igi_strprintf(ctx, &room->folder, "%s/%s-%016llx", cache, stem, (unsigned long long)hash));
cleanup:
    igi_free(stem);
    free(text); /* jansson's */
    return status;
}

igi_status chart_room_plan(igi_context *ctx, const char *base, const igi_json *set, double severity,
                           uint64_t seed, const char *cache, bool small, chart_room *room)
{
    json_t *spec = NULL;
    igi_json_file file;
    *room = (chart_room){.seed = seed};
    if (igi_is_folder(base)) return igi_strdup(ctx, base, &room->folder);
    IGI_TRY(igi_json_load(ctx, base, &file));
    igi_status status = IGI_OK;
    spec = json_deep_copy(file.root);
    if (!spec) IGI_TRY_GOTO(igi_fail(ctx, IGI_E_SYSTEM, "%s: no memory to change it", base));
    if (small) shrink(spec);
    IGI_TRY_GOTO(apply_set(ctx, set, severity, spec));
    IGI_TRY_GOTO(plan_spec(ctx, spec, base, cache, room));
cleanup:
    json_decref(spec);
    igi_json_unload(&file);
    return status;
}

static igi_status render(igi_context *ctx, const chart_room *room, const char *folder)
{
    igi_status status = IGI_OK;
    igi_context *own = NULL;
    char *spec = NULL;
    IGI_TRY_GOTO(igi_strprintf(ctx, &spec, "%s/spec.json", folder));
    IGI_TRY_GOTO(igi_file_save(ctx, spec, room->spec, strlen(room->spec)));
    IGI_TRY_GOTO(chart_own_context(ctx, room->seed, &own));
    status = igi_synth(own, spec, folder);
    if (status != IGI_OK) status = igi_fail(ctx, status, "%s", igi_context_message(own));
cleanup:
    igi_context_destroy(own);
    igi_free(spec);
    return status;
}

igi_status chart_room_make(igi_context *ctx, const chart_room *room)
{
    igi_status status = IGI_OK;
    igi_output *output = NULL;
    char *manifest = NULL;
    if (!room->spec) return IGI_OK;
    IGI_TRY_GOTO(igi_strprintf(ctx, &manifest, "%s/scene.json", room->folder));
    if (igi_file_exists(manifest)) goto cleanup;
    IGI_TRY_GOTO(igi_output_begin(ctx, room->folder, true, NULL, &output));
    IGI_TRY_GOTO(render(ctx, room, igi_output_folder(output)));
    IGI_TRY_GOTO(igi_output_commit(ctx, output));
cleanup:
    igi_output_destroy(output);
    igi_free(manifest);
    return status;
}

void chart_room_clear(chart_room *room)
{
    igi_free(room->folder);
    igi_free(room->spec);
    chart_relit_clear(&room->relit);
    *room = (chart_room){0};
}
