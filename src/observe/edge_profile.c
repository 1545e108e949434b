/* SPDX-License-Identifier: Apache-2.0
 *
 * A step of brightness along a row of pixels, to a few hundredths of one.
 *
 * A pixel whose centre lies t beyond the edge is covered by the far side to
 *     C(t) = integral of (a box of width 1) * (a box of width |slope|), from -infinity to t,
 * so that, with shading linear on either side,
 *     y(t) = (a0 + a1 t) (1 - C(t)) + (b0 + b1 t) C(t).
 * For a given place the four numbers are linear; the place is searched in one dimension. A weak
 * prior holds the slopes of the shading, which noise would otherwise buy.
 */
#include "base/solve.h"
#include "observe/edge_sites.h"

#include <math.h>
#include <string.h>

/* Steps of the search, pixels; a parabola through the best three gives the rest. */
#define COARSE .5
#define MIDDLE .1
#define FINE .02
/* The prior's standard deviation of a shading, of the step a pixel. */
#define SHADING .03
/* What a clear step is: in standard deviations of the residuals, and of the brighter side. */
#define CLEAR_SIGMAS 6.0
#define CLEAR_SHARE .06
/* The pixels are squares only nearly. */
#define LEAST_SIGMA .02

static double ramp(double u)
{
    return u > 0 ? u * u / 2 : 0;
}

static double coverage(double t, double slope)
{
    double m = fabs(slope);
    if (m < .05) return t <= -.5 ? 0 : t >= .5 ? 1 : t + .5;
    return (ramp(t + (1 + m) / 2) - ramp(t + (1 - m) / 2) - ramp(t - (1 - m) / 2) +
            ramp(t - (1 + m) / 2)) /
           m;
}

typedef struct profile {
    const double *y;
    int count;
    double slope, prior; /* 1 / variance of the shading, in units of the residuals' */
} profile;

/* The misfit with the step at `at`; levels: a0 a1 b0 b1. Of a least-squares solution x of M x = v, it
 * is the sum of squares less v x. */
static double fit_levels(const profile *p, double at, double levels[4])
{
    double m[16] = {0}, v[4] = {0}, sum = 0, blurred = (1 + fabs(p->slope)) / 2;
    for (int i = 0; i < p->count; i++) {
        double t = i + .5 - at, y = p->y[i];
        sum += y * y;
        if (fabs(t) >= blurred) {
            int k = t > 0 ? 2 : 0;
            m[5 * k] += 1;
            m[5 * k + 4] += t;
            m[5 * k + 5] += t * t;
            v[k] += y;
            v[k + 1] += t * y;
            continue;
        }
        double c = coverage(t, p->slope);
        const double basis[4] = {1 - c, t * (1 - c), c, t * c};
        for (int j = 0; j < 4; j++) {
            for (int k = 0; k <= j; k++) m[4 * j + k] += basis[j] * basis[k];
            v[j] += basis[j] * y;
        }
    }
    m[5] += p->prior;
    m[15] += p->prior;
    memcpy(levels, v, sizeof v);
    if (!igi_solve_cholesky(m, 4, levels, 1)) return HUGE_VAL;
    for (int k = 0; k < 4; k++) sum -= v[k] * levels[k];
    return fmax(0, sum);
}

static double search(const profile *p, double from, double to, double step, double *place)
{
    double best = HUGE_VAL, levels[4];
    for (double at = from; at <= to + 1e-9; at += step) {
        double misfit = fit_levels(p, at, levels);
        if (misfit < best) best = misfit, *place = at;
    }
    return best;
}

/* d y / d place, squared and summed. */
static double information(const profile *p, double at, const double levels[4])
{
    double sum = 0;
    for (int i = 0; i < p->count; i++) {
        double t = i + .5 - at;
        double d = coverage(t + FINE, p->slope) - coverage(t - FINE, p->slope);
        d *= (levels[2] - levels[0]) / (2 * FINE);
        sum += d * d;
    }
    return sum;
}

bool igi_edge_profile_measure(const double *y, int count, double expected, double reach,
                              double slope, double *place, double *sigma)
{
    profile p = {y, count, slope, 0};
    double levels[4], high = 0;
    for (int i = 0; i < count; i++) {
        if (!isfinite(y[i])) return false;
        high = fmax(high, fabs(y[i]));
    }
    /* The unit of the residuals is not known yet: a few per cent of the brighter side. */
    p.prior = .03 * .03 / (SHADING * SHADING);
    double at = expected;
    (void)search(&p, expected - reach, expected + reach, COARSE, &at);
    if (fabs(at - expected) > reach - COARSE / 2) return false;
    (void)search(&p, at - COARSE, at + COARSE, MIDDLE, &at);
    (void)search(&p, at - MIDDLE / 2, at + MIDDLE / 2, MIDDLE / 2, &at);
    double below = fit_levels(&p, at - FINE, levels), above = fit_levels(&p, at + FINE, levels);
    double here = fit_levels(&p, at, levels), bend = below - 2 * here + above;
    if (bend > 0) {
        double shift = .5 * (below - above) / bend;
        at += fmax(-MIDDLE / 4, fmin(MIDDLE / 4, FINE * shift));
    }
    double misfit = fit_levels(&p, at, levels), variance = misfit / (count - 5);
    double step = fabs(levels[2] - levels[0]), info = information(&p, at, levels);
    if (step < CLEAR_SHARE * high || step * step < CLEAR_SIGMAS * CLEAR_SIGMAS * variance ||
        !(info > 0))
        return false;
    *place = at;
    *sigma = hypot(LEAST_SIGMA, sqrt(variance / info));
    return true;
}
