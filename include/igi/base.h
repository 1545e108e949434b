/* SPDX-License-Identifier: Apache-2.0
 *
 * What every call of igi shares: status values, the context, progress and cancelling.
 *
 * Errors are values. A function that can fail returns an igi_status, and on failure leaves one
 * sentence in the context (igi_context_message): the file, the place, what is wrong, what to do.
 * Results come through out-pointers, which are NULL after a failure.
 *
 * Ownership: whoever calls ..._create or ..._load owns the result and calls ..._destroy;
 * ..._destroy(NULL) does nothing. Getters return views that live as long as their owner.
 *
 * Options: ..._options_init sets struct_size and every default, and comes first; NULL for options is
 * all defaults where a function says so. ..._name is a value's word, never NULL; ..._from_name finds
 * the value again and is false, *value untouched, where no value has that word.
 *
 * Threads: one context is used by one thread at a time; the library's own workers are inside it.
 */
#ifndef IGI_BASE_H
#define IGI_BASE_H

#include <stdbool.h>
#include <stddef.h>
#include <stdint.h>

#if defined(__GNUC__)
#define IGI_API __attribute__((visibility("default")))
#define IGI_MUST_USE __attribute__((warn_unused_result))
#define IGI_PRINTF(format_at, args_at) __attribute__((format(printf, format_at, args_at)))
#else
#define IGI_API
#define IGI_MUST_USE
#define IGI_PRINTF(format_at, args_at)
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* The most colour bands an image, a light or an albedo may have. */
#define IGI_MAX_BANDS 16

/* Every outcome: name, value, meaning. The values are the program's exit statuses. */
#define IGI_STATUS_LIST(X)                                              \
    X(IGI_OK, 0, "done")                                                \
    X(IGI_E_NO_ANSWER, 1, "it ran, and the answer is no")               \
    X(IGI_E_USAGE, 2, "the call or the command line is wrong")          \
    X(IGI_E_DATA, 3, "the input data is wrong")                         \
    X(IGI_E_SYSTEM, 4, "the file system or the memory did not suffice") \
    X(IGI_E_INTERNAL, 5, "a fault of igi's own")                        \
    X(IGI_E_CANCELLED, 130, "interrupted")

#define IGI_STATUS_ENUM(name, value, meaning) name = value,
typedef enum igi_status { IGI_STATUS_LIST(IGI_STATUS_ENUM) } igi_status;
#undef IGI_STATUS_ENUM

/* The meaning of a status, a few words; never NULL. */
IGI_API const char *igi_status_meaning(igi_status status);

typedef struct igi_context igi_context;

/* Progress, at most some ten times a second, from the calling thread. `stage` is a word or two,
 * `fraction` runs from 0 to 1 within the stage. Return false to cancel. */
typedef bool (*igi_progress_fn)(void *user, const char *stage, double fraction);

/* A warning or a remark, one sentence without a newline; from the calling thread. */
typedef void (*igi_log_fn)(void *user, const char *sentence);

typedef struct igi_context_options {
    size_t struct_size;       /* set by igi_context_options_init */
    int threads;              /* 1..256; 0: as many as there are processors (default) */
    uint64_t seed;            /* of every random stream; default 1 */
    igi_progress_fn progress; /* may be NULL */
    igi_log_fn log;           /* may be NULL */
    void *user;               /* handed to both */
} igi_context_options;

IGI_API void igi_context_options_init(igi_context_options *options);

/* options may be NULL for all defaults. On failure *context is NULL. */
IGI_API IGI_MUST_USE igi_status igi_context_create(const igi_context_options *options,
                                                   igi_context **context);
IGI_API void igi_context_destroy(igi_context *context);

/* The sentence of the last failure, "" if there was none. Valid until the next call. */
IGI_API const char *igi_context_message(const igi_context *context);

/* Asks the running call to stop with IGI_E_CANCELLED; may be called from a signal handler or
 * another thread. */
IGI_API void igi_context_cancel(igi_context *context);

/* What one stage of a run cost. */
typedef struct igi_stage {
    const char *name;
    double cpu_s; /* of all threads */
    double wall_s;
    uint64_t rays;
    uint64_t peak_bytes; /* most resident memory of the process up to the end of the stage */
} igi_stage;

/* The stages since the context was made, in order. */
IGI_API size_t igi_context_stages(const igi_context *context, const igi_stage **stages);

#ifdef __cplusplus
}
#endif
#endif
