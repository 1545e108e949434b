/* SPDX-License-Identifier: Apache-2.0 */
#include "scene/file_text.h"

#include "base/file.h"

#include <errno.h>
#include <math.h>
#include <stdio.h>
#include <string.h>
#include <strings.h>
#include <sys/stat.h>

static igi_status read_open_file(igi_context *ctx, FILE *file, const char *path, size_t limit,
                                 igi_text *text)
{
    struct stat info;
    if (fstat(fileno(file), &info) != 0 || !S_ISREG(info.st_mode))
        return igi_fail(ctx, IGI_E_SYSTEM, "%s: not a plain file; name one", path);
    if ((uintmax_t)info.st_size > limit)
        return igi_fail(ctx, IGI_E_DATA, "%s: larger than %zu MiB; is it the right file?", path,
                        limit >> 20);
    size_t size = (size_t)info.st_size;
    IGI_TRY(IGI_ALLOC(ctx, size + 1, &text->bytes));
    text->size = fread(text->bytes, 1, size, file);
    text->bytes[text->size] = 0;
    if (ferror(file))
        return igi_fail(ctx, IGI_E_SYSTEM, "%s: cannot be read: %s", path, strerror(errno));
    return IGI_OK;
}

igi_status igi_text_load(igi_context *ctx, const char *path, size_t limit, igi_text *text)
{
    *text = (igi_text){0};
    FILE *file = fopen(path, "rb");
    if (!file)
        return errno == ENOENT || errno == ENOTDIR
                   ? igi_fail(ctx, IGI_E_DATA, "%s: no such file or folder; check the path", path)
                   : igi_fail(ctx, IGI_E_SYSTEM, "%s: cannot be opened: %s", path, strerror(errno));
    igi_status status = read_open_file(ctx, file, path, limit, text);
    fclose(file);
    if (status != IGI_OK) {
        igi_free(text->bytes);
        *text = (igi_text){0};
    }
    return status;
}

static bool scan_word(const char **at, double *value)
{
    static const struct {
        const char *word;
        double value;
    } words[] = {{"infinity", HUGE_VAL}, {"inf", HUGE_VAL}, {"nan", (double)NAN}};
    for (size_t i = 0; i < sizeof words / sizeof words[0]; i++) {
        size_t length = strlen(words[i].word);
        if (strncasecmp(*at, words[i].word, length) == 0) {
            *at += length;
            *value = words[i].value;
            return true;
        }
    }
    return false;
}

static inline bool is_digit(char c)
{
    return c >= '0' && c <= '9';
}

static const char *scan_exponent(const char *p, int *exponent)
{
    const char *q = p + 1;
    bool negative = *q == '-';
    if (*q == '-' || *q == '+') q++;
    if (!is_digit(*q)) return p;
    int e = 0;
    for (; is_digit(*q); q++)
        if (e < 100000) e = e * 10 + (*q - '0');
    *exponent += negative ? -e : e;
    return q;
}

bool igi_scan_number(const char **at, double *value)
{
    /* Powers that a double holds exactly: with a mantissa below 2^53 the result is the nearest. */
    static const double power[] = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                   1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                   1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
    const uint64_t full = 100000000000000000u; /* 18 digits are kept, more only shift */
    const char *p = *at;
    bool negative = *p == '-';
    if (*p == '-' || *p == '+') p++;
    const char *digits = p;
    uint64_t mantissa = 0;
    int exponent = 0;
    for (; is_digit(*p); p++) {
        if (mantissa < full) mantissa = mantissa * 10 + (uint64_t)(*p - '0');
        else exponent++;
    }
    bool any = p > digits;
    if (*p == '.') {
        const char *fraction = ++p;
        for (; is_digit(*p); p++)
            if (mantissa < full) {
                mantissa = mantissa * 10 + (uint64_t)(*p - '0');
                exponent--;
            }
        any = any || p > fraction;
    }
    double x = (double)mantissa;
    if (any) {
        if (*p == 'e' || *p == 'E') p = scan_exponent(p, &exponent);
        if (exponent < 0) x = exponent >= -22 ? x / power[-exponent] : x * pow(10, exponent);
        else if (exponent > 0 && mantissa)
            x *= exponent <= 22 ? power[exponent] : pow(10, exponent);
    } else {
        p = digits;
        if (!scan_word(&p, &x)) return false;
    }
    *value = negative ? -x : x;
    *at = p;
    return true;
}

bool igi_file_exists(const char *path)
{
    if (igi_is_folder(path)) return false;
    FILE *file = fopen(path, "rb");
    if (file) fclose(file);
    return file != NULL;
}

bool igi_is_folder(const char *path)
{
    struct stat info;
    return stat(path, &info) == 0 && S_ISDIR(info.st_mode);
}

bool igi_ends_with(const char *path, const char *ending)
{
    size_t n = strlen(path), m = strlen(ending);
    return n >= m && strcasecmp(path + n - m, ending) == 0;
}

igi_status igi_path_join(igi_context *ctx, const char *folder, const char *name, char **path)
{
    if (name[0] == '/' || strcmp(folder, ".") == 0) return igi_strdup(ctx, name, path);
    size_t length = strlen(folder);
    bool slash = length > 0 && folder[length - 1] == '/';
    return igi_strprintf(ctx, path, "%s%s%s", folder, slash ? "" : "/", name);
}

igi_status igi_path_folder(igi_context *ctx, const char *path, char **folder)
{
    const char *slash = strrchr(path, '/');
    if (!slash) return igi_strdup(ctx, ".", folder);
    int length = slash == path ? 1 : (int)(slash - path);
    return igi_strprintf(ctx, folder, "%.*s", length, path);
}

igi_status igi_path_stem(igi_context *ctx, const char *path, char **stem)
{
    const char *name = igi_file_name(path);
    const char *dot = strrchr(name, '.');
    int length = dot && dot > name ? (int)(dot - name) : (int)strlen(name);
    return igi_strprintf(ctx, stem, "%.*s", length, name);
}

#define MAX_WORD 40

/* Levenshtein's distance; both words are at most MAX_WORD long. */
static size_t edit_distance(const char *a, const char *b)
{
    size_t row[MAX_WORD + 1], n = strlen(b);
    for (size_t j = 0; j <= n; j++) row[j] = j;
    for (size_t i = 0; a[i]; i++) {
        size_t diagonal = row[0];
        row[0] = i + 1;
        for (size_t j = 0; j < n; j++) {
            size_t best = diagonal + (a[i] != b[j]);
            diagonal = row[j + 1];
            if (row[j] + 1 < best) best = row[j] + 1;
            if (diagonal + 1 < best) best = diagonal + 1;
            row[j + 1] = best;
        }
    }
    return row[n];
}

const char *igi_closest(const char *word, const char *const *candidates, size_t count)
{
    size_t length = strlen(word);
    if (length > MAX_WORD) return NULL;
    const char *closest = NULL;
    size_t least = (length + 2) / 3; /* farther off, it is another word */
    for (size_t i = 0; i < count; i++) {
        if (strlen(candidates[i]) > MAX_WORD) continue;
        size_t distance = edit_distance(word, candidates[i]);
        if (distance <= least && (!closest || distance < least)) {
            least = distance;
            closest = candidates[i];
        }
    }
    return closest;
}
