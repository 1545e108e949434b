/* SPDX-License-Identifier: Apache-2.0
 *
 * calib/NAME.json, read.
 */
#include "lens/lens_private.h"
#include "scene/json.h"

#include <math.h>

static igi_status read_size(igi_context *ctx, const igi_json *root, const char *key, int *value)
{
    double x;
    igi_json at = igi_json_member(root, key);
    IGI_TRY(igi_json_number(ctx, &at, &x));
    if (!(x >= 1 && x <= 65535) || x != floor(x))
        return igi_json_fail(ctx, &at, "is %g; it must be a number of pixels", x);
    *value = (int)x;
    return IGI_OK;
}

static igi_status read_views(igi_context *ctx, const igi_json *root, igi_calibration *c)
{
    igi_json views = igi_json_member(root, "views");
    size_t count = 0;
    if (!views.value) return IGI_OK;
    IGI_TRY(igi_json_array(ctx, &views, &count));
    IGI_TRY(IGI_ALLOC(ctx, count, &c->views));
    for (size_t i = 0; i < count; i++) {
        igi_json view = igi_json_element(&views, i), file = igi_json_member(&view, "file");
        igi_json rms = igi_json_member(&view, "rms_px"), used = igi_json_member(&view, "used");
        const char *name = NULL;
        IGI_TRY(igi_json_object(ctx, &view));
        IGI_TRY(igi_json_string(ctx, &file, &name));
        IGI_TRY(igi_json_number(ctx, &rms, &c->views[i].rms_px));
        IGI_TRY(igi_json_bool(ctx, &used, &c->views[i].used));
        IGI_TRY(igi_strdup(ctx, name, &c->views[i].file));
        c->view_count = i + 1;
    }
    return IGI_OK;
}

static igi_status read_lens(igi_context *ctx, const igi_json *root, igi_calibration *c)
{
    if (!igi_json_member(root, "fl_x").value) return IGI_OK;
    igi_json deviations = igi_json_member(root, "std"), rms = igi_json_member(root, "rms_px");
    for (int i = 0; i < 9; i++) {
        igi_json at = igi_json_member(root, igi_lens_keys[i]);
        bool optional = i >= 4;
        if (optional && !at.value) continue;
        IGI_TRY(igi_json_number(ctx, &at, igi_lens_field(&c->lens, i)));
        if (i < 2 && !(c->lens.fl_x > 0 && (i == 0 || c->lens.fl_y > 0)))
            return igi_json_fail(ctx, &at, "must be positive");
        if (!deviations.value) continue;
        igi_json deviation = igi_json_member(&deviations, igi_lens_keys[i]);
        if (deviation.value) IGI_TRY(igi_json_number(ctx, &deviation, &c->deviations[i]));
    }
    if (rms.value) IGI_TRY(igi_json_number(ctx, &rms, &c->rms_px));
    c->has_lens = true;
    return read_views(ctx, root, c);
}

static igi_status read_vignetting(igi_context *ctx, const igi_json *root, igi_vignetting *v)
{
    igi_json at = igi_json_member(root, "vignetting");
    if (!at.value) return IGI_OK;
    static const char *const keys[] = {"centre", "k", "rms", "f_number", "focal_mm"};
    double *fields[] = {&v->rms, &v->f_number, &v->focal_mm}, centre[2];
    igi_json middle = igi_json_member(&at, "centre"), k = igi_json_member(&at, "k");
    IGI_TRY(igi_json_object(ctx, &at));
    IGI_TRY(igi_json_check_keys(ctx, &at, keys, sizeof keys / sizeof keys[0]));
    IGI_TRY(igi_json_numbers(ctx, &middle, 2, centre));
    IGI_TRY(igi_json_numbers(ctx, &k, 3, v->k));
    for (int i = 0; i < 3; i++) {
        igi_json field = igi_json_member(&at, keys[i + 2]);
        if (field.value) IGI_TRY(igi_json_number(ctx, &field, fields[i]));
    }
    v->centre_x = centre[0];
    v->centre_y = centre[1];
    v->known = true;
    return IGI_OK;
}

/* One curve: rising from 0 or above. */
static igi_status read_curve(igi_context *ctx, const igi_json *at, int channel, igi_response *r)
{
    igi_status status = IGI_OK;
    double *values = NULL;
    size_t levels = (size_t)r->levels;
    IGI_TRY(IGI_ALLOC(ctx, levels, &values));
    IGI_TRY_GOTO(igi_json_numbers(ctx, at, levels, values));
    for (size_t z = 0; z < levels; z++) {
        if (values[z] < 0 || (z > 0 && values[z] < values[z - 1])) {
            status = igi_json_fail(ctx, at, "falls at code %zu; a response rises", z);
            goto cleanup;
        }
        r->exposure[(size_t)channel * levels + z] = (float)values[z];
    }
cleanup:
    igi_free(values);
    return status;
}

static igi_status read_response(igi_context *ctx, const igi_json *root, igi_response **response)
{
    igi_json at = igi_json_member(root, "response");
    if (!at.value) return IGI_OK;
    igi_json levels = igi_json_member(&at, "levels"), curves = igi_json_member(&at, "exposure");
    igi_json low = igi_json_member(&at, "low"), high = igi_json_member(&at, "high");
    igi_json std = igi_json_member(&at, "std");
    double number, lows[3], highs[3], deviation = 0;
    size_t channels = 0;
    IGI_TRY(igi_json_object(ctx, &at));
    IGI_TRY(igi_json_number(ctx, &levels, &number));
    IGI_TRY(igi_json_array(ctx, &curves, &channels));
    if ((number != 256 && number != 65536) || (channels != 1 && channels != 3))
        return igi_json_fail(ctx, &at, "must have 256 or 65536 levels, and 1 or 3 curves");
    IGI_TRY(igi_json_numbers(ctx, &low, channels, lows));
    IGI_TRY(igi_json_numbers(ctx, &high, channels, highs));
    if (std.value) IGI_TRY(igi_json_number(ctx, &std, &deviation));
    if (!(deviation >= 0 && deviation < 10))
        return igi_json_fail(ctx, &std, "is %g; give a relative standard deviation", deviation);
    IGI_TRY(igi_response_create(ctx, (int)channels, (int)number, response));
    (*response)->deviation = deviation;
    for (size_t c = 0; c < channels; c++) {
        igi_json curve = igi_json_element(&curves, c);
        if (!(lows[c] >= 0 && lows[c] < highs[c] && highs[c] < number))
            return igi_json_fail(ctx, &at, "low and high must be codes, low the lower");
        (*response)->low[c] = (int)lows[c];
        (*response)->high[c] = (int)highs[c];
        IGI_TRY(read_curve(ctx, &curve, (int)c, *response));
    }
    return IGI_OK;
}

static igi_status read_all(igi_context *ctx, const igi_json *root, igi_calibration **calibration)
{
    int width = 0, height = 0;
    double version;
    igi_json igi = igi_json_member(root, "igi"), camera = igi_json_member(root, "camera");
    IGI_TRY(igi_json_object(ctx, root));
    IGI_TRY(igi_json_number(ctx, &igi, &version));
    if (version != 1)
        return igi_json_fail(ctx, &igi, "is %g; this program reads version 1", version);
    IGI_TRY(read_size(ctx, root, "w", &width));
    IGI_TRY(read_size(ctx, root, "h", &height));
    IGI_TRY(igi_calibration_create(ctx, width, height, calibration));
    if (camera.value && json_string_length(camera.value) > 0) {
        const char *name = NULL;
        IGI_TRY(igi_json_string(ctx, &camera, &name));
        igi_free((*calibration)->camera);
        (*calibration)->camera = NULL;
        IGI_TRY(igi_strdup(ctx, name, &(*calibration)->camera));
    }
    IGI_TRY(read_lens(ctx, root, *calibration));
    IGI_TRY(read_vignetting(ctx, root, &(*calibration)->vignetting));
    return read_response(ctx, root, &(*calibration)->response);
}

igi_status igi_calibration_load(igi_context *ctx, const char *path, igi_calibration **calibration)
{
    igi_json_file file = {0};
    *calibration = NULL;
    if (igi_calibration_is_foreign(path))
        return igi_fail(ctx, IGI_E_DATA,
                        "%s: a lens of another program's; igi calibrate --convert makes a .json of "
                        "it",
                        path);
    IGI_TRY(igi_json_load(ctx, path, &file));
    igi_json root = igi_json_root(&file);
    igi_status status = read_all(ctx, &root, calibration);
    igi_json_unload(&file);
    if (status != IGI_OK) {
        igi_calibration_destroy(*calibration);
        *calibration = NULL;
    }
    return status;
}
