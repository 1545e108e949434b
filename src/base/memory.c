/* SPDX-License-Identifier: Apache-2.0
 *
 * The one file that calls malloc.
 */
#include "base/context.h"
#include "base/context_private.h"

#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

void igi_fail_allocation_after(igi_context *ctx, long n)
{
    atomic_store(&ctx->root->allocations_left, n);
}

static bool allocation_is_to_fail(igi_context *ctx)
{
    atomic_long *left = &ctx->root->allocations_left;
    if (atomic_load_explicit(left, memory_order_relaxed) < 0) return false;
    return atomic_fetch_sub(left, 1) == 0;
}

static void say_out_of_memory(igi_context *ctx, size_t count, size_t size)
{
    (void)igi_fail(ctx, IGI_E_SYSTEM,
                   "memory: no room for %zu elements of %zu bytes; close other programs, or use "
                   "fewer or smaller images",
                   count, size);
}

void *igi_calloc(igi_context *ctx, size_t count, size_t size)
{
    void *memory = NULL;
    if (!allocation_is_to_fail(ctx)) memory = calloc(count ? count : 1, size ? size : 1);
    if (!memory) say_out_of_memory(ctx, count, size);
    return memory;
}

void *igi_grow(igi_context *ctx, void *array, size_t *capacity, size_t need, size_t size)
{
    if (array && need <= *capacity) return array;
    size_t wanted = *capacity < 8 ? 16 : *capacity * 2;
    if (wanted < need) wanted = need;
    void *grown = NULL;
    if (wanted <= SIZE_MAX / size && !allocation_is_to_fail(ctx))
        grown = realloc(array, wanted * size);
    if (!grown) say_out_of_memory(ctx, wanted, size);
    else *capacity = wanted;
    return grown;
}

igi_status igi_strdup(igi_context *ctx, const char *text, char **copy)
{
    size_t bytes = strlen(text) + 1;
    IGI_TRY(IGI_ALLOC(ctx, bytes, copy));
    memcpy(*copy, text, bytes);
    return IGI_OK;
}

igi_status igi_vstrprintf(igi_context *ctx, char **text, const char *format, va_list args)
{
    va_list measured;
    va_copy(measured, args);
    int length = vsnprintf(NULL, 0, format, measured);
    va_end(measured);
    *text = NULL;
    if (length < 0) return igi_fail(ctx, IGI_E_INTERNAL, "text: format '%s' failed", format);
    IGI_TRY(IGI_ALLOC(ctx, (size_t)length + 1, text));
    vsnprintf(*text, (size_t)length + 1, format, args);
    return IGI_OK;
}

igi_status igi_strprintf(igi_context *ctx, char **text, const char *format, ...)
{
    va_list args;
    va_start(args, format);
    igi_status status = igi_vstrprintf(ctx, text, format, args);
    va_end(args);
    return status;
}

igi_status igi_add_sentence(igi_context *ctx, char ***list, size_t *count, char *sentence)
{
    size_t capacity = *count;
    char **grown = igi_grow(ctx, *list, &capacity, *count + 1, sizeof *grown);
    if (!grown) {
        igi_free(sentence);
        return IGI_E_SYSTEM;
    }
    *list = grown;
    grown[(*count)++] = sentence;
    return IGI_OK;
}

igi_status igi_copy_sentences(igi_context *ctx, char *const *from, size_t from_count, char ***list,
                              size_t *count)
{
    for (size_t i = 0; i < from_count; i++) {
        char *copy;
        IGI_TRY(igi_strdup(ctx, from[i], &copy));
        IGI_TRY(igi_add_sentence(ctx, list, count, copy));
    }
    return IGI_OK;
}

void igi_free(void *pointer)
{
    free(pointer);
}
