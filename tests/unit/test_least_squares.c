/* SPDX-License-Identifier: Apache-2.0
 *
 * The fit, its bounds, its loss, and what its covariance claims, against closed forms.
 */
#include "base/parallel.h"
#include "base/rng.h"
#include "bridge/least_squares.h"
#include "test.h"

#include <unistd.h>

/* y_b = sum over j of a[b][j] x[j]. */
typedef struct linear {
    size_t columns;
    const double *a, *y;
} linear;

static bool linear_residual(void *user, size_t b, const double *x, double *r, double *jacobian)
{
    const linear *l = user;
    const double *a = l->a + b * l->columns;
    r[0] = -l->y[b];
    for (size_t j = 0; j < l->columns; j++) {
        r[0] += a[j] * x[j];
        if (jacobian) jacobian[j] = a[j];
    }
    return true;
}

static bool rosenbrock(void *user, size_t b, const double *x, double *r, double *jacobian)
{
    (void)user, (void)b;
    r[0] = 10 * (x[1] - x[0] * x[0]);
    r[1] = 1 - x[0];
    if (jacobian) {
        jacobian[0] = -20 * x[0], jacobian[1] = 10;
        jacobian[2] = -1, jacobian[3] = 0;
    }
    return true;
}

static const int two_residuals[] = {2};

static void valley(void)
{
    igi_context *ctx = test_context(1);
    igi_least_squares p = {.parameter_count = 2,
                           .block_count = 1,
                           .block_sizes = two_residuals,
                           .residuals = rosenbrock};
    igi_least_squares_result result;
    double x[2] = {-1.2, 1}, covariance[4];
    CHECK_OK(ctx, igi_least_squares_solve(ctx, &p, x, covariance, &result));
    CHECK_NEAR(x[0], 1, 1e-7);
    CHECK_NEAR(x[1], 1, 1e-7);
    CHECK_NEAR(result.cost, 0, 1e-16);
    CHECK(result.converged && result.rank == 2 && !result.at_bound[0] && !result.at_bound[1]);
    CHECK(isinf(result.residual_variance) && isinf(covariance[0])); /* 2 - 2 = 0 */

    p.max_iterations = 2;
    double y[2] = {-1.2, 1};
    CHECK_OK(ctx, igi_least_squares_solve(ctx, &p, y, NULL, &result));
    CHECK(!result.converged && result.iterations == 2);
    igi_context_destroy(ctx);
}

/* The valley's floor is x1 = x0^2, so the least with x0 <= 0.5 is (0.5, 0.25). */
static void valley_in_bounds(void)
{
    igi_context *ctx = test_context(1);
    const double lower[] = {-2, -2}, upper[] = {0.5, 2};
    igi_least_squares p = {.parameter_count = 2,
                           .block_count = 1,
                           .block_sizes = two_residuals,
                           .residuals = rosenbrock,
                           .lower = lower,
                           .upper = upper};
    igi_least_squares_result result;
    double x[2] = {-30, 30}; /* outside */
    CHECK_OK(ctx, igi_least_squares_solve(ctx, &p, x, NULL, &result));
    CHECK(x[0] == 0.5);
    CHECK_NEAR(x[1], 0.25, 1e-8);
    CHECK(result.converged && result.at_bound[0] == 1 && result.at_bound[1] == 0);
    igi_context_destroy(ctx);
}

static double clamp(double x, double low, double high)
{
    return fmin(fmax(x, low), high);
}

static double two_parameter_cost(const double *a, const double *y, size_t rows, const double *x)
{
    double cost = 0;
    for (size_t b = 0; b < rows; b++) {
        double r = a[2 * b] * x[0] + a[2 * b + 1] * x[1] - y[b];
        cost += r * r / 2;
    }
    return cost;
}

/* The least over a rectangle: the free one if it lies inside, else the best on the four edges. */
static double least_in_rectangle(const double *a, const double *y, size_t rows, const double *low,
                                 const double *high)
{
    double h[2][2] = {{0}}, g[2] = {0};
    for (size_t b = 0; b < rows; b++)
        for (int i = 0; i < 2; i++) {
            g[i] += a[2 * b + (size_t)i] * y[b];
            for (int j = 0; j < 2; j++) h[i][j] += a[2 * b + (size_t)i] * a[2 * b + (size_t)j];
        }
    double det = h[0][0] * h[1][1] - h[0][1] * h[1][0];
    double x[2] = {(g[0] * h[1][1] - g[1] * h[0][1]) / det,
                   (g[1] * h[0][0] - g[0] * h[1][0]) / det};
    if (x[0] >= low[0] && x[0] <= high[0] && x[1] >= low[1] && x[1] <= high[1])
        return two_parameter_cost(a, y, rows, x);
    double least = HUGE_VAL;
    for (int i = 0; i < 2; i++)
        for (int side = 0; side < 2; side++) {
            x[i] = side ? high[i] : low[i];
            x[1 - i] = clamp((g[1 - i] - h[0][1] * x[i]) / h[1 - i][1 - i], low[1 - i],
                             high[1 - i]);
            least = fmin(least, two_parameter_cost(a, y, rows, x));
        }
    return least;
}

static double unit_random(igi_rng *rng)
{
    return igi_rng_next(rng) * 0x1p-32;
}

/* Correlated columns and optima on edges and corners, where cutting off steps at the bounds ends
 * anywhere; and units from 1e-6 on, where an absolute test of the gradient ends at once. */
static void correlated_in_bounds(void)
{
    igi_context *ctx = test_context(1);
    enum { ROWS = 12 };
    igi_rng rng = igi_rng_make(1, 0);
    int on_bound = 0, steps = 0;
    for (int trial = 0; trial < 300; trial++) {
        double a[2 * ROWS], y[ROWS], low[2], high[2], x[2];
        double unit = pow(10, -6 + 8 * unit_random(&rng));
        double apart = pow(10, -3 * unit_random(&rng));
        double truth[2] = {3 * unit_random(&rng) - 1.5, 3 * unit_random(&rng) - 1.5};
        for (int i = 0; i < 2; i++) {
            low[i] = unit_random(&rng) - 1;
            high[i] = low[i] + 0.1 + unit_random(&rng);
            x[i] = 3 * unit_random(&rng) - 1.5;
        }
        for (size_t b = 0; b < ROWS; b++) {
            a[2 * b] = unit * (unit_random(&rng) - 0.3);
            a[2 * b + 1] = a[2 * b] + unit * apart * (unit_random(&rng) - 0.5);
            y[b] = a[2 * b] * truth[0] + a[2 * b + 1] * truth[1] +
                   0.01 * unit * (unit_random(&rng) - 0.5);
        }
        linear l = {2, a, y};
        igi_least_squares p = {.parameter_count = 2,
                               .block_count = ROWS,
                               .residuals = linear_residual,
                               .user = &l,
                               .lower = low,
                               .upper = high};
        igi_least_squares_result result;
        CHECK_OK(ctx, igi_least_squares_solve(ctx, &p, x, NULL, &result));
        CHECK_NEAR(result.cost / least_in_rectangle(a, y, ROWS, low, high), 1, 1e-9);
        CHECK(result.converged);
        steps += result.iterations;
        on_bound += result.at_bound[0] || result.at_bound[1];
    }
    CHECK(on_bound > 100 && on_bound < 300);
    CHECK(steps < 300 * 6); /* some four a fit: no creeping along a bound */
    igi_context_destroy(ctx);
}

typedef struct decay {
    double t[50], y[50];
} decay;

static bool decay_residual(void *user, size_t b, const double *x, double *r, double *jacobian)
{
    const decay *d = user;
    double e = exp(-x[1] * d->t[b]);
    r[0] = x[0] * e - d->y[b];
    if (jacobian) jacobian[0] = e, jacobian[1] = -x[0] * d->t[b] * e;
    return true;
}

static decay decay_with_outliers(void)
{
    decay d;
    for (int i = 0; i < 50; i++) {
        d.t[i] = 0.06 * i;
        d.y[i] = 2 * exp(-1.3 * d.t[i]) + (i % 7 == 3 ? 1 + 0.1 * i : 0);
    }
    return d;
}

static void outliers(void)
{
    igi_context *ctx = test_context(1);
    decay d = decay_with_outliers();
    igi_least_squares p = {
        .parameter_count = 2, .block_count = 50, .residuals = decay_residual, .user = &d};
    igi_least_squares_result result;
    double x[2] = {1, 0.5};
    CHECK_OK(ctx, igi_least_squares_solve(ctx, &p, x, NULL, &result));
    CHECK(result.converged && fabs(x[1] - 1.3) > 0.2); /* what the loss is for */
    p.loss_scale = 1e-4;
    double y[2] = {1, 0.5};
    CHECK_OK(ctx, igi_least_squares_solve(ctx, &p, y, NULL, &result));
    CHECK(result.converged);
    CHECK_NEAR(y[0], 2, 2e-4);
    CHECK_NEAR(y[1], 1.3, 2e-4);
    igi_context_destroy(ctx);
}

/* (X^T X)^-1 of a straight line is known. */
static void covariance_of_a_line(void)
{
    igi_context *ctx = test_context(1);
    enum { ROWS = 40 };
    double a[2 * ROWS], y[ROWS], t1 = 0, t2 = 0;
    for (size_t b = 0; b < ROWS; b++) {
        double t = 3 + 0.25 * (double)b;
        a[2 * b] = 1, a[2 * b + 1] = t;
        y[b] = 5 - 2 * t + (b % 2 ? 0.1 : -0.1) * (double)(b % 5);
        t1 += t, t2 += t * t;
    }
    linear l = {2, a, y};
    igi_least_squares p = {.parameter_count = 2,
                           .block_count = ROWS,
                           .residuals = linear_residual,
                           .user = &l,
                           .residual_variance = 0.04};
    double x[2] = {0, 0}, c[4], det = ROWS * t2 - t1 * t1;
    igi_least_squares_result result;
    CHECK_OK(ctx, igi_least_squares_solve(ctx, &p, x, c, &result));
    CHECK(result.rank == 2 && result.residual_variance == 0.04);
    CHECK_NEAR(c[0] / (0.04 * t2 / det), 1, 1e-9);
    CHECK_NEAR(c[3] / (0.04 * ROWS / det), 1, 1e-9);
    CHECK_NEAR(c[1] / (-0.04 * t1 / det), 1, 1e-9);
    CHECK(c[1] == c[2]);

    p.residual_variance = 0;
    double variance = 2 * two_parameter_cost(a, y, ROWS, x) / (ROWS - 2);
    CHECK_OK(ctx, igi_least_squares_solve(ctx, &p, x, c, &result));
    CHECK_NEAR(result.residual_variance / variance, 1, 1e-12);
    CHECK_NEAR(c[0] / (variance * t2 / det), 1, 1e-9);

    /* The bounds do not narrow it; a parameter that is held does. */
    const double low[] = {-100, -1}, high[] = {100, 1};
    p.lower = low, p.upper = high, p.residual_variance = 0.04;
    CHECK_OK(ctx, igi_least_squares_solve(ctx, &p, x, c, &result));
    CHECK(result.at_bound[1] == -1 && x[1] == -1);
    CHECK_NEAR(c[3] / (0.04 * ROWS / det), 1, 1e-9);
    const double held[] = {100, -1};
    p.upper = held;
    CHECK_OK(ctx, igi_least_squares_solve(ctx, &p, x, c, &result));
    CHECK(result.converged && result.rank == 1 && x[1] == -1 && c[3] == 0 && c[1] == 0);
    CHECK_NEAR(c[0] / (0.04 / ROWS), 1, 1e-9);
    igi_context_destroy(ctx);
}

/* The mean of 30 numbers, of which 4 are far off: these count as -+ a and tell nothing more. */
static void covariance_with_outliers(void)
{
    igi_context *ctx = test_context(1);
    enum { ROWS = 30, FAR = 4 };
    double a[ROWS], y[ROWS];
    for (size_t b = 0; b < ROWS; b++) {
        a[b] = 1;
        y[b] = b < FAR ? (b % 2 ? 50 : -50) : 7 + (b % 2 ? 0.1 : -0.1);
    }
    linear l = {1, a, y};
    igi_least_squares p = {.parameter_count = 1,
                           .block_count = ROWS,
                           .residuals = linear_residual,
                           .user = &l,
                           .loss_scale = 0.5,
                           .residual_variance = 0.01};
    double x = 3, c;
    igi_least_squares_result result;
    CHECK_OK(ctx, igi_least_squares_solve(ctx, &p, &x, &c, &result));
    CHECK_NEAR(x, 7, 1e-7);
    CHECK_NEAR(c, 0.01 / (ROWS - FAR), 1e-12);
    p.residual_variance = 0;
    CHECK_OK(ctx, igi_least_squares_solve(ctx, &p, &x, &c, &result));
    double psi = (ROWS - FAR) * 0.01 + FAR * 0.25, slope = (double)(ROWS - FAR) / ROWS;
    CHECK_NEAR(result.residual_variance, psi / (ROWS - 1) / slope, 1e-9);
    igi_context_destroy(ctx);
}

static void undetermined_directions(void)
{
    igi_context *ctx = test_context(1);
    enum { ROWS = 20 };
    double a[4 * ROWS], y[ROWS], sum = 0;
    for (size_t b = 0; b < ROWS; b++) {
        double c = cos((double)(b % 10)), s = b < 10 ? 1 : -1; /* at right angles */
        a[4 * b] = a[4 * b + 1] = 1e-4 * s;                    /* the same column twice */
        a[4 * b + 2] = c;
        a[4 * b + 3] = 0; /* no influence at all */
        y[b] = 1e-4 * s + 2 * c;
        sum += c * c;
    }
    linear l = {4, a, y};
    igi_least_squares p = {.parameter_count = 4,
                           .block_count = ROWS,
                           .residuals = linear_residual,
                           .user = &l,
                           .residual_variance = 1};
    double x[4] = {0.1, 0.2, 0, 5}, c[16];
    igi_least_squares_result result;
    CHECK_OK(ctx, igi_least_squares_solve(ctx, &p, x, c, &result));
    CHECK(result.converged && result.rank == 2);
    CHECK(isinf(c[0]) && isinf(c[5]) && isinf(c[15]));
    CHECK_NEAR(c[10] * sum, 1, 1e-9);
    for (int i = 0; i < 16; i++) CHECK(i % 5 == 0 || c[i] == 0);
    CHECK_NEAR(x[0] + x[1], 1, 1e-6);
    CHECK_NEAR(x[2], 2, 1e-7);
    CHECK(x[3] == 5);
    igi_context_destroy(ctx);
}

typedef enum fault { NOT_A_NUMBER, NOT_IN_DOMAIN, INFINITE, BAD_SLOPE, NOT_WRITTEN } fault;

static bool faulty(void *user, size_t b, const double *x, double *r, double *jacobian)
{
    fault f = *(const fault *)user;
    if (f == NOT_WRITTEN) return true;
    if (f == NOT_IN_DOMAIN) return false;
    r[0] = f == NOT_A_NUMBER && b == 2 ? (double)NAN : f == INFINITE ? -(double)INFINITY : x[0];
    if (jacobian) jacobian[0] = f == BAD_SLOPE ? (double)NAN : 1;
    return true;
}

/* ln x = ln 2 from x = 10: the first full step leads to x < 0. */
static bool logarithm(void *user, size_t b, const double *x, double *r, double *jacobian)
{
    (void)b;
    r[0] = log(x[0]) - log(2);
    if (jacobian) jacobian[0] = 1 / x[0];
    return x[0] > 0 || *(const bool *)user; /* says so, or hands out the NaN */
}

static void not_finite(void)
{
    igi_context *ctx = test_context(1);
    igi_least_squares_result result;
    for (int f = NOT_A_NUMBER; f <= NOT_WRITTEN; f++) {
        fault which = (fault)f;
        igi_least_squares p = {
            .parameter_count = 1, .block_count = 3, .residuals = faulty, .user = &which};
        double x = 7, c;
        CHECK(igi_least_squares_solve(ctx, &p, &x, &c, &result) == IGI_E_NO_ANSWER);
        CHECK_CONTAINS(igi_context_message(ctx), "not finite");
        CHECK(x == 7);
    }
    for (int i = 0; i < 2; i++) {
        bool silently = i;
        igi_least_squares p = {
            .parameter_count = 1, .block_count = 1, .residuals = logarithm, .user = &silently};
        double x = 10;
        CHECK_OK(ctx, igi_least_squares_solve(ctx, &p, &x, NULL, &result));
        CHECK_NEAR(x, 2, 1e-7);
        CHECK(result.converged);
    }
    igi_context_destroy(ctx);
}

static void nothing_to_fit(void)
{
    igi_context *ctx = test_context(1);
    const double low[] = {0, -HUGE_VAL}, high[] = {1, HUGE_VAL};
    igi_least_squares p = {
        .parameter_count = 2, .residuals = linear_residual, .lower = low, .upper = high};
    double x[2] = {4, 4}, c[4];
    igi_least_squares_result result;
    CHECK_OK(ctx, igi_least_squares_solve(ctx, &p, x, c, &result));
    CHECK(x[0] == 1 && x[1] == 4 && result.rank == 0 && result.cost == 0 && result.converged);
    CHECK(isinf(c[0]) && isinf(c[3]) && c[1] == 0 && c[2] == 0);
    igi_context_destroy(ctx);
}

static void wrong_calls(void)
{
    igi_context *ctx = test_context(1);
    const double one[] = {1, 1}, zero[] = {0, 0}, nan[] = {0, (double)NAN};
    const int empty[] = {1, 0};
    const igi_least_squares good = {
        .parameter_count = 2, .block_count = 2, .residuals = linear_residual};
    igi_least_squares wrong[8];
    for (int i = 0; i < 8; i++) wrong[i] = good;
    wrong[0].parameter_count = 0;
    wrong[1].parameter_count = IGI_LEAST_SQUARES_MAX_PARAMETERS + 1;
    wrong[2].lower = one, wrong[2].upper = zero;
    wrong[3].upper = nan;
    wrong[4].block_sizes = empty;
    wrong[5].loss_scale = -1;
    wrong[6].tolerance = (double)NAN;
    wrong[7].max_iterations = -1;
    igi_least_squares_result result;
    double x[IGI_LEAST_SQUARES_MAX_PARAMETERS + 1] = {0};
    for (int i = 0; i < 8; i++)
        CHECK(igi_least_squares_solve(ctx, &wrong[i], x, NULL, &result) == IGI_E_USAGE);
    x[1] = (double)NAN;
    CHECK(igi_least_squares_solve(ctx, &good, x, NULL, &result) == IGI_E_USAGE);
    CHECK_CONTAINS(igi_context_message(ctx), "parameter 1 starts at nan");
    igi_context_destroy(ctx);
}

typedef struct answer {
    double x[2], covariance[4], cost;
    int iterations;
} answer;

static igi_status solve_one(igi_context *worker, void *user, size_t index, int number)
{
    (void)number;
    answer *a = (answer *)user + index;
    decay d = decay_with_outliers();
    igi_least_squares p = {.parameter_count = 2,
                           .block_count = 50,
                           .residuals = decay_residual,
                           .user = &d,
                           .loss_scale = 0.05};
    igi_least_squares_result result;
    a->x[0] = 1, a->x[1] = 0.5;
    IGI_TRY(igi_least_squares_solve(worker, &p, a->x, a->covariance, &result));
    a->cost = result.cost, a->iterations = result.iterations;
    return IGI_OK;
}

static void same_bytes_side_by_side(void)
{
    enum { COUNT = 40 };
    answer *answers = calloc(COUNT, sizeof *answers);
    igi_context *many = test_context(4);
    CHECK_OK(many, igi_parallel_for(many, COUNT, solve_one, answers));
    for (int i = 1; i < COUNT; i++) CHECK(memcmp(answers, answers + i, sizeof *answers) == 0);
    CHECK(answers[0].x[1] > 1);
    igi_context_destroy(many);
    free(answers);
}

/* All that went before, failures too, with stderr in a file. */
static void prints_nothing(void)
{
    FILE *file = tmpfile();
    fflush(stderr);
    int kept = dup(STDERR_FILENO);
    CHECK(file && kept >= 0 && dup2(fileno(file), STDERR_FILENO) >= 0);
    not_finite();
    undetermined_directions();
    outliers();
    fflush(stderr);
    dup2(kept, STDERR_FILENO);
    close(kept);
    CHECK(lseek(fileno(file), 0, SEEK_END) == 0);
    fclose(file);
}

TEST_MAIN({"prints nothing", prints_nothing}, {"valley", valley},
          {"valley in bounds", valley_in_bounds}, {"correlated in bounds", correlated_in_bounds},
          {"outliers", outliers}, {"covariance of a line", covariance_of_a_line},
          {"covariance with outliers", covariance_with_outliers},
          {"undetermined directions", undetermined_directions}, {"not finite", not_finite},
          {"nothing to fit", nothing_to_fit}, {"wrong calls", wrong_calls},
          {"same bytes side by side", same_bytes_side_by_side})
