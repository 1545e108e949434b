/* SPDX-License-Identifier: Apache-2.0 */
#include "specular/lobe_view.h"

#include "brdf/brdf.h"
#include "scene/camera.h"
#include "scene/light_profile.h"

#define LAMP_SAMPLES 16
#define LOBE_SAMPLES 16
/* A first look at a lamp, by few points and as if the lobe were so much broader: where it finds less
 * than this share of what was seen, the highlight is elsewhere. */
#define GLANCE_SAMPLES 4
#define GLANCE_WIDTH 1.5f
#define GLANCE_SHARE 1e-4f
#define CERTAIN 10 /* times that needs no look */

/* A place that a lobe is seen at. */
typedef struct lobe_place {
    const igi_problem *problem;
    const igi_lobe *lobe;
    igi_vec point, normal, out; /* out in the frame of the normal */
} lobe_place;

static bool is_around(const igi_light *light)
{
    return light->type == IGI_LIGHT_ENV || light->type == IGI_LIGHT_AMBIENT;
}

/* What rays of the lobe meet of the lights: what is around the scene, and of a sharp lobe lamps. */
static void add_mirrored(const lobe_place *at, float *radiance)
{
    const igi_problem *p = at->problem;
    const igi_lobe *lobe = at->lobe;
    bool sharp = lobe->alpha < IGI_SHARP_ALPHA, wanted = sharp;
    for (size_t l = 0; l < p->light_count; l++) wanted |= is_around(&p->lights[l]);
    for (int k = 0; wanted && k < LOBE_SAMPLES; k++) {
        float u = ((float)k + 0.5f) / LOBE_SAMPLES, v = (float)k * 0.6180339887f, scale, base;
        igi_vec in = igi_lobe_sample(lobe->model, lobe->alpha, at->out, u, v - floorf(v));
        float pdf = igi_lobe_pdf(lobe->model, lobe->alpha, in, at->out);
        if (in.z <= 0 || !(pdf > 0)) continue;
        igi_vec direction = igi_to_world(in, at->normal);
        igi_hit hit = igi_trace(p->tracer, at->point, direction);
        float met[IGI_MAX_BANDS] = {0}, carried = in.z / (pdf * LOBE_SAMPLES);
        if (hit.triangle == IGI_NO_HIT)
            igi_lighting_add_met(p->lighting, at->point, direction, &hit, pdf * LOBE_SAMPLES,
                                 LAMP_SAMPLES, met);
        else if (sharp) igi_lighting_add_emitted(p->lighting, direction, &hit, met);
        igi_lobe_terms(lobe->model, lobe->alpha, in, at->out, &scale, &base);
        for (int b = 0; b < p->bands; b++)
            radiance[b] += (lobe->specular[b] * scale + base) * carried * met[b];
    }
}

/* How much of a sample counts: of an environment nothing where something is in between, and beside the
 * lobe's own rays its share. */
static float share_of(const lobe_place *at, size_t light, const igi_light_sample *sample,
                      igi_vec in, float visible)
{
    if (at->problem->lights[light].type != IGI_LIGHT_ENV) return visible;
    float own = LAMP_SAMPLES * sample->pdf;
    float lobes = LOBE_SAMPLES * igi_lobe_pdf(at->lobe->model, at->lobe->alpha, in, at->out);
    return igi_light_hidden(at->problem->tracer, at->point, sample) ? 0 : own / (own + lobes);
}

/* One lamp by so many points, as if the lobe had the roughness alpha. */
static void add_lamp(const lobe_place *at, size_t light, float alpha, size_t count, float visible,
                     float *radiance)
{
    const igi_problem *p = at->problem;
    const float start[2] = {0.5f, 0.5f};
    igi_light_sample samples[LAMP_SAMPLES];
    size_t n = igi_light_sample_set(p->lighting, light, at->point, count, start, samples);
    for (size_t k = 0; k < n; k++) {
        igi_vec in = igi_to_local(samples[k].direction, at->normal);
        float scale, base;
        if (in.z <= 0) continue;
        igi_lobe_terms(at->lobe->model, alpha, in, at->out, &scale, &base);
        float share = share_of(at, light, &samples[k], in, visible);
        float carried = share * in.z * samples[k].weight;
        for (int b = 0; b < p->bands; b++)
            radiance[b] += (at->lobe->specular[b] * scale + base) * carried *
                           igi_light_sample_value(&p->lights[light], &samples[k], b);
    }
}

/* How much of a Ward lobe a lamp may send, for a coefficient and a radiance of 1. */
typedef struct lobe_reach {
    float most; /* where each coordinate by itself is as near to the mirror direction as the lamp's
                     ball comes */
    float middle; /* if all of the ball were in its middle's direction */
} lobe_reach;

static lobe_reach reach_of(const lobe_place *at, size_t light, float alpha)
{
    igi_vec middle;
    float radius = igi_light_ball(at->problem->lighting, light, &middle);
    igi_vec to = igi_sub(middle, at->point);
    float squared = igi_dot(to, to), outside = squared - radius * radius, a2 = alpha * alpha;
    if (!(outside > radius * radius)) return (lobe_reach){HUGE_VALF, 0};
    /* twice the sine of half the ball's angle is below this: so far do unit vectors differ */
    float off = radius / sqrtf(outside);
    igi_vec in = igi_to_local(igi_scale(to, 1 / sqrtf(squared)), at->normal);
    float in_z = in.z + off, z = in_z + at->out.z, unit = off * off / (4 * a2);
    if (!(in_z > 0)) return (lobe_reach){0, 0};
    float across = hypotf(in.x + at->out.x, in.y + at->out.y), nearest = fmaxf(0, across - off);
    lobe_reach r = {unit * sqrtf(in_z / at->out.z) * expf(-nearest * nearest / (z * z * a2)), 0};
    if (in.z > 0) {
        z = in.z + at->out.z;
        r.middle = unit * sqrtf(in.z / at->out.z) * expf(-across * across / (z * z * a2));
    }
    return r;
}

/* Is the lamp mirrored somewhere else, far from here? */
static bool is_elsewhere(const lobe_place *at, size_t light, uint32_t side)
{
    const igi_problem *p = at->problem;
    const float *seen = p->seen + (size_t)side * (size_t)p->bands;
    float glance[IGI_MAX_BANDS] = {0}, found = 0, all = 0, bright = 0;
    float alpha = fminf(1, GLANCE_WIDTH * at->lobe->alpha);
    for (int b = 0; b < p->bands; b++) {
        all += seen[b];
        bright += at->lobe->specular[b] * (float)p->lights[light].value[b];
    }
    bright *= igi_light_profile(&p->lights[light], 1);
    if (at->lobe->model == IGI_WARD) {
        lobe_reach reach = reach_of(at, light, alpha);
        if (bright * reach.most < GLANCE_SHARE * all) return true;
        if (bright * reach.middle > CERTAIN * GLANCE_SHARE * all) return false;
    }
    add_lamp(at, light, alpha, GLANCE_SAMPLES, 1, glance);
    for (int b = 0; b < p->bands; b++) found += glance[b];
    return found < GLANCE_SHARE * all;
}

/* The view of a side in a photograph; SIZE_MAX: no photograph shows the side. */
static size_t view_of_side(const igi_correction *c, uint32_t side, size_t frame)
{
    size_t at = c->view_begin[side], end = c->view_begin[side + 1];
    if (at == end) return SIZE_MAX;
    while (at + 1 < end && c->view_frame[at] < frame) at++;
    return at;
}

static void add_lamps(const igi_lobe_view *view, const igi_problem *problem, const igi_lobe *lobe,
                      uint32_t side, size_t frame, const igi_hit *hit, float *lamps)
{
    const igi_problem *p = problem;
    uint32_t row = view->rows->row_of[side];
    if (row == IGI_NO_ROW) return;
    igi_vec point = igi_triangle_point(&p->scene->mesh, hit->triangle, hit->u, hit->v);
    igi_vec normal = igi_tracer_normal(p->tracer, hit->triangle);
    igi_vec eye = igi_camera_centre(&p->scene->frames[frame].camera);
    if (hit->back) normal = igi_scale(normal, -1);
    igi_vec out = igi_to_local(igi_normalize(igi_sub(eye, point)), normal);
    lobe_place at = {p, lobe, point, normal, out};
    if (out.z <= 0) return;
    add_mirrored(&at, lamps);
    for (size_t l = 0; l < view->rows->lights; l++) {
        float open = view->rows->open[row * view->rows->lights + l];
        float visible = open > 0 ? view->rows->direct[row * view->rows->lights + l] / open : 0;
        bool area = p->lights[l].type == IGI_LIGHT_AREA;
        if (!(visible > 0) || (area && lobe->alpha < IGI_SHARP_ALPHA)) continue;
        if (area && is_elsewhere(&at, l, side)) continue;
        add_lamp(&at, l, lobe->alpha, LAMP_SAMPLES, visible, lamps);
    }
}

/* What a photograph shows of a lobe: the side, and which of the correction's views it is. */
typedef struct seen_lobe {
    const igi_lobe *lobe;
    uint32_t side;
    size_t at; /* SIZE_MAX: nothing is known of its surfaces */
} seen_lobe;

static bool find_seen(const igi_lobe_view *view, const igi_problem *p, size_t frame,
                      const igi_hit *hit, seen_lobe *s)
{
    s->lobe = &view->lobes[p->scene->mesh.regions[hit->triangle]];
    if (s->lobe->model == IGI_LAMBERT) return false;
    s->side = igi_side_at(p->patches, hit->triangle, hit->u, hit->v, hit->back);
    s->at = view_of_side(view->correction, s->side, frame);
    return true;
}

void igi_lobe_view_parts(const igi_lobe_view *view, const igi_problem *problem, size_t frame,
                         const igi_hit *hit, int half, igi_lobe_parts *parts)
{
    const igi_correction *c = view->correction;
    size_t bands = (size_t)problem->bands, views = c->view_begin[2 * problem->patches->count];
    seen_lobe s;
    *parts = (igi_lobe_parts){.lit = 0};
    if (!find_seen(view, problem, frame, hit, &s)) return;
    add_lamps(view, problem, s.lobe, s.side, frame, hit, parts->radiance);
    if (s.at == SIZE_MAX) return;
    const float *own = c->surfaces + ((size_t)half * views + s.at) * bands;
    const float *other = c->surfaces + ((size_t)(1 - half) * views + s.at) * bands;
    for (size_t b = 0; b < bands; b++) {
        parts->radiance[b] += own[b];
        parts->mirrored += other[b] / (float)bands;
    }
    parts->lit = c->lamps[(size_t)(1 - half) * views + s.at];
}

void igi_lobe_view_radiance(const igi_lobe_view *view, const igi_problem *problem, size_t frame,
                            const igi_hit *hit, float *radiance)
{
    const igi_correction *c = view->correction;
    size_t bands = (size_t)problem->bands, views = c->view_begin[2 * problem->patches->count];
    seen_lobe s;
    if (!find_seen(view, problem, frame, hit, &s)) return;
    add_lamps(view, problem, s.lobe, s.side, frame, hit, radiance);
    for (size_t b = 0; b < bands && s.at != SIZE_MAX; b++)
        radiance[b] += 0.5f *
                       (c->surfaces[s.at * bands + b] + c->surfaces[(views + s.at) * bands + b]);
}
