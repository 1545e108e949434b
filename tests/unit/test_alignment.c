/* SPDX-License-Identifier: Apache-2.0
 *
 * What photographs' shifts say about all cameras: off, or not; by what they share, or each by its own.
 */
#include "test.h"

#include "base/rng.h"
#include "observe/alignment.h"

enum { FRAMES = 20 };
#define ERROR_PX .08

static double normal(igi_rng *rng)
{
    double u = 1 - (double)igi_rng_float(rng);
    return sqrt(-2 * log(u)) * cos(2 * IGI_PI * (double)igi_rng_float(rng));
}

/* Each by `own` and all by shift and magnified, beside the errors of measuring. */
static igi_alignment judge(double own, double shift, double magnified, size_t count)
{
    igi_registration r[FRAMES] = {{0}};
    igi_rng rng = igi_rng_make(3, 1);
    igi_alignment a;
    igi_context *ctx = test_context(1);
    for (size_t i = 0; i < count; i++) {
        r[i].edges = 80;
        r[i].offset_error = r[i].corner_error = ERROR_PX;
        r[i].shift_error = ERROR_PX * sqrt(2 + 2 / 3.0);
        for (int k = 0; k < 2; k++)
            r[i].offset[k] = hypot(own, ERROR_PX) * normal(&rng) + (k ? -.5 : 1) * shift;
        r[i].magnified = ERROR_PX * normal(&rng) + magnified;
        r[i].shift = sqrt(r[i].offset[0] * r[i].offset[0] + r[i].offset[1] * r[i].offset[1] +
                          r[i].magnified * r[i].magnified / 3);
    }
    CHECK_OK(ctx, igi_alignment_judge(ctx, r, count, &a));
    igi_context_destroy(ctx);
    return a;
}

static void nothing_is_off(void)
{
    igi_alignment a = judge(0, 0, 0, FRAMES);
    CHECK(a.known == FRAMES && a.typical_px < .1);
    CHECK(!a.all_off && !a.shift_is_shared && !a.magnified_is_shared);
}

static void each_by_its_own(void)
{
    igi_alignment a = judge(.3, 0, 0, FRAMES);
    CHECK_NEAR(a.typical_px, .3 * 1.2, .12);
    CHECK(a.all_off && !a.shift_is_shared && !a.magnified_is_shared);
}

static void all_alike(void)
{
    igi_alignment a = judge(.1, 1, 0, FRAMES), b = judge(.1, 0, 1, FRAMES);
    CHECK(a.all_off && a.shift_is_shared && !a.magnified_is_shared);
    CHECK_NEAR(a.shift[0], 1, .1);
    CHECK_NEAR(a.shift[1], -.5, .1);
    CHECK(b.all_off && !b.shift_is_shared && b.magnified_is_shared);
    CHECK_NEAR(b.magnified, 1, .1);
}

/* Three that happen to be alike are no proof. */
static void too_few(void)
{
    igi_alignment a = judge(0, 1, 0, 3);
    CHECK(a.all_off && !a.shift_is_shared);
    a = judge(.5, 0, 0, 2);
    CHECK(!a.all_off);
}

TEST_MAIN({"nothing_is_off", nothing_is_off}, {"each_by_its_own", each_by_its_own},
          {"all_alike", all_alike}, {"too_few", too_few})
