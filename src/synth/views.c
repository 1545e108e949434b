/* SPDX-License-Identifier: Apache-2.0
 *
 * Where the photographs are taken from: as the spec lists them, on a ring, or inside the scene at
 * random, each looking at a random point of the next region in turn, until all are seen.
 */
#include "synth/synth.h"

#include "base/rng.h"
#include "scene/camera.h"

#include <math.h>

#define COUNT(array) (sizeof(array) / sizeof(array)[0])
#define TRIES 20000

static igi_status read_corners(igi_context *ctx, const igi_json *parent, const char *key,
                               double corners[2][3], bool *present)
{
    static const char *const known[] = {"low", "high"};
    igi_json at = igi_json_member(parent, key);
    if (!at.value) return IGI_OK;
    IGI_TRY(igi_json_object(ctx, &at));
    IGI_TRY(igi_json_check_keys(ctx, &at, known, COUNT(known)));
    IGI_TRY(member_vector(ctx, &at, "low", corners[0]));
    *present = true;
    return member_vector(ctx, &at, "high", corners[1]);
}

static igi_status read_look(igi_context *ctx, const igi_json *parent, view_set *views)
{
    static const char *const known[] = {"eye", "target"};
    igi_json at = igi_json_member(parent, "look");
    if (!at.value) return IGI_OK;
    size_t count;
    IGI_TRY(igi_json_array(ctx, &at, &count));
    IGI_TRY(IGI_ALLOC(ctx, count, &views->look));
    for (size_t i = 0; i < count; i++) {
        igi_json one = igi_json_element(&at, i);
        IGI_TRY(igi_json_object(ctx, &one));
        IGI_TRY(igi_json_check_keys(ctx, &one, known, COUNT(known)));
        IGI_TRY(member_vector(ctx, &one, "eye", views->look[i][0]));
        IGI_TRY(member_vector(ctx, &one, "target", views->look[i][1]));
    }
    views->look_count = count;
    return IGI_OK;
}

static igi_status read_ring(igi_context *ctx, const igi_json *parent, view_set *views)
{
    static const char *const known[] = {"centre", "radius", "height"};
    igi_json at = igi_json_member(parent, "ring");
    if (!at.value) return IGI_OK;
    views->has_ring = true;
    views->ring_radius = 1;
    IGI_TRY(igi_json_object(ctx, &at));
    IGI_TRY(igi_json_check_keys(ctx, &at, known, COUNT(known)));
    IGI_TRY(member_vector(ctx, &at, "centre", views->ring_centre));
    IGI_TRY(optional_number(ctx, &at, "radius", 1e-3, 1e6, &views->ring_radius));
    return optional_number(ctx, &at, "height", -1e6, 1e6, &views->ring_height);
}

igi_status views_read(igi_context *ctx, const igi_json *at, view_set *views)
{
    static const char *const known[] = {"width", "height", "count",     "samples", "fov_deg", "seed",
                                        "eyes",  "unseen", "clearance", "ring",    "look"};
    if (!at->value) return IGI_OK;
    int seed = (int)views->seed;
    IGI_TRY(igi_json_object(ctx, at));
    IGI_TRY(igi_json_check_keys(ctx, at, known, COUNT(known)));
    IGI_TRY(optional_int(ctx, at, "width", 1, 16384, &views->width));
    IGI_TRY(optional_int(ctx, at, "height", 1, 16384, &views->height));
    IGI_TRY(optional_int(ctx, at, "count", 1, 10000, &views->count));
    IGI_TRY(optional_int(ctx, at, "samples", 1, 1 << 20, &views->samples));
    IGI_TRY(optional_number(ctx, at, "fov_deg", 1, 170, &views->fov_deg));
    IGI_TRY(optional_int(ctx, at, "seed", 0, 1 << 30, &seed));
    IGI_TRY(optional_number(ctx, at, "clearance", 0, 1e6, &views->clearance));
    views->seed = (uint64_t)seed;
    IGI_TRY(read_corners(ctx, at, "eyes", views->eyes, &views->has_eyes));
    IGI_TRY(read_corners(ctx, at, "unseen", views->unseen, &views->has_unseen));
    IGI_TRY(read_ring(ctx, at, views));
    return read_look(ctx, at, views);
}

static igi_camera camera_at(const view_set *views, igi_vec eye, igi_vec target)
{
    igi_vec back = igi_normalize(igi_sub(eye, target));
    igi_vec up = fabsf(back.z) > 0.999f ? igi_v(0, 1, 0) : igi_v(0, 0, 1);
    igi_vec right = igi_normalize(igi_cross(up, back));
    up = igi_cross(back, right);
    double focal = views->width / (2 * tan(views->fov_deg * IGI_PI / 360));
    igi_camera c = {.width = views->width, .height = views->height, .fl_x = focal, .fl_y = focal,
                    .cx = views->width / 2.0, .cy = views->height / 2.0};
    const igi_vec columns[4] = {right, up, back, eye};
    for (int k = 0; k < 4; k++) {
        c.camera_to_world[0][k] = (double)columns[k].x;
        c.camera_to_world[1][k] = (double)columns[k].y;
        c.camera_to_world[2][k] = (double)columns[k].z;
    }
    return c;
}

bool view_sees(const igi_camera *camera, const igi_tracer *tracer, igi_vec point)
{
    double x, y;
    if (!igi_camera_project(camera, point, &x, &y)) return false;
    if (!(x >= 0 && y >= 0 && x < camera->width && y < camera->height)) return false;
    return !igi_occluded(tracer, igi_camera_centre(camera), point);
}

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
    int region; /* the one looked at last */
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

static igi_status choose_one(igi_context *ctx, chooser *c, igi_camera *camera)
{
    float size = igi_tracer_size(c->tracer, NULL, NULL);
    float clearance = c->views->clearance > 0 ? (float)c->views->clearance : 0.04f * size;
    for (int i = 0; i < TRIES; i++) {
        if (i % 100 == 0) c->region = next_region(c);
        igi_vec eye = random_in(&c->rng, c->low, c->high);
        igi_vec target = random_on(&c->rng, &c->scene->mesh, c->region);
        igi_vec d = igi_sub(target, eye);
        float distance = igi_length(d);
        if (distance < 0.2f * size || fabsf(d.z) > 0.9f * distance) continue;
        if (igi_occluded(c->tracer, eye, target)) continue;
        if (!is_free(c->tracer, &c->rng, eye, clearance)) continue;
        *camera = camera_at(c->views, eye, target);
        if (!sees_hidden(c, camera)) return IGI_OK;
    }
    return igi_fail(ctx, IGI_E_DATA,
                    "views: no place for a camera in %d tries; give \"eyes\", a smaller "
                    "\"clearance\", or list the views under \"look\"",
                    TRIES);
}

igi_status views_choose(igi_context *ctx, const view_set *views, const igi_scene *scene,
                        const igi_tracer *tracer, igi_camera **cameras, size_t *count)
{
    igi_status status = IGI_OK;
    chooser c = {.views = views, .scene = scene, .tracer = tracer, .region = -1};
    *count = views->look_count ? views->look_count : (size_t)views->count;
    IGI_TRY(IGI_ALLOC(ctx, *count, cameras));
    if (!views->look_count && !views->has_ring) IGI_TRY_GOTO(chooser_start(ctx, &c));
    for (size_t i = 0; i < *count; i++) {
        if (views->look_count) {
            (*cameras)[i] = camera_at(views, igi_v_ofd(views->look[i][0]), igi_v_ofd(views->look[i][1]));
        } else if (views->has_ring) {
            double turn = 2 * IGI_PI * (double)i / (double)*count, r = views->ring_radius;
            igi_vec centre = igi_v_ofd(views->ring_centre);
            igi_vec off = igi_v((float)(r * cos(turn)), (float)(r * sin(turn)), (float)views->ring_height);
            (*cameras)[i] = camera_at(views, igi_add(centre, off), centre);
        } else {
            IGI_TRY_GOTO(choose_one(ctx, &c, &(*cameras)[i]));
        }
    }
cleanup:
    igi_free(c.hidden);
    return status;
}

igi_status views_save(igi_context *ctx, const igi_camera *cameras, size_t count, const char *path)
{
    json_t *frames = json_array();
    int bad = !frames;
    for (size_t i = 0; i < count; i++) {
        json_t *rows = json_array();
        for (int r = 0; r < 3; r++) {
            const double *m = cameras[i].camera_to_world[r];
            bad |= json_array_append_new(rows, json_pack("[ffff]", m[0], m[1], m[2], m[3]));
        }
        bad |= json_array_append_new(rows, json_pack("[ffff]", 0.0, 0.0, 0.0, 1.0));
        json_t *file = json_sprintf("images/%04zu.exr", i);
        bad |= json_array_append_new(frames, json_pack("{soso}", "file_path", file, "transform_matrix", rows));
    }
    const igi_camera *c = &cameras[0];
    json_t *root = json_pack("{ss si si sf sf sf sf so}", "camera_model", "OPENCV", "w", c->width,
                             "h", c->height, "fl_x", c->fl_x, "fl_y", c->fl_y, "cx", c->cx, "cy",
                             c->cy, "frames", frames);
    igi_status status = bad || !root ? igi_fail(ctx, IGI_E_SYSTEM, "%s: no memory to write it", path)
                                     : save_json(ctx, root, path);
    json_decref(root);
    return status;
}
