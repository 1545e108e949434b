/* SPDX-License-Identifier: Apache-2.0
 *
 * A test program: static void cases, CHECKs that print both values, and TEST_MAIN with a table.
 * `test_x NAME` runs the cases whose name contains NAME. Exit 77: everything was skipped.
 */
#ifndef IGI_TESTS_TEST_H
#define IGI_TESTS_TEST_H

#include <igi/igi.h>

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static int test_failures, test_checks, test_skips;

#define CHECK(condition)                                                         \
    do {                                                                         \
        test_checks++;                                                           \
        if (!(condition)) {                                                      \
            test_failures++;                                                     \
            printf("%s:%d: CHECK(%s) failed\n", __FILE__, __LINE__, #condition); \
        }                                                                        \
    } while (0)

#define CHECK_NEAR(got, want, tolerance)                                                        \
    do {                                                                                        \
        double got_ = (got), want_ = (want), tolerance_ = (tolerance);                          \
        test_checks++;                                                                          \
        if (!(fabs(got_ - want_) <= tolerance_)) {                                              \
            test_failures++;                                                                    \
            printf("%s:%d: %s = %.9g, want %.9g within %.3g\n", __FILE__, __LINE__, #got, got_, \
                   want_, tolerance_);                                                          \
        }                                                                                       \
    } while (0)

#define CHECK_STR(got, want)                                                                    \
    do {                                                                                        \
        const char *got_ = (got), *want_ = (want);                                              \
        test_checks++;                                                                          \
        if (strcmp(got_, want_) != 0) {                                                         \
            test_failures++;                                                                    \
            printf("%s:%d: %s = \"%s\", want \"%s\"\n", __FILE__, __LINE__, #got, got_, want_); \
        }                                                                                       \
    } while (0)

/* Does `text` contain `part`? */
#define CHECK_CONTAINS(text, part)                                                               \
    do {                                                                                         \
        const char *text_ = (text), *part_ = (part);                                             \
        test_checks++;                                                                           \
        if (!strstr(text_, part_)) {                                                             \
            test_failures++;                                                                     \
            printf("%s:%d: \"%s\" does not contain \"%s\"\n", __FILE__, __LINE__, text_, part_); \
        }                                                                                        \
    } while (0)

/* Succeeds or prints the context's sentence. */
#define CHECK_OK(ctx, call)                                                                 \
    do {                                                                                    \
        igi_status status_ = (call);                                                        \
        test_checks++;                                                                      \
        if (status_ != IGI_OK) {                                                            \
            test_failures++;                                                                \
            printf("%s:%d: %s: %s\n", __FILE__, __LINE__, #call, igi_context_message(ctx)); \
        }                                                                                   \
    } while (0)

typedef struct test_case {
    const char *name;
    void (*run)(void);
} test_case;

static inline int test_main(int argc, char **argv, const test_case *cases, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        if (argc > 1 && !strstr(cases[i].name, argv[1])) continue;
        int before = test_failures;
        cases[i].run();
        printf("%s %s\n", test_failures == before ? "ok  " : "FAIL", cases[i].name);
    }
    printf("%d checks, %d failed, %d skipped\n", test_checks, test_failures, test_skips);
    return test_failures ? 1 : test_checks == 0 && test_skips ? 77 : 0;
}

/* TEST_MAIN({"name", function}, ...) */
#define TEST_MAIN(...)                                                       \
    int main(int argc, char **argv)                                          \
    {                                                                        \
        static const test_case cases[] = {__VA_ARGS__};                      \
        return test_main(argc, argv, cases, sizeof cases / sizeof cases[0]); \
    }

/* The optional folder of independent data: IGI_SHARED_DATA, or ../shared/data beside the checkout.
 * Writes folder/name into `path`; false, with a word about skipping, when it is not there. */
static inline bool test_shared_data(const char *name, char *path, size_t size)
{
    const char *folder = getenv("IGI_SHARED_DATA");
    if (!folder || !folder[0]) folder = IGI_SOURCE_DIR "/../shared/data";
    snprintf(path, size, "%s/%s", folder, name);
    FILE *file = fopen(path, "r"); /* opens folders too, for reading */
    if (file) {
        fclose(file);
        return true;
    }
    printf("skipped: no %s (set IGI_SHARED_DATA to the data folder)\n", path);
    test_skips++;
    return false;
}

static inline igi_context *test_context(int threads)
{
    igi_context_options options;
    igi_context_options_init(&options);
    options.threads = threads;
    igi_context *ctx = NULL;
    if (igi_context_create(&options, &ctx) != IGI_OK) abort();
    return ctx;
}

#endif
