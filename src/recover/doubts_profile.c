/* SPDX-License-Identifier: Apache-2.0
 *
 * Lamps that photographs show brighter from one side than from another: their profile is not what the
 * manifest says. With x the brightness over the stated profile and theta the angle from the normal,
 *     ln x = b ln cos(theta) + constant
 * is fitted to a photograph's mean each; n + b is the profile that they show.
 */
#include "recover/doubt.h"

#include "base/order.h"
#include "observe/lamp_profile.h"
#include "scene/camera.h"

#define FEWEST_PIXELS 5 /* of a photograph, */
#define FEWEST_VIEWS 4  /* and of those */
#define SPREAD 0.05     /* of ln cos, as a standard deviation */
#define OFF 0.1         /* of b */
#define SIGMAS 6.0

/* Sums over photographs. */
typedef struct fit {
    double n, x, y, xx, xy, yy;
} fit;

static void look(const igi_problem *p, int region, size_t frame, fit *s)
{
    const igi_observations *o = p->observations;
    igi_vec eye = igi_camera_centre(&p->scene->frames[frame].camera);
    double n = 0, x = 0, y = 0;
    for (size_t i = o->frame_begin[frame]; i < o->frame_begin[frame + 1]; i++) {
        uint32_t surface = o->surface[i], triangle = igi_surface_triangle(surface);
        if ((int)p->scene->mesh.regions[triangle] != region || igi_surface_is_back(surface))
            continue;
        double seen = igi_mean(o->radiance + i * (size_t)p->bands, (size_t)p->bands);
        double profile = igi_observation_profile(p->scene, o, i);
        igi_vec point = igi_triangle_point(&p->scene->mesh, triangle, o->uv[2 * i],
                                           o->uv[2 * i + 1]);
        igi_vec toward = igi_normalize(igi_sub(eye, point));
        double cosine = fabs((double)igi_dot(toward, igi_tracer_normal(p->tracer, triangle)));
        if (!(seen > 0 && profile > 0 && cosine > 0)) continue;
        x += log(cosine);
        y += log(seen / profile);
        n++;
    }
    if (n < FEWEST_PIXELS) return;
    x /= n;
    y /= n;
    *s = (fit){s->n + 1, s->x + x, s->y + y, s->xx + x * x, s->xy + x * y, s->yy + y * y};
}

/* b; 0 where the photographs do not tell. */
static double exponent_off(const fit *s)
{
    if (s->n < FEWEST_VIEWS) return 0;
    double xx = s->xx - s->x * s->x / s->n, xy = s->xy - s->x * s->y / s->n;
    double yy = s->yy - s->y * s->y / s->n;
    if (!(xx > SPREAD * SPREAD * s->n)) return 0;
    double b = xy / xx, error = sqrt(fmax(0, yy - b * xy) / (s->n - 2) / xx);
    return fabs(b) > fmax(OFF, SIGMAS * error) ? b : 0;
}

igi_status igi_doubt_profiles(igi_context *ctx, const igi_problem *p, igi_materials *m)
{
    for (size_t l = 0; l < p->scene->light_count; l++) {
        const igi_light *light = &p->scene->lights[l];
        fit s = {0};
        if (light->type != IGI_LIGHT_AREA) continue;
        for (size_t f = 0; f < p->observations->frame_count; f++) look(p, light->region, f, &s);
        double b = exponent_off(&s);
        if (b == 0) continue;
        char *sentence;
        IGI_TRY(igi_strprintf(ctx, &sentence,
                              "lights[%zu]: the photographs show '%s' brighter from one side than "
                              "from another, about as cos^%.2g of the angle from its normal, where "
                              "%.2g is stated; its light goes elsewhere: give its \"profile\"",
                              l, p->scene->regions[light->region].name, light->profile + b,
                              light->profile));
        IGI_TRY(igi_doubt_say(ctx, m, sentence));
    }
    return IGI_OK;
}
