/* SPDX-License-Identifier: Apache-2.0
 *
 * Seen from far away, so that every pixel has the same view direction z. Diffuse light is in closed
 * form: the room's radiance a + b y gives irradiance pi a + 2 pi/3 b n_y, and the box is small.
 * Lobes are summed over the box, or over directions of their own.
 */
#include "report/sphere.h"

#include "brdf/brdf.h"

#include <math.h>

enum { BOX_SIDE = 5, LOBE_SAMPLES = 24, ROOM_SAMPLES = 6 };
#define BROAD 0.08f /* a lobe that spans several of the box's parts */
#define AMBIENT 0.16f
#define SLOPE 0.12f
#define BOX_RADIANCE 9.0f
#define BOX_HALF 0.16f /* half its side, at distance 1 */

typedef struct studio {
    igi_vec box, right, up; /* its direction and sides */
    igi_vec parts[BOX_SIDE * BOX_SIDE];
    float solid; /* solid angle of one of its parts */
    float white; /* brightest radiance of a white diffuse ball */
} studio;

static igi_vec box_direction(const studio *s, int k)
{
    float x = BOX_HALF * (2 * ((float)(k % BOX_SIDE) + 0.5f) / BOX_SIDE - 1);
    float y = BOX_HALF * (2 * ((float)(k / BOX_SIDE) + 0.5f) / BOX_SIDE - 1);
    return igi_normalize(igi_madd(igi_madd(s->box, s->right, x), s->up, y));
}

static float room_radiance(igi_vec d)
{
    return AMBIENT + SLOPE * d.y;
}

static bool is_box(const studio *s, igi_vec d)
{
    float along = igi_dot(d, s->box);
    return along > 0 && fabsf(igi_dot(d, s->right)) < BOX_HALF * along &&
           fabsf(igi_dot(d, s->up)) < BOX_HALF * along;
}

static float irradiance(const studio *s, igi_vec n)
{
    float sum = IGI_PIF * AMBIENT + 2 * IGI_PIF / 3 * SLOPE * n.y;
    float box = BOX_RADIANCE * s->solid * BOX_SIDE * BOX_SIDE;
    return sum + box * fmaxf(0, igi_dot(n, s->box));
}

static studio make_studio(void)
{
    studio s = {.box = igi_normalize((igi_vec){-0.5f, 0.65f, 0.75f})};
    igi_frame_of(s.box, &s.right, &s.up);
    s.solid = 4 * BOX_HALF * BOX_HALF / (BOX_SIDE * BOX_SIDE);
    for (int k = 0; k < BOX_SIDE * BOX_SIDE; k++) s.parts[k] = box_direction(&s, k);
    s.white = irradiance(&s, s.box) / IGI_PIF;
    return s;
}

typedef struct lobe_light {
    float scale, base; /* integrals of both terms of the lobe with the light */
} lobe_light;

static igi_vec to_local(igi_vec v, igi_vec t, igi_vec b, igi_vec n)
{
    return (igi_vec){igi_dot(v, t), igi_dot(v, b), igi_dot(v, n)};
}

/* A broad lobe has the box from its parts and the even room from a few directions, a narrow one both
 * from directions of its own. */
static lobe_light shine(const studio *s, const igi_material *m, igi_vec n)
{
    lobe_light sum = {0, 0};
    igi_vec t, b;
    float alpha = (float)m->alpha, scale, base;
    bool broad = alpha > BROAD;
    int own = broad ? ROOM_SAMPLES : LOBE_SAMPLES;
    igi_frame_of(n, &t, &b);
    igi_vec out = to_local((igi_vec){0, 0, 1}, t, b, n);
    for (int k = 0; broad && k < BOX_SIDE * BOX_SIDE; k++) {
        igi_vec in = to_local(s->parts[k], t, b, n);
        if (in.z <= 0) continue;
        igi_lobe_terms(m->model, alpha, in, out, &scale, &base);
        sum.scale += BOX_RADIANCE * s->solid * in.z * scale;
        sum.base += BOX_RADIANCE * s->solid * in.z * base;
    }
    for (int k = 0; k < own; k++) {
        float u = ((float)k + 0.5f) / (float)own, v = (float)k * 0.6180339887f;
        igi_vec in = igi_lobe_sample(m->model, alpha, out, u, v - floorf(v));
        if (in.z <= 0) continue;
        igi_vec world = igi_madd(igi_madd(igi_scale(t, in.x), b, in.y), n, in.z);
        float light = is_box(s, world) ? (broad ? 0 : BOX_RADIANCE) : room_radiance(world);
        igi_lobe_ratios(m->model, alpha, in, out, &scale, &base);
        sum.scale += light * in.z * scale / (float)own;
        sum.base += light * in.z * base / (float)own;
    }
    return sum;
}

static void shade(const studio *s, const igi_material *m, int bands, igi_vec n, float *pixel)
{
    float diffuse = irradiance(s, n) / IGI_PIF / s->white;
    lobe_light lobe = {0, 0};
    if (m->model != IGI_LAMBERT) lobe = shine(s, m, n);
    for (int b = 0; b < bands; b++) {
        double specular = m->specular_is_rgb ? m->specular_rgb[b] : m->specular;
        pixel[b] = (float)m->albedo[b] * diffuse +
                   ((float)specular * lobe.scale + lobe.base) / s->white;
    }
}

igi_status igi_sphere_draw(igi_context *ctx, const igi_material *material, int bands, int side,
                           igi_image **picture)
{
    studio s = make_studio();
    float radius = 0.5f * (float)side - 0.5f;
    IGI_TRY(igi_image_create(ctx, side, side, bands + 1, picture));
    for (int i = 0; i < side * side; i++) {
        float x = ((float)(i % side) + 0.5f - 0.5f * (float)side) / radius;
        float y = (0.5f * (float)side - 0.5f - (float)(i / side)) / radius;
        float r = sqrtf(x * x + y * y), *pixel = (*picture)->samples + i * (bands + 1);
        pixel[bands] = fmaxf(0, fminf(1, (1 - r) * radius + 0.5f));
        if (pixel[bands] <= 0) continue;
        if (r > 0.999f) {
            x *= 0.999f / r;
            y *= 0.999f / r;
        }
        igi_vec n = {x, y, sqrtf(fmaxf(0, 1 - x * x - y * y))};
        shade(&s, material, bands, n, pixel);
    }
    return IGI_OK;
}
