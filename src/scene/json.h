/* SPDX-License-Identifier: Apache-2.0
 *
 * JSON whose errors name the line and the key. Jansson parses and keeps no lines; so each value
 * here knows its place in the tree, and only when something is wrong is the text walked again to
 * find where that place is.
 */
#ifndef IGI_SRC_SCENE_JSON_H
#define IGI_SRC_SCENE_JSON_H

#include "scene/file_text.h"

#include <jansson.h>

typedef struct igi_json_file {
    const char *path; /* the caller's */
    igi_text text;
    json_t *root;
} igi_json_file;

/* A value and the way to it. The parent must live as long as the child is used. */
typedef struct igi_json {
    const igi_json_file *file;
    const struct igi_json *parent; /* NULL: the root */
    const char *key;               /* NULL: an element of an array */
    size_t index;                  /* of an element */
    json_t *value;                 /* NULL: absent */
} igi_json;

/* The file must hold one object or array without doubled keys. */
IGI_MUST_USE igi_status igi_json_load(igi_context *ctx, const char *path, igi_json_file *file);
void igi_json_unload(igi_json_file *file);

igi_json igi_json_root(const igi_json_file *file);
/* .value is NULL when there is no such member. `key` must outlive the result. */
igi_json igi_json_member(const igi_json *object, const char *key);
igi_json igi_json_element(const igi_json *array, size_t index);

/* The line on which the value's key, or the value of an element, stands. */
int igi_json_line(const igi_json *at);

/* IGI_E_DATA with FILE:LINE: "key[2].key": before the given words. */
igi_status igi_json_fail(igi_context *ctx, const igi_json *at, const char *format, ...)
    IGI_PRINTF(3, 4);

/* Each fails with a sentence when the value is absent or of another type. */
IGI_MUST_USE igi_status igi_json_object(igi_context *ctx, const igi_json *at);
IGI_MUST_USE igi_status igi_json_array(igi_context *ctx, const igi_json *at, size_t *count);
IGI_MUST_USE igi_status igi_json_number(igi_context *ctx, const igi_json *at, double *value);
IGI_MUST_USE igi_status igi_json_bool(igi_context *ctx, const igi_json *at, bool *value);
/* Not empty. */
IGI_MUST_USE igi_status igi_json_string(igi_context *ctx, const igi_json *at, const char **value);
/* An array of exactly `count` numbers. */
IGI_MUST_USE igi_status igi_json_numbers(igi_context *ctx, const igi_json *at, size_t count,
                                         double *values);

/* Refuses members whose key is not among the known ones, and says which was probably meant. */
IGI_MUST_USE igi_status igi_json_check_keys(igi_context *ctx, const igi_json *object,
                                            const char *const *known, size_t count);

bool igi_is_utf8(const char *text);

#endif
