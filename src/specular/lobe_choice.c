/* SPDX-License-Identifier: Apache-2.0 */
#include "specular/lobe_choice.h"

#include <math.h>

/* What a lobe must gain in -2 ln likelihood: in all, and of every residual. On surfaces without a
 * lobe, errors of the irradiance feign up to .03 of a residual; the faintest true lobe of the cubical
 * room gains .2, then .05. */
#define MIN_GAIN 20
#define GAIN_SHARE 0.04
#define MIN_SIGMAS 4
#define HINT_SHARE 0.03
#define HINT_NOISE 0.2
#define SHARP_SHARE 0.01

bool igi_lobe_is_hinted(const igi_lobe_estimate *e)
{
    if (e->plain_noise > HINT_NOISE) return true; /* no diffuse surface looks like this */
    return e->plain_deviance - e->deviance > HINT_SHARE * e->residuals;
}

/* Is the lobe asked for? It must gain more than what the noise of S is
 * excused for, far more likelihood than chance gives (BIC), more than errors
 * of the irradiance could feign (a share of every residual), and have a width of its own. */
static bool is_earned(const igi_lobe_estimate *e)
{
    double gain = e->plain_deviance - e->deviance;
    return gain > e->excused && gain > MIN_GAIN + 2 * log(fmax(e->residuals, 1)) &&
           gain > GAIN_SHARE * e->residuals && !e->at_bound &&
           e->specular > MIN_SIGMAS * e->noise_std;
}

/* A later model must be better by more than the noise of such differences, which for sharp lobes is
 * that of S: a share of all that the lobe explains; and a lobe that ran into
 * an end of what is looked for is none. */
static bool is_better(const igi_lobe_estimate *later, const igi_lobe_estimate *best)
{
    if (later->at_bound != best->at_bound) return best->at_bound;
    double margin = igi_lobe_margin(later);
    if (best->alpha < (double)IGI_SHARP_ALPHA)
        margin += SHARP_SHARE * fmax(0, best->plain_deviance - best->deviance);
    return later->deviance < best->deviance - margin;
}

/* The family that fits best beside the chosen one, unless it fits worse by more than the margin. */
static void find_alike(const igi_lobe_estimate *found, size_t count, igi_lobe_estimate *best)
{
    double least = best->deviance + igi_lobe_margin(best);
    for (size_t i = 0; i < count; i++) {
        if (found[i].model == best->model || found[i].at_bound || found[i].deviance > least)
            continue;
        least = found[i].deviance;
        best->alike = found[i].model;
        best->alike_alpha = found[i].alpha;
    }
}

void igi_lobe_choose(const igi_lobe_estimate *found, size_t count, igi_lobe_estimate *best)
{
    const igi_lobe_estimate *broad = NULL;
    *best = found[0];
    for (size_t i = 0; i < count; i++) {
        /* the margin is to tell families apart, not whether there is a lobe at all */
        bool first = !is_earned(best) && is_earned(&found[i]);
        if (first || is_better(&found[i], best)) *best = found[i];
        if (found[i].at_bound && (!broad || found[i].deviance < broad->deviance)) broad = &found[i];
    }
    find_alike(found, count, best);
    if (!broad || best->at_bound) return;
    if (best->deviance <= broad->deviance - igi_lobe_margin(best)) return;
    best->broader = broad->model;
    best->broader_specular = broad->specular;
    best->broader_alpha = broad->alpha;
}

void igi_lobe_allow_for_broader(igi_lobe_estimate *e, const igi_lobe_estimate *first)
{
    e->broader = first->broader;
    if (e->broader == IGI_LAMBERT) return;
    e->specular_std = hypot(e->specular_std, first->broader_specular - e->specular);
    e->alpha_std = hypot(e->alpha_std, first->broader_alpha - e->alpha);
}

void igi_lobe_take(igi_lobe_estimate *e, int bands, igi_lobe *lobe)
{
    bool earned = is_earned(e);
    if (!earned) e->model = IGI_LAMBERT;
    lobe->model = e->model;
    lobe->alpha = (float)e->alpha;
    for (int b = 0; b < bands; b++)
        lobe->specular[b] = earned ? (float)igi_lobe_coefficient(e, b) : 0;
}
