/* SPDX-License-Identifier: Apache-2.0
 *
 * Form factors in closed form against tabulated values and against each other.
 */
#include "test.h"

#include "base/rng.h"
#include "transport/form_factor.h"

static const double floor_square[4][3] = {
    {0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}; /* faces up */
static const double ceiling_square[4][3] = {{0, 0, 1}, {0, 1, 1}, {1, 1, 1}, {1, 0, 1}};
static const double wall_square[4][3] = {{0, 0, 0}, {0, 1, 0}, {0, 1, 1}, {0, 0, 1}}; /* faces +x */

static void from_a_corner(void)
{
    const double up[3] = {0, 0, 1}, corner[3] = {0, 0, 0}, middle[3] = {.5, .5, 0};
    CHECK_NEAR(igi_form_factor_from_point(corner, up, ceiling_square, 4), 0.138531605994893, 1e-14);
    /* Four squares of half the side around the point. */
    double x = 0.5, h = 1, a = x / sqrt(x * x + h * h);
    CHECK_NEAR(igi_form_factor_from_point(middle, up, ceiling_square, 4),
               4 * (2 * a * atan(a)) / (2 * IGI_PI), 1e-14);
}

static void horizon_cuts(void)
{
    /* A wall that stands on the horizon, and the same wall reaching down below it. */
    const double p[3] = {.3, .4, 0}, up[3] = {0, 0, 1};
    double deep[4][3] = {{0, 0, -2}, {0, 1, -2}, {0, 1, 1}, {0, 0, 1}};
    double tip[4][3] = {{0, .5, -1}, {0, 1, 0}, {0, .5, 1}, {0, 0, 0}}; /* two corners on it */
    double half[3][3] = {{0, 1, 0}, {0, .5, 1}, {0, 0, 0}};
    double whole = igi_form_factor_from_point(p, up, wall_square, 4);
    CHECK(whole > 0.05);
    CHECK_NEAR(igi_form_factor_from_point(p, up, (const double(*)[3])deep, 4), whole, 1e-14);
    CHECK_NEAR(igi_form_factor_from_point(p, up, (const double(*)[3])tip, 4),
               igi_form_factor_from_point(p, up, (const double(*)[3])half, 3), 1e-14);
    const double down[3] = {0, 0, -1};
    CHECK_NEAR(igi_form_factor_from_point(p, down, wall_square, 4), 0, 1e-14);
    CHECK_NEAR(igi_form_factor_from_point(p, down, ceiling_square, 4), 0, 0);
}

static void unit_squares(void)
{
    CHECK_NEAR(igi_form_factor_between(floor_square, 4, ceiling_square, 4), 0.199824895698387,
               1e-12);
    CHECK_NEAR(igi_form_factor_between(floor_square, 4, wall_square, 4), 0.200043776075403, 1e-11);
    CHECK_NEAR(igi_form_factor_between(floor_square, 4, floor_square, 4), 0, 0);
    /* Back to back sees nothing. */
    double down[4][3] = {{0, 1, 0}, {1, 1, 0}, {1, 0, 0}, {0, 0, 0}};
    CHECK_NEAR(igi_form_factor_between((const double(*)[3])down, 4, ceiling_square, 4), 0, 0);
}

/* A regular polygon of as large an area as the unit disk. */
static void make_disk(double (*p)[3], size_t n, double z, bool facing_up, double turn)
{
    double r = sqrt(2 * IGI_PI / ((double)n * sin(2 * IGI_PI / (double)n)));
    for (size_t k = 0; k < n; k++) {
        double a = turn + 2 * IGI_PI * (double)k / (double)n * (facing_up ? 1 : -1);
        p[k][0] = r * cos(a);
        p[k][1] = r * sin(a);
        p[k][2] = z;
    }
}

static double disks(size_t n)
{
    double a[256][3], b[256][3];
    make_disk(a, n, 0, true, 0);
    make_disk(b, n, 1, false, 0.1);
    return igi_form_factor_between((const double(*)[3])a, n, (const double(*)[3])b, n);
}

static void coaxial_disks(void)
{
    double last = fabs(disks(8) - 0.381966011250105);
    for (size_t n = 16; n <= 128; n *= 2) { /* falls at least as 1/n^2 */
        double error = fabs(disks(n) - 0.381966011250105);
        CHECK(error < last / 3.9);
        last = error;
    }
    CHECK(last < 2e-6);
}

/* The same factor by averaging the one from a point over the polygon: n x n midpoints. */
static double by_points(const double (*a)[3], const double (*b)[3], int n)
{
    double e1[3], e2[3], normal[3], sum = 0;
    for (int k = 0; k < 3; k++) {
        e1[k] = a[1][k] - a[0][k];
        e2[k] = a[3][k] - a[0][k];
    }
    double length2 = 0;
    for (int k = 0; k < 3; k++) {
        int k1 = (k + 1) % 3, k2 = (k + 2) % 3;
        normal[k] = e1[k1] * e2[k2] - e1[k2] * e2[k1];
        length2 += normal[k] * normal[k];
    }
    for (int k = 0; k < 3; k++) normal[k] /= sqrt(length2);
    for (int i = 0; i < n * n; i++) {
        double p[3];
        for (int k = 0; k < 3; k++)
            p[k] = a[0][k] + e1[k] * (i % n + .5) / n + e2[k] * (i / n + .5) / n;
        sum += igi_form_factor_from_point(p, normal, b, 4);
    }
    return sum / (n * n);
}

static void random_parallelogram(igi_rng *rng, double (*p)[3])
{
    for (int k = 0; k < 3; k++) {
        double corner = 3.0 * (double)igi_rng_float(rng);
        double e1 = (double)igi_rng_float(rng) - .5, e2 = (double)igi_rng_float(rng) - .5;
        p[0][k] = corner;
        p[1][k] = corner + e1;
        p[2][k] = corner + e1 + e2;
        p[3][k] = corner + e2;
    }
}

static double area(const double (*p)[3])
{
    double sum = 0;
    for (int k = 0; k < 3; k++) {
        int k1 = (k + 1) % 3, k2 = (k + 2) % 3;
        double c = (p[1][k1] - p[0][k1]) * (p[3][k2] - p[0][k2]) -
                   (p[1][k2] - p[0][k2]) * (p[3][k1] - p[0][k1]);
        sum += c * c;
    }
    return sqrt(sum);
}

/* Any two: each against the average over points, and reciprocity. */
static void random_pairs(void)
{
    igi_rng rng = igi_rng_make(7, 1);
    int seen = 0;
    for (int trial = 0; trial < 200; trial++) {
        double p[4][3], q[4][3];
        random_parallelogram(&rng, p);
        random_parallelogram(&rng, q);
        const double(*a)[3] = (const double(*)[3])p, (*b)[3] = (const double(*)[3])q;
        double ab = igi_form_factor_between(a, 4, b, 4), ba = igi_form_factor_between(b, 4, a, 4);
        CHECK(ab >= 0 && ab <= 1);
        CHECK_NEAR(area(a) * ab, area(b) * ba, 1e-6 * area(a) * ab + 1e-12);
        double points = by_points(a, b, 24);
        CHECK_NEAR(ab, points, 0.02 * points + 1e-5);
        if (ab > 1e-3) seen++;
    }
    CHECK(seen > 20);
}

/* Squares close together and small squares far apart: both ends of what a room asks for. */
static void extremes(void)
{
    double near[4][3], far[4][3];
    for (int k = 0; k < 4; k++) {
        memcpy(near[k], ceiling_square[k], sizeof near[k]);
        memcpy(far[k], ceiling_square[k], sizeof far[k]);
        near[k][2] = 1e-3;
        far[k][2] = 300;
    }
    /* 1 - F = 4h/pi + O(h^2 log h) for squares at h: what escapes through the slit of 4h/A */
    double f = igi_form_factor_between(floor_square, 4, (const double(*)[3])near, 4);
    CHECK_NEAR(1 - f, 2e-3, 1e-5);
    f = igi_form_factor_between(floor_square, 4, (const double(*)[3])far, 4);
    CHECK_NEAR(f * 9e4 * IGI_PI, 1, 1e-4);
}

static void degenerate(void)
{
    double line[3][3] = {{0, 0, 1}, {1, 1, 1}, {2, 2, 1}},
           point[3][3] = {{0, 0, 1}, {0, 0, 1}, {0, 0, 1}};
    double bad[3][3] = {{0, 0, 1}, {1, (double)NAN, 1}, {2, 2, 1}};
    CHECK_NEAR(igi_form_factor_between(floor_square, 4, (const double(*)[3])line, 3), 0, 0);
    CHECK_NEAR(igi_form_factor_between((const double(*)[3])point, 3, floor_square, 4), 0, 0);
    CHECK_NEAR(igi_form_factor_between((const double(*)[3])bad, 3, floor_square, 4), 0, 0);
    CHECK_NEAR(igi_form_factor_between(floor_square, 2, ceiling_square, 4), 0, 0);
    const double up[3] = {0, 0, 1}, on_it[3] = {.5, .5, 1};
    CHECK(isfinite(igi_form_factor_from_point(on_it, up, ceiling_square, 4)));
    CHECK_NEAR(igi_form_factor_from_point(on_it, up, (const double(*)[3])line, 3), 0, 0);
}

TEST_MAIN({"from_a_corner", from_a_corner}, {"horizon_cuts", horizon_cuts},
          {"unit_squares", unit_squares}, {"coaxial_disks", coaxial_disks},
          {"random_pairs", random_pairs}, {"extremes", extremes}, {"degenerate", degenerate})
