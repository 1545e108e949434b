/* SPDX-License-Identifier: Apache-2.0
 *
 * Calibrations, and how they are written: calib/NAME.json, whose schema is in calib/README.md.
 */
#include "base/file.h"
#include "lens/lens_private.h"
#include "scene/json.h"

#include <math.h>

const char *const igi_lens_keys[9] = {"fl_x", "fl_y", "cx", "cy", "k1", "k2", "p1", "p2", "k3"};

double *igi_lens_field(igi_camera *lens, int i)
{
    double *fields[9] = {&lens->fl_x, &lens->fl_y, &lens->cx, &lens->cy, &lens->k1,
                         &lens->k2,   &lens->p1,   &lens->p2, &lens->k3};
    return fields[i];
}

igi_status igi_calibration_create(igi_context *ctx, int width, int height,
                                  igi_calibration **calibration)
{
    igi_calibration *made = NULL;
    *calibration = NULL;
    IGI_TRY(IGI_ALLOC(ctx, 1, &made));
    made->width = made->lens.width = width;
    made->height = made->lens.height = height;
    igi_status status = igi_strdup(ctx, "", &made->camera);
    if (status == IGI_OK) *calibration = made;
    else igi_calibration_destroy(made);
    return status;
}

void igi_calibration_forget_views(igi_calibration *calibration)
{
    for (size_t i = 0; i < calibration->view_count; i++) {
        igi_free(calibration->views[i].file);
        igi_free(calibration->views[i].corners);
    }
    igi_free(calibration->views);
    calibration->views = NULL;
    calibration->view_count = 0;
}

void igi_calibration_destroy(igi_calibration *calibration)
{
    if (!calibration) return;
    igi_calibration_forget_views(calibration);
    igi_free(calibration->camera);
    igi_response_destroy(calibration->response);
    igi_free(calibration);
}

igi_status igi_calibration_for(igi_context *ctx, const char *path, const igi_photo *photo,
                               igi_calibration **calibration)
{
    if (!*calibration) {
        IGI_TRY(igi_calibration_create(ctx, photo->width, photo->height, calibration));
        igi_free((*calibration)->camera);
        (*calibration)->camera = NULL;
        return igi_strdup(ctx, photo->camera, &(*calibration)->camera);
    }
    if (photo->width == (*calibration)->width && photo->height == (*calibration)->height)
        return IGI_OK;
    return igi_fail(ctx, IGI_E_DATA,
                    "%s: %d x %d pixels, and the calibration is for %d x %d; use photographs of "
                    "one camera at its full size",
                    path, photo->width, photo->height, (*calibration)->width,
                    (*calibration)->height);
}

static json_t *numbers(const double *x, size_t count)
{
    json_t *array = json_array();
    for (size_t i = 0; i < count; i++) json_array_append_new(array, json_real(x[i]));
    return array;
}

static void put_lens(json_t *root, const igi_calibration *c)
{
    igi_camera lens = c->lens;
    json_t *deviations = json_object();
    for (int i = 0; i < 9; i++) {
        json_object_set_new(root, igi_lens_keys[i], json_real(*igi_lens_field(&lens, i)));
        json_object_set_new(deviations, igi_lens_keys[i], json_real(c->deviations[i]));
    }
    json_object_set_new(root, "std", deviations);
    json_object_set_new(root, "rms_px", json_real(c->rms_px));
    json_t *views = json_array();
    for (size_t i = 0; i < c->view_count; i++) {
        json_t *view = json_object();
        json_object_set_new(view, "file", json_string(c->views[i].file));
        json_object_set_new(view, "rms_px", json_real(c->views[i].rms_px));
        json_object_set_new(view, "used", json_boolean(c->views[i].used));
        json_array_append_new(views, view);
    }
    json_object_set_new(root, "views", views);
}

static json_t *pack_vignetting(const igi_vignetting *v)
{
    json_t *object = json_object();
    const double centre[2] = {v->centre_x, v->centre_y};
    json_object_set_new(object, "centre", numbers(centre, 2));
    json_object_set_new(object, "k", numbers(v->k, 3));
    json_object_set_new(object, "rms", json_real(v->rms));
    json_object_set_new(object, "f_number", json_real(v->f_number));
    json_object_set_new(object, "focal_mm", json_real(v->focal_mm));
    return object;
}

static json_t *pack_response(const igi_response *r)
{
    json_t *object = json_object(), *low = json_array(), *high = json_array(),
           *curves = json_array();
    json_object_set_new(object, "levels", json_integer(r->levels));
    for (int c = 0; c < r->channels; c++) {
        json_t *curve = json_array();
        json_array_append_new(low, json_integer(r->low[c]));
        json_array_append_new(high, json_integer(r->high[c]));
        for (int z = 0; z < r->levels; z++)
            json_array_append_new(curve, json_real((double)r->exposure[c * r->levels + z]));
        json_array_append_new(curves, curve);
    }
    json_object_set_new(object, "low", low);
    json_object_set_new(object, "high", high);
    json_object_set_new(object, "exposure", curves);
    if (r->deviation > 0) json_object_set_new(object, "std", json_real(r->deviation));
    return object;
}

bool igi_calibration_is_opencv(const char *path)
{
    return igi_ends_with(path, ".yml") || igi_ends_with(path, ".yaml") ||
           igi_ends_with(path, ".xml");
}

bool igi_calibration_is_foreign(const char *path)
{
    return igi_calibration_is_opencv(path) || igi_ends_with(path, "cameras.txt") ||
           igi_ends_with(path, ".bin");
}

igi_status igi_calibration_save(igi_context *ctx, const igi_calibration *calibration,
                                const char *path)
{
    json_t *root = json_object();
    json_object_set_new(root, "igi", json_integer(1));
    json_object_set_new(root, "camera", json_string(calibration->camera));
    json_object_set_new(root, "w", json_integer(calibration->width));
    json_object_set_new(root, "h", json_integer(calibration->height));
    if (calibration->has_lens) put_lens(root, calibration);
    if (calibration->vignetting.known)
        json_object_set_new(root, "vignetting", pack_vignetting(&calibration->vignetting));
    if (calibration->response)
        json_object_set_new(root, "response", pack_response(calibration->response));
    igi_status status = igi_file_save_json(ctx, path, root, 9);
    json_decref(root);
    return status;
}
