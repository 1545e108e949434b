/* SPDX-License-Identifier: Apache-2.0
 *
 * What the solved powers cannot be told apart from, in a sentence a light: other lights whose errors
 * undo its own, and the regions whose albedo goes the other way when its power goes up.
 */
#include "diffuse/powers_private.h"

#include <stdio.h>

/* One standard deviation, relative, from which on a power is named as open: below it, powers were within 1.7 %
 * in scripts/light_powers' rooms 1 to 13. */
#define UNSURE 0.015
#define TIED 0.9    /* correlation of lights that cannot be told apart */
#define FOLLOWS 0.5 /* per cent by which an albedo falls, for one per cent of a light's value */
#define MOST_NAMED 4

static igi_status append(igi_context *ctx, char **text, const char *between, const char *word,
                         const char *after)
{
    char *longer;
    IGI_TRY(igi_strprintf(ctx, &longer, "%s%s%s%s", *text ? *text : "", between, word, after));
    igi_free(*text);
    *text = longer;
    return IGI_OK;
}

/* "lights[2] ('lamp')" */
static igi_status append_light(igi_context *ctx, const igi_powers *p, size_t light,
                               const char *between, char **text)
{
    int region = p->problem->lights[light].region;
    char number[32];
    snprintf(number, sizeof number, "lights[%zu]", p->problem->light_of[light]);
    IGI_TRY(append(ctx, text, between, number, ""));
    if (region < 0) return IGI_OK;
    return append(ctx, text, " ('", p->problem->scene->regions[region].name, "')");
}

static igi_status append_rivals(igi_context *ctx, const igi_power_outcome *o, size_t variable,
                                char **text)
{
    const igi_powers *p = o->p;
    size_t n = p->count, named = 0;
    for (size_t m = 0; m < n && named < MOST_NAMED; m++) {
        const igi_power_variable *other = &p->variables[m];
        if (other->light == p->variables[variable].light || !(other->unit > 0)) continue;
        double stds = igi_power_std(o, variable) * igi_power_std(o, m);
        if (!(o->covariance[variable * n + m] < -TIED * stds)) continue;
        const char *between = named++ ? ", " : "; it can hardly be told from ";
        IGI_TRY(append_light(ctx, p, other->light, between, text));
    }
    return IGI_OK;
}

/* Does the albedo of the region undo what this variable is wrong by? */
static bool region_follows(const igi_power_outcome *o, size_t variable, size_t region)
{
    const igi_powers *p = o->p;
    size_t n = p->count;
    double variance = o->covariance[variable * (n + 1)], value = p->variables[variable].value;
    for (size_t b = 0; b < p->bands; b++) {
        size_t at = region * p->bands + b;
        double change = 0;
        if (!igi_power_in_band(&p->variables[variable], b)) continue;
        for (size_t m = 0; m < n; m++)
            change += p->mean_gain[at * n + m] * o->covariance[m * n + variable] / variance * value;
        if (change > FOLLOWS) return true;
    }
    return false;
}

static igi_status append_regions(igi_context *ctx, const igi_power_outcome *o, size_t variable,
                                 char **text)
{
    const igi_powers *p = o->p;
    size_t all = 0;
    for (size_t r = 0; r < p->regions; r++) {
        if (!region_follows(o, variable, r) || all++ >= MOST_NAMED) continue;
        const char *between = all == 1 ? "; its strength trades against the albedo of '" : ", '";
        IGI_TRY(append(ctx, text, between, p->problem->scene->regions[r].name, "'"));
    }
    if (all <= MOST_NAMED) return IGI_OK;
    char number[32];
    snprintf(number, sizeof number, "%zu", all - MOST_NAMED);
    return append(ctx, text, " and ", number, " more");
}

static double relative_std(const igi_power_outcome *o, size_t variable)
{
    return igi_power_std(o, variable) / fmax(o->p->variables[variable].value, 1e-3);
}

/* The band in which the light is known worst. */
static size_t worst_variable(const igi_power_outcome *o, size_t first)
{
    const igi_powers *p = o->p;
    size_t worst = first;
    for (size_t v = first; v < p->count && p->variables[v].light == p->variables[first].light; v++)
        if (relative_std(o, v) > relative_std(o, worst)) worst = v;
    return worst;
}

igi_status igi_power_explain(igi_context *ctx, const igi_power_outcome *o, size_t first,
                             igi_diffuse *diffuse)
{
    const igi_powers *p = o->p;
    char *text = NULL, per_cent[32];
    igi_status status = IGI_OK;
    size_t v = worst_variable(o, first), light = p->variables[v].light;
    bool is_lamp = p->problem->lights[light].type == IGI_LIGHT_AREA;
    if (p->variables[v].unit > 0 && relative_std(o, v) < UNSURE) return IGI_OK;
    IGI_TRY_GOTO(append_light(ctx, p, light, "", &text));
    if (!(p->variables[v].unit > 0))
        IGI_TRY_GOTO(append(ctx, &text, ": ",
                            "its power is unknown, and it lights nothing that photographs show",
                            ""));
    else {
        snprintf(per_cent, sizeof per_cent, "%.2g", 100 * relative_std(o, v));
        IGI_TRY_GOTO(append(ctx, &text, ": its power is known to within ", per_cent, " % only"));
        IGI_TRY_GOTO(append_rivals(ctx, o, v, &text));
        IGI_TRY_GOTO(append_regions(ctx, o, v, &text));
    }
    IGI_TRY_GOTO(append(ctx, &text, "; give its power, or ",
                        is_lamp ? "add a photograph that shows it shining"
                                : "add photographs of plain surfaces that it lights unevenly",
                        ""));
    status = igi_add_sentence(ctx, &diffuse->warnings, &diffuse->warning_count, text);
    text = NULL;
cleanup:
    igi_free(text);
    return status;
}
