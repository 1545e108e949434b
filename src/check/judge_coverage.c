/* SPDX-License-Identifier: Apache-2.0
 *
 * What is not seen: regions, surroundings, highlights; and what that does to errors.
 */
#include "check/judge.h"

#include <math.h>
#include <stdio.h>

#define HARDLY 0.2 /* a region of which less is seen is not judged */
#define UNSEEN_AREA 0.1
#define SURROUNDINGS 0.1
#define FEW_HIGHLIGHTS 3
#define AMPLIFIED 10.0
#define SMALL 1e-3 /* of the room's area: no photograph is asked for */

static double total_area(const igi_check *check)
{
    double sum = 0;
    for (size_t r = 0; r < check->region_count; r++) sum += check->regions[r].area;
    return sum;
}

static igi_status judge_observed(const igi_case *c)
{
    igi_assumption *a = igi_case_add(c, "observed");
    const igi_check *check = c->check;
    size_t unseen = 0, hardly = 0, surfaces = 0;
    double largest = 0;
    igi_advice advice;
    for (size_t r = 0; r < check->region_count; r++) {
        const igi_region_check *region = &check->regions[r];
        if (region->emitter) continue;
        surfaces++;
        unseen += region->views == 0;
        hardly += region->views > 0 && region->observed < HARDLY;
        if (region->observed < HARDLY && region->area * (1 - region->observed) > largest) {
            largest = region->area * (1 - region->observed);
            a->region = (int)r;
        }
    }
    if (unseen == surfaces) {
        IGI_TRY(igi_case_find(c, a, IGI_FAILS, 0, "no photograph shows any surface"));
        return igi_case_remedy(c, a, NULL, "check that mesh and cameras share one frame");
    }
    bool holds = unseen + hardly == 0 && check->unseen_area <= UNSEEN_AREA;
    char poor[96] = "";
    if (unseen + hardly > 0)
        snprintf(poor, sizeof poor, "; of %zu regions %zu are not seen at all, %zu hardly",
                 surfaces, unseen, hardly);
    IGI_TRY(igi_case_find(c, a, holds ? IGI_HOLDS : IGI_DOUBTFUL, check->unseen_area,
                          "%.1f %% of the surface is in no photograph%s%s%s%s",
                          100 * check->unseen_area, poor, a->region >= 0 ? " (largest: '" : "",
                          a->region >= 0 ? check->regions[a->region].name : "",
                          a->region >= 0 ? "')" : ""));
    if (holds) return IGI_OK;
    IGI_TRY(igi_advise_unseen(c->ctx, c->survey, a->region, &advice));
    if (advice.gain == 0)
        return igi_case_remedy(c, a, NULL,
                               "no place in sight of the cameras shows it; its albedo will be a "
                               "guess, as its error bar says");
    return igi_case_remedy(c, a, &advice, "it would show %.0f %% of what is missing%s%s%s",
                           100 * advice.gain, a->region >= 0 ? " of '" : "",
                           a->region >= 0 ? check->regions[a->region].name : "",
                           a->region >= 0 ? "'" : "");
}

static igi_status judge_surroundings(const igi_case *c)
{
    igi_assumption *a = igi_case_add(c, "surroundings");
    double sum = 0, weights = 0, worst = 0;
    igi_advice advice;
    for (size_t r = 0; r < c->check->region_count; r++) {
        const igi_region_check *region = &c->check->regions[r];
        if (region->emitter || isnan(region->unseen)) continue;
        sum += region->area * region->observed * region->unseen;
        weights += region->area * region->observed;
        if (region->unseen <= worst) continue;
        worst = region->unseen;
        a->region = (int)r;
    }
    double share = weights > 0 ? sum / weights : 1;
    IGI_TRY(igi_case_find(c, a, share > SURROUNDINGS ? IGI_DOUBTFUL : IGI_HOLDS, share,
                          "%.1f %% of what the seen surfaces face is not seen itself%s%s%s",
                          100 * share, a->region >= 0 ? " (most: '" : "",
                          a->region >= 0 ? c->check->regions[a->region].name : "",
                          a->region >= 0 ? "')" : ""));
    if (share <= SURROUNDINGS) return IGI_OK;
    IGI_TRY(igi_advise_unseen(c->ctx, c->survey, -1, &advice));
    if (advice.gain == 0)
        return igi_case_remedy(c, a, NULL,
                               "no place in sight of the cameras shows it; it will be solved for");
    return igi_case_remedy(c, a, &advice, "it would show %.0f %% of what is missing",
                           100 * advice.gain);
}

static igi_status judge_highlights(const igi_case *c)
{
    igi_assumption *a = igi_case_add(c, "highlights");
    const igi_check *check = c->check;
    size_t without = 0, surfaces = 0;
    double largest = 0, all = total_area(check);
    igi_advice advice;
    for (size_t r = 0; r < check->region_count; r++) {
        const igi_region_check *region = &check->regions[r];
        if (region->emitter || region->views == 0) continue;
        surfaces++;
        if (region->highlights_seen >= FEW_HIGHLIGHTS) continue;
        without++;
        if (region->area <= largest) continue;
        largest = region->area;
        a->region = (int)r;
    }
    IGI_TRY(igi_case_find(c, a, without ? IGI_DOUBTFUL : IGI_HOLDS, (double)without,
                          "of %zu of %zu regions seen, no photograph shows where it would mirror a "
                          "lamp%s%s%s",
                          without, surfaces, without ? " (largest: '" : "",
                          without ? check->regions[a->region].name : "", without ? "')" : ""));
    if (without == 0) return IGI_OK;
    advice.gain = 0;
    if (largest > SMALL * all) IGI_TRY(igi_advise_highlight(c->ctx, c->survey, a->region, &advice));
    return igi_case_remedy(c, a, &advice, "if '%s' is glossy, %s", check->regions[a->region].name,
                           advice.gain > 0 ? "a highlight shows there"
                                           : "its lobe cannot be told; move a lamp or the camera");
}

static igi_status judge_condition(const igi_case *c)
{
    igi_assumption *a = igi_case_add(c, "conditioned");
    double relit = c->check->amplification, unseen = c->check->unseen_condition;
    if (isnan(relit)) {
        IGI_TRY(igi_case_find(c, a, IGI_DOUBTFUL, relit,
                              "cannot be checked while a light's power is unknown"));
        return igi_case_remedy(c, a, NULL, "give the powers of the lights");
    }
    bool holds = relit <= AMPLIFIED;
    IGI_TRY(igi_case_find(c, a, holds ? IGI_HOLDS : IGI_DOUBTFUL, relit,
                          "an error of albedo grows %.1f times in relit pictures, an error of what "
                          "is unseen %.2f times",
                          relit, unseen));
    if (holds) return IGI_OK;
    return igi_case_remedy(c, a, NULL,
                           "in so white a room, recover with a smaller --target-error, and "
                           "check relit pictures");
}

igi_status igi_judge_coverage(const igi_case *c)
{
    IGI_TRY(judge_observed(c));
    IGI_TRY(judge_surroundings(c));
    IGI_TRY(judge_highlights(c));
    return judge_condition(c);
}
