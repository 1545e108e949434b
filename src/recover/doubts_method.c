/* SPDX-License-Identifier: Apache-2.0
 *
 * What the chosen method leaves out of its error bars. Light from surfaces that no photograph shows is a
 * guess: `patches` asks what the guess does to every albedo, the others do not. `direct` knows no light
 * from surfaces at all.
 */
#include "recover/doubt.h"

#define WORTH_A_WORD 0.01 /* of the surface */

/* Share of the surface that belongs to regions which nothing determines; the largest of them. */
static double guessed_share(const igi_problem *p, const igi_materials *m, size_t *largest)
{
    double all = 0, guessed = 0, most = 0;
    for (size_t r = 0; r < m->count; r++) {
        double area = igi_doubt_area(&p->scene->mesh, r);
        all += area;
        if (m->materials[r].determined || m->materials[r].emitter) continue;
        guessed += area;
        if (area > most) *largest = r;
        most = fmax(most, area);
    }
    return all > 0 ? guessed / all : 0;
}

static igi_status say(igi_context *ctx, const igi_problem *p, double share, size_t region,
                      igi_materials *m)
{
    char *sentence;
    IGI_TRY(igi_strprintf(ctx, &sentence,
                          "no photograph shows %.0f %% of the surface (most of it '%s'): the light "
                          "that it sends is a guess, and the error bars of --method %s do not hold "
                          "that; those of --method patches do",
                          fmax(1, 100 * share), m->materials[region].region,
                          igi_method_name(p->options->method)));
    return igi_doubt_say(ctx, m, sentence);
}

igi_status igi_doubt_method(igi_context *ctx, const igi_problem *p, igi_materials *m)
{
    size_t largest = 0;
    if (p->options->method == IGI_METHOD_PATCHES) return IGI_OK;
    if (p->options->method == IGI_METHOD_DIRECT) {
        char *sentence;
        IGI_TRY(igi_strdup(ctx,
                           "--method direct takes light from other surfaces for albedo, and its "
                           "error bars do not hold that: it is there to be compared with",
                           &sentence));
        return igi_doubt_say(ctx, m, sentence);
    }
    double share = guessed_share(p, m, &largest);
    return share > WORTH_A_WORD ? say(ctx, p, share, largest, m) : IGI_OK;
}
