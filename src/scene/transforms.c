/* SPDX-License-Identifier: Apache-2.0
 *
 * transforms.json as nerfstudio and instant-ngp have it. Other tools write it, with keys of their
 * own: what is not known here is passed over.
 */
#include "scene/frame.h"
#include "scene/json.h"

#include <igi/image.h>

#include <math.h>
#include <string.h>

typedef struct numbers {
    double w, h, fl_x, fl_y, cx, cy, k1, k2, k3, k4, p1, p2, angle_x, angle_y; /* NaN: not given */
} numbers;

/* Takes what the object gives; the rest stays as it was. */
static igi_status read_numbers(igi_context *ctx, const igi_json *object, numbers *n)
{
    const struct {
        const char *key;
        double *value;
    } keys[] = {{"w", &n->w},
                {"h", &n->h},
                {"fl_x", &n->fl_x},
                {"fl_y", &n->fl_y},
                {"cx", &n->cx},
                {"cy", &n->cy},
                {"k1", &n->k1},
                {"k2", &n->k2},
                {"k3", &n->k3},
                {"k4", &n->k4},
                {"p1", &n->p1},
                {"p2", &n->p2},
                {"camera_angle_x", &n->angle_x},
                {"camera_angle_y", &n->angle_y}};
    for (size_t i = 0; i < sizeof keys / sizeof keys[0]; i++) {
        igi_json member = igi_json_member(object, keys[i].key);
        if (member.value) IGI_TRY(igi_json_number(ctx, &member, keys[i].value));
    }
    return IGI_OK;
}

static igi_status check_model(igi_context *ctx, const igi_json *object)
{
    static const char *const pinholes[] = {"OPENCV",        "PINHOLE", "SIMPLE_PINHOLE",
                                           "SIMPLE_RADIAL", "RADIAL",  "FULL_OPENCV",
                                           "PERSPECTIVE"};
    igi_json model = igi_json_member(object, "camera_model");
    igi_json fisheye = igi_json_member(object, "is_fisheye");
    if (json_is_true(fisheye.value))
        return igi_json_fail(ctx, &fisheye, "fisheye cameras are not known; undistort the images");
    if (!model.value) return IGI_OK;
    const char *name;
    IGI_TRY(igi_json_string(ctx, &model, &name));
    for (size_t i = 0; i < sizeof pinholes / sizeof pinholes[0]; i++)
        if (strcmp(name, pinholes[i]) == 0) return IGI_OK;
    return igi_json_fail(ctx, &model,
                         "camera model \"%s\" is not known; undistort the images, or "
                         "use OPENCV",
                         name);
}

static double otherwise(double value, double fallback)
{
    return isnan(value) ? fallback : value;
}

static igi_status make_camera(igi_context *ctx, const igi_json *frame, const char *path,
                              const numbers *n, igi_camera *c)
{
    if (!isnan(n->w) && !isnan(n->h)) {
        if (!(n->w >= 1 && n->h >= 1 && n->w <= 1 << 20 && n->h <= 1 << 20) ||
            n->w != floor(n->w) || n->h != floor(n->h))
            return igi_json_fail(ctx, frame, "\"w\" and \"h\" must be whole numbers of pixels");
        c->width = (int)n->w;
        c->height = (int)n->h;
    } else {
        int channels, bands;
        if (igi_image_probe_exr(ctx, path, &c->width, &c->height, &channels, &bands) != IGI_OK)
            return igi_json_fail(ctx, frame,
                                 "no \"w\" and \"h\", and %s does not tell them; give "
                                 "them",
                                 path);
    }
    if (otherwise(n->k4, 0) != 0)
        return igi_json_fail(ctx, frame, "\"k4\" is not 0, as of a fisheye; undistort the images");
    double fl_x = n->fl_x, fl_y = n->fl_y;
    if (isnan(fl_x)) fl_x = .5 * c->width / tan(.5 * n->angle_x);
    if (isnan(fl_y)) fl_y = .5 * c->height / tan(.5 * n->angle_y);
    c->fl_x = otherwise(fl_x, fl_y);
    c->fl_y = otherwise(fl_y, fl_x);
    if (isnan(c->fl_x))
        return igi_json_fail(ctx, frame, "no focal length; give \"fl_x\" or \"camera_angle_x\"");
    c->cx = otherwise(n->cx, .5 * c->width);
    c->cy = otherwise(n->cy, .5 * c->height);
    c->k1 = otherwise(n->k1, 0);
    c->k2 = otherwise(n->k2, 0);
    c->k3 = otherwise(n->k3, 0);
    c->p1 = otherwise(n->p1, 0);
    c->p2 = otherwise(n->p2, 0);
    const char *fault = igi_camera_fault(c);
    return fault ? igi_json_fail(ctx, frame, "%s; correct it", fault) : IGI_OK;
}

static igi_status read_matrix(igi_context *ctx, const igi_json *frame, igi_camera *c)
{
    igi_json matrix = igi_json_member(frame, "transform_matrix");
    size_t rows;
    IGI_TRY(igi_json_array(ctx, &matrix, &rows));
    if (rows != 3 && rows != 4)
        return igi_json_fail(ctx, &matrix, "has %zu rows; give 4 (or 3) of 4 numbers", rows);
    for (size_t i = 0; i < rows; i++) {
        double entry[4];
        igi_json row = igi_json_element(&matrix, i);
        IGI_TRY(igi_json_numbers(ctx, &row, 4, entry));
        if (i < 3) memcpy(c->camera_to_world[i], entry, sizeof entry);
        else if (entry[0] != 0 || entry[1] != 0 || entry[2] != 0 || entry[3] != 1)
            return igi_json_fail(ctx, &row, "is the last row and must be 0 0 0 1");
    }
    if (!igi_frame_orthonormalize(c))
        return igi_json_fail(ctx, &matrix,
                             "is no rotation and translation; its first three columns "
                             "must be at right angles, of one length, right-handed");
    return IGI_OK;
}

static igi_status read_frame(igi_context *ctx, const igi_json *at, const char *folder,
                             const numbers *global, igi_frame *frame)
{
    numbers n = *global;
    const char *name;
    IGI_TRY(igi_json_object(ctx, at));
    igi_json file = igi_json_member(at, "file_path");
    IGI_TRY(igi_json_string(ctx, &file, &name));
    IGI_TRY(igi_image_path(ctx, folder, name, &frame->path));
    IGI_TRY(igi_path_stem(ctx, name, &frame->name));
    IGI_TRY(check_model(ctx, at));
    IGI_TRY(read_numbers(ctx, at, &n));
    IGI_TRY(make_camera(ctx, at, frame->path, &n, &frame->camera));
    return read_matrix(ctx, at, &frame->camera);
}

igi_status igi_transforms_read(igi_context *ctx, const char *path, igi_frame **frames,
                               size_t *count)
{
    igi_json_file file;
    char *folder = NULL;
    size_t frame_count;
    const double no = (double)NAN;
    numbers global = {no, no, no, no, no, no, no, no, no, no, no, no, no, no};
    igi_status status = igi_json_load(ctx, path, &file);
    if (status != IGI_OK) return status;
    igi_json root = igi_json_root(&file);
    IGI_TRY_GOTO(igi_path_folder(ctx, path, &folder));
    IGI_TRY_GOTO(igi_json_object(ctx, &root));
    IGI_TRY_GOTO(check_model(ctx, &root));
    IGI_TRY_GOTO(read_numbers(ctx, &root, &global));
    igi_json list = igi_json_member(&root, "frames");
    IGI_TRY_GOTO(igi_json_array(ctx, &list, &frame_count));
    if (frame_count == 0) {
        status = igi_json_fail(ctx, &list, "is empty; give at least one frame");
        goto cleanup;
    }
    IGI_TRY_GOTO(IGI_ALLOC(ctx, frame_count, frames));
    *count = frame_count;
    for (size_t i = 0; i < frame_count; i++) {
        igi_json at = igi_json_element(&list, i);
        IGI_TRY_GOTO(read_frame(ctx, &at, folder, &global, &(*frames)[i]));
    }
cleanup:
    igi_free(folder);
    igi_json_unload(&file);
    return status;
}
