/* SPDX-License-Identifier: Apache-2.0
 *
 * What each triangle of an area light gives to a point: in closed form, or as if it were small. For lamps of
 * a hundred triangles the latter is most of the work, so it runs over plain arrays, which compilers turn
 * into vectors.
 */
#include "light/lighting.h"

#define FEW_EMITTERS 8 /* up to here each gets its closed form at any distance */
/* A small triangle is its area at its centre: off by about .3 area/distance^2. */
#define FAR_AREAS 1000
/* From here on its three edges' middles stand for it (exact for polynomials of degree 2). */
#define MIDDLE_AREAS 40
#define NEAR (-1.0f)
#define FAR_EDGES 40 /* with it, a triangle is its centre */
#define MOST_CUTS 14 /* of a triangle in two, for the profile of what is near */
#define LEAST 1e-18f /* so that nothing is divided by nothing */

/* Of the emitters from `first` on. */
typedef struct pieces {
    const float *x, *y, *z;    /* centres */
    const float *nx, *ny, *nz; /* normals */
    const float *area;
} pieces;

static pieces pieces_from(const igi_lighting *l, size_t first)
{
    const float *p = l->pieces + first;
    size_t n = l->emitter_count;
    return (pieces){p, p + n, p + 2 * n, p + 3 * n, p + 4 * n, p + 5 * n, p + 6 * n};
}

void igi_emitters_arrange(igi_lighting *l)
{
    size_t n = l->emitter_count;
    for (size_t i = 0; i < n; i++) {
        const emitter *e = &l->emitters[i];
        const float values[IGI_PIECE_VALUES] = {e->centre.x, e->centre.y, e->centre.z, e->normal.x,
                                                e->normal.y, e->normal.z, e->area};
        for (size_t k = 0; k < IGI_PIECE_VALUES; k++) l->pieces[k * n + i] = values[k];
    }
}

void igi_emitters_angles(const igi_lighting *l, size_t first, size_t count, igi_vec point,
                         float *restrict angles)
{
    pieces p = pieces_from(l, first);
    for (size_t i = 0; i < count; i++) {
        float x = p.x[i] - point.x, y = p.y[i] - point.y, z = p.z[i] - point.z;
        float squared = x * x + y * y + z * z + LEAST;
        float facing = -(x * p.nx[i] + y * p.ny[i] + z * p.nz[i]);
        float front = facing > 0 ? facing : 0; /* before the division, or it hides in a branch */
        angles[i] = p.area[i] * front / (squared * sqrtf(squared));
    }
}

/* NEAR: it faces the point and is too large to be taken as small. */
static void weigh_small(const igi_lighting *l, size_t first, size_t count, const igi_vec at[2],
                        float *restrict weights)
{
    pieces p = pieces_from(l, first);
    igi_vec point = at[0], normal = at[1];
    float reach = count > FEW_EMITTERS ? FAR_AREAS : (float)INFINITY;
    for (size_t i = 0; i < count; i++) {
        float x = p.x[i] - point.x, y = p.y[i] - point.y, z = p.z[i] - point.z;
        float squared = x * x + y * y + z * z;
        float at_light = -(x * p.nx[i] + y * p.ny[i] + z * p.nz[i]);
        float at_point = x * normal.x + y * normal.y + z * normal.z;
        float front = at_light > 0 ? at_light : 0, above = at_point > 0 ? at_point : 0;
        float limit = reach * p.area[i], some = squared + LEAST;
        float small = p.area[i] * (above * front / (some * some));
        weights[i] = ((at_light > 0) & (squared <= limit)) ? NEAR : small;
    }
}

/* By the middles of its edges; NEAR where it is too close for that, or crosses the horizon. */
static float weigh_middle(const emitter *e, igi_vec point, igi_vec normal)
{
    igi_vec to = igi_sub(e->centre, point), half1 = igi_scale(e->edge1, 0.5f);
    igi_vec half2 = igi_scale(e->edge2, 0.5f), corner = igi_sub(e->corner, point);
    const igi_vec middles[3] = {igi_add(corner, half1), igi_add(corner, half2),
                                igi_add(igi_add(corner, half1), half2)};
    float sum = 0;
    if (!(igi_dot(to, to) > MIDDLE_AREAS * e->area)) return NEAR;
    for (int k = 0; k < 3; k++) {
        float squared = igi_dot(middles[k], middles[k]), above = igi_dot(middles[k], normal);
        if (!(above > 0)) return NEAR;
        sum += above / (squared * squared);
    }
    return e->area * -igi_dot(corner, e->normal) * sum / 3; /* a plane: alike at all of them */
}

typedef struct corner {
    double x, y, z, height; /* seen from the point; height above its horizon */
} corner;

static corner corner_of(igi_vec p, igi_vec point, igi_vec normal)
{
    corner c = {(double)p.x - (double)point.x, (double)p.y - (double)point.y,
                (double)p.z - (double)point.z, 0};
    c.height = c.x * (double)normal.x + c.y * (double)normal.y + c.z * (double)normal.z;
    return c;
}

static corner on_horizon(corner a, corner b)
{
    double t = a.height / (a.height - b.height);
    return (corner){a.x + t * (b.x - a.x), a.y + t * (b.y - a.y), a.z + t * (b.z - a.z), 0};
}

/* theta n.(a x b)/|a x b|; the cross product with the edge keeps its digits. */
static double edge_term(corner a, corner b, igi_vec n)
{
    double ex = b.x - a.x, ey = b.y - a.y, ez = b.z - a.z;
    double cx = a.y * ez - a.z * ey, cy = a.z * ex - a.x * ez, cz = a.x * ey - a.y * ex;
    double sine = sqrt(cx * cx + cy * cy + cz * cz);
    if (!(sine > 0)) return 0;
    double cosine = a.x * b.x + a.y * b.y + a.z * b.z;
    double theta = (double)atan2f((float)sine, (float)cosine);
    return theta / sine * (cx * (double)n.x + cy * (double)n.y + cz * (double)n.z);
}

/* E = 1/2 |sum_i theta_i n.(v_i x v_i+1)/|v_i x v_i+1|| for a polygon of radiance 1 with corners v_i seen
 * from the point and clipped to the horizon (Lambert 1760). The emitter's front is toward the point. */
static float exact_irradiance(const emitter *e, igi_vec point, igi_vec normal)
{
    corner in[3] = {corner_of(e->corner, point, normal),
                    corner_of(igi_add(e->corner, e->edge1), point, normal),
                    corner_of(igi_add(e->corner, e->edge2), point, normal)};
    corner out[4];
    int n = 0;
    for (int i = 0; i < 3; i++) {
        corner a = in[i], b = in[(i + 1) % 3];
        if (a.height > 0) out[n++] = a;
        if ((a.height > 0) != (b.height > 0)) out[n++] = on_horizon(a, b);
    }
    double sum = 0;
    for (int i = 0; i < n; i++) sum += edge_term(out[i], out[(i + 1) % n], normal);
    return 0.5f * (float)fabs(sum);
}

/* Sums over a triangle seen from the point: of the irradiance that its parts send, and of that times
 * the profile. */
typedef struct profiled {
    const igi_light *light;
    igi_vec normal; /* at the point */
    float height;   /* of the point above the emitter's plane */
    double plain, shaped;
} profiled;

static void add_point(profiled *p, igi_vec at, float area)
{
    float squared = igi_dot(at, at), above = igi_dot(at, p->normal);
    if (!(above > 0)) return;
    double sent = (double)(area * above / (squared * squared));
    p->plain += sent;
    p->shaped += sent * (double)igi_light_profile(p->light, p->height / sqrtf(squared));
}

/* Radon's seven points (1948), exact for polynomials of degree 5. */
static void add_points(profiled *p, const igi_vec corners[3], igi_vec centre, float area)
{
    static const float rings[2][2] = {{0.10128651f, 0.12593918f}, {0.47014206f, 0.13239415f}};
    igi_vec sum = igi_scale(centre, 3);
    add_point(p, centre, 0.225f * area);
    for (int k = 0; k < 6; k++) {
        const float *ring = rings[k / 3];
        igi_vec at = igi_madd(igi_scale(sum, ring[0]), corners[k % 3], 1 - 3 * ring[0]);
        add_point(p, at, ring[1] * area);
    }
}

/* Halves the triangle's longest edge until it is short for its distance and the profile. */
static void add_triangle(profiled *p, const igi_vec corners[3], float area, int cuts)
{
    int longest = 0;
    float most = 0;
    for (int k = 0; k < 3; k++) {
        igi_vec edge = igi_sub(corners[(k + 1) % 3], corners[k]);
        if (igi_dot(edge, edge) <= most) continue;
        most = igi_dot(edge, edge);
        longest = k;
    }
    igi_vec centre = igi_scale(igi_add(igi_add(corners[0], corners[1]), corners[2]), 1 / 3.0f);
    float far = igi_dot(centre, centre) / ((1 + (float)p->light->profile) * most);
    if (cuts == 0 || far > 1) {
        if (far > FAR_EDGES) add_point(p, centre, area);
        else add_points(p, corners, centre, area);
        return;
    }
    igi_vec a = corners[longest], b = corners[(longest + 1) % 3], c = corners[(longest + 2) % 3];
    igi_vec middle = igi_scale(igi_add(a, b), 0.5f);
    add_triangle(p, (const igi_vec[3]){a, middle, c}, area / 2, cuts - 1);
    add_triangle(p, (const igi_vec[3]){middle, b, c}, area / 2, cuts - 1);
}

/* Mean of the profile over an emitter, by what each part of it sends were it alike everywhere. */
static float mean_profile(const igi_light *light, const emitter *e, igi_vec point, igi_vec normal)
{
    igi_vec first = igi_sub(e->corner, point);
    const igi_vec corners[3] = {first, igi_add(first, e->edge1), igi_add(first, e->edge2)};
    profiled p = {.light = light, .normal = normal, .height = -igi_dot(first, e->normal)};
    add_triangle(&p, corners, e->area, MOST_CUTS);
    return p.plain > 0 ? (float)(p.shaped / p.plain) : 0;
}

float igi_emitters_weigh(const igi_lighting *l, const source *s, igi_vec point, igi_vec normal,
                         float *weights)
{
    const igi_vec at[2] = {point, normal};
    float sum = 0;
    weigh_small(l, s->first, s->count, at, weights);
    for (size_t i = 0; i < s->count; i++) {
        const emitter *e = &l->emitters[s->first + i];
        if (weights[i] < 0 && s->count > FEW_EMITTERS) weights[i] = weigh_middle(e, point, normal);
        if (weights[i] < 0) weights[i] = exact_irradiance(e, point, normal);
        if (s->light->profile > 0 && weights[i] > 0)
            weights[i] *= mean_profile(s->light, e, point, normal);
        sum += weights[i];
    }
    return sum;
}
