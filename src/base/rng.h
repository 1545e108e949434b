/* SPDX-License-Identifier: Apache-2.0
 *
 * Random and low-discrepancy numbers. A stream is keyed by what it is for, never by a thread.
 */
#ifndef IGI_SRC_BASE_RNG_H
#define IGI_SRC_BASE_RNG_H

#include <math.h>
#include <stdint.h>

/* PCG32 (O'Neill 2014): 64 bits of state, 32 of output. */
typedef struct igi_rng {
    uint64_t state, increment;
} igi_rng;

/* SplitMix64's finaliser (Steele et al. 2014): a good 64-bit hash. */
static inline uint64_t igi_hash64(uint64_t x)
{
    x += 0x9e3779b97f4a7c15u;
    x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
    x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
    return x ^ (x >> 31);
}

static inline uint32_t igi_rng_next(igi_rng *rng)
{
    uint64_t old = rng->state;
    rng->state = old * 6364136223846793005u + rng->increment;
    uint32_t shifted = (uint32_t)(((old >> 18) ^ old) >> 27);
    uint32_t rotation = (uint32_t)(old >> 59);
    return (shifted >> rotation) | (shifted << ((32u - rotation) & 31u));
}

/* The stream number `stream` of `seed`. */
static inline igi_rng igi_rng_make(uint64_t seed, uint64_t stream)
{
    igi_rng rng = {igi_hash64(seed ^ igi_hash64(stream)), (igi_hash64(stream) << 1) | 1u};
    (void)igi_rng_next(&rng);
    return rng;
}

/* Uniform in [0,1): 24 bits, so that float arithmetic never rounds it to 1. */
static inline float igi_u32_to_float(uint32_t bits)
{
    return (float)(bits >> 8) * 0x1p-24f;
}

static inline float igi_rng_float(igi_rng *rng)
{
    return igi_u32_to_float(igi_rng_next(rng));
}

/* Point k of Roberts' R sequence (2018; a Kronecker sequence) of 1 to 4 dimensions,
 * x_d = frac(shift_d + (k + 1) g^-d) with g^5 = g + 1; in [0,1). */
static inline void igi_kronecker(const double *shift, int k, int dimensions, double *x)
{
    static const double step[4] = {0.8566748838545029, 0.7338918566271260, 0.6287067210378087,
                                   0.5385972572236101}; /* g^-1 .. g^-4, g = 1.1673039782614187 */
    for (int d = 0; d < dimensions; d++) {
        x[d] = shift[d] + (k + 1) * step[d];
        x[d] -= floor(x[d]);
    }
}

#endif
