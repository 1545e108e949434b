/* SPDX-License-Identifier: Apache-2.0
 *
 * Steps of brightness under noise: found without bias, and as far off as they say. Pixels are summed
 * up from points, not by the formula that is fitted.
 */
#include "test.h"

#include "base/rng.h"
#include "observe/edge_sites.h"

#define PIXELS 11
#define POINTS 24 /* of a pixel, along either side */
#define ROWS 4000

/* A row across an edge that passes the row's middle at `place`: dark left of it, bright right. */
static void draw_row(double place, double slope, double noise, igi_rng *rng, double *y)
{
    for (int i = 0; i < PIXELS; i++) {
        y[i] = 0;
        for (int k = 0; k < POINTS * POINTS; k++) {
            double x = i + (k % POINTS + .5) / POINTS;
            double across = (k / POINTS + .5) / POINTS - .5;
            double t = x - place;
            y[i] += (t > slope * across ? 1 + .01 * t : .3 - .005 * t) / (POINTS * POINTS);
        }
        double sum = -6; /* of twelve uniform numbers: normal, of variance 1 */
        for (int k = 0; k < 12; k++) sum += (double)igi_rng_float(rng);
        y[i] += noise * sum;
    }
}

static void measure_steps(double slope, double noise)
{
    igi_rng rng = igi_rng_make(8, 9);
    double y[PIXELS], at, sigma, sum = 0;
    int found = 0, within = 0;
    for (int n = 0; n < ROWS; n++) {
        double place = 5 + (double)igi_rng_float(&rng);
        draw_row(place, slope, noise, &rng, y);
        if (!igi_edge_profile_measure(y, PIXELS, 5.5, 2, slope, &at, &sigma)) continue;
        sum += at - place;
        within += fabs(at - place) < .75 * sigma;
        found++;
    }
    printf("slope %.1f, noise %.3f: %d found, off by %.4f, %.3f within .75 sigma\n", slope, noise,
           found, sum / found, (double)within / found);
    CHECK(found > .98 * ROWS);
    CHECK_NEAR(sum / found, 0, .006);
    /* .52 of Student's errors with the 6 degrees of freedom that 11 pixels leave */
    CHECK_NEAR((double)within / found, .45, .1);
}

static void steps_are_as_far_off_as_they_say(void)
{
    measure_steps(0, .03);
    measure_steps(.6, .03);
    measure_steps(-.6, .05);
}

static void no_step_no_edge(void)
{
    igi_rng rng = igi_rng_make(1, 1);
    double y[PIXELS], at, sigma;
    for (int i = 0; i < PIXELS; i++) y[i] = 1 + .1 * (double)igi_rng_float(&rng) + .02 * i;
    CHECK(!igi_edge_profile_measure(y, PIXELS, 5.5, 2, 0, &at, &sigma));
    draw_row(8.4, 0, 0, &rng, y); /* beyond reach */
    CHECK(!igi_edge_profile_measure(y, PIXELS, 5.5, 2, 0, &at, &sigma));
    draw_row(5.2, 0, 0, &rng, y);
    y[3] = (double)NAN;
    CHECK(!igi_edge_profile_measure(y, PIXELS, 5.5, 2, 0, &at, &sigma));
}

TEST_MAIN({"steps_are_as_far_off_as_they_say", steps_are_as_far_off_as_they_say},
          {"no_step_no_edge", no_step_no_edge})
