/* SPDX-License-Identifier: Apache-2.0
 *
 * How far the cells of each region lie from the equation, and which lie too far. Few cells say
 * little, and lean on the other regions: on their harmonic mean, lest a textured region speak for
 * a plain one.
 */
#include "diffuse/powers_private.h"

#include <string.h>

#define LEAST_SCATTER 1e-8
#define SHRINKING 4.0    /* so many cells' worth of the other regions' scatter */
#define OUTLIER_SIGMAS 4 /* beyond that a cell counts less (Huber) */

void igi_powers_weigh(igi_powers *p)
{
    double pooled = 0, pooled_cells = 0;
    memset(p->misfits, 0, p->regions * p->bands * sizeof *p->misfits);
    for (size_t cell = 0; cell < p->cells.count; cell++)
        for (size_t b = 0; b < p->bands; b++) {
            double d = igi_power_misfit(p, cell, b);
            p->misfits[p->cells.region[cell] * p->bands + b] += p->size[cell] * d * d *
                                                                p->trust[cell * p->bands + b];
        }
    for (size_t at = 0; at < p->regions * p->bands; at++) {
        double cells = (double)p->cells.of_region[at / p->bands];
        if (cells < 2) continue;
        pooled += cells * cells / fmax(p->misfits[at], LEAST_SCATTER * cells);
        pooled_cells += cells;
    }
    double common = pooled > 0 ? pooled_cells / pooled : IGI_FIRST_SCATTER;
    for (size_t at = 0; at < p->regions * p->bands; at++) {
        double cells = (double)p->cells.of_region[at / p->bands];
        p->scatter[at] = fmax(LEAST_SCATTER, (p->misfits[at] + SHRINKING * common) /
                                                 (fmax(cells - 1, 0) + SHRINKING));
    }
    for (size_t k = 0; k < p->cells.count * p->bands; k++) {
        size_t cell = k / p->bands, at = p->cells.region[cell] * p->bands + k % p->bands;
        double sigmas = fabs(igi_power_misfit(p, cell, k % p->bands)) *
                        sqrt(p->size[cell] / p->scatter[at]);
        p->trust[k] = sigmas > OUTLIER_SIGMAS ? OUTLIER_SIGMAS / sigmas : 1;
    }
}
