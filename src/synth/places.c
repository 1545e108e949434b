/* SPDX-License-Identifier: Apache-2.0
 *
 * Places for cameras, as a photographer would choose them: of some free places, each looking at a
 * random point of the next region in turn, the one that shows most of what few views have shown.
 */
#include "synth/synth.h"

#include "base/rng.h"
#include "scene/camera.h"

#include <math.h>

#define TRIES 20000     /* for a free place */
#define CANDIDATES 12   /* for each view */
#define POINTS_EACH 100 /* of a region, to tell what a view shows */

static igi_vec random_in(igi_rng *rng, igi_vec low, igi_vec high)
{
    igi_vec d = igi_sub(high, low);
    float x = igi_rng_float(rng), y = igi_rng_float(rng), z = igi_rng_float(rng);
    return igi_v(low.x + x * d.x, low.y + y * d.y, low.z + z * d.z);
}

/* A uniform point of a region's surface; region -1: of any. */
static igi_vec random_on(igi_rng *rng, const igi_mesh *mesh, int region)
{
    double total = 0;
    uint32_t chosen = 0;
    for (uint32_t t = 0; t < mesh->triangle_count; t++) { /* a weighted reservoir of one */
        if (region >= 0 && mesh->regions[t] != (uint32_t)region) continue;
        double area = (double)igi_triangle_area(mesh, t);
        total += area;
        if ((double)igi_rng_float(rng) * total <= area) chosen = t;
    }
    float root = sqrtf(igi_rng_float(rng)), v = igi_rng_float(rng);
    return igi_triangle_point(mesh, chosen, root * (1 - v), root * v);
}

/* Free of surfaces all around, and not within something solid. */
static bool is_free(const igi_tracer *tracer, igi_rng *rng, igi_vec eye, float clearance)
{
    enum { RAYS = 64 };
    int behind = 0;
    for (int i = 0; i < RAYS; i++) {
        igi_vec up = {0, 0, i % 2 ? 1.0f : -1.0f};
        igi_vec d = igi_cosine_direction(up, igi_rng_float(rng), igi_rng_float(rng));
        igi_hit hit = igi_trace(tracer, eye, d);
        if (hit.distance < clearance) return false;
        behind += hit.back;
    }
    return behind < RAYS / 2;
}

typedef struct chooser {
    const view_set *views;
    const igi_scene *scene;
    const igi_tracer *tracer;
    igi_rng rng;
    igi_vec low, high; /* of the eyes */
    igi_vec *hidden;   /* points that no view may see */
    size_t hidden_count;
    int region;      /* the one looked at last */
    igi_vec *points; /* on all regions alike */
    float *worth;    /* of seeing each once more */
    size_t point_count;
} chooser;

static bool is_within(igi_vec p, const double corners[2][3])
{
    const double at[3] = {(double)p.x, (double)p.y, (double)p.z};
    for (int k = 0; k < 3; k++)
        if (!(at[k] >= corners[0][k] && at[k] <= corners[1][k])) return false;
    return true;
}

static igi_status chooser_start(igi_context *ctx, chooser *c)
{
    enum { POINTS = 20000 };
    const view_set *v = c->views;
    c->rng = igi_rng_make(igi_seed(ctx), v->seed);
    (void)igi_tracer_size(c->tracer, &c->low, &c->high);
    igi_vec inset = igi_scale(igi_sub(c->high, c->low), 0.12f);
    c->low = v->has_eyes ? igi_v_ofd(v->eyes[0]) : igi_add(c->low, inset);
    c->high = v->has_eyes ? igi_v_ofd(v->eyes[1]) : igi_sub(c->high, inset);
    c->point_count = POINTS_EACH * c->scene->region_count;
    IGI_TRY(IGI_ALLOC(ctx, c->point_count, &c->points));
    IGI_TRY(IGI_ALLOC(ctx, c->point_count, &c->worth));
    for (size_t i = 0; i < c->point_count; i++) {
        c->points[i] = random_on(&c->rng, &c->scene->mesh, (int)(i / POINTS_EACH));
        c->worth[i] = 1;
    }
    if (!v->has_unseen) return IGI_OK;
    IGI_TRY(IGI_ALLOC(ctx, POINTS, &c->hidden));
    for (int i = 0; i < POINTS; i++) {
        igi_vec p = random_on(&c->rng, &c->scene->mesh, -1);
        if (is_within(p, v->unseen)) c->hidden[c->hidden_count++] = p;
    }
    return IGI_OK;
}

static bool sees_hidden(const chooser *c, const igi_camera *camera)
{
    for (size_t i = 0; i < c->hidden_count; i++)
        if (view_sees(camera, c->tracer, c->hidden[i])) return true;
    return false;
}

static int next_region(const chooser *c)
{
    int count = (int)c->scene->region_count;
    for (int k = 1; k <= count; k++) {
        int region = (c->region + k) % count;
        if (!c->scene->regions[region].emitter) return region;
    }
    return 0;
}

/* A place from which one can look at the next region. */
static igi_status find_place(igi_context *ctx, chooser *c, igi_camera *camera)
{
    float size = igi_tracer_size(c->tracer, NULL, NULL);
    float clearance = c->views->clearance > 0 ? (float)c->views->clearance : 0.04f * size;
    for (int i = 0; i < TRIES; i++) {
        if (i % 100 == 99) c->region = next_region(c);
        igi_vec eye = random_in(&c->rng, c->low, c->high);
        igi_vec target = random_on(&c->rng, &c->scene->mesh, c->region);
        igi_vec d = igi_sub(target, eye);
        float distance = igi_length(d);
        if (distance < 0.2f * size || fabsf(d.z) > 0.9f * distance) continue;
        if (igi_occluded(c->tracer, eye, target)) continue;
        if (!is_free(c->tracer, &c->rng, eye, clearance)) continue;
        *camera = view_camera(c->views, eye, target);
        if (!sees_hidden(c, camera)) return IGI_OK;
    }
    return igi_fail(ctx, IGI_E_DATA,
                    "views: no place for a camera in %d tries; give \"eyes\", a smaller "
                    "\"clearance\", or list the views under \"look\"",
                    TRIES);
}

static float gain_of(const chooser *c, const igi_camera *camera)
{
    float gain = 0;
    for (size_t i = 0; i < c->point_count; i++)
        if (view_sees(camera, c->tracer, c->points[i])) gain += c->worth[i];
    return gain;
}

static igi_status choose_one(igi_context *ctx, chooser *c, igi_camera *camera)
{
    float best = -1;
    c->region = next_region(c);
    for (int k = 0; k < CANDIDATES; k++) {
        igi_camera candidate;
        IGI_TRY(find_place(ctx, c, &candidate));
        float gain = gain_of(c, &candidate);
        if (gain <= best) continue;
        best = gain;
        *camera = candidate;
    }
    for (size_t i = 0; i < c->point_count; i++)
        if (view_sees(camera, c->tracer, c->points[i])) c->worth[i] *= 0.25f;
    return IGI_OK;
}

igi_status views_place(igi_context *ctx, const view_set *views, const igi_scene *scene,
                       const igi_tracer *tracer, igi_camera *cameras, size_t count)
{
    igi_status status = IGI_OK;
    chooser c = {.views = views, .scene = scene, .tracer = tracer, .region = -1};
    IGI_TRY_GOTO(chooser_start(ctx, &c));
    for (size_t i = 0; i < count; i++) IGI_TRY_GOTO(choose_one(ctx, &c, &cameras[i]));
cleanup:
    igi_free(c.points);
    igi_free(c.worth);
    igi_free(c.hidden);
    return status;
}
