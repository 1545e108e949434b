/* SPDX-License-Identifier: Apache-2.0
 *
 * Reflection at a point: the diffuse part, from a map where there is one, and the lobe.
 */
#include "brdf/brdf.h"
#include "render/path.h"

static int wrap(int i, int n, bool repeat)
{
    if (repeat) return i < 0 ? i + n : i >= n ? i - n : i; /* it is off by one at most */
    return i < 0 ? 0 : i >= n ? n - 1 : i;
}

/* Bilinear; row 0 is v = 1, texel centres at halves. */
static void look_up(const finish *f, int bands, const float uv[2], float *albedo)
{
    const igi_image *map = f->map;
    float u = f->repeat ? uv[0] - floorf(uv[0]) : fminf(1.0f, fmaxf(0.0f, uv[0]));
    float v = f->repeat ? uv[1] - floorf(uv[1]) : fminf(1.0f, fmaxf(0.0f, uv[1]));
    float x = u * (float)map->width - 0.5f, y = (1 - v) * (float)map->height - 0.5f;
    float x0 = floorf(x), y0 = floorf(y), fx = x - x0, fy = y - y0;
    for (int b = 0; b < bands; b++) albedo[b] = 0;
    for (int k = 0; k < 4; k++) {
        int column = wrap((int)x0 + k % 2, map->width, f->repeat);
        int row = wrap((int)y0 + k / 2, map->height, f->repeat);
        float weight = (k % 2 ? fx : 1 - fx) * (k / 2 ? fy : 1 - fy);
        const float *texel = map->samples + ((size_t)row * (size_t)map->width + (size_t)column) *
                                                (size_t)map->channels;
        for (int b = 0; b < bands; b++) albedo[b] += weight * f->map_scale[b] * texel[b];
    }
}

/* The lobe's share of samples: what it reflects beside the diffuse part, roughly. */
static float share_of_lobe(const surface *s, int bands)
{
    if (s->finish->model == IGI_LAMBERT) return 0;
    float diffuse = 0, specular = s->finish->specular_mean;
    for (int b = 0; b < bands; b++) diffuse += s->albedo[b] / (float)bands;
    if (s->finish->model == IGI_GGX)
        specular += (1 - specular) * powf(1 - fminf(1.0f, s->out.z), 5);
    if (!(specular > 0)) return 0;
    return fminf(0.9f, fmaxf(0.1f, specular / (specular + diffuse)));
}

void surface_albedo(const igi_renderer *r, const finish *f, uint32_t triangle, float u, float v,
                    float *albedo)
{
    const igi_mesh *mesh = &r->scene->mesh;
    if (f->map && mesh->uvs) {
        float uv[2];
        igi_triangle_uv(mesh, triangle, u, v, uv);
        look_up(f, r->bands, uv, albedo);
        return;
    }
    for (int b = 0; b < r->bands; b++) albedo[b] = f->albedo[b];
}

void surface_at(const igi_renderer *r, const igi_hit *hit, igi_vec direction, surface *s)
{
    const igi_mesh *mesh = &r->scene->mesh;
    s->finish = &r->finishes[mesh->regions[hit->triangle]];
    if (s->finish->absorbs) return;
    s->point = igi_triangle_point(mesh, hit->triangle, hit->u, hit->v);
    s->normal = igi_scale(r->normals[hit->triangle], hit->back ? -1.0f : 1.0f);
    igi_frame_of(s->normal, &s->t, &s->b);
    s->out = igi_v(-igi_dot(direction, s->t), -igi_dot(direction, s->b),
                   -igi_dot(direction, s->normal));
    surface_albedo(r, s->finish, hit->triangle, hit->u, hit->v, s->albedo);
    s->lobe_share = share_of_lobe(s, r->bands);
}

bool surface_value(const surface *s, int bands, igi_vec direction, float *value, float *pdf)
{
    igi_vec in = {igi_dot(direction, s->t), igi_dot(direction, s->b),
                  igi_dot(direction, s->normal)};
    const finish *f = s->finish;
    float scale = 0, base = 0;
    *pdf = 0;
    if (!(in.z > 0)) return false;
    if (s->lobe_share > 0) {
        igi_lobe_terms(f->model, f->alpha, in, s->out, &scale, &base);
        *pdf = s->lobe_share * igi_lobe_pdf(f->model, f->alpha, in, s->out);
    }
    *pdf += (1 - s->lobe_share) * in.z / IGI_PIF;
    for (int b = 0; b < bands; b++)
        value[b] = in.z * (s->albedo[b] / IGI_PIF + f->specular[b] * scale + base);
    return true;
}

igi_vec surface_sample(const surface *s, float choice, float u, float v)
{
    if (!(choice < s->lobe_share)) return igi_cosine_direction(s->normal, u, v);
    igi_vec in = igi_lobe_sample(s->finish->model, s->finish->alpha, s->out, u, v);
    igi_vec d = igi_madd(igi_scale(s->t, in.x), s->b, in.y);
    return igi_normalize(igi_madd(d, s->normal, in.z));
}

bool surface_mirror(const surface *s, int bands, igi_vec *direction, float *throughput)
{
    const finish *f = s->finish;
    if (f->model == IGI_LAMBERT) return false;
    float schlick = f->model == IGI_GGX ? powf(1 - fminf(1.0f, s->out.z), 5) : 0;
    *direction = igi_normalize(igi_madd(*direction, s->normal, 2 * s->out.z));
    for (int b = 0; b < bands; b++)
        throughput[b] *= f->specular[b] + (1 - f->specular[b]) * schlick;
    return true;
}
