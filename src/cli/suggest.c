/* SPDX-License-Identifier: Apache-2.0
 *
 * Did you mean: the nearest name by Levenshtein's distance.
 */
#include "cli.h"

#include <string.h>

enum { LONGEST = 32 };

static size_t distance(const char *a, const char *b)
{
    size_t n = strlen(a), m = strlen(b), row[LONGEST + 1];
    if (n > LONGEST || m > LONGEST) return LONGEST;
    for (size_t j = 0; j <= m; j++) row[j] = j;
    for (size_t i = 1; i <= n; i++) {
        size_t diagonal = row[0];
        row[0] = i;
        for (size_t j = 1; j <= m; j++) {
            size_t change = diagonal + (a[i - 1] != b[j - 1]);
            size_t gap = (row[j] < row[j - 1] ? row[j] : row[j - 1]) + 1;
            diagonal = row[j];
            row[j] = change < gap ? change : gap;
        }
    }
    return row[m];
}

const char *cli_nearest(const char *word, const char *const *names)
{
    const char *nearest = NULL;
    size_t least = 1 + strlen(word) / 3;
    for (; *names; names++) {
        size_t d = distance(word, *names);
        if (d > least || (nearest && d == least)) continue;
        least = d;
        nearest = *names;
    }
    return nearest;
}
