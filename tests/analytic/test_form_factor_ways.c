/* SPDX-License-Identifier: Apache-2.0
 *
 * The three ways to form factors against each other, and how fast two of them converge.
 */
#include "test.h"

#include "base/rng.h"
#include "rooms.h"
#include "transport/form_factor.h"
#include "transport/hemicube.h"

typedef struct setting {
    igi_context *ctx;
    room *room;
    igi_tracer *tracer;
    igi_elements *elements;
} setting;

static setting begin(room *r, double size, bool both, int threads)
{
    setting s = {.ctx = test_context(threads), .room = r};
    CHECK_OK(s.ctx, igi_tracer_create(s.ctx, &r->mesh, &s.tracer));
    CHECK_OK(s.ctx, igi_elements_create(s.ctx, &r->mesh, size, 4000, both, &s.elements));
    return s;
}

static void end(setting *s)
{
    igi_elements_destroy(s->elements);
    igi_tracer_destroy(s->tracer);
    igi_context_destroy(s->ctx);
    free(s->room);
}

/* The matrix, to be freed. */
static double *factors(const setting *s, igi_factor_way way, int effort, uint64_t seed)
{
    igi_factor_options o;
    igi_factor_options_init(&o, way);
    o.seed = seed;
    if (way == IGI_FACTOR_RAYS) o.rays = effort;
    if (way == IGI_FACTOR_HEMICUBE) o.points = effort;
    o.resolution = 32;
    double *f = malloc(s->elements->count * s->elements->count * sizeof *f);
    CHECK_OK(s->ctx, igi_form_factors(s->ctx, s->elements, s->tracer, &o, f));
    return f;
}

static room *cube(double side, int n)
{
    room *r = room_new();
    room_cube(r, side, n);
    return r;
}

static double worst_row_sum(const double *f, size_t n)
{
    double worst = 0;
    for (size_t i = 0; i < n; i++) {
        double sum = 0;
        for (size_t j = 0; j < n; j++) sum += f[i * n + j];
        worst = fmax(worst, fabs(sum - 1));
    }
    return worst;
}

/* Root mean square of A_i F_ij - A_i G_ij, over that of A_i G_ij. */
static double difference(const setting *s, const double *f, const double *g)
{
    size_t n = s->elements->count;
    double sum = 0, all = 0;
    for (size_t i = 0; i < n * n; i++) {
        double a = s->elements->elements[i / n].area;
        sum += a * a * (f[i] - g[i]) * (f[i] - g[i]);
        all += a * a * g[i] * g[i];
    }
    return sqrt(sum / all);
}

static double asymmetry(const setting *s, const double *f)
{
    size_t n = s->elements->count;
    double sum = 0, all = 0;
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            double a = s->elements->elements[i].area * f[i * n + j];
            double b = s->elements->elements[j].area * f[j * n + i];
            sum += (a - b) * (a - b);
            all += a * b;
        }
    return sqrt(sum / all);
}

/* A cube with sides of 2 in 108 triangles: all ways agree, rows close, reciprocity holds. What the
 * hemicubes lack is points: along a common edge the factor changes much within an element. */
static void agree_in_a_cube(void)
{
    setting s = begin(cube(2, 1), .5, false, 2);
    size_t n = s.elements->count;
    double *closed = factors(&s, IGI_FACTOR_CLOSED, 0, 1);
    double *rays = factors(&s, IGI_FACTOR_RAYS, 16384, 1);
    double *hemicube = factors(&s, IGI_FACTOR_HEMICUBE, 32, 1);
    double *few = factors(&s, IGI_FACTOR_HEMICUBE, 8, 1);
    CHECK(worst_row_sum(closed, n) < 1e-6);
    CHECK(worst_row_sum(rays, n) < 1e-9);
    CHECK(worst_row_sum(hemicube, n) < 1e-9);
    CHECK(asymmetry(&s, closed) < 1e-12);
    CHECK_NEAR(difference(&s, rays, closed), 0, 0.02);
    CHECK_NEAR(difference(&s, hemicube, closed), 0, 0.1);
    CHECK(difference(&s, few, closed) > 1.5 * difference(&s, hemicube, closed));
    CHECK_NEAR(asymmetry(&s, rays), 0, 0.03);
    CHECK_NEAR(asymmetry(&s, hemicube), 0, 0.15);
    printf("   rays %.4f hemicube %.4f of closed; asymmetry %.4f %.4f\n",
           difference(&s, rays, closed), difference(&s, hemicube, closed), asymmetry(&s, rays),
           asymmetry(&s, hemicube));
    free(closed);
    free(rays);
    free(hemicube);
    free(few);
    end(&s);
}

/* Least-squares slope of y over x. */
static double slope(const double *x, const double *y, int n)
{
    double mx = 0, my = 0, xx = 0, xy = 0;
    for (int i = 0; i < n; i++) mx += x[i] / n, my += y[i] / n;
    for (int i = 0; i < n; i++) xx += (x[i] - mx) * (x[i] - mx), xy += (x[i] - mx) * (y[i] - my);
    return xy / xx;
}

/* The six unit squares of a cube, each merged from 8 triangles. */
static void rays_converge(void)
{
    setting s = begin(cube(1, 2), 2, false, 2);
    double *closed = factors(&s, IGI_FACTOR_CLOSED, 0, 1), x[6], y[6];
    CHECK(s.elements->count == 6);
    CHECK_NEAR(closed[1], 0.199824895698387, 1e-8);
    CHECK_NEAR(closed[2], 0.200043776075403, 1e-8);
    for (int k = 0; k < 6; k++) {
        int rays = 64 << (2 * k);
        double sum = 0;
        for (uint64_t seed = 1; seed <= 8; seed++) {
            double *f = factors(&s, IGI_FACTOR_RAYS, rays, seed), d = difference(&s, f, closed);
            sum += d * d / 8;
            free(f);
        }
        x[k] = log(rays);
        y[k] = 0.5 * log(sum);
        printf("   %6d rays: %.5f\n", rays, sqrt(sum));
    }
    double order = slope(x, y, 6);
    printf("   order %.3f\n", order);
    CHECK_NEAR(order, -0.625, 0.12); /* an indicator in 4 dimensions: -(1 + 1/4)/2 */
    CHECK(exp(y[5]) < 5e-3);
    free(closed);
    end(&s);
}

/* Root mean square error of the factors from points to the faces of a cube, at one resolution. */
static double hemicube_error(const setting *s, int resolution, bool tilted)
{
    igi_hemicube *h = NULL;
    igi_hemicube_buffer *b = NULL;
    CHECK_OK(s->ctx, igi_hemicube_create(s->ctx, resolution, &h));
    CHECK_OK(s->ctx, igi_hemicube_buffer_create(s->ctx, h, &b));
    igi_rng rng = igi_rng_make(3, 3);
    double sum = 0;
    for (int trial = 0; trial < 32; trial++) {
        double p[3], n[3] = {0, 0, 1}, row[6] = {0}, want[6] = {0}, all = 0;
        for (int k = 0; k < 3; k++) p[k] = .2 + .6 * (double)igi_rng_float(&rng);
        igi_vec d = igi_cosine_direction(igi_v(0, 0, 1), igi_rng_float(&rng), igi_rng_float(&rng));
        if (tilted) n[0] = (double)d.x, n[1] = (double)d.y, n[2] = (double)d.z;
        igi_hemicube_add(s->elements, h, b, p, n, 6.28 * (double)igi_rng_float(&rng), 1, row);
        for (size_t f = 0; f < s->elements->facet_count; f++) {
            const igi_facet *facet = &s->elements->facets[f];
            want[facet->element[0]] += igi_form_factor_from_point(p, n, facet->corner, 3);
        }
        for (int j = 0; j < 6; j++) {
            sum += (row[j] - want[j]) * (row[j] - want[j]) / (6 * 32);
            all += row[j];
        }
        CHECK_NEAR(all, 1, 1e-12);
    }
    igi_hemicube_buffer_destroy(b);
    igi_hemicube_destroy(h);
    return sqrt(sum);
}

/* The picture's resolution alone: outlines in all directions give -1.5; those along pixel columns,
 * as a room's vertical edges are however the cube is turned, give -1. */
static void hemicube_converges(void)
{
    setting s = begin(cube(1, 2), 2, false, 1);
    double x[5], y[2][5];
    for (int k = 0; k < 5; k++) {
        int resolution = 16 << k;
        x[k] = log(resolution);
        for (int tilted = 0; tilted < 2; tilted++)
            y[tilted][k] = log(hemicube_error(&s, resolution, tilted));
        printf("   resolution %4d: upright %.6f tilted %.6f\n", resolution, exp(y[0][k]),
               exp(y[1][k]));
    }
    printf("   order: upright %.3f tilted %.3f\n", slope(x, y[0], 5), slope(x, y[1], 5));
    CHECK_NEAR(slope(x, y[0], 5), -1.1, 0.2);
    CHECK_NEAR(slope(x, y[1], 5), -1.5, 0.2);
    end(&s);
}

/* A cube with a sheet in the middle, seen from both sides, larger than the closed form can bear. */
static void agree_behind_a_sheet(void)
{
    room *r = cube(2, 1);
    const double p[3] = {.4, .5, 1}, u[3] = {1.2, 0, 0}, v[3] = {0, 1, .3};
    room_quad(r, p, u, v, 1, 6);
    setting s = begin(r, .7, true, 2);
    bool *keep = calloc(s.elements->count, sizeof *keep); /* no room has its walls' backs in it */
    for (size_t i = 0; i < s.elements->count; i++)
        keep[i] = !s.elements->elements[i].back || s.elements->elements[i].region == 6;
    CHECK_OK(s.ctx, igi_elements_keep(s.ctx, s.elements, keep));
    free(keep);
    size_t n = s.elements->count;
    double *rays = factors(&s, IGI_FACTOR_RAYS, 16384, 1);
    double *hemicube = factors(&s, IGI_FACTOR_HEMICUBE, 32, 1);
    printf("   %zu elements: %.4f\n", n, difference(&s, hemicube, rays));
    CHECK_NEAR(difference(&s, hemicube, rays), 0, 0.1);
    CHECK(worst_row_sum(rays, n) < 1e-9);
    CHECK(worst_row_sum(hemicube, n) < 1e-9);
    CHECK(asymmetry(&s, rays) < 0.03);
    free(rays);
    free(hemicube);
    end(&s);
}

/* Inside a unit sphere F_ij = A_j / (4 pi), wherever i and j are. */
static void sphere_inside(void)
{
    double last = HUGE_VAL;
    for (int n = 2; n <= 8; n *= 2) {
        room *r = room_new();
        room_sphere(r, n, true);
        setting s = begin(r, 2, false, 2);
        size_t count = s.elements->count;
        CHECK(count == 8 * (size_t)(n * n));
        double *closed = factors(&s, IGI_FACTOR_CLOSED, 0, 1),
               *want = malloc(count * count * sizeof *want);
        for (size_t i = 0; i < count * count; i++)
            want[i] = i % count == i / count ? 0
                                             : s.elements->elements[i % count].area / (4 * IGI_PI);
        double error = difference(&s, closed, want);
        printf("   %4zu facets: %.4f\n", count, error);
        CHECK(error < last / 1.8);
        CHECK(worst_row_sum(closed, count) < 1e-5);
        last = error;
        free(closed);
        free(want);
        end(&s);
    }
    CHECK(last < 0.04);
}

static void same_for_any_threads(void)
{
    for (int way = IGI_FACTOR_CLOSED; way <= IGI_FACTOR_HEMICUBE; way++) {
        setting one = begin(cube(1, 1), .6, false, 1), three = begin(cube(1, 1), .6, false, 3);
        double *a = factors(&one, (igi_factor_way)way, 64, 5),
               *b = factors(&three, (igi_factor_way)way, 64, 5);
        size_t n = one.elements->count;
        CHECK(memcmp(a, b, n * n * sizeof *a) == 0);
        free(a);
        free(b);
        end(&one);
        end(&three);
    }
}

/* One lone triangle sees nothing; an open box loses light; wrong options are refused. */
static void open_and_wrong(void)
{
    room *r = room_new();
    room_triangle(r, room_vertex(r, 0, 0, 0), room_vertex(r, 1, 0, 0), room_vertex(r, 0, 1, 0), 0);
    setting s = begin(r, 1, true, 1);
    for (int way = IGI_FACTOR_CLOSED; way <= IGI_FACTOR_HEMICUBE; way++) {
        double *f = factors(&s, (igi_factor_way)way, 64, 1);
        for (int i = 0; i < 4; i++) CHECK_NEAR(f[i], 0, 0);
        free(f);
    }
    igi_factor_options o;
    igi_factor_options_init(&o, IGI_FACTOR_HEMICUBE);
    o.resolution = 33;
    double f[4];
    CHECK(igi_form_factors(s.ctx, s.elements, s.tracer, &o, f) == IGI_E_USAGE);
    CHECK_CONTAINS(igi_context_message(s.ctx), "resolution 33");
    o.way = (igi_factor_way)9;
    CHECK(igi_form_factors(s.ctx, s.elements, s.tracer, &o, f) == IGI_E_USAGE);
    end(&s);

    r = cube(1, 1);
    r->mesh.triangle_count = 2; /* the floor alone */
    room_quad(r, (double[3]){0, 0, 1}, (double[3]){0, 1, 0}, (double[3]){1, 0, 0}, 1, 1);
    s = begin(r, 2, false, 1);
    for (int way = IGI_FACTOR_CLOSED; way <= IGI_FACTOR_HEMICUBE; way++) {
        double *g = factors(&s, (igi_factor_way)way, way == IGI_FACTOR_RAYS ? 65536 : 64, 1);
        CHECK_NEAR(g[1], 0.199824895698387, way == IGI_FACTOR_CLOSED ? 1e-8 : 2e-3);
        CHECK_NEAR(g[0], 0, 0);
        free(g);
    }
    end(&s);
}

TEST_MAIN({"agree_in_a_cube", agree_in_a_cube}, {"rays_converge", rays_converge},
          {"hemicube_converges", hemicube_converges},
          {"agree_behind_a_sheet", agree_behind_a_sheet}, {"sphere_inside", sphere_inside},
          {"same_for_any_threads", same_for_any_threads}, {"open_and_wrong", open_and_wrong})
