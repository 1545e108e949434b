/* SPDX-License-Identifier: Apache-2.0
 *
 * The stated power of a light that no photograph shows, against what surfaces say of it. Where they say
 * nothing, it is believed as far as powers can be known, and albedos are open by as much.
 */
#include "recover/doubt.h"

#define OFF 0.04
#define OFF_SIGMAS 4.0
#define STATED 0.01 /* nobody states a power better */

static igi_status say(igi_context *ctx, const igi_light_shares *s, size_t k, igi_materials *m)
{
    char *sentence;
    double scale = s->scales[k], error = s->errors[k];
    if (!(fabs(scale) > fmax(OFF, OFF_SIGMAS * error))) return IGI_OK;
    IGI_TRY(igi_strprintf(ctx, &sentence,
                          "lights[%zu]: where it reaches surfaces, they are as bright as if it had "
                          "%.3g +- %.2g times the power that is stated: check its power and its "
                          "place, and that no light is missing; or leave its power out to have it "
                          "solved",
                          s->p->light_of[s->lights[k]], fmax(0, 1 + scale), error));
    return igi_doubt_say(ctx, m, sentence);
}

igi_status igi_doubt_powers(igi_context *ctx, const igi_light_shares *s, igi_materials *m,
                            double *off)
{
    const igi_problem *p = s->p;
    for (size_t k = 0; k < s->light_count; k++) {
        const igi_light *light = &p->lights[s->lights[k]];
        if (igi_light_shares_shows(light->type) ||
            !p->scene->lights[p->light_of[s->lights[k]]].known)
            continue;
        IGI_TRY(say(ctx, s, k, m));
        double scale = s->scales[k], error = s->errors[k];
        double open = error * STATED / hypot(error, STATED);
        double wrong = sqrt(fmax(0, scale * scale - error * error) + open * open);
        for (size_t r = 0; r < s->regions; r++) off[r] = hypot(off[r], wrong * s->shares[r][k]);
    }
    return IGI_OK;
}
