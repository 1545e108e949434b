/* SPDX-License-Identifier: Apache-2.0
 *
 * A COLMAP model as it is read: cameras with their models, and images with their poses.
 */
#include "scene/colmap_private.h"

#include <stdlib.h>
#include <string.h>

/* Where each model keeps what: letters are f (both focal lengths), x, y (one), u, v (centre),
 * 1 2 3 (k), p q (p1 p2), 0 (must be zero). */
static const struct {
    const char *name;
    int id;
    const char *parameters;
} models[] = {{"SIMPLE_PINHOLE", 0, "fuv"}, {"PINHOLE", 1, "xyuv"},
              {"SIMPLE_RADIAL", 2, "fuv1"}, {"RADIAL", 3, "fuv12"},
              {"OPENCV", 4, "xyuv12pq"},    {"FULL_OPENCV", 6, "xyuv12pq3000"}};
#define MODEL_COUNT (sizeof models / sizeof models[0])

size_t igi_colmap_find_model(const char *name, size_t length, uint64_t number)
{
    for (size_t i = 0; i < MODEL_COUNT; i++) {
        if (!name && (uint64_t)models[i].id == number) return i;
        if (name && strlen(models[i].name) == length && memcmp(models[i].name, name, length) == 0)
            return i;
    }
    return IGI_COLMAP_NO_MODEL;
}

size_t igi_colmap_parameter_count(size_t model)
{
    return strlen(models[model].parameters);
}

igi_status igi_colmap_fail(const igi_colmap *r, const char *what)
{
    if (r->line) return igi_fail(r->ctx, IGI_E_DATA, "%s:%u: %s", r->file, r->line, what);
    return igi_fail(r->ctx, IGI_E_DATA, "%s: byte %zu: %s", r->file,
                    (size_t)(r->at - r->text.bytes), what);
}

igi_status igi_colmap_set_camera(const igi_colmap *r, igi_colmap_camera *c, size_t model,
                                 const double *values)
{
    for (size_t i = 0; models[model].parameters[i]; i++) {
        double v = values[i];
        switch (models[model].parameters[i]) {
        case 'f': c->camera.fl_x = c->camera.fl_y = v; break;
        case 'x': c->camera.fl_x = v; break;
        case 'y': c->camera.fl_y = v; break;
        case 'u': c->camera.cx = v; break;
        case 'v': c->camera.cy = v; break;
        case '1': c->camera.k1 = v; break;
        case '2': c->camera.k2 = v; break;
        case '3': c->camera.k3 = v; break;
        case 'p': c->camera.p1 = v; break;
        case 'q': c->camera.p2 = v; break;
        default:
            if (v != 0)
                return igi_colmap_fail(
                    r, "FULL_OPENCV with k4, k5 or k6 is not known; undistort the images");
        }
    }
    const char *fault = igi_camera_fault(&c->camera);
    return fault ? igi_colmap_fail(r, fault) : IGI_OK;
}

igi_status igi_colmap_add_camera(igi_colmap *r, igi_colmap_camera **camera)
{
    void *grown = igi_grow(r->ctx, r->cameras, &r->camera_capacity, r->camera_count + 1,
                           sizeof *r->cameras);
    if (!grown) return IGI_E_SYSTEM;
    r->cameras = grown;
    *camera = &r->cameras[r->camera_count++];
    **camera = (igi_colmap_camera){0};
    return IGI_OK;
}

/* The image: beside the model, in its folder "images", or the same one to three folders up. One that
 * is missing is looked for where the others are. */
static igi_status find_image(igi_colmap *r, const char *name, char **path)
{
    static const char *const places[] = {"../images", "images",       ".",
                                         "..",        "../../images", "../../../images"};
    igi_status status = IGI_OK;
    size_t count = sizeof places / sizeof places[0];
    *path = NULL;
    for (size_t i = 0; i <= count && status == IGI_OK; i++) {
        char *folder = NULL;
        const char *place = i < count ? places[i] : r->images ? r->images : places[0];
        igi_free(*path);
        *path = NULL;
        status = igi_path_join(r->ctx, r->folder, place, &folder);
        if (status == IGI_OK) status = igi_image_path(r->ctx, folder, name, path);
        igi_free(folder);
        if (status != IGI_OK || i == count || !igi_file_exists(*path)) continue;
        r->images = place;
        break;
    }
    return status;
}

/* q (w x y z) and t take the world to the camera, OpenCV's axes. */
static igi_status set_pose(igi_colmap *r, igi_camera *c, const double q[4], const double t[3])
{
    double n = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    if (!(n > 1e-12 && n < 1e12))
        return igi_colmap_fail(r, "the rotation's quaternion has no direction");
    double s = 2 / n, w = q[0], x = q[1], y = q[2], z = q[3];
    const double rotation[3][3] = {
        {1 - s * (y * y + z * z), s * (x * y - w * z), s * (x * z + w * y)},
        {s * (x * y + w * z), 1 - s * (x * x + z * z), s * (y * z - w * x)},
        {s * (x * z - w * y), s * (y * z + w * x), 1 - s * (x * x + y * y)}};
    for (int i = 0; i < 3; i++) {
        c->camera_to_world[i][0] = rotation[0][i];
        c->camera_to_world[i][1] = -rotation[1][i]; /* OpenGL's y is up, its z backward */
        c->camera_to_world[i][2] = -rotation[2][i];
        c->camera_to_world[i][3] = 0;
        for (int k = 0; k < 3; k++) c->camera_to_world[i][3] -= rotation[k][i] * t[k];
    }
    return igi_frame_orthonormalize(c) ? IGI_OK : igi_colmap_fail(r, "the pose is not finite");
}

static int by_id(const void *a, const void *b)
{
    const igi_colmap_camera *x = a, *y = b;
    return (x->id > y->id) - (x->id < y->id);
}

void igi_colmap_sort_cameras(igi_colmap *r)
{
    if (r->camera_count) qsort(r->cameras, r->camera_count, sizeof *r->cameras, by_id);
}

igi_status igi_colmap_add_frame(igi_colmap *r, const double pose[7], uint64_t camera,
                                const char *name)
{
    const igi_colmap_camera key = {.id = camera};
    const igi_colmap_camera *found = r->camera_count ? bsearch(&key, r->cameras, r->camera_count,
                                                               sizeof key, by_id)
                                                     : NULL;
    if (!found) return igi_colmap_fail(r, "the image names a camera that is not in cameras");
    if (!name[0]) return igi_colmap_fail(r, "the image has no name");
    void *grown = igi_grow(r->ctx, r->frames, &r->frame_capacity, r->frame_count + 1,
                           sizeof *r->frames);
    if (!grown) return IGI_E_SYSTEM;
    r->frames = grown;
    igi_frame *frame = &r->frames[r->frame_count++];
    *frame = (igi_frame){.camera = found->camera};
    IGI_TRY(set_pose(r, &frame->camera, pose, pose + 4));
    IGI_TRY(igi_path_stem(r->ctx, name, &frame->name));
    return find_image(r, name, &frame->path);
}
