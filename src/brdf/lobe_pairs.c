/* SPDX-License-Identifier: Apache-2.0
 *
 * With s = in + out, q = s_x^2 + s_y^2, and a = alpha^2,
 *     ward   tan^2 = q/s_z^2:               exp(-tan^2/a) / (4 pi a sqrt(in_z out_z))
 *     phong  1 - cos = (q + (in_z - out_z)^2)/2:    (n+2)/(2 pi) exp(n ln cos)
 *     ggx    D = a/(pi (sin^2 + a cos^2)^2) over the half vector s/|s|, h.in = |s|/2
 * Ward and Phong are one form, strength(alpha) factor exp(-rate(alpha) decay).
 */
#include "brdf/lobe_pairs.h"

#include <string.h>

#define LANES IGI_LOBE_LANES
#define ARRAYS 8
#define FAR 1e6f   /* the decay of what no lobe reaches */
#define NOTHING 30 /* e^-30 */

igi_status igi_lobe_pairs_create(igi_context *ctx, igi_model model, size_t room,
                                 igi_lobe_pairs *pairs)
{
    float *all;
    *pairs = (igi_lobe_pairs){.model = model, .room = (room + LANES - 1) / LANES * LANES};
    IGI_TRY(IGI_ALLOC(ctx, ARRAYS * pairs->room + 1, &all));
    float **arrays[ARRAYS] = {&pairs->across, &pairs->in_z,    &pairs->out_z,   &pairs->factor,
                              &pairs->decay,  &pairs->schlick, &pairs->nearest, &pairs->values};
    for (size_t k = 0; k < ARRAYS; k++) *arrays[k] = all + k * pairs->room;
    return IGI_OK;
}

void igi_lobe_pairs_clear(igi_lobe_pairs *pairs)
{
    igi_free(pairs->across);
    *pairs = (igi_lobe_pairs){.model = IGI_LAMBERT};
}

void igi_lobe_pairs_pad(igi_lobe_pairs *p)
{
    for (; p->count % LANES; p->count++) {
        p->across[p->count] = 1;
        p->in_z[p->count] = p->out_z[p->count] = 1e-3f;
    }
}

static void prepare_ward(igi_lobe_pairs *p)
{
    for (size_t i = 0; i < p->count; i++) {
        float z = p->in_z[i] + p->out_z[i];
        float tan2 = p->across[i] / (z * z);
        p->decay[i] = tan2 < FAR ? tan2 : FAR;
        p->factor[i] = 1 / (4 * IGI_PIF * sqrtf(p->in_z[i] * p->out_z[i]));
    }
}

static void prepare_phong(igi_lobe_pairs *p)
{
    for (size_t i = 0; i < p->count; i++) {
        float d = p->in_z[i] - p->out_z[i], one_minus_cos = 0.5f * (p->across[i] + d * d);
        bool before = one_minus_cos < 0.999999f; /* within a right angle of the mirror direction */
        p->decay[i] = before ? -log1pf(-one_minus_cos) : FAR;
        p->factor[i] = before ? 1 / (2 * IGI_PIF) : 0;
    }
}

/* decay: sin^2 of the half vector; factor: its cos^2. */
static void prepare_ggx(igi_lobe_pairs *p)
{
    for (size_t i = 0; i < p->count; i++) {
        float z = p->in_z[i] + p->out_z[i], squared = p->across[i] + z * z;
        float c = 1 - 0.5f * sqrtf(squared); /* rounding: -6e-8, and its fifth power nothing */
        p->decay[i] = p->across[i] / squared;
        p->factor[i] = z * z / squared;
        p->schlick[i] = c * c * c * c * c;
    }
}

void igi_lobe_pairs_prepare(igi_lobe_pairs *p)
{
    if (p->model == IGI_WARD) prepare_ward(p);
    else if (p->model == IGI_PHONG) prepare_phong(p);
    else prepare_ggx(p);
    for (size_t i = 0; i < p->count / LANES; i++) {
        float least = p->decay[i * LANES];
        for (size_t k = 1; k < LANES; k++)
            if (p->decay[i * LANES + k] < least) least = p->decay[i * LANES + k];
        p->nearest[i] = least;
    }
}

/* e^-x for x >= 0, within 3e-7: 2^-(i + f) by the exponent's bits and a polynomial. */
static inline float exp_minus(float x)
{
    float y = (x < 80 ? x : 80) * 1.44269504f, power;
    int32_t i = (int32_t)(y + 0.5f), bits = (127 - i) * (1 << 23);
    float f = ((float)i - y) * 0.693147181f; /* |f| <= ln 2 / 2 */
    float high = 4.16666667e-2f + f * (8.33333333e-3f + f * 1.38888889e-3f);
    memcpy(&power, &bits, sizeof power);
    return (1 + f * (1 + f * (0.5f + f * (1.66666667e-1f + f * high)))) * power;
}

static void exponentials(float *restrict values, const float *restrict decay,
                         const float *restrict factor, size_t count, const float form[2])
{
    float strength = form[0], rate = form[1];
    for (size_t i = 0; i < count; i++)
        values[i] = strength * factor[i] * exp_minus(rate * decay[i]);
}

/* Runs of pairs that the lobe reaches, and between them zeros. */
static void evaluate_exponential(igi_lobe_pairs *p, const float form[2], size_t first, size_t last)
{
    for (size_t at = first, next; at < last; at = next) {
        bool reached = p->nearest[at / LANES] * form[1] < NOTHING;
        for (next = at + LANES; next < last; next += LANES)
            if ((p->nearest[next / LANES] * form[1] < NOTHING) != reached) break;
        if (reached) exponentials(p->values + at, p->decay + at, p->factor + at, next - at, form);
        else memset(p->values + at, 0, (next - at) * sizeof *p->values);
    }
}

static void evaluate_ggx(float *restrict values, const igi_lobe_pairs *p, float a, size_t first,
                         size_t last)
{
    const float *in_z = p->in_z, *out_z = p->out_z, *sine = p->decay, *cosine = p->factor;
    for (size_t i = first; i < last; i++) {
        float in = in_z[i], out = out_z[i], d = sine[i] + a * cosine[i];
        float below = out * sqrtf(a + (1 - a) * in * in) + in * sqrtf(a + (1 - a) * out * out);
        values[i] = 0.5f / IGI_PIF * a / (d * d * below);
    }
}

void igi_lobe_pairs_evaluate(igi_lobe_pairs *pairs, float alpha, size_t first, size_t last)
{
    alpha = fminf(1.0f, fmaxf(IGI_ALPHA_MIN, alpha));
    float a = alpha * alpha;
    const float ward[2] = {1 / a, 1 / a}, phong[2] = {2 / a, 2 / a - 2};
    if (pairs->model == IGI_WARD) evaluate_exponential(pairs, ward, first, last);
    else if (pairs->model == IGI_PHONG) evaluate_exponential(pairs, phong, first, last);
    else evaluate_ggx(pairs->values, pairs, a, first, last);
}
