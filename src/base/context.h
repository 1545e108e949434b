/* SPDX-License-Identifier: Apache-2.0
 *
 * Inside the context: failing, allocating, reporting, and what a stage costs.
 */
#ifndef IGI_SRC_BASE_CONTEXT_H
#define IGI_SRC_BASE_CONTEXT_H

#include <igi/base.h>

#include <stdarg.h>

/* Leaves the sentence "igi"-style (`FILE[:LINE]: what is wrong; what to do`) in the context and
 * returns `status`, so that one writes `return igi_fail(ctx, IGI_E_DATA, "%s:%d: ...", ...)`. */
igi_status igi_fail(igi_context *ctx, igi_status status, const char *format, ...) IGI_PRINTF(3, 4);

/* Hands a warning to the log callback. */
void igi_warn(igi_context *ctx, const char *format, ...) IGI_PRINTF(2, 3);

/* Passes a failure up: the sentence is already in the context. */
#define IGI_TRY(expression)                            \
    do {                                               \
        igi_status try_status_ = (expression);         \
        if (try_status_ != IGI_OK) return try_status_; \
    } while (0)

/* The same for a function with one exit: `igi_status status = IGI_OK; ... cleanup: ...`. */
#define IGI_TRY_GOTO(expression)            \
    do {                                    \
        status = (expression);              \
        if (status != IGI_OK) goto cleanup; \
    } while (0)

/* The only allocator. Zeroed memory for count x size bytes; the product is checked. NULL on
 * failure, with the sentence in the context. count == 0 gives a unique pointer. */
void *igi_calloc(igi_context *ctx, size_t count, size_t size);
/* `array` (may be NULL) with room for at least `need` elements, doubling *capacity; its contents
 * are kept, new elements are not zeroed. NULL on failure: `array` is then still the caller's. */
void *igi_grow(igi_context *ctx, void *array, size_t *capacity, size_t need, size_t size);
void igi_free(void *pointer);

/* Typed fronts with a status: IGI_TRY_GOTO(IGI_ALLOC(ctx, n, &array)). */
#define IGI_ALLOC(ctx, count, pointer) \
    ((*(pointer) = igi_calloc((ctx), (count), sizeof **(pointer))) ? IGI_OK : IGI_E_SYSTEM)

IGI_MUST_USE igi_status igi_strdup(igi_context *ctx, const char *text, char **copy);
/* A formatted string of its own. */
IGI_MUST_USE igi_status igi_strprintf(igi_context *ctx, char **text, const char *format, ...)
    IGI_PRINTF(3, 4);
IGI_MUST_USE igi_status igi_vstrprintf(igi_context *ctx, char **text, const char *format,
                                       va_list args) IGI_PRINTF(3, 0);

/* Adds a sentence to a list of them, which owns it from then on; frees it when there is no room. */
IGI_MUST_USE igi_status igi_add_sentence(igi_context *ctx, char ***list, size_t *count,
                                         char *sentence);
/* Adds copies of them all. */
IGI_MUST_USE igi_status igi_copy_sentences(igi_context *ctx, char *const *from, size_t from_count,
                                           char ***list, size_t *count);

/* For tests: the n-th allocation from now on fails (0: the next); -1: none does. */
void igi_fail_allocation_after(igi_context *ctx, long n);

int igi_threads(const igi_context *ctx);
uint64_t igi_seed(const igi_context *ctx);

/* Ends the stage that runs and begins another; `name` is a literal. NULL only ends. */
void igi_stage_begin(igi_context *ctx, const char *name);
/* Reports how far the stage is; IGI_E_CANCELLED when the user asked to stop. Cheap. */
IGI_MUST_USE igi_status igi_progress(igi_context *ctx, double fraction);
/* Adds to the count of rays of the running stage; from any worker. */
void igi_count_rays(igi_context *ctx, uint64_t rays);

/* CPU seconds of this process, all threads. */
double igi_cpu_seconds(void);

#endif
