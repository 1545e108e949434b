/* SPDX-License-Identifier: Apache-2.0
 *
 * What the places of lights leave open, in albedos and powers.
 */
#include "diffuse/positions_private.h"

#include <math.h>

void igi_positions_widen(const igi_positions *p, const igi_problem *problem, igi_diffuse *diffuse)
{
    size_t n = p ? p->columns : 0;
    for (size_t at = 0; p && at < p->regions * p->bands; at++) {
        size_t r = at / p->bands, b = at % p->bands;
        const double *share = p->share + at * n;
        double variance = 0;
        for (size_t v = 0; v < n; v++)
            for (size_t m = 0; m < n; m++)
                variance += share[v] * share[m] * p->covariance[v * n + m];
        if (diffuse->determined[r])
            diffuse->albedo_std[r][b] = hypot(diffuse->albedo_std[r][b],
                                              diffuse->albedo[r][b] * sqrt(fmax(0, variance)));
    }
    for (size_t k = 0; p && k < p->power_count; k++) {
        size_t v = 3 * p->count + k, light = p->powers[k].light;
        double relative = sqrt(fmax(0, p->covariance[v * (n + 1)]));
        for (size_t b = 0; b < p->bands; b++)
            if (p->powers[k].band < 0 || (size_t)p->powers[k].band == b)
                problem->light_std[light][b] = hypot(problem->light_std[light][b],
                                                     relative * problem->lights[light].value[b]);
    }
}
