/* SPDX-License-Identifier: Apache-2.0
 *
 * Form factors in closed form.
 *
 * From a point (Lambert 1760):  F = 1/(2 pi) sum_k  G_k . n,   G_k along a_k x a_k+1, as long as
 * the angle between a_k and a_k+1, the directions to the polygon's corners.
 *
 * Between polygons, by Stokes' theorem twice:  A_1 F_12 = 1/(2 pi) oint_1 oint_2 ln r  dx_1 . dx_2.
 * The inner integral along an edge is elementary. The outer one has an integrand like x ln x where
 * the edges come close to each other: at the outer edge's ends, where a corner of the other polygon
 * stands beside it, and where the two lines pass each other. It is cut there, and each part is
 * integrated by Gauss-Legendre after x = t^3 (10 - 15 t + 6 t^2), which flattens both ends; the
 * plain rule does for edges far apart.
 * Lengths are measured in units of the distance between the polygons: the sum over closed contours
 * does not change, and much less cancels.
 */
#include "transport/form_factor.h"

#include <string.h>

typedef struct d3 {
    double x, y, z;
} d3;

static d3 d3_of(const double *p)
{
    return (d3){p[0], p[1], p[2]};
}
static d3 sub(d3 a, d3 b)
{
    return (d3){a.x - b.x, a.y - b.y, a.z - b.z};
}
static d3 madd(d3 a, d3 b, double s)
{
    return (d3){a.x + b.x * s, a.y + b.y * s, a.z + b.z * s};
}
static double dot(d3 a, d3 b)
{
    return a.x * b.x + a.y * b.y + a.z * b.z;
}
static d3 cross(d3 a, d3 b)
{
    return (d3){a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
static double length(d3 a)
{
    return sqrt(dot(a, a));
}

/* G . n of the edge from direction a to direction b (neither need be unit). */
static double edge_term(d3 a, d3 b, d3 n)
{
    d3 c = cross(a, b);
    double sine = length(c);
    if (sine == 0) return 0; /* the edge points at us: no angle, or we stand on it */
    return atan2(sine, dot(a, b)) * dot(c, n) / sine;
}

double igi_form_factor_from_point(const double point[3], const double normal[3],
                                  const double (*polygon)[3], size_t count)
{
    d3 p = d3_of(point), n = d3_of(normal), leave = {0}, enter = {0};
    double sum = 0;
    for (size_t k = 0; k < count; k++) {
        d3 a = sub(d3_of(polygon[k]), p), b = sub(d3_of(polygon[(k + 1) % count]), p);
        double ha = dot(a, n), hb = dot(b, n);
        if (ha <= 0 && hb <= 0) continue;
        if (ha < 0 || hb < 0) {
            d3 on = madd(a, sub(b, a), ha / (ha - hb));
            if (ha < 0) a = enter = on;
            else b = leave = on;
        } else if (ha == 0) {
            enter = a;
        } else if (hb == 0) {
            leave = b;
        }
        sum += edge_term(a, b, n);
    }
    sum += edge_term(leave, enter, n);   /* along the horizon; 0 if it was not reached */
    return fmax(0, -sum / (2 * IGI_PI)); /* a front is seen clockwise from behind its polygon */
}

/* Gauss-Legendre on [0,1]. */
#define FAR_POINTS 8
static const double far_x[FAR_POINTS / 2] = {0.1834346424956498, 0.5255324099163290,
                                             0.7966664774136267, 0.9602898564975363};
static const double far_w[FAR_POINTS / 2] = {0.3626837833783620, 0.3137066458778873,
                                             0.2223810344533745, 0.1012285362903763};
#define NEAR_POINTS 20
static const double near_x[NEAR_POINTS / 2] = {
    0.0765265211334973, 0.2277858511416451, 0.3737060887154196, 0.5108670019508271,
    0.6360536807265150, 0.7463319064601508, 0.8391169718222188, 0.9122344282513259,
    0.9639719272779138, 0.9931285991850949};
static const double near_w[NEAR_POINTS / 2] = {
    0.1527533871307258, 0.1491729864726037, 0.1420961093183820, 0.1316886384491766,
    0.1181945319615184, 0.1019301198172404, 0.0832767415767048, 0.0626720483341091,
    0.0406014298003869, 0.0176140071391521};

typedef struct segment {
    d3 from, along; /* along: unit */
    double length;
} segment;

/* Integral of ln |x - y| dy along the segment. */
static double log_along(const segment *s, d3 x)
{
    d3 to = sub(x, s->from);
    double t0 = -dot(to, s->along);
    double t1 = t0 + s->length;
    d3 aside = madd(to, s->along, t0); /* not by Pythagoras: on the line, h would be 1e-8, not 0 */
    double h2 = dot(aside, aside), h = sqrt(h2);
    double r0 = t0 * t0 + h2, r1 = t1 * t1 + h2, sum = -s->length;
    if (r0 > 0) sum -= 0.5 * t0 * log(r0);
    if (r1 > 0) sum += 0.5 * t1 * log(r1);
    /* atan(t1/h) - atan(t0/h), as one angle */
    if (h > 0) sum += h * atan2(h * s->length, h2 + t0 * t1);
    return sum;
}

static double outer_far(const segment *outer, const segment *inner)
{
    double sum = 0;
    for (int k = 0; k < FAR_POINTS; k++) {
        double x = k & 1 ? 0.5 + 0.5 * far_x[k / 2] : 0.5 - 0.5 * far_x[k / 2];
        sum += far_w[k / 2] * log_along(inner, madd(outer->from, outer->along, x * outer->length));
    }
    return 0.5 * outer->length * sum;
}

static double outer_near_part(const segment *outer, const segment *inner, double from, double to)
{
    double sum = 0;
    for (int k = 0; k < NEAR_POINTS; k++) {
        double t = k & 1 ? 0.5 + 0.5 * near_x[k / 2] : 0.5 - 0.5 * near_x[k / 2];
        double x = t * t * t * (10 + t * (6 * t - 15));
        double slope = 30 * t * t * (1 - t) * (1 - t);
        d3 at = madd(outer->from, outer->along, from + x * (to - from));
        sum += near_w[k / 2] * slope * log_along(inner, at);
    }
    return 0.5 * (to - from) * sum;
}

/* Where the outer edge is nearest to an end of the inner one (end 0, 1) or to its line (end 2). */
static double nearest_at(const segment *outer, const segment *inner, int end)
{
    d3 to = sub(inner->from, outer->from);
    double cosine = dot(outer->along, inner->along), at = dot(to, outer->along);
    if (end == 1) at += inner->length * cosine;
    if (end == 2 && cosine * cosine < 1)
        at = (at - dot(to, inner->along) * cosine) / (1 - cosine * cosine);
    return fmin(fmax(at, 0), outer->length);
}

static double outer_near(const segment *outer, const segment *inner)
{
    double cuts[5] = {0, 0, 0, 0, outer->length}, sum = 0;
    for (int k = 1; k <= 3; k++) { /* sorted as they come */
        double at = nearest_at(outer, inner, k - 1);
        int place = k;
        for (; place > 1 && cuts[place - 1] > at; place--) cuts[place] = cuts[place - 1];
        cuts[place] = at;
    }
    for (int k = 0; k < 4; k++) {
        if (cuts[k + 1] - cuts[k] > 1e-12 * outer->length)
            sum += outer_near_part(outer, inner, cuts[k], cuts[k + 1]);
    }
    return sum;
}

typedef struct polygon {
    size_t count;
    d3 corner[IGI_MAX_POLYGON + 1]; /* a cut may add one */
    d3 normal;                      /* as long as twice the area */
} polygon;

static void find_normal(polygon *p)
{
    p->normal = (d3){0, 0, 0};
    for (size_t k = 1; k + 1 < p->count; k++) {
        d3 c = cross(sub(p->corner[k], p->corner[0]), sub(p->corner[k + 1], p->corner[0]));
        p->normal = madd(p->normal, c, 1);
    }
}

/* What of `p` lies in front of the plane of `other`; within `slack` of it counts as in it. */
static void cut_by(polygon *p, const polygon *other, double slack)
{
    double scale = 1 / length(other->normal), height[IGI_MAX_POLYGON + 1];
    bool below = false, above = false;
    for (size_t k = 0; k < p->count; k++) {
        height[k] = dot(sub(p->corner[k], other->corner[0]), other->normal) * scale;
        if (fabs(height[k]) <= slack) height[k] = 0;
        below = below || height[k] < 0;
        above = above || height[k] > 0;
    }
    if (!above) p->count = 0;
    if (!below || !above) return;
    polygon kept = {.count = 0};
    for (size_t k = 0; k < p->count && kept.count <= IGI_MAX_POLYGON; k++) {
        size_t next = (k + 1) % p->count;
        if (height[k] >= 0) kept.corner[kept.count++] = p->corner[k];
        if (height[k] * height[next] < 0 && kept.count <= IGI_MAX_POLYGON)
            kept.corner[kept.count++] = madd(p->corner[k], sub(p->corner[next], p->corner[k]),
                                             height[k] / (height[k] - height[next]));
    }
    p->count = kept.count;
    memcpy(p->corner, kept.corner, kept.count * sizeof *kept.corner);
    find_normal(p);
}

static double radius_about(const polygon *p, d3 centre)
{
    double r = 0;
    for (size_t k = 0; k < p->count; k++) r = fmax(r, length(sub(p->corner[k], centre)));
    return r;
}

static d3 middle(const polygon *p)
{
    d3 c = {0, 0, 0};
    for (size_t k = 0; k < p->count; k++) c = madd(c, p->corner[k], 1.0 / (double)p->count);
    return c;
}

static segment edge_of(const polygon *p, size_t k, double unit)
{
    segment s = {p->corner[k], sub(p->corner[(k + 1) % p->count], p->corner[k]), 0};
    s.length = length(s.along);
    if (s.length > 0)
        s.along = (d3){s.along.x / s.length, s.along.y / s.length, s.along.z / s.length};
    s.length /= unit;
    s.from = (d3){s.from.x / unit, s.from.y / unit, s.from.z / unit};
    return s;
}

/* Distance between the edges, from below: between the balls around them. */
static bool edges_are_far(const segment *a, const segment *b)
{
    d3 ma = madd(a->from, a->along, 0.5 * a->length), mb = madd(b->from, b->along, 0.5 * b->length);
    return length(sub(ma, mb)) > 0.5 * (a->length + b->length) + a->length;
}

static double contour_integral(const polygon *a, const polygon *b, double unit)
{
    double sum = 0;
    for (size_t i = 0; i < a->count; i++) {
        segment outer = edge_of(a, i, unit);
        for (size_t j = 0; j < b->count; j++) {
            segment inner = edge_of(b, j, unit);
            double cosine = dot(outer.along, inner.along);
            if (cosine == 0 || outer.length == 0 || inner.length == 0) continue;
            sum += cosine * (edges_are_far(&outer, &inner) ? outer_far(&outer, &inner)
                                                           : outer_near(&outer, &inner));
        }
    }
    return sum * unit * unit / (2 * IGI_PI);
}

static bool read_polygon(polygon *p, const double (*corners)[3], size_t count)
{
    if (count < 3 || count > IGI_MAX_POLYGON) return false;
    p->count = count;
    for (size_t k = 0; k < count; k++) p->corner[k] = d3_of(corners[k]);
    find_normal(p);
    double area = length(p->normal);
    return area > 0 && isfinite(area);
}

double igi_form_factor_between(const double (*from)[3], size_t from_count, const double (*to)[3],
                               size_t to_count)
{
    polygon a, b;
    if (!read_polygon(&a, from, from_count) || !read_polygon(&b, to, to_count)) return 0;
    double whole = 0.5 * length(a.normal);
    d3 ma = middle(&a), mb = middle(&b);
    double apart = length(sub(ma, mb)), size = fmax(radius_about(&a, ma), radius_about(&b, mb));
    polygon uncut = a;
    cut_by(&a, &b, 1e-9 * size);
    cut_by(&b, &uncut, 1e-9 * size);
    if (a.count < 3 || b.count < 3 || length(a.normal) == 0 || length(b.normal) == 0) return 0;
    double f = contour_integral(&a, &b, fmax(apart, 1e-3 * size)) / whole;
    return fmin(fmax(f, 0), 1);
}
