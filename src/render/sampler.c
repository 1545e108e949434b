/* SPDX-License-Identifier: Apache-2.0
 *
 * Padded (0,2)-nets: every pair of dimensions takes the first 1, 4, 16 or more points of Sobol's
 * first two dimensions, in an order and with digits scrambled by a hash (Kollig and Keller 2002). Every
 * batch is an independent, unbiased set, so that the spread of the batches is the picture's
 * variance.
 */
#include "render/path.h"

/* Sobol's second dimension in 1/16, where the first is the index with its bits reversed. */
static const uint32_t first[16] = {0, 8, 4, 12, 2, 10, 6, 14, 1, 9, 5, 13, 3, 11, 7, 15};
static const uint32_t second[16] = {0, 8, 12, 4, 10, 2, 6, 14, 15, 7, 3, 11, 5, 13, 9, 1};

/* A bijection of 0..mask for each key (Kensler 2013): without it, the same digit of every dimension
 * would differ by a constant alone, and a product of two would not be stratified at all. */
static uint32_t shuffle(uint32_t i, uint32_t mask, uint32_t key)
{
    i = (i ^ key) * 0xe170893du;
    i ^= key >> 16;
    i ^= (i & mask) >> 4;
    i = (i ^ key >> 8) * 0x0929eb3fu;
    i ^= key >> 23;
    i ^= (i & mask) >> 1;
    i *= (1 | key >> 27) * 0x6935fa69u;
    i ^= (i & mask) >> 2;
    i *= 0x9e501cc3u;
    i ^= (i & mask) >> 2;
    return (i * 0xc860a3dfu + key) & mask;
}

/* Beyond the tables: digits reversed, and Sobol's second dimension. */
static void net_point(uint32_t i, uint32_t *x, uint32_t *y)
{
    *x = *y = 0;
    for (uint32_t a = 1u << 31, b = 1u << 31; i; i >>= 1, a >>= 1, b ^= b >> 1)
        if (i & 1) {
            *x |= a;
            *y ^= b;
        }
}

void sampler_next(sampler *s, float *u, float *v)
{
    uint64_t h = igi_hash64(s->key + s->dimension++);
    uint32_t i = shuffle(s->index, s->mask, (uint32_t)(h ^ h >> 29));
    uint32_t x, y;
    if (s->mask < 16) {
        x = first[i] << 28;
        y = second[i] << 28;
    } else {
        net_point(i, &x, &y);
    }
    *u = igi_u32_to_float(x ^ (uint32_t)(h >> 32));
    *v = igi_u32_to_float(y ^ (uint32_t)(h >> 4));
}
