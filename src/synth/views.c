/* SPDX-License-Identifier: Apache-2.0
 *
 * Cameras: read from the spec, listed or on a ring, and written as transforms.json.
 */
#include "synth/synth.h"
#include "base/file.h"

#include "scene/camera.h"

#include <math.h>

#define COUNT(array) (sizeof(array) / sizeof(array)[0])

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
    static const char *const known[] = {"width",     "height", "count", "samples",
                                        "fov_deg",   "seed",   "eyes",  "unseen",
                                        "clearance", "ring",   "look"};
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

igi_status views_choose(igi_context *ctx, const view_set *views, const igi_scene *scene,
                        const igi_tracer *tracer, igi_camera **cameras, size_t *count)
{
    *count = views->look_count ? views->look_count : (size_t)views->count;
    IGI_TRY(IGI_ALLOC(ctx, *count, cameras));
    if (!views->look_count && !views->has_ring)
        return views_place(ctx, views, scene, tracer, *cameras, *count);
    for (size_t i = 0; i < *count; i++) {
        igi_vec target = igi_v_ofd(views->ring_centre), eye;
        double turn = 2 * IGI_PI * (double)i / (double)*count, r = views->ring_radius;
        eye = igi_add(target, igi_v((float)(r * cos(turn)), (float)(r * sin(turn)),
                                    (float)views->ring_height));
        if (views->look_count) {
            eye = igi_v_ofd(views->look[i][0]);
            target = igi_v_ofd(views->look[i][1]);
        }
        (*cameras)[i] = view_camera(views, eye, target);
    }
    return IGI_OK;
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
        bad |= json_array_append_new(
            frames, json_pack("{soso}", "file_path", file, "transform_matrix", rows));
    }
    const igi_camera *c = &cameras[0];
    json_t *root = json_pack("{ss si si sf sf sf sf so}", "camera_model", "OPENCV", "w", c->width,
                             "h", c->height, "fl_x", c->fl_x, "fl_y", c->fl_y, "cx", c->cx, "cy",
                             c->cy, "frames", frames);
    igi_status status = bad || !root
                            ? igi_fail(ctx, IGI_E_SYSTEM, "%s: no memory to write it", path)
                            : igi_file_save_json(ctx, path, root, 9);
    json_decref(root);
    return status;
}
