/* SPDX-License-Identifier: Apache-2.0
 *
 * A mesh that is not exact shows in the photographs' edges, which lie beside its own, each by something
 * else. By as much as edges are off, surfaces may be nearer to a lamp or farther, and get more of its
 * light or less, which nothing else shows: a wall that is off as a whole looks as even as before.
 */
#include "recover/doubt.h"

#include "scene/camera.h"

#define WORTH_PX 0.18   /* beyond it: a word */
#define EXACT_PX 0.2    /* where cameras and mesh are exact, edges lie so far off, for noise */
#define FEWEST_EDGES 20 /* of a photograph; none: its camera was found to be right */
#define FOUND 0.7 /* of a displacement: the rest passes for the camera's (igi chart stability) */
#define LOOKED_AT 500 /* sides, for distances */

/* Mean over the photographs of what their edges are off, pixels, beyond what is found anyway. */
static double edges_off(const igi_observations *o)
{
    double sum = 0, n = 0;
    for (size_t f = 0; o->registrations && f < o->frame_count; f++) {
        const igi_registration *r = &o->registrations[f];
        if (!(r->residual > 0) || (r->edges > 0 && r->edges < FEWEST_EDGES)) continue;
        sum += r->residual;
        n++;
    }
    double mean = sum / fmax(1, n);
    return sqrt(fmax(0, mean * mean - EXACT_PX * EXACT_PX));
}

/* A pixel's side at the distance of what photographs show, metres. */
static double pixel_m(const igi_light_shares *s)
{
    double sum = 0, n = 0;
    size_t step = s->count / LOOKED_AT + 1;
    for (size_t f = 0; f < s->p->scene->frame_count; f++) {
        const igi_camera *c = &s->p->scene->frames[f].camera;
        igi_vec eye = igi_camera_centre(c);
        for (size_t i = 0; i < s->count; i += step, n++)
            sum += (double)igi_length(igi_sub(s->looks[i].point, eye)) / c->fl_x;
    }
    return n > 0 ? sum / n : 0;
}

/* What reaches one side more where it lies `delta` farther out, as a share of all that does. */
static double change_of(const igi_light_shares *s, const igi_look *l, size_t light, double delta)
{
    const igi_lighting *lighting = s->p->lighting;
    igi_vec out = igi_add(l->point, igi_scale(l->normal, (float)delta));
    double change = 0;
    change += (double)igi_light_irradiance(lighting, NULL, light, out, l->normal, 1, 0);
    change -= (double)igi_light_irradiance(lighting, NULL, light, l->point, l->normal, 1, 0);
    return change * igi_light_shares_value(s->p, light) / l->received;
}

static igi_status say(igi_context *ctx, double px, double delta, igi_materials *m)
{
    char *sentence;
    IGI_TRY(
        igi_strprintf(ctx, &sentence,
                      "the photographs' edges lie some %.2f pixels beside the mesh's, each "
                      "otherwise: the mesh is off by some %.2g m here and there; the error bars "
                      "of albedo hold what that does to its light, those of lobes do not",
                      px, delta));
    return igi_doubt_say(ctx, m, sentence);
}

/* Each corner of a lamp is off by `delta` in its own direction: the area of a square of side a by
 * sqrt(2) delta / a, and its light with it. */
static void widen_by_lamps(const igi_light_shares *s, double delta, double *off)
{
    for (size_t k = 0; k < s->light_count; k++) {
        const igi_light *light = &s->p->lights[s->lights[k]];
        if (light->type != IGI_LIGHT_AREA) continue;
        double area = igi_doubt_area(&s->p->scene->mesh, (size_t)light->region);
        double wrong = delta * sqrt(2 / fmax(area, delta * delta));
        for (size_t r = 0; r < s->regions; r++) off[r] = hypot(off[r], wrong * s->shares[r][k]);
    }
}

/* All of a region moves at once. */
igi_status igi_doubt_shape(igi_context *ctx, const igi_light_shares *s, igi_materials *m,
                           double *off)
{
    double px = edges_off(s->p->observations), delta = px * pixel_m(s) / FOUND;
    if (!(delta > 0)) return IGI_OK;
    if (px > WORTH_PX) IGI_TRY(say(ctx, px, delta, m));
    widen_by_lamps(s, delta, off);
    for (size_t r = 0; r < s->regions; r++) {
        double change = 0, n = 0;
        size_t step = (size_t)(s->sides[r] / LOOKED_AT) + 1, seen = 0;
        for (size_t i = 0; i < s->count; i++) {
            if (s->looks[i].region != r || seen++ % step) continue;
            for (size_t k = 0; k < s->light_count; k++)
                change += change_of(s, &s->looks[i], s->lights[k], delta);
            n++;
        }
        off[r] = hypot(off[r], change / fmax(1, n));
    }
    return IGI_OK;
}
