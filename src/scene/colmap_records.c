/* SPDX-License-Identifier: Apache-2.0
 *
 * The lines and the bytes of COLMAP's models.
 */
#include "scene/colmap_private.h"

#include <string.h>

/* ---- text ---- */

static void skip_blanks(igi_colmap *r)
{
    while (*r->at == ' ' || *r->at == '\t' || *r->at == '\r') r->at++;
}

static void next_line(igi_colmap *r)
{
    const char *newline = memchr(r->at, '\n', (size_t)(r->end - r->at));
    r->at = newline ? newline + 1 : r->end;
    r->line++;
}

/* Goes to the next line that says something; false at the end. */
static bool find_line(igi_colmap *r)
{
    for (; r->at < r->end; next_line(r)) {
        skip_blanks(r);
        if (r->at < r->end && *r->at != '\n' && *r->at != '#') return true;
    }
    return false;
}

static bool scan_numbers(igi_colmap *r, double *values, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        skip_blanks(r);
        if (!igi_scan_number(&r->at, &values[i])) return false;
    }
    return true;
}

static bool scan_id(igi_colmap *r, uint64_t *id)
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

static igi_status read_text_camera(igi_colmap *r)
{
    igi_colmap_camera *c;
    double size[2], values[IGI_COLMAP_MAX_PARAMETERS];
    IGI_TRY(igi_colmap_add_camera(r, &c));
    if (!scan_id(r, &c->id)) return igi_colmap_fail(r, "no camera's number at the line's start");
    skip_blanks(r);
    size_t length = strcspn(r->at, " \t\r\n");
    size_t model = igi_colmap_find_model(r->at, length, 0);
    if (model == IGI_COLMAP_NO_MODEL)
        return igi_colmap_fail(
            r, "camera model not known; undistort the images with COLMAP, or use OPENCV");
    r->at += length;
    if (!scan_numbers(r, size, 2) || !scan_size(size, &c->camera))
        return igi_colmap_fail(r, "no width and height in pixels");
    if (!scan_numbers(r, values, igi_colmap_parameter_count(model)))
        return igi_colmap_fail(r, "fewer parameters than the camera's model has");
    return igi_colmap_set_camera(r, c, model, values);
}

static igi_status read_text_image(igi_colmap *r)
{
    uint64_t id, camera;
    double pose[7];
    if (!scan_id(r, &id) || !scan_numbers(r, pose, 7) || !scan_id(r, &camera))
        return igi_colmap_fail(r, "not IMAGE_ID QW QX QY QZ TX TY TZ CAMERA_ID NAME");
    skip_blanks(r);
    size_t length = strcspn(r->at, "\r\n");
    char *name;
    IGI_TRY(igi_strprintf(r->ctx, &name, "%.*s", (int)length, r->at));
    igi_status status = igi_colmap_add_frame(r, pose, camera, name);
    igi_free(name);
    if (status == IGI_OK) next_line(r); /* the points that it sees follow, perhaps none */
    return status;
}

igi_status igi_colmap_read_text(igi_colmap *r, bool images)
{
    for (r->line = 1; find_line(r); next_line(r))
        IGI_TRY(images ? read_text_image(r) : read_text_camera(r));
    return IGI_OK;
}

/* ---- binary: little endian, packed ---- */

static bool take_bytes(igi_colmap *r, size_t count, uint64_t *value)
{
    if ((size_t)(r->end - r->at) < count) return false;
    *value = 0;
    for (size_t i = 0; i < count; i++) *value |= (uint64_t)(unsigned char)r->at[i] << (8 * i);
    r->at += count;
    return true;
}

static bool take_doubles(igi_colmap *r, double *values, size_t count)
{
    for (size_t i = 0; i < count; i++) {
        uint64_t bits;
        if (!take_bytes(r, 8, &bits)) return false;
        memcpy(&values[i], &bits, sizeof bits);
    }
    return true;
}

static igi_status read_binary_camera(igi_colmap *r)
{
    igi_colmap_camera *c;
    uint64_t number, size[2];
    double values[IGI_COLMAP_MAX_PARAMETERS];
    IGI_TRY(igi_colmap_add_camera(r, &c));
    if (!take_bytes(r, 4, &c->id) || !take_bytes(r, 4, &number) || !take_bytes(r, 8, &size[0]) ||
        !take_bytes(r, 8, &size[1]))
        return igi_colmap_fail(r, "the file ends early; write it again");
    size_t model = igi_colmap_find_model(NULL, 0, number);
    if (model == IGI_COLMAP_NO_MODEL)
        return igi_colmap_fail(
            r, "camera model not known; undistort the images with COLMAP, or use OPENCV");
    const double pixels[2] = {(double)size[0], (double)size[1]};
    if (!scan_size(pixels, &c->camera)) return igi_colmap_fail(r, "no width and height in pixels");
    if (!take_doubles(r, values, igi_colmap_parameter_count(model)))
        return igi_colmap_fail(r, "the file ends early; write it again");
    return igi_colmap_set_camera(r, c, model, values);
}

static igi_status read_binary_image(igi_colmap *r)
{
    uint64_t id, camera, points;
    double pose[7];
    if (!take_bytes(r, 4, &id) || !take_doubles(r, pose, 7) || !take_bytes(r, 4, &camera))
        return igi_colmap_fail(r, "the file ends early; write it again");
    const char *name = r->at;
    const char *nul = memchr(name, 0, (size_t)(r->end - name));
    if (!nul) return igi_colmap_fail(r, "the file ends early; write it again");
    IGI_TRY(igi_colmap_add_frame(r, pose, camera, name));
    r->at = nul + 1;
    if (!take_bytes(r, 8, &points) || points > (size_t)(r->end - r->at) / 24)
        return igi_colmap_fail(r, "the file ends early; write it again");
    r->at += points * 24; /* x, y, the point's number */
    return IGI_OK;
}

igi_status igi_colmap_read_binary(igi_colmap *r, bool images)
{
    uint64_t count;
    r->line = 0;
    if (!take_bytes(r, 8, &count)) return igi_colmap_fail(r, "the file ends early; write it again");
    for (uint64_t i = 0; i < count; i++)
        IGI_TRY(images ? read_binary_image(r)
                       : read_binary_camera(r)); /* ends at the file's end at the latest */
    return IGI_OK;
}
