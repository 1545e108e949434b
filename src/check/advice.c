/* SPDX-License-Identifier: Apache-2.0
 *
 * Places to photograph from are drawn on the lines from the cameras to what they see: free space
 * that one can get to. The best is the one that shows most of what is missing within one picture.
 */
#include "check/survey.h"

#include "scene/camera.h"

#include <math.h>

#define PLACES 240
#define POINTS 200
#define HALF_FIELD_COS 0.819f /* 35 degrees */
#define LEAST_COS 0.2f        /* flatter views tell little */

typedef struct missing {
    size_t count;
    igi_vec point[POINTS], normal[POINTS]; /* of the front; both sides may be looked at */
} missing;

typedef struct candidate {
    size_t count;
    igi_vec toward[POINTS]; /* unit */
} candidate;

/* Up to POINTS points of patches that `wanted` accepts, even in area. */
static igi_status draw_points(igi_context *ctx, const igi_survey *s, int region, bool unseen,
                              missing *m)
{
    double area = 0, walked = 0;
    m->count = 0;
    for (int pass = 0; pass < 2; pass++)
        for (uint32_t p = 0; p < s->patches->count && m->count < POINTS; p++) {
            if (s->patches->triangle[p] == IGI_NO_HIT) continue;
            uint32_t r = igi_patch_region(s->patches, p), triangle;
            if (s->scene->regions[r].emitter || (region >= 0 && (int)r != region) ||
                (unseen && s->seen[2 * p] + s->seen[2 * p + 1] > 0))
                continue;
            if (pass == 0) area += (double)s->patches->area[p];
            if (pass == 0) continue;
            walked += (double)s->patches->area[p];
            if (walked * POINTS < area * ((double)m->count + 0.5)) continue;
            float u, v;
            igi_rng rng = igi_rng_make(igi_seed(ctx) + 0xad71, p);
            igi_patch_sample(s->patches, p, &rng, &triangle, &u, &v);
            m->point[m->count] = igi_triangle_point(&s->scene->mesh, triangle, u, v);
            m->normal[m->count++] = igi_tracer_normal(s->tracer, triangle);
        }
    return IGI_OK;
}

/* A place in free space; false: this line has none. */
static bool draw_place(const igi_survey *s, igi_rng *rng, igi_vec *eye)
{
    size_t frame = igi_rng_next(rng) % s->scene->frame_count;
    const igi_camera *camera = &s->scene->frames[frame].camera;
    igi_vec centre = igi_camera_centre(camera);
    double x = camera->width * (double)igi_rng_float(rng),
           y = camera->height * (double)igi_rng_float(rng);
    igi_vec direction = igi_camera_direction(camera, x, y);
    igi_hit hit = igi_trace(s->tracer, centre, direction);
    if (hit.triangle == IGI_NO_HIT) return false;
    *eye = igi_madd(centre, direction, hit.distance * 0.85f * igi_rng_float(rng));
    return true;
}

/* Does the place show the point, and, if that is asked for, a lamp mirrored there? */
static bool shows(const igi_survey *s, igi_vec eye, igi_vec point, igi_vec normal, bool mirrored)
{
    igi_vec way = igi_sub(eye, point);
    float cosine = igi_dot(way, normal) / fmaxf(igi_length(way), 1e-9f);
    if (cosine < 0) normal = igi_scale(normal, -1);
    if (fabsf(cosine) < LEAST_COS) return false;
    igi_vec start = igi_madd(point, normal, 2 * igi_tracer_epsilon(s->tracer));
    if (mirrored && !igi_survey_mirrors_lamp(s, eye, point, normal)) return false;
    return !igi_occluded(s->tracer, start, eye);
}

/* How many of the directions one picture holds, at best, and where it looks. */
static size_t aim(const candidate *c, igi_vec *best)
{
    size_t most = 0;
    for (size_t i = 0; i < c->count; i++) {
        size_t n = 0;
        igi_vec sum = {0, 0, 0};
        for (size_t k = 0; k < c->count; k++) {
            if (igi_dot(c->toward[i], c->toward[k]) < HALF_FIELD_COS) continue;
            n++;
            sum = igi_add(sum, c->toward[k]);
        }
        if (n <= most) continue;
        most = n;
        *best = igi_normalize(sum);
    }
    return most;
}

static igi_status advise(igi_context *ctx, const igi_survey *s, const missing *m, bool mirrored,
                         igi_advice *advice)
{
    candidate c;
    igi_rng rng = igi_rng_make(igi_seed(ctx) + 0xad71ce, mirrored);
    *advice = (igi_advice){0};
    for (int place = 0; place < PLACES && m->count > 0; place++) {
        igi_vec eye, look;
        if (!draw_place(s, &rng, &eye)) continue;
        c.count = 0;
        for (size_t i = 0; i < m->count; i++)
            if (shows(s, eye, m->point[i], m->normal[i], mirrored))
                c.toward[c.count++] = igi_normalize(igi_sub(m->point[i], eye));
        double gain = (double)aim(&c, &look) / (double)m->count;
        if (gain <= advice->gain) continue;
        igi_hit hit = igi_trace(s->tracer, eye, look);
        float distance = hit.triangle == IGI_NO_HIT ? 1 : hit.distance;
        *advice = (igi_advice){gain, eye, igi_madd(eye, look, distance)};
    }
    igi_count_rays(ctx, PLACES * m->count);
    return IGI_OK;
}

igi_status igi_advise_unseen(igi_context *ctx, const igi_survey *survey, int region,
                             igi_advice *advice)
{
    missing m;
    IGI_TRY(draw_points(ctx, survey, region, true, &m));
    return advise(ctx, survey, &m, false, advice);
}

igi_status igi_advise_highlight(igi_context *ctx, const igi_survey *survey, int region,
                                igi_advice *advice)
{
    missing m;
    IGI_TRY(draw_points(ctx, survey, region, false, &m));
    return advise(ctx, survey, &m, true, advice);
}
