/* SPDX-License-Identifier: Apache-2.0
 *
 * With x_c = pi L_c and E_c(s) the irradiance of cell c for lights at s with powers v,
 *     f_c = x_c t_r / E_c - 1,        t_r = sum u / sum u x/E over the region,
 * falls by (d ln E_c - its mean over the region), with d ln E_c / d ln v_l = v_l G_cl / E_c and
 *     d ln E_c / d s_lk = v_l (G_cl(s + h e_k / 2) - G_cl(s - h e_k / 2)) / h E_c:
 * albedos are eliminated, powers stand in the same small system. A shadow's edge moves with the
 * light: over a cell's many points the difference is smooth. Errors as in powers_finish.c.
 */
#include "diffuse/positions_private.h"

#include "base/solve.h"

#include <string.h>

#define OUTLIER_SIGMAS 4 /* beyond that a cell counts less (Huber) */
#define SHRINKING 4.0    /* so many cells' worth of the other regions' scatter */
#define LEAST_SCATTER 1e-8
#define POWER_STD 1.0 /* relative, of a power before anything is known */

/* E of a cell, and its derivatives by the columns over E. */
static double irradiance(const igi_positions *p, size_t cell, size_t b, double *gains)
{
    const igi_light *lights = p->problem->lights;
    const double *direct = p->direct + cell * p->problem->light_count;
    double e = p->received[cell * p->bands + b], h = (double)p->problem->patches->size_m;
    for (size_t l = 0; l < p->problem->light_count; l++) e += lights[l].value[b] * direct[l];
    e = fmax(e, 1e-6 * p->reflected[cell * p->bands + b]);
    memset(gains, 0, p->columns * sizeof *gains);
    for (size_t k = 0; k < p->count && e > 0; k++) {
        const double *g = &p->moved[(cell * p->count + k) * IGI_PLACE_STEPS];
        double v = lights[p->light[k]].value[b] / (h * e);
        for (size_t i = 0; i < 3; i++) gains[3 * k + i] = v * (g[1 + 2 * i] - g[2 + 2 * i]);
    }
    for (size_t n = 0; n < p->power_count && e > 0; n++) {
        const igi_place_power *w = &p->powers[n];
        if (w->band < 0 || (size_t)w->band == b)
            gains[3 * p->count + n] = lights[w->light].value[b] * direct[w->light] / e;
    }
    return e;
}

static double weight_of(const igi_positions *p, size_t cell, size_t b)
{
    return p->size[cell] * p->trust[cell * p->bands + b] / p->scatter[p->cells.region[cell]];
}

/* 1 / albedo and the mean gains of each region and band. */
static void average(igi_positions *p)
{
    size_t n = p->columns, k = p->regions * p->bands;
    double *weights = p->sums;
    memset(p->inverse, 0, k * sizeof *p->inverse);
    memset(p->share, 0, k * n * sizeof *p->share);
    memset(weights, 0, k * sizeof *weights);
    for (size_t cell = 0; cell < p->cells.count; cell++)
        for (size_t b = 0; b < p->bands; b++) {
            size_t at = p->cells.region[cell] * p->bands + b;
            double e = irradiance(p, cell, b, p->gains);
            double w = weight_of(p, cell, b);
            if (!(e > 0)) continue;
            weights[at] += w;
            p->inverse[at] += w * p->reflected[cell * p->bands + b] / e;
            for (size_t v = 0; v < n; v++) p->share[at * n + v] += w * p->gains[v];
        }
    for (size_t at = 0; at < k; at++) {
        p->inverse[at] = p->inverse[at] > 0 ? weights[at] / p->inverse[at] : 0;
        for (size_t v = 0; v < n && weights[at] > 0; v++) p->share[at * n + v] /= weights[at];
    }
}

/* A cell's misfit, and by how much it falls with each column. */
static double misfit(const igi_positions *p, size_t cell, size_t b, double *gains)
{
    size_t at = p->cells.region[cell] * p->bands + b;
    double e = irradiance(p, cell, b, gains);
    if (!(e > 0 && p->inverse[at] > 0)) {
        memset(gains, 0, p->columns * sizeof *gains);
        return 0;
    }
    for (size_t v = 0; v < p->columns; v++) gains[v] -= p->share[at * p->columns + v];
    return p->reflected[cell * p->bands + b] * p->inverse[at] / e - 1;
}

/* How far the cells of each region lie from the equation, leaning on the others where they are few,
 * and which lie too far. */
static void weigh(igi_positions *p)
{
    double pooled = 0, all = 0, *sum = p->sums;
    memset(sum, 0, p->regions * sizeof *sum);
    for (size_t cell = 0; cell < p->cells.count; cell++)
        for (size_t b = 0; b < p->bands; b++) {
            double f = misfit(p, cell, b, p->gains);
            sum[p->cells.region[cell]] += p->size[cell] * p->trust[cell * p->bands + b] * f * f;
        }
    for (size_t r = 0; r < p->regions; r++) {
        double n = (double)(p->cells.of_region[r] * p->bands);
        if (p->cells.of_region[r] < 2) continue;
        pooled += n * n / fmax(sum[r], LEAST_SCATTER);
        all += n;
    }
    double common = pooled > 0 ? all / pooled : 1;
    for (size_t r = 0; r < p->regions; r++) {
        double n = (double)(p->cells.of_region[r] * p->bands);
        p->scatter[r] = fmax(LEAST_SCATTER, (sum[r] + SHRINKING * common) /
                                                (fmax(n - (double)p->bands, 0) + SHRINKING));
    }
    for (size_t cell = 0; cell < p->cells.count; cell++)
        for (size_t b = 0; b < p->bands; b++) {
            double sigmas = fabs(misfit(p, cell, b, p->gains)) *
                            sqrt(p->size[cell] / p->scatter[p->cells.region[cell]]);
            p->trust[cell * p->bands + b] = sigmas > OUTLIER_SIGMAS ? OUTLIER_SIGMAS / sigmas : 1;
        }
}

static void add_prior(igi_positions *p)
{
    size_t n = p->columns;
    memset(p->matrix, 0, n * n * sizeof *p->matrix);
    memset(p->right, 0, n * sizeof *p->right);
    for (size_t v = 0; v < n; v++) {
        double std = v < 3 * p->count ? p->prior_std[v / 3] : POWER_STD;
        p->matrix[v * (n + 1)] = 1 / (std * std);
        if (v < 3 * p->count)
            p->right[v] = (p->prior[v / 3][v % 3] -
                           p->problem->lights[p->light[v / 3]].position[v % 3]) /
                          (std * std);
    }
}

bool igi_positions_step(igi_positions *p, bool adapts, double *steps)
{
    size_t n = p->columns;
    average(p);
    if (adapts) weigh(p);
    if (adapts) average(p);
    add_prior(p);
    for (size_t cell = 0; cell < p->cells.count; cell++)
        for (size_t b = 0; b < p->bands; b++) {
            double f = misfit(p, cell, b, p->gains), w = weight_of(p, cell, b);
            for (size_t v = 0; v < n; v++) {
                p->right[v] += w * p->gains[v] * f;
                for (size_t m = 0; m < n; m++)
                    p->matrix[v * n + m] += w * p->gains[v] * p->gains[m];
            }
        }
    memcpy(p->factor, p->matrix, n * n * sizeof *p->matrix);
    memcpy(steps, p->right, n * sizeof *steps);
    return igi_solve_cholesky(p->factor, n, steps, 1);
}

bool igi_positions_covariance(igi_positions *p)
{
    size_t n = p->columns;
    double *s = p->covariance, *score = p->right;
    for (size_t v = 0; v < n * n; v++) s[v] = 0;
    for (size_t v = 0; v < n; v++) {
        double std = v < 3 * p->count ? p->prior_std[v / 3] : POWER_STD;
        s[v * (n + 1)] = 1 / (std * std);
    }
    for (size_t cell = 0; cell < p->cells.count; cell++) {
        memset(score, 0, n * sizeof *score);
        for (size_t b = 0; b < p->bands; b++) {
            double f = misfit(p, cell, b, p->gains), w = weight_of(p, cell, b);
            if (w > 0) f = copysign(fmax(fabs(f), 1 / sqrt(w)), f); /* few may fit by luck */
            for (size_t v = 0; v < n; v++) score[v] += w * f * p->gains[v];
        }
        for (size_t v = 0; v < n; v++)
            for (size_t m = 0; m < n; m++) s[v * n + m] += score[v] * score[m];
    }
    memset(score, 0, n * sizeof *score); /* where the noise of gathered light draws them to */
    for (size_t cell = 0; cell < p->cells.count; cell++)
        for (size_t b = 0; b < p->bands; b++) {
            double e = irradiance(p, cell, b, p->gains), w = weight_of(p, cell, b);
            for (size_t v = 0; v < n && e > 0; v++)
                score[v] += w * p->gains[v] * p->noise[cell * p->bands + b] / (e * e);
        }
    for (size_t v = 0; v < n; v++)
        for (size_t m = 0; m < n; m++) s[v * n + m] += score[v] * score[m];
    return igi_solve_sandwich(p->matrix, p->factor, n, s);
}
