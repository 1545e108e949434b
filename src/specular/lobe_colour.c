/* SPDX-License-Identifier: Apache-2.0
 *
 * At a given roughness each band has its own linear problem (lobe_profile.c):
 *     rho_b = <y_perp, S_perp>_b / <S_perp, S_perp>_b,
 * and beside one coefficient for all bands, chi^2 falls by
 *     sum_b <y_perp, S_perp>_b^2 / <S_perp, S_perp>_b - <y_perp, S_perp>^2 / <S_perp, S_perp>.
 */
#include "specular/lobe_colour.h"

#define LEAST_TINT 1e-3 /* a band without any lobe would tell nothing of its own error */

/* <S_perp, y_perp> and <S_perp, S_perp> of one band. */
static void project(const igi_profile *f, const igi_profile_column *c, size_t b, double *ys,
                    double *ss)
{
    *ys = *ss = 0;
    for (size_t i = 0; i < f->n; i++) {
        size_t k = i * f->bands + b, at = i * c->stride + b;
        const double *g = f->sums + 3 * (f->h->group[i] * f->bands + b);
        double w = (double)f->weight[k], s = (double)c->scale[at], y = (double)f->h->radiance[k];
        double along = g[0] > 0 ? (double)f->h->irradiance[k] / IGI_PI * g[2] / g[0] : 0;
        if (c->base) y -= (double)c->base[at];
        *ys += w * (s - along) * y;
        *ss += w * ((s - along) * s - (c->noise ? (double)(f->bias[k] * c->noise[at]) : 0));
    }
}

void igi_lobe_colour_look(const igi_profile *f, const igi_profile_column *c,
                          igi_lobe_colour *colour)
{
    double all_ys = 0, all_ss = 0, mean = 0;
    double *tint = colour->tint;
    colour->gain = 0;
    for (size_t b = 0; b < f->bands; b++) {
        double ys, ss;
        project(f, c, b, &ys, &ss);
        tint[b] = ss > 0 ? fmax(0, ys / ss) : 0;
        mean += tint[b] / (double)f->bands;
        colour->gain += tint[b] * ys;
        all_ys += ys;
        all_ss += ss;
    }
    if (all_ss > 0 && all_ys > 0) colour->gain -= all_ys * all_ys / all_ss;
    for (size_t b = 0; b < f->bands; b++) tint[b] = mean > 0 ? fmax(LEAST_TINT, tint[b] / mean) : 1;
}

double igi_lobe_colour_margin(const igi_lobe_estimate *e, int bands)
{
    return igi_lobe_margin(e) + (bands - 1) * log(fmax(e->residuals, 1));
}
