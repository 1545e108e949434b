/* SPDX-License-Identifier: Apache-2.0
 *
 * COLMAP's sparse models, text and binary: cameras and images. COLMAP keeps world-to-camera with
 * OpenCV's axes; its pixel centres are at .5, like ours. Frames come sorted by name, since COLMAP
 * writes them in no particular order.
 */
#include "scene/frames.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define MAX_MODEL_BYTES ((size_t)2 << 30)
#define MAX_PARAMETERS 16

typedef struct colmap_camera {
    uint64_t id;
    igi_camera camera; /* intrinsics */
} colmap_camera;

typedef struct colmap_reader {
    igi_context *ctx;
    const char *folder; /* of the model */
    char *file;         /* the one that is read */
    igi_text text;
    const char *at, *end;
    unsigned line; /* 0 in binary files */
    colmap_camera *cameras;
    size_t camera_count, camera_capacity;
    igi_frame *frames;
    size_t frame_count, frame_capacity;
} colmap_reader;

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

static igi_status fail(const colmap_reader *r, const char *what)
{
    if (r->line) return igi_fail(r->ctx, IGI_E_DATA, "%s:%u: %s", r->file, r->line, what);
    return igi_fail(r->ctx, IGI_E_DATA, "%s: byte %zu: %s", r->file,
                    (size_t)(r->at - r->text.bytes), what);
}

static igi_status set_camera(colmap_reader *r, colmap_camera *c, size_t model, const double *values)
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
                return fail(r, "FULL_OPENCV with k4, k5 or k6 is not known; undistort the images");
        }
    }
    const char *fault = igi_camera_fault(&c->camera);
    return fault ? fail(r, fault) : IGI_OK;
}

static igi_status add_camera(colmap_reader *r, colmap_camera **camera)
{
    void *grown = igi_grow(r->ctx, r->cameras, &r->camera_capacity, r->camera_count + 1,
                           sizeof *r->cameras);
    if (!grown) return IGI_E_SYSTEM;
    r->cameras = grown;
    *camera = &r->cameras[r->camera_count++];
    **camera = (colmap_camera){0};
    return IGI_OK;
}

/* The image: beside the model, in its folder "images", or the same one to three folders up. */
static igi_status find_image(colmap_reader *r, const char *name, char **path)
{
    static const char *const places[] = {"../images", "images",       ".",
                                         "..",        "../../images", "../../../images"};
    char *folder = NULL, *first = NULL;
    igi_status status = IGI_OK;
    *path = NULL;
    for (size_t i = 0; i < sizeof places / sizeof places[0]; i++) {
        IGI_TRY_GOTO(igi_path_join(r->ctx, r->folder, places[i], &folder));
        IGI_TRY_GOTO(igi_image_path(r->ctx, folder, name, path));
        igi_free(folder);
        folder = NULL;
        if (igi_file_exists(*path)) goto cleanup;
        if (!first) first = *path; /* named in the sentence if there is none */
        else igi_free(*path);
        *path = NULL;
    }
    *path = first;
    first = NULL;
cleanup:
    igi_free(folder);
    igi_free(first);
    return status;
}

/* q (w x y z) and t take the world to the camera, OpenCV's axes. */
static igi_status set_pose(colmap_reader *r, igi_camera *c, const double q[4], const double t[3])
{
    double n = q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3];
    if (!(n > 1e-12 && n < 1e12)) return fail(r, "the rotation's quaternion has no direction");
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
    return igi_frame_orthonormalize(c) ? IGI_OK : fail(r, "the pose is not finite");
}

static int by_id(const void *a, const void *b)
{
    const colmap_camera *x = a, *y = b;
    return (x->id > y->id) - (x->id < y->id);
}

static void sort_cameras(colmap_reader *r)
{
    if (r->camera_count) qsort(r->cameras, r->camera_count, sizeof *r->cameras, by_id);
}

static igi_status add_frame(colmap_reader *r, const double pose[7], uint64_t camera,
                            const char *name)
{
    const colmap_camera key = {.id = camera};
    const colmap_camera *found = r->camera_count
                                     ? bsearch(&key, r->cameras, r->camera_count, sizeof key, by_id)
                                     : NULL;
    if (!found) return fail(r, "the image names a camera that is not in cameras");
    if (!name[0]) return fail(r, "the image has no name");
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

/* ---- text ---- */

static void skip_blanks(colmap_reader *r)
{
    while (*r->at == ' ' || *r->at == '\t' || *r->at == '\r') r->at++;
}

static void next_line(colmap_reader *r)
{
    const char *newline = memchr(r->at, '\n', (size_t)(r->end - r->at));
    r->at = newline ? newline + 1 : r->end;
    r->line++;
}

/* Goes to the next line that says something; false at the end. */
static bool find_line(colmap_reader *r)
{
    for (; r->at < r->end; next_line(r)) {
        skip_blanks(r);
        if (r->at < r->end && *r->at != '\n' && *r->at != '#') return true;
    }
    return false;
}

static bool scan_numbers(colmap_reader *r, double *values, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        skip_blanks(r);
        if (!igi_scan_number(&r->at, &values[i])) return false;
    }
    return true;
}

static bool scan_id(colmap_reader *r, uint64_t *id)
{
    double value;
    if (!scan_numbers(r, &value, 1) || !(value >= 0 && value < 1e15)) return false;
    *id = (uint64_t)value;
    return true;
}

static bool scan_size(const double size[2], igi_camera *c)
{
    for (int k = 0; k < 2; k++)
        if (!(size[k] >= 1 && size[k] <= 1 << 20)) return false;
    c->width = (int)size[0];
    c->height = (int)size[1];
    return true;
}

static igi_status read_text_camera(colmap_reader *r)
{
    colmap_camera *c;
    double size[2], values[MAX_PARAMETERS];
    IGI_TRY(add_camera(r, &c));
    if (!scan_id(r, &c->id)) return fail(r, "no camera's number at the line's start");
    skip_blanks(r);
    size_t length = strcspn(r->at, " \t\r\n"), model = 0;
    while (model < MODEL_COUNT && (strlen(models[model].name) != length ||
                                   strncmp(models[model].name, r->at, length) != 0))
        model++;
    if (model == MODEL_COUNT)
        return fail(r, "camera model not known; undistort the images with COLMAP, or use OPENCV");
    r->at += length;
    if (!scan_numbers(r, size, 2) || !scan_size(size, &c->camera))
        return fail(r, "no width and height in pixels");
    if (!scan_numbers(r, values, strlen(models[model].parameters)))
        return fail(r, "fewer parameters than the camera's model has");
    return set_camera(r, c, model, values);
}

static igi_status read_text_image(colmap_reader *r)
{
    uint64_t id, camera;
    double pose[7];
    if (!scan_id(r, &id) || !scan_numbers(r, pose, 7) || !scan_id(r, &camera))
        return fail(r, "not IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME");
    skip_blanks(r);
    size_t length = strcspn(r->at, "\r\n");
    char *name;
    IGI_TRY(igi_strprintf(r->ctx, &name, "%.*s", (int)length, r->at));
    igi_status status = add_frame(r, pose, camera, name);
    igi_free(name);
    if (status == IGI_OK) next_line(r); /* the points that it sees follow, perhaps none */
    return status;
}

static igi_status read_text(colmap_reader *r, igi_status (*record)(colmap_reader *))
{
    for (r->line = 1; find_line(r); next_line(r)) IGI_TRY(record(r));
    return IGI_OK;
}

/* ---- binary: little endian, packed ---- */

static bool take_bytes(colmap_reader *r, size_t count, uint64_t *value)
{
    if ((size_t)(r->end - r->at) < count) return false;
    *value = 0;
    for (size_t i = 0; i < count; i++) *value |= (uint64_t)(unsigned char)r->at[i] << (8 * i);
    r->at += count;
    return true;
}

static bool take_doubles(colmap_reader *r, double *values, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        uint64_t bits;
        if (!take_bytes(r, 8, &bits)) return false;
        memcpy(&values[i], &bits, sizeof bits);
    }
    return true;
}

static igi_status read_binary_camera(colmap_reader *r)
{
    colmap_camera *c;
    uint64_t number, size[2];
    double values[MAX_PARAMETERS];
    IGI_TRY(add_camera(r, &c));
    if (!take_bytes(r, 4, &c->id) || !take_bytes(r, 4, &number) || !take_bytes(r, 8, &size[0]) ||
        !take_bytes(r, 8, &size[1]))
        return fail(r, "the file ends early; write it again");
    size_t model = 0;
    while (model < MODEL_COUNT && (uint64_t)models[model].id != number) model++;
    if (model == MODEL_COUNT)
        return fail(r, "camera model not known; undistort the images with COLMAP, or use OPENCV");
    const double pixels[2] = {(double)size[0], (double)size[1]};
    if (!scan_size(pixels, &c->camera)) return fail(r, "no width and height in pixels");
    if (!take_doubles(r, values, strlen(models[model].parameters)))
        return fail(r, "the file ends early; write it again");
    return set_camera(r, c, model, values);
}

static igi_status read_binary_image(colmap_reader *r)
{
    uint64_t id, camera, points;
    double pose[7];
    if (!take_bytes(r, 4, &id) || !take_doubles(r, pose, 7) || !take_bytes(r, 4, &camera))
        return fail(r, "the file ends early; write it again");
    const char *name = r->at;
    const char *nul = memchr(name, 0, (size_t)(r->end - name));
    if (!nul) return fail(r, "the file ends early; write it again");
    IGI_TRY(add_frame(r, pose, camera, name));
    r->at = nul + 1;
    if (!take_bytes(r, 8, &points) || points > (size_t)(r->end - r->at) / 24)
        return fail(r, "the file ends early; write it again");
    r->at += points * 24; /* x, y, the point's number */
    return IGI_OK;
}

static igi_status read_binary(colmap_reader *r, igi_status (*record)(colmap_reader *))
{
    uint64_t count;
    r->line = 0;
    if (!take_bytes(r, 8, &count)) return fail(r, "the file ends early; write it again");
    for (uint64_t i = 0; i < count; i++)
        IGI_TRY(record(r)); /* ends at the file's end at the latest */
    return IGI_OK;
}

/* ---- both ---- */

static igi_status open_part(colmap_reader *r, const char *name)
{
    igi_free(r->text.bytes);
    r->text = (igi_text){0};
    igi_free(r->file);
    IGI_TRY(igi_path_join(r->ctx, r->folder, name, &r->file));
    IGI_TRY(igi_text_load(r->ctx, r->file, MAX_MODEL_BYTES, &r->text));
    r->at = r->text.bytes;
    r->end = r->at + r->text.size;
    return IGI_OK;
}

static int by_name(const void *a, const void *b)
{
    const igi_frame *x = a, *y = b;
    int order = strcmp(x->name, y->name);
    return order ? order : strcmp(x->path, y->path);
}

static igi_status has_part(igi_context *ctx, const char *folder, const char *name, bool *has)
{
    char *path;
    IGI_TRY(igi_path_join(ctx, folder, name, &path));
    *has = igi_file_exists(path);
    igi_free(path);
    return IGI_OK;
}

static igi_status read_model(colmap_reader *r)
{
    bool is_binary, is_text;
    IGI_TRY(has_part(r->ctx, r->folder, "images.bin", &is_binary));
    IGI_TRY(has_part(r->ctx, r->folder, "images.txt", &is_text));
    if (is_binary) {
        IGI_TRY(open_part(r, "cameras.bin"));
        IGI_TRY(read_binary(r, read_binary_camera));
        sort_cameras(r);
        IGI_TRY(open_part(r, "images.bin"));
        IGI_TRY(read_binary(r, read_binary_image));
    } else if (is_text) {
        IGI_TRY(open_part(r, "cameras.txt"));
        IGI_TRY(read_text(r, read_text_camera));
        sort_cameras(r);
        IGI_TRY(open_part(r, "images.txt"));
        IGI_TRY(read_text(r, read_text_image));
    } else {
        return igi_fail(r->ctx, IGI_E_DATA,
                        "%s: neither images.bin nor images.txt; name the folder of COLMAP's model",
                        r->folder);
    }
    if (r->frame_count == 0) return fail(r, "no image in the model");
    qsort(r->frames, r->frame_count, sizeof *r->frames, by_name);
    return IGI_OK;
}

igi_status igi_colmap_read(igi_context *ctx, const char *folder, igi_frame **frames, size_t *count)
{
    static const char *const below[] = {"sparse/0/images.bin", "sparse/0/images.txt",
                                        "0/images.bin", "0/images.txt"};
    char *inner = NULL;
    colmap_reader r = {.ctx = ctx, .folder = folder};
    igi_status status = IGI_OK;
    for (size_t i = 0; i < sizeof below / sizeof below[0] && !inner; i++) {
        bool has;
        IGI_TRY_GOTO(has_part(ctx, folder, below[i], &has));
        if (has) IGI_TRY_GOTO(igi_path_join(ctx, folder, i < 2 ? "sparse/0" : "0", &inner));
    }
    if (inner) r.folder = inner;
    status = read_model(&r);
    *frames = r.frames;
    *count = r.frame_count;
cleanup:
    igi_free(inner);
    igi_free(r.file);
    igi_free(r.text.bytes);
    igi_free(r.cameras);
    return status;
}
