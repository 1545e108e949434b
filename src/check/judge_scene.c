/* SPDX-License-Identifier: Apache-2.0
 *
 * The mesh, the lights, and whether light and photographs can be of one room.
 */
#include "check/judge.h"
#include "check/mesh_faults.h"

#include <math.h>

#define ESCAPED 0.002     /* a hole of which light says nothing */
#define LAMP_DOUBTFUL 0.1 /* ln of shown over given */
#define LAMP_FAILING 0.4
#define FAILING_ALBEDO 1.15
#define FAILING_SHARE 0.1 /* of the seen area */
#define ALBEDO 1.05       /* the estimate is good to some per cent */

static bool has_sky(const igi_scene *scene)
{
    for (size_t l = 0; l < scene->light_count; l++)
        if (scene->lights[l].type == IGI_LIGHT_ENV || scene->lights[l].type == IGI_LIGHT_AMBIENT)
            return true;
    return false;
}

static igi_status judge_closed(const igi_case *c)
{
    igi_assumption *a = igi_case_add(c, "closed");
    double escaped = 0, weights = 0, worst = 0;
    for (size_t r = 0; r < c->check->region_count; r++) {
        const igi_region_check *region = &c->check->regions[r];
        if (isnan(region->escaped) || region->emitter) continue;
        escaped += region->area * region->observed * region->escaped;
        weights += region->area * region->observed;
        if (region->escaped <= worst) continue;
        worst = region->escaped;
        a->region = (int)r;
    }
    escaped = weights > 0 ? escaped / weights : 0;
    if (has_sky(c->scene) || escaped <= ESCAPED)
        return igi_case_find(c, a, IGI_HOLDS, escaped,
                             "%.2f %% of what the surfaces face lies outside the mesh%s",
                             100 * escaped, escaped > ESCAPED ? ", where a light is given" : "");
    IGI_TRY(
        igi_case_find(c, a, IGI_DOUBTFUL, escaped,
                      "%.2f %% of what the surfaces face lies outside the mesh (most from '%s', "
                      "%.1f %%), and nothing says how bright it is there",
                      100 * escaped, c->check->regions[a->region].name, 100 * worst));
    return igi_case_remedy(c, a, NULL,
                           "close the mesh, or add an env or ambient light for what is outside; "
                           "if it is dark there, all is well");
}

static igi_status judge_faces(const igi_case *c)
{
    igi_assumption *a = igi_case_add(c, "mesh");
    igi_mesh_faults m;
    IGI_TRY(igi_mesh_faults_find(c->ctx, &c->scene->mesh, &m));
    c->check->doubled_faces = m.doubled;
    c->check->flipped_edges = m.flipped;
    size_t of = m.doubled ? m.first_doubled : m.first_flipped;
    if (m.doubled + m.flipped == 0)
        return igi_case_find(c, a, IGI_HOLDS, 0, "no face lies on another, none is turned around");
    a->region = (int)c->scene->mesh.regions[of];
    IGI_TRY(igi_case_find(c, a, IGI_DOUBTFUL, (double)(m.doubled + m.flipped),
                          "%zu faces lie on others, %zu edges join faces that face opposite ways "
                          "(first: triangle %zu of '%s')",
                          m.doubled, m.flipped, of, c->check->regions[a->region].name));
    return igi_case_remedy(c, a, NULL,
                           m.doubled ? "remove doubled faces; which of two regions a ray meets is "
                                       "chance"
                                     : "make normals consistent; it matters for lamps alone, which "
                                       "shine from their fronts");
}

/* How bright the photographs show a lamp whose power is given, in units of that; NaN: not seen. */
static double shown_over_given(const igi_case *c, size_t light)
{
    const igi_light *l = &c->scene->lights[light];
    double shown[IGI_MAX_BANDS], sum[2] = {0, 0};
    if (l->type != IGI_LIGHT_AREA || !l->known || !igi_survey_lamp(c->survey, l->region, shown))
        return (double)NAN;
    for (int b = 0; b < c->scene->bands; b++) {
        sum[0] += shown[b];
        sum[1] += l->value[b];
    }
    return sum[1] > 0 ? sum[0] / sum[1] : (double)NAN;
}

/* Of lamps that are given and seen, the one of which both disagree most. */
static igi_status compare_lamps(const igi_case *c, igi_assumption *a)
{
    size_t worst = 0;
    double ratio = 1;
    for (size_t l = 0; l < c->scene->light_count; l++) {
        double r = shown_over_given(c, l);
        if (!(r > 0) || fabs(log(r)) <= fabs(log(ratio))) continue;
        ratio = r;
        worst = l;
    }
    if (fabs(log(ratio)) < LAMP_DOUBTFUL) return IGI_OK;
    igi_free(a->finding);
    a->finding = NULL;
    a->region = c->scene->lights[worst].region;
    /* darker than given may be saturation; brighter cannot */
    IGI_TRY(igi_case_find(c, a, log(ratio) > LAMP_FAILING ? IGI_FAILS : IGI_DOUBTFUL, ratio,
                          "the photographs show '%s' %.3g times as bright as given",
                          c->check->lights[worst].name, ratio));
    return igi_case_remedy(c, a, NULL,
                           "leave its radiance out of scene.json: it is then read from the "
                           "photographs; or correct it%s",
                           ratio < 1 ? ", unless the photographs are saturated there" : "");
}

static igi_status count_lights(const igi_case *c, igi_assumption *a)
{
    size_t given = 0, readable = 0, unknown = 0, first = 0;
    for (size_t l = 0; l < c->check->light_count; l++) {
        const igi_light_check *light = &c->check->lights[l];
        if (light->known) given++;
        else if (light->seen) readable++;
        else if (unknown++ == 0) first = l;
    }
    if (unknown == 0 && given + readable > 0) {
        const char *all = given + readable == 1 ? "the light" : "all lights";
        double count = (double)(given + readable);
        if (readable == 0)
            return igi_case_find(c, a, IGI_HOLDS, count, "the power of %s is given", all);
        if (given == 0)
            return igi_case_find(c, a, IGI_HOLDS, count,
                                 "the power of %s can be read from the photographs", all);
        return igi_case_find(c, a, IGI_HOLDS, count,
                             "the power of %zu light%s is given, that of %zu can be read from the "
                             "photographs",
                             given, given == 1 ? "" : "s", readable);
    }
    if (given + readable == 0) {
        IGI_TRY(igi_case_find(c, a, IGI_FAILS, (double)unknown,
                              unknown ? "no light's power is given or seen: bright lights and dark "
                                        "surfaces cannot be told from the opposite"
                                      : "there is no light"));
        return igi_case_remedy(c, a, NULL, "give a light's power, or photograph a lamp");
    }
    IGI_TRY(
        igi_case_find(c, a, IGI_DOUBTFUL, (double)unknown,
                      "the power of %zu light%s (first: %s) is neither given nor seen, and will "
                      "be solved for",
                      unknown, unknown == 1 ? "" : "s", c->check->lights[first].name));
    return igi_case_remedy(c, a, NULL, "give its power, or photograph it");
}

static igi_status judge_lights(const igi_case *c)
{
    igi_assumption *a = igi_case_add(c, "lights");
    IGI_TRY(count_lights(c, a));
    return a->verdict == IGI_HOLDS ? compare_lamps(c, a) : IGI_OK;
}

/* Share of the seen area whose albedo is impossible, not by a little. */
static double impossible_share(const igi_case *c)
{
    double all = 0, impossible = 0;
    for (size_t r = 0; r < c->check->region_count; r++) {
        const igi_region_check *region = &c->check->regions[r];
        double highest = 0;
        if (region->emitter) continue;
        for (int b = 0; b < c->scene->bands; b++) highest = fmax(highest, region->albedo[b]);
        all += region->area * region->observed;
        if (highest > FAILING_ALBEDO) impossible += region->area * region->observed;
    }
    return all > 0 ? impossible / all : 0;
}

static igi_status judge_energy(const igi_case *c)
{
    igi_assumption *a = igi_case_add(c, "energy");
    double most = -1;
    for (size_t r = 0; r < c->check->region_count; r++)
        for (int b = 0; b < c->scene->bands; b++)
            if (c->check->regions[r].albedo[b] > most) { /* not of NaN */
                most = c->check->regions[r].albedo[b];
                a->region = (int)r;
            }
    if (most < 0) {
        IGI_TRY(igi_case_find(c, a, IGI_DOUBTFUL, (double)NAN,
                              "cannot be checked while a light's power is unknown"));
        return igi_case_remedy(c, a, NULL, "give the powers of the lights");
    }
    const char *name = c->check->regions[a->region].name;
    if (most <= ALBEDO)
        return igi_case_find(
            c, a, IGI_HOLDS, most,
            "no surface sends on more light than arrives (at most %.2f of it, '%s')", most, name);
    bool fails = impossible_share(c) > FAILING_SHARE;
    IGI_TRY(igi_case_find(c, a, fails ? IGI_FAILS : IGI_DOUBTFUL, most,
                          "'%s' seems to send on %.2f times the light that arrives", name, most));
    return igi_case_remedy(c, a, NULL,
                           fails ? "a light is missing or too weak, or lights and photographs have "
                                   "different units"
                                 : "it is a mirror, or the photographs show it where it shines; or "
                                   "a light near it is missing");
}

igi_status igi_judge_mesh(const igi_case *c)
{
    IGI_TRY(judge_closed(c));
    return judge_faces(c);
}

igi_status igi_judge_light(const igi_case *c)
{
    IGI_TRY(judge_lights(c));
    return judge_energy(c);
}
