/* SPDX-License-Identifier: Apache-2.0 */
#include "scene/json.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <string.h>

/* Jansson needs up to some twenty times the text; 30,000 frames of transforms.json fit. */
#define MAX_JSON_BYTES ((size_t)32 << 20)

igi_status igi_json_load(igi_context *ctx, const char *path, igi_json_file *file)
{
    *file = (igi_json_file){.path = path};
    IGI_TRY(igi_text_load(ctx, path, MAX_JSON_BYTES, &file->text));
    const char *start = file->text.bytes;
    size_t size = file->text.size;
    if (size >= 3 && memcmp(start, "\xef\xbb\xbf", 3) == 0) { /* as some editors leave it */
        start += 3;
        size -= 3;
    }
    /* Jansson 2.14 lets a NUL behind a number pass; the walk by lines would end there. */
    const char *nul = memchr(start, 0, size);
    if (nul) {
        size_t at = (size_t)(nul - start);
        igi_json_unload(file);
        return igi_fail(ctx, IGI_E_DATA, "%s: no valid JSON: byte %zu is a NUL; write it as UTF-8",
                        path, at);
    }
    json_error_t error;
    /* Integers as reals: a width may stand as 1080.0, and none may be too large to be read. */
    file->root = json_loadb(start, size, JSON_REJECT_DUPLICATES | JSON_DECODE_INT_AS_REAL, &error);
    if (file->root) return IGI_OK;
    igi_status status = json_error_code(&error) == json_error_out_of_memory
                            ? igi_fail(ctx, IGI_E_SYSTEM, "%s: no memory to read it", path)
                            : igi_fail(ctx, IGI_E_DATA, "%s:%d: no valid JSON: %s; mend the file",
                                       path, error.line > 0 ? error.line : 1, error.text);
    igi_json_unload(file);
    return status;
}

void igi_json_unload(igi_json_file *file)
{
    json_decref(file->root);
    igi_free(file->text.bytes);
    *file = (igi_json_file){0};
}

igi_json igi_json_root(const igi_json_file *file)
{
    igi_json root = {.file = file, .value = file->root};
    return root;
}

igi_json igi_json_member(const igi_json *object, const char *key)
{
    igi_json member = {.file = object->file, .parent = object, .key = key};
    member.value = json_object_get(object->value, key);
    return member;
}

igi_json igi_json_element(const igi_json *array, size_t index)
{
    igi_json element = {.file = array->file, .parent = array, .index = index};
    element.value = json_array_get(array->value, index);
    return element;
}

/* The text has been parsed, so the walk below looks for little but the end. */

static const char *skip_blanks(const char *p)
{
    while (*p == ' ' || *p == '\t' || *p == '\r' || *p == '\n' || *p == ',' || *p == ':') p++;
    return p;
}

static const char *skip_string(const char *p)
{
    if (*p) p++;
    for (; *p && *p != '"'; p++)
        if (*p == '\\' && p[1]) p++;
    return *p ? p + 1 : p;
}

static const char *skip_value(const char *p)
{
    int depth = 0;
    do {
        if (*p == '"') {
            p = skip_string(p);
        } else if (*p == '{' || *p == '[') {
            depth++;
            p++;
        } else if (*p == '}' || *p == ']') {
            depth--;
            p++;
        } else if (depth > 0) {
            p++;
        } else {
            p += strcspn(p, ",]} \t\r\n");
        }
    } while (depth > 0 && *p);
    return p;
}

/* Jansson keeps members in the order of the file, and refuses doubled keys: a member's number in
 * its iteration is its number in the text. */
static size_t member_number(const igi_json *member)
{
    size_t number = 0;
    const char *key;
    json_t *value;
    json_object_foreach (member->parent->value, key, value) {
        if (strcmp(key, member->key) == 0) break;
        number++;
    }
    return number;
}

/* Where the value stands; *name: where its key does, or the value for an element. */
static const char *locate(const igi_json *at, const char **name)
{
    if (!at->parent) {
        const char *start = at->file->text.bytes;
        if (strncmp(start, "\xef\xbb\xbf", 3) == 0) start += 3;
        return *name = skip_blanks(start);
    }
    const char *p = locate(at->parent, name);
    if (*p) p = skip_blanks(p + 1);
    size_t number = at->key ? member_number(at) : at->index;
    for (size_t i = 0; i < number; i++) {
        if (at->key) p = skip_blanks(skip_string(p));
        p = skip_blanks(skip_value(p));
    }
    *name = p;
    return at->key ? skip_blanks(skip_string(p)) : p;
}

int igi_json_line(const igi_json *at)
{
    while (!at->value && at->parent) at = at->parent; /* what is absent has no line */
    const char *name;
    (void)locate(at, &name);
    int line = 1;
    for (const char *p = at->file->text.bytes; p < name; p++) line += *p == '\n';
    return line;
}

static size_t write_place(const igi_json *at, char *place, size_t size)
{
    if (!at->parent) return 0;
    size_t length = write_place(at->parent, place, size);
    if (length >= size) return length;
    int more = at->key ? snprintf(place + length, size - length, "%s%s", length ? "." : "", at->key)
                       : snprintf(place + length, size - length, "[%zu]", at->index);
    return length + (more > 0 ? (size_t)more : 0);
}

igi_status igi_json_fail(igi_context *ctx, const igi_json *at, const char *format, ...)
{
    char what[512], place[256] = "";
    va_list args;
    va_start(args, format);
    vsnprintf(what, sizeof what, format, args);
    va_end(args);
    if (write_place(at, place, sizeof place) == 0)
        return igi_fail(ctx, IGI_E_DATA, "%s:%d: %s", at->file->path, igi_json_line(at), what);
    return igi_fail(ctx, IGI_E_DATA, "%s:%d: \"%s\": %s", at->file->path, igi_json_line(at), place,
                    what);
}

static igi_status mismatch(igi_context *ctx, const igi_json *at, const char *wanted)
{
    if (!at->value) return igi_json_fail(ctx, at, "is missing; give %s", wanted);
    static const char *const names[] = {"an object", "an array", "a string", "a number",
                                        "a number",  "true",     "false",    "null"};
    return igi_json_fail(ctx, at, "is %s; give %s", names[json_typeof(at->value)], wanted);
}

igi_status igi_json_object(igi_context *ctx, const igi_json *at)
{
    return json_is_object(at->value) ? IGI_OK : mismatch(ctx, at, "an object { ... }");
}

igi_status igi_json_array(igi_context *ctx, const igi_json *at, size_t *count)
{
    *count = json_array_size(at->value);
    return json_is_array(at->value) ? IGI_OK : mismatch(ctx, at, "an array [ ... ]");
}

igi_status igi_json_number(igi_context *ctx, const igi_json *at, double *value)
{
    *value = json_number_value(at->value);
    return json_is_number(at->value) ? IGI_OK : mismatch(ctx, at, "a number");
}

igi_status igi_json_bool(igi_context *ctx, const igi_json *at, bool *value)
{
    *value = json_is_true(at->value);
    return json_is_boolean(at->value) ? IGI_OK : mismatch(ctx, at, "true or false");
}

igi_status igi_json_string(igi_context *ctx, const igi_json *at, const char **value)
{
    *value = json_string_value(at->value);
    if (!*value) return mismatch(ctx, at, "a string");
    return **value ? IGI_OK : igi_json_fail(ctx, at, "is empty; give a name");
}

igi_status igi_json_numbers(igi_context *ctx, const igi_json *at, size_t count, double *values)
{
    size_t got;
    IGI_TRY(igi_json_array(ctx, at, &got));
    if (got != count) return igi_json_fail(ctx, at, "has %zu numbers; give %zu", got, count);
    for (size_t i = 0; i < count; i++) {
        igi_json element = igi_json_element(at, i);
        IGI_TRY(igi_json_number(ctx, &element, &values[i]));
    }
    return IGI_OK;
}

igi_status igi_json_check_keys(igi_context *ctx, const igi_json *object, const char *const *known,
                               size_t count)
{
    IGI_TRY(igi_json_object(ctx, object));
    const char *key;
    json_t *value;
    json_object_foreach (object->value, key, value) {
        bool is_known = false;
        for (size_t i = 0; i < count && !is_known; i++) is_known = strcmp(key, known[i]) == 0;
        if (is_known) continue;
        igi_json member = igi_json_member(object, key);
        const char *meant = igi_closest(key, known, count);
        return meant ? igi_json_fail(ctx, &member, "unknown key; did you mean \"%s\"?", meant)
                     : igi_json_fail(ctx, &member, "unknown key; remove it");
    }
    return IGI_OK;
}

bool igi_is_utf8(const char *text)
{
    json_t *string = json_string(text); /* NULL when it is not */
    json_decref(string);
    return string != NULL;
}
