/* SPDX-License-Identifier: Apache-2.0
 *
 * Three-vectors by value. Float for rays and shading, double where cameras are computed.
 */
#ifndef IGI_SRC_BASE_VEC_H
#define IGI_SRC_BASE_VEC_H

#include <math.h>

#define IGI_PI 3.14159265358979323846
#define IGI_PIF 3.14159265358979323846f

typedef struct igi_vec {
    float x, y, z;
} igi_vec;

static inline igi_vec igi_v(float x, float y, float z)
{
    igi_vec v = {x, y, z};
    return v;
}
static inline igi_vec igi_v_of(const float *p)
{
    return igi_v(p[0], p[1], p[2]);
}
static inline igi_vec igi_v_ofd(const double *p)
{
    return igi_v((float)p[0], (float)p[1], (float)p[2]);
}
static inline igi_vec igi_add(igi_vec a, igi_vec b)
{
    return igi_v(a.x + b.x, a.y + b.y, a.z + b.z);
}
static inline igi_vec igi_sub(igi_vec a, igi_vec b)
{
    return igi_v(a.x - b.x, a.y - b.y, a.z - b.z);
}
static inline igi_vec igi_scale(igi_vec a, float s)
{
    return igi_v(a.x * s, a.y * s, a.z * s);
}
/* a + s b */
static inline igi_vec igi_madd(igi_vec a, igi_vec b, float s)
{
    return igi_v(a.x + b.x * s, a.y + b.y * s, a.z + b.z * s);
}
static inline float igi_dot(igi_vec a, igi_vec b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
static inline igi_vec igi_cross(igi_vec a, igi_vec b)
{
    return igi_v(a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x);
}
static inline float igi_length(igi_vec a)
{
    return sqrtf(igi_dot(a, a));
}
/* The zero vector stays zero. */
static inline igi_vec igi_normalize(igi_vec a)
{
    float l = igi_length(a);
    return l > 0 ? igi_scale(a, 1 / l) : a;
}

/* Two unit vectors that complete the unit vector n to a right-handed frame (t, b, n);
 * Duff et al., "Building an orthonormal basis, revisited", JCGT 2017. */
static inline void igi_frame_of(igi_vec n, igi_vec *t, igi_vec *b)
{
    float sign = copysignf(1.0f, n.z);
    float p = -1.0f / (sign + n.z);
    float q = n.x * n.y * p;
    *t = igi_v(1.0f + sign * n.x * n.x * p, sign * q, -sign * n.x);
    *b = igi_v(q, sign + n.y * n.y * p, -n.y);
}

/* Cosine-distributed direction about n from a point (u,v) of the unit square; pdf = cos/pi
 * (Malley's method: a uniform disk projected up). */
static inline igi_vec igi_cosine_direction(igi_vec n, float u, float v)
{
    igi_vec t, b;
    igi_frame_of(n, &t, &b);
    float r = sqrtf(u), phi = 2 * IGI_PIF * v;
    float z = sqrtf(fmaxf(0.0f, 1 - u));
    return igi_madd(igi_madd(igi_scale(n, z), t, r * cosf(phi)), b, r * sinf(phi));
}

#endif
