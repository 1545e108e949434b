/* SPDX-License-Identifier: Apache-2.0
 *
 * The specular lobes of formats' "The BRDFs, exactly". Half vectors come from sums of directions and
 * small angles from differences, never from 1 - cos^2: with alpha = .001 the lobe is a milliradian
 * wide, and floats near 1 are 6e-8 apart.
 */
#include "brdf/brdf.h"

static float clamp_alpha(float alpha)
{
    return fminf(1.0f, fmaxf(IGI_ALPHA_MIN, alpha));
}

static igi_vec half_vector(igi_vec in, igi_vec out)
{
    return igi_normalize(igi_add(in, out));
}

static igi_vec reflect(igi_vec out, igi_vec half)
{
    return igi_normalize(igi_sub(igi_scale(half, 2 * igi_dot(half, out)), out));
}

#define NOTHING 80 /* e^-80: where floats end, exponentials are slow */

static float tan2_of(igi_vec h)
{
    return (h.x * h.x + h.y * h.y) / (h.z * h.z);
}

/* Ward: exp(-tan^2 delta/alpha^2) / (4 pi alpha^2). */
static float ward_core(float alpha, float tan2)
{
    float a2 = alpha * alpha, x = tan2 / a2;
    return x < NOTHING ? expf(-x) / (4 * IGI_PIF * a2) : 0;
}

/* The density of half vectors is exp(-tan^2/alpha^2)/(pi alpha^2 cos^3 delta), and dh = di/(4 h.o)
 * (Walter, "Notes on the Ward BRDF", 2005). With the sum s = in + out, h.o = |s|/2, and
 * cos^3 delta h.o = s_z^3/(2 |s|^2): nothing has to be normalised. */
static float ward_squeeze(igi_vec sum)
{
    return sum.z * sum.z * sum.z / (2 * igi_dot(sum, sum));
}

static igi_vec ward_sample(float alpha, igi_vec out, float u, float v)
{
    float tan2 = -alpha * alpha * log1pf(-u), phi = 2 * IGI_PIF * v;
    float cosine = 1 / sqrtf(1 + tan2), sine = sqrtf(tan2) * cosine;
    return reflect(out, igi_v(sine * cosf(phi), sine * sinf(phi), cosine));
}

/* Trowbridge-Reitz. */
static float ggx_density(float alpha, igi_vec h)
{
    float a2 = alpha * alpha, d = h.x * h.x + h.y * h.y + a2 * h.z * h.z;
    return a2 / (IGI_PIF * d * d);
}

/* cos sqrt(1 + alpha^2 tan^2): cos (1 + 2 Lambda) of Smith's masking. */
static float ggx_masking(float alpha, float cosine)
{
    return sqrtf(alpha * alpha + (1 - alpha * alpha) * cosine * cosine);
}

/* D G2 / (4 cos_i cos_o), G2 = 1/(1 + Lambda_i + Lambda_o) (Heitz 2014). */
static float ggx_core(float alpha, igi_vec h, igi_vec in, igi_vec out)
{
    float below = out.z * ggx_masking(alpha, in.z) + in.z * ggx_masking(alpha, out.z);
    return 0.5f * ggx_density(alpha, h) / below;
}

/* Of visible normals, D G1 (o.h)/cos_o, over 4 o.h. */
static float ggx_pdf(float alpha, igi_vec h, igi_vec out)
{
    return 0.5f * ggx_density(alpha, h) / (out.z + ggx_masking(alpha, out.z));
}

/* Visible normals by spherical caps (Dupuy and Benyoub 2023). */
static igi_vec ggx_sample(float alpha, igi_vec out, float u, float v)
{
    igi_vec o = igi_normalize(igi_v(alpha * out.x, alpha * out.y, out.z));
    float phi = 2 * IGI_PIF * v, z = (1 - u) * (1 + o.z) - o.z;
    float sine = sqrtf(fmaxf(0.0f, 1 - z * z));
    igi_vec h = igi_add(igi_v(sine * cosf(phi), sine * sinf(phi), z), o);
    return reflect(out, igi_normalize(igi_v(alpha * h.x, alpha * h.y, fmaxf(1e-12f, h.z))));
}

static float phong_exponent(float alpha)
{
    return 2 / (alpha * alpha) - 2;
}

/* cos^n of the angle between `in` and the mirror direction of `out`. */
static float phong_power(float n, igi_vec in, igi_vec out)
{
    igi_vec d = igi_sub(in, igi_v(-out.x, -out.y, out.z));
    float one_minus_cos = 0.5f * igi_dot(d, d);
    return one_minus_cos < 1 ? expf(n * log1pf(-one_minus_cos)) : 0;
}

static igi_vec phong_sample(float n, igi_vec out, float u, float v)
{
    float log_cos = log1pf(-u) / (n + 1), phi = 2 * IGI_PIF * v;
    float cosine = expf(log_cos), sine = sqrtf(-expm1f(2 * log_cos));
    igi_vec mirror = igi_v(-out.x, -out.y, out.z), t, b;
    igi_frame_of(mirror, &t, &b);
    igi_vec d = igi_madd(igi_scale(mirror, cosine), t, sine * cosf(phi));
    return igi_madd(d, b, sine * sinf(phi));
}

void igi_lobe_terms(igi_model model, float alpha, igi_vec in, igi_vec out, float *scale,
                    float *base)
{
    *scale = *base = 0;
    if (model == IGI_LAMBERT || !(in.z > 0 && out.z > 0)) return;
    alpha = clamp_alpha(alpha);
    if (model == IGI_WARD) {
        *scale = ward_core(alpha, tan2_of(igi_add(in, out))) / sqrtf(in.z * out.z);
    } else if (model == IGI_GGX) {
        igi_vec h = half_vector(in, out);
        float core = ggx_core(alpha, h, in, out), c = 1 - igi_dot(h, in);
        float schlick = c * c * c * c * c;
        *scale = core * (1 - schlick);
        *base = core * schlick;
    } else {
        float n = phong_exponent(alpha);
        *scale = (n + 2) / (2 * IGI_PIF) * phong_power(n, in, out);
    }
}

igi_vec igi_lobe_sample(igi_model model, float alpha, igi_vec out, float u, float v)
{
    alpha = clamp_alpha(alpha);
    switch (model) {
    case IGI_WARD: return ward_sample(alpha, out, u, v);
    case IGI_GGX: return ggx_sample(alpha, out, u, v);
    case IGI_PHONG: return phong_sample(phong_exponent(alpha), out, u, v);
    case IGI_LAMBERT: break;
    }
    return igi_cosine_direction(igi_v(0, 0, 1), u, v);
}

float igi_lobe_pdf(igi_model model, float alpha, igi_vec in, igi_vec out)
{
    if (!(in.z > 0 && out.z > 0)) return 0;
    alpha = clamp_alpha(alpha);
    switch (model) {
    case IGI_WARD: {
        igi_vec sum = igi_add(in, out);
        return ward_core(alpha, tan2_of(sum)) / ward_squeeze(sum);
    }
    case IGI_GGX: return ggx_pdf(alpha, half_vector(in, out), out);
    case IGI_PHONG: {
        float n = phong_exponent(alpha);
        return (n + 1) / (2 * IGI_PIF) * phong_power(n, in, out);
    }
    case IGI_LAMBERT: break;
    }
    return in.z / IGI_PIF;
}

void igi_lobe_ratios(igi_model model, float alpha, igi_vec in, igi_vec out, float *scale,
                     float *base)
{
    *scale = *base = 0;
    if (!(in.z > 0 && out.z > 0)) return;
    alpha = clamp_alpha(alpha);
    igi_vec sum = igi_add(in, out);
    if (model == IGI_WARD) {
        *scale = ward_squeeze(sum) / sqrtf(in.z * out.z);
    } else if (model == IGI_GGX) {
        float mask_in = ggx_masking(alpha, in.z), mask_out = ggx_masking(alpha, out.z);
        float all = (out.z + mask_out) / (out.z * mask_in + in.z * mask_out);
        float c = 1 - 0.5f * igi_length(sum); /* |s|/2 is the cosine with the half vector */
        *base = all * c * c * c * c * c;
        *scale = all - *base;
    } else if (model == IGI_PHONG) {
        float n = phong_exponent(alpha);
        *scale = (n + 2) / (n + 1);
    }
}

float igi_ward_pdf_sum(const float *alphas, int count, igi_vec in, igi_vec out)
{
    if (!(in.z > 0 && out.z > 0)) return 0;
    igi_vec both = igi_add(in, out);
    float tan2 = tan2_of(both), sum = 0;
    for (int k = 0; k < count; k++) sum += ward_core(clamp_alpha(alphas[k]), tan2);
    return sum / ward_squeeze(both);
}
