/* SPDX-License-Identifier: Apache-2.0
 *
 * Three ways to (I - rho F) B = E.
 *
 * Gathering (Gauss-Seidel) replaces each B_i by what it gathers now. With q the largest
 * rho_i sum_j F_ij, a sweep that changes B by d at most leaves it within d q/(1-q) of the answer: the
 * stop is a bound, not a hope. q < 1 unless something reflects everything; then sweeps go on until
 * nothing moves.
 *
 * Shooting (Cohen et al. 1988) keeps for each element what it has not sent on, and sends that of the
 * element with most power; it stops when all that is left, reflected for ever, is below tolerance.
 *
 * LU with row pivots is 40 lines, needs no library that starts threads of its own, and adds in the
 * same order everywhere; for the thousand elements that this system is made for it takes a second.
 */
#include "transport/radiosity.h"

#include <math.h>
#include <string.h>

#define MAX_SWEEPS 100000

static igi_status no_answer(igi_context *ctx)
{
    return igi_fail(
        ctx, IGI_E_NO_ANSWER,
        "radiosity: the light does not die out; is an albedo 1 or more in a closed room?");
}

/* max_i rho_i sum_j F_ij, held below 1 */
static double reflected_most(const igi_radiosity_system *s)
{
    double most = 0;
    for (size_t i = 0; i < s->count; i++) {
        double sum = 0;
        for (size_t j = 0; j < s->count; j++) sum += s->factors[i * s->count + j];
        most = fmax(most, s->albedo[i] * sum);
    }
    return fmin(most, 1 - 1e-6);
}

static double largest(const double *values, size_t count)
{
    double most = 0;
    for (size_t i = 0; i < count; i++) {
        if (!isfinite(values[i])) return HUGE_VAL; /* fmax would pass over NaN */
        most = fmax(most, fabs(values[i]));
    }
    return most;
}

static igi_status gather(igi_context *ctx, const igi_radiosity_system *s, double tolerance,
                         double *b)
{
    double q = reflected_most(s);
    memcpy(b, s->sent, s->count * sizeof *b);
    for (int sweep = 0; sweep < MAX_SWEEPS; sweep++) {
        double change = 0;
        for (size_t i = 0; i < s->count; i++) {
            const double *row = s->factors + i * s->count;
            double sum = 0;
            for (size_t j = 0; j < s->count; j++) sum += row[j] * b[j];
            /* what it sees of itself is on the left side */
            double own = 1 - s->albedo[i] * row[i];
            if (!(own > 0)) return no_answer(ctx);
            double now = (s->sent[i] + s->albedo[i] * (sum - row[i] * b[i])) / own;
            change = fmax(change, fabs(now - b[i]));
            b[i] = now;
        }
        double most = largest(b, s->count);
        if (!isfinite(most)) break;
        if (change * q <= tolerance * most * (1 - q)) return IGI_OK;
        if (sweep % 64 == 63) IGI_TRY(igi_progress(ctx, 0)); /* cancelled? */
    }
    return no_answer(ctx);
}

static igi_status shoot(igi_context *ctx, const igi_radiosity_system *s, double tolerance,
                        double *b)
{
    double q = reflected_most(s), *unshot;
    igi_status status = IGI_OK;
    IGI_TRY(IGI_ALLOC(ctx, s->count, &unshot));
    memcpy(unshot, s->sent, s->count * sizeof *unshot);
    memcpy(b, s->sent, s->count * sizeof *b);
    for (size_t shot = 0;; shot++) {
        size_t from = 0;
        for (size_t i = 1; i < s->count; i++)
            if (s->areas[i] * fabs(unshot[i]) > s->areas[from] * fabs(unshot[from])) from = i;
        if (shot % s->count == 0) { /* what is left can add its 1/(1-q)-fold at most */
            double left = largest(unshot, s->count), most = largest(b, s->count);
            if (!isfinite(most) || shot / s->count >= MAX_SWEEPS) {
                status = no_answer(ctx);
                break;
            }
            if (left * q <= tolerance * (1 - q) * most) break;
            IGI_TRY_GOTO(igi_progress(ctx, 0));
        }
        double amount = unshot[from];
        unshot[from] = 0;
        for (size_t j = 0; j < s->count; j++) {
            double arrives = s->albedo[j] * s->factors[j * s->count + from] * amount;
            unshot[j] += arrives;
            b[j] += arrives;
        }
    }
cleanup:
    igi_free(unshot);
    return status;
}

/* Solves m x = x in place; false when m is singular to working precision. Destroys m. */
static bool eliminate(double *m, double *x, size_t n)
{
    for (size_t k = 0; k < n; k++) {
        size_t pivot = k;
        for (size_t i = k + 1; i < n; i++)
            if (fabs(m[i * n + k]) > fabs(m[pivot * n + k])) pivot = i;
        if (!(fabs(m[pivot * n + k]) > 1e-12)) return false;
        for (size_t j = k; j < n && pivot != k; j++) {
            double swap = m[k * n + j];
            m[k * n + j] = m[pivot * n + j];
            m[pivot * n + j] = swap;
        }
        double swap = x[k];
        x[k] = x[pivot];
        x[pivot] = swap;
        for (size_t i = k + 1; i < n; i++) {
            double factor = m[i * n + k] / m[k * n + k];
            if (factor == 0) continue;
            for (size_t j = k + 1; j < n; j++) m[i * n + j] -= factor * m[k * n + j];
            x[i] -= factor * x[k];
        }
    }
    for (size_t k = n; k-- > 0;) {
        for (size_t j = k + 1; j < n; j++) x[k] -= m[k * n + j] * x[j];
        x[k] /= m[k * n + k];
    }
    return true;
}

static igi_status solve_directly(igi_context *ctx, const igi_radiosity_system *s, double *b)
{
    double *m;
    IGI_TRY(IGI_ALLOC(ctx, s->count * s->count, &m));
    for (size_t i = 0; i < s->count; i++)
        for (size_t j = 0; j < s->count; j++)
            m[i * s->count + j] = (i == j) - s->albedo[i] * s->factors[i * s->count + j];
    memcpy(b, s->sent, s->count * sizeof *b);
    bool solved = eliminate(m, b, s->count) && isfinite(largest(b, s->count));
    igi_free(m);
    /* Light that grows at every bounce has an algebraic answer, with darkness below zero in it. */
    double most = solved ? largest(b, s->count) : 0;
    for (size_t i = 0; i < s->count; i++)
        if (s->sent[i] >= 0 && b[i] < -1e-6 * most) solved = false;
    return solved ? IGI_OK : no_answer(ctx);
}

igi_status igi_radiosity_solve(igi_context *ctx, const igi_radiosity_system *system,
                               igi_radiosity_way way, double *radiosity)
{
    double tolerance = system->tolerance > 0 ? system->tolerance : 1e-9;
    if (system->count == 0) return IGI_OK;
    switch (way) {
    case IGI_RADIOSITY_GAUSS_SEIDEL: return gather(ctx, system, tolerance, radiosity);
    case IGI_RADIOSITY_SHOOTING: return shoot(ctx, system, tolerance, radiosity);
    case IGI_RADIOSITY_LU: return solve_directly(ctx, system, radiosity);
    }
    return igi_fail(ctx, IGI_E_USAGE, "radiosity: there is no way number %d", (int)way);
}
