/* SPDX-License-Identifier: Apache-2.0
 *
 * The lamps against what the photographs show of them: their radiance, and their outlines. A lamp that
 * is drawn too large sends too much light.
 */
#include "recover/doubt.h"

#include "observe/lamp_profile.h"

#define LAMP_OFF 0.005
#define LAMP_SIGMAS 6.0
#define FEWEST_LAMP_PIXELS 20
#define LAMP_WRONG 0.1 /* a lamp that is off by more is no small error of its value */
#define OUTLINE 0.01   /* of a lamp's area */
#define OUTLINE_SIGMAS 4.0

double igi_doubt_area(const igi_mesh *mesh, size_t region)
{
    double area = 0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++)
        if (mesh->regions[t] == region) area += (double)igi_triangle_area(mesh, t);
    return area;
}

/* What is seen of a lamp's front, over its profile, mean over bands. */
typedef struct lamp_view {
    double mean, error, pixels; /* error: of the mean, one standard deviation */
} lamp_view;

static lamp_view look_at_lamp(const igi_problem *p, int region)
{
    const igi_observations *o = p->observations;
    double sum = 0, squares = 0, n = 0;
    for (size_t i = 0; i < o->count; i++) {
        uint32_t surface = o->surface[i];
        if ((int)p->scene->mesh.regions[igi_surface_triangle(surface)] != region ||
            igi_surface_is_back(surface))
            continue;
        double x = 0, profile = igi_observation_profile(p->scene, o, i);
        if (!(profile > 0)) continue;
        for (int b = 0; b < p->bands; b++)
            x += (double)o->radiance[i * (size_t)p->bands + (size_t)b] / p->bands;
        x /= profile;
        sum += x;
        squares += x * x;
        n++;
    }
    if (n == 0) return (lamp_view){0, 0, 0};
    return (lamp_view){sum / n, sqrt(fmax(0, squares / n - sum / n * sum / n) / n), n};
}

igi_status igi_doubt_lamps(igi_context *ctx, const igi_problem *p, igi_materials *m, double *off)
{
    double all = 0, sum = 0;
    for (size_t l = 0; l < p->scene->light_count; l++) {
        const igi_light *light = &p->scene->lights[l];
        double stated = 0;
        if (light->type != IGI_LIGHT_AREA || !light->known) continue;
        lamp_view seen = look_at_lamp(p, light->region);
        for (int b = 0; b < p->bands; b++) stated += light->value[b] / p->bands;
        if (seen.pixels < FEWEST_LAMP_PIXELS || !(stated > 0)) continue;
        double wrong = fabs(seen.mean / stated - 1),
               power = stated * igi_doubt_area(&p->scene->mesh, (size_t)light->region);
        all += power;
        if (wrong < LAMP_WRONG) sum += power * wrong;
        if (!(wrong > fmax(LAMP_OFF, LAMP_SIGMAS * seen.error / stated))) continue;
        char *sentence;
        IGI_TRY(igi_strprintf(ctx, &sentence,
                              "lights[%zu]: the photographs show '%s' with %.4g times the radiance "
                              "that is stated: one of them is wrong, by its unit or because the "
                              "lamp is saturated; leave the radiance out to have it read",
                              l, p->scene->regions[light->region].name, seen.mean / stated));
        IGI_TRY(igi_doubt_say(ctx, m, sentence));
    }
    *off = all > 0 ? sum / all : 0;
    return IGI_OK;
}

igi_status igi_doubt_outlines(igi_context *ctx, const igi_problem *p, igi_materials *m, double *off)
{
    const igi_observations *o = p->observations;
    double all = 0, sum = 0;
    for (size_t k = 0; k < p->light_count; k++) {
        const igi_light *light = &p->lights[k];
        if (light->type != IGI_LIGHT_AREA) continue;
        double power = 0, area = igi_doubt_area(&p->scene->mesh, (size_t)light->region);
        for (int b = 0; b < p->bands; b++) power += light->value[b] * area;
        all += power;
        igi_lamp_size size = igi_outlines_sum(o->outlines, o->outline_count,
                                              (uint32_t)light->region);
        double wrong = fabs(size.ratio - 1);
        if (!isfinite(size.error)) continue;
        if (wrong < LAMP_WRONG) sum += power * igi_doubt_sure(wrong, size.error);
        if (!(wrong > fmax(OUTLINE, OUTLINE_SIGMAS * size.error))) continue;
        char *sentence;
        IGI_TRY(igi_strprintf(ctx, &sentence,
                              "lights[%zu]: '%s' is %.1f +- %.1f %% %s in the mesh than in the %zu "
                              "photographs that tell, in area: its light is off by as much; mend "
                              "its outline",
                              p->light_of[k], p->scene->regions[light->region].name, 100 * wrong,
                              100 * size.error, size.ratio < 1 ? "larger" : "smaller",
                              size.photographs));
        IGI_TRY(igi_doubt_say(ctx, m, sentence));
    }
    *off = all > 0 ? sum / all : 0;
    return IGI_OK;
}
