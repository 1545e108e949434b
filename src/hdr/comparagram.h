/* SPDX-License-Identifier: Apache-2.0
 *
 * Which of a comparagram says something about the response.
 */
#ifndef IGI_SRC_HDR_COMPARAGRAM_H
#define IGI_SRC_HDR_COMPARAGRAM_H

#include "hdr/hdr_private.h"

/* Marks the codes of a and of b that are neither at the floor nor at the top, by one channel's counts. */
void igi_comparagram_find_valid(const uint32_t *counts, bool valid_a[IGI_HDR_BINS],
                                bool valid_b[IGI_HDR_BINS]);
/* A pair that is stated to differ, and whose codes are all the same, differs by a factor 1. */
bool igi_comparagram_looks_equal(const igi_bracket *bracket, size_t pair);

/* Debevec and Malik's hat: codes in the middle are the surest. */
static inline double igi_code_weight(size_t z)
{
    return (double)(z < IGI_HDR_BINS - 1 - z ? z : IGI_HDR_BINS - 1 - z) / (IGI_HDR_BINS / 2 - .5);
}

/* What a pair of codes has to say. */
static inline double igi_comparagram_weight(const uint32_t *counts, const bool *valid_a,
                                            const bool *valid_b, size_t a, size_t b)
{
    if (!valid_a[a] || !valid_b[b]) return 0;
    return counts[a * IGI_HDR_BINS + b] * igi_code_weight(a) * igi_code_weight(b);
}

#endif
