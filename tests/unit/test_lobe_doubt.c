/* SPDX-License-Identifier: Apache-2.0
 *
 * How far to believe a lobe: the jackknife against fits that really leave a piece out, and the bound
 * on a lobe that was not found, with a highlight in sight and without.
 */
#include "test.h"

#include "base/rng.h"
#include "brdf/brdf.h"
#include "specular/jackknife.h"
#include "specular/lobe_doubt.h"

#define N 24
#define PIECES 6

/* r = y - a u - b v: linear, so that one Newton step is the whole way. */
static double u[N], v[N], y[N];

static bool line(void *user, size_t block, const double *x, double *residuals, double *jacobian)
{
    (void)user;
    for (size_t i = 0; i < 4; i++) {
        size_t k = 4 * block + i;
        residuals[i] = y[k] - x[0] * u[k] - x[1] * v[k];
        if (!jacobian) continue;
        jacobian[2 * i] = -u[k];
        jacobian[2 * i + 1] = -v[k];
    }
    return true;
}

/* Without the rows of `piece`. */
static void solve_without(const uint32_t *pieces, uint32_t piece, double x[2])
{
    double a = 0, b = 0, d = 0, p = 0, q = 0;
    for (size_t k = 0; k < N; k++) {
        if (pieces[k / 2] == piece) continue;
        a += u[k] * u[k], b += u[k] * v[k], d += v[k] * v[k];
        p += u[k] * y[k], q += v[k] * y[k];
    }
    x[0] = (d * p - b * q) / (a * d - b * b);
    x[1] = (a * q - b * p) / (a * d - b * b);
}

static void leaves_out(void)
{
    igi_context *ctx = test_context(1);
    igi_rng rng = igi_rng_make(3, 1);
    uint32_t pieces[N / 2];
    int sizes[N / 4];
    double x[2], one[2], want[3] = {0}, got[4], h[2][2] = {{0}};
    for (size_t k = 0; k < N; k++) {
        pieces[k / 2] = (uint32_t)(k / 2 * 7 % PIECES); /* in no order */
        sizes[k / 4] = 4;
        u[k] = 1 + (double)igi_rng_float(&rng);
        v[k] = (double)igi_rng_float(&rng);
        y[k] = 2 * u[k] - v[k] + (double)pieces[k / 2] * 0.1 + 0.1 * (double)igi_rng_float(&rng);
        double *sum = h[0], parts[2] = {u[k] * u[k], v[k] * v[k]};
        for (int j = 0; j < 2; j++) sum[j] += parts[j];
    }
    solve_without(pieces, PIECES, x);
    for (uint32_t c = 0; c < PIECES; c++) {
        double part[2] = {0};
        solve_without(pieces, c, one);
        for (size_t k = 0; k < N; k++)
            if (pieces[k / 2] == c) part[0] += u[k] * u[k], part[1] += v[k] * v[k];
        for (int j = 0; j < 2; j++) h[1][j] += part[j] * part[j];
        want[0] += (one[0] - x[0]) * (one[0] - x[0]) * (PIECES - 1.0) / PIECES;
        want[1] += (one[0] - x[0]) * (one[1] - x[1]) * (PIECES - 1.0) / PIECES;
        want[2] += (one[1] - x[1]) * (one[1] - x[1]) * (PIECES - 1.0) / PIECES;
    }
    igi_least_squares problem = {
        .parameter_count = 2, .block_count = N / 4, .block_sizes = sizes, .residuals = line};
    CHECK_OK(ctx, igi_jackknife(ctx, &problem, x, pieces, 2, got));
    double widen[2];
    for (int j = 0; j < 2; j++) {
        double worth = h[0][j] * h[0][j] / h[1][j];
        widen[j] = 1 + 1.5 / worth + 0.8 / (worth * worth);
        CHECK(worth > 3 && worth <= PIECES);
    }
    CHECK_NEAR(got[0], want[0] * widen[0] * widen[0], 1e-9 * want[0]);
    CHECK_NEAR(got[1], want[1] * widen[0] * widen[1], 1e-9 * fabs(want[1]));
    CHECK_NEAR(got[3], want[2] * widen[1] * widen[1], 1e-9 * want[2]);
    for (size_t k = 0; k < N / 2; k++) pieces[k] = 5;
    CHECK_OK(ctx, igi_jackknife(ctx, &problem, x, pieces, 2, got));
    CHECK(isinf(got[0]) && isinf(got[3]));
    igi_context_destroy(ctx);
}

/* Pixels that look at a diffuse surface under one lamp, from where it would be mirrored, or not. */
#define PIXELS 400

static igi_lobe_doubt doubt_of(igi_context *ctx, bool mirrored, double specular)
{
    static float radiance[PIXELS], irradiance[PIXELS], incident[PIXELS];
    static uint32_t group[PIXELS], observation[PIXELS], piece[PIXELS];
    static igi_direction_sample directions[PIXELS];
    igi_rng rng = igi_rng_make(11, 0);
    igi_lobe_doubt doubt;
    for (size_t i = 0; i < PIXELS; i++) {
        float tilt = 0.6f * igi_rng_float(&rng), aside = mirrored ? -tilt : 1.2f + tilt, s, base;
        igi_direction_sample *d = &directions[i];
        d->out = igi_normalize(igi_v(tilt, 0, 1));
        d->in = igi_normalize(igi_v(aside, 0.4f * (igi_rng_float(&rng) - 0.5f), 1));
        d->weight = 0.1f;
        incident[i] = 10;
        irradiance[i] = 2;
        piece[i] = (uint32_t)(i % 40);
        igi_lobe_terms(IGI_WARD, 0.1f, d->in, d->out, &s, &base);
        radiance[i] = (0.5f / IGI_PIF * 2 + (float)specular * s) *
                      (1 + 0.05f * (igi_rng_float(&rng) - 0.5f));
    }
    igi_highlights h = {.count = PIXELS,
                        .samples = 1,
                        .bands = 1,
                        .groups = 1,
                        .group = group,
                        .observation = observation,
                        .piece = piece,
                        .radiance = radiance,
                        .irradiance = irradiance,
                        .directions = directions,
                        .incident = incident};
    CHECK_OK(ctx, igi_lobe_doubt_create(ctx, &h, &doubt));
    return doubt;
}

static void bounds(void)
{
    igi_context *ctx = test_context(1);
    igi_lobe_doubt seen = doubt_of(ctx, true, 0), unseen = doubt_of(ctx, false, 0);
    igi_lobe_doubt lobe = doubt_of(ctx, true, 0.02);
    CHECK(seen.bound > 0 && seen.bound < 0.02);
    CHECK(seen.share[0] > 0 && seen.share[0] < 0.008); /* .021 if a lobe were taken for granted */
    CHECK(unseen.bound > 0.5);     /* nothing mirrors the lamp: anything is possible */
    CHECK(unseen.share[0] < 0.01); /* though not of the albedo: no pixel would show it */
    CHECK(lobe.bound > 0.02 && lobe.share[0] > 5 * seen.share[0]); /* within its bound, and felt */
    igi_context_destroy(ctx);
}

TEST_MAIN({"leaves_out", leaves_out}, {"bounds", bounds})
