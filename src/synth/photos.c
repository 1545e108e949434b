/* SPDX-License-Identifier: Apache-2.0
 *
 * The pictures as a camera would have delivered them: brackets of clipped, noisy codes behind a
 * lens that distorts and shades, with EXIF; and what its owner would have measured beforehand.
 */
#include "synth/photos.h"

#include "base/file.h"
#include "base/rng.h"
#include "hdr/hdr.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <stdio.h>
#include <sys/stat.h>

#define EXPOSURES 5
#define STEP 4.0 /* two stops */
#define FLATS 3
#define F_NUMBER 8.0

static const igi_sensor sensor = {.full_well_e = 20000, .read_noise_e = 3, .bits = 12};

void photos_distort(igi_camera *camera)
{
    camera->k1 = -.25;
    camera->k2 = .06; /* keeps the radius rising however wide the view */
}

/* A camera's tone curve: gamma 2.2 with a soft shoulder, code^2.2 = (1+s) x / (x+s), s = 1.5. */
static igi_status make_response(igi_context *ctx, int channels, igi_response **response)
{
    IGI_TRY(igi_response_create(ctx, channels, 65536, response));
    for (int c = 0; c < channels; c++)
        for (int z = 0; z < 65536; z++) {
            double u = pow(z / 65535., 2.2 + .05 * (c - 1)); /* films differ a little by colour */
            (*response)->exposure[c * 65536 + z] = (float)(1.5 * u / (2.5 - u));
        }
    return IGI_OK;
}

/* One of the space of known responses, a little different by colour. */
static igi_status draw_response(igi_context *ctx, int channels, const char *basis,
                                igi_response **response)
{
    double(*table)[IGI_HDR_TABLE];
    IGI_TRY(igi_hdr_load_basis(ctx, basis, &table));
    igi_status status = igi_response_create(ctx, channels, 65536, response);
    for (int c = 0; status == IGI_OK && c < channels; c++) {
        float *x = (*response)->exposure + c * 65536;
        const double weights[3] = {1, .9 + .1 * c, .4};
        for (int z = 0; z < 65536; z++) {
            double at = z / 65535. * (IGI_HDR_TABLE - 1), value = 0;
            size_t i = at < IGI_HDR_TABLE - 2 ? (size_t)at : IGI_HDR_TABLE - 2;
            for (int k = 0; k < 3; k++)
                value += weights[k] *
                         (table[k][i] + (at - (double)i) * (table[k][i + 1] - table[k][i]));
            x[z] = (float)(z > 0 ? fmax(value, (double)x[z - 1]) : 0);
        }
    }
    igi_free(table);
    return status;
}

static igi_status make_camera(igi_context *ctx, const igi_image *like, const igi_camera *lens,
                              const char *basis, igi_calibration **camera)
{
    IGI_TRY(igi_calibration_create(ctx, like->width, like->height, camera));
    igi_calibration *c = *camera;
    c->has_lens = true;
    c->lens = *lens;
    photos_distort(&c->lens);
    c->vignetting = (igi_vignetting){.known = true,
                                     .centre_x = .52 * like->width,
                                     .centre_y = .49 * like->height,
                                     .k = {-.35, .08, -.03}, /* 30 % at the corners */
                                     .f_number = F_NUMBER};
    int channels = like->channels < 3 ? 1 : 3;
    return basis ? draw_response(ctx, channels, basis, &c->response)
                 : make_response(ctx, channels, &c->response);
}

/* The radiance that all but a thousandth of the pixels stay below. */
static double brightest(igi_context *ctx, igi_image **pictures, size_t count)
{
    uint64_t histogram[512] = {0}, total = 0, above = 0;
    (void)ctx;
    for (size_t i = 0; i < count; i++) {
        size_t samples = (size_t)pictures[i]->width * (size_t)pictures[i]->height *
                         (size_t)pictures[i]->channels;
        for (size_t k = 0; k < samples; k++) {
            double x = (double)pictures[i]->samples[k];
            int bin = x > 0 ? (int)(8 * log2(x)) + 256 : 0;
            histogram[bin < 0 ? 0 : bin > 511 ? 511 : bin]++;
        }
        total += samples;
    }
    for (int bin = 511; bin > 0; bin--) {
        above += histogram[bin];
        if (above > total / 1000) return exp2((bin + 1 - 256) / 8.);
    }
    return 1;
}

static igi_status save_photo(igi_context *ctx, const igi_image *picture,
                             const igi_calibration *camera, double h, uint64_t seed,
                             const char *path)
{
    igi_exposure exposure = {.time_s = h * F_NUMBER * F_NUMBER, .f_number = F_NUMBER, .iso = 100};
    igi_photo *photo = NULL;
    IGI_TRY(igi_photograph(ctx, picture, camera, &sensor, &exposure, seed, &photo));
    igi_status status = igi_photo_save_png(ctx, photo, path);
    igi_photo_destroy(photo);
    return status;
}

static igi_status save_brackets(igi_context *ctx, const char *folder, igi_image **pictures,
                                size_t count, const igi_calibration *camera)
{
    /* Lamps well below the top, where a recovered response is at its worst. */
    double shortest = .4 / brightest(ctx, pictures, count);
    for (size_t i = 0; i < count; i++)
        for (size_t e = 0; e < EXPOSURES; e++) {
            char *path = NULL;
            uint64_t seed = igi_hash64(igi_seed(ctx) + 100 * i + e);
            IGI_TRY(igi_strprintf(ctx, &path, "%s/%04zu_%zu.png", folder, i, e));
            igi_status status = save_photo(ctx, pictures[i], camera,
                                           shortest * pow(STEP, (double)e), seed, path);
            igi_free(path);
            IGI_TRY(status);
        }
    return IGI_OK;
}

/* Which photographs make which image; EXIF states their exposures. */
static igi_status save_list(igi_context *ctx, const char *folder, size_t count)
{
    char *path = NULL, name[64];
    json_t *root = json_object(), *images = json_object();
    int bad = 0;
    for (size_t i = 0; i < count; i++) {
        json_t *files = json_array();
        for (size_t e = 0; e < EXPOSURES; e++) {
            snprintf(name, sizeof name, "%04zu_%zu.png", i, e);
            bad |= json_array_append_new(files, json_string(name));
        }
        snprintf(name, sizeof name, "%04zu", i);
        bad |= json_object_set_new(images, name, files);
    }
    bad |= json_object_set_new(root, "igi", json_integer(1));
    bad |= json_object_set(root, "images", images);
    igi_status status = igi_strprintf(ctx, &path, "%s/brackets.json", folder);
    if (status == IGI_OK) status = igi_file_save_json(ctx, path, bad ? NULL : root, 9);
    igi_free(path);
    json_decref(images);
    json_decref(root);
    return status;
}

/* Photographs of an evenly lit wall, and the lens as a chessboard would have told it. */
static igi_status save_calibration(igi_context *ctx, const char *folder, igi_calibration *camera,
                                   int channels)
{
    igi_status status = IGI_OK;
    igi_image *wall = NULL;
    char *path = NULL;
    igi_response *response = camera->response;
    IGI_TRY_GOTO(igi_image_create(ctx, camera->width, camera->height, channels, &wall));
    size_t samples = (size_t)wall->width * (size_t)wall->height * (size_t)channels;
    for (size_t i = 0; i < samples; i++) wall->samples[i] = 1;
    for (size_t i = 0; i < FLATS; i++) {
        igi_free(path);
        IGI_TRY_GOTO(igi_strprintf(ctx, &path, "%s/flat_%zu.png", folder, i));
        IGI_TRY_GOTO(save_photo(ctx, wall, camera, .5, igi_hash64(igi_seed(ctx) + 99 + i), path));
    }
    camera->vignetting.known = false;
    camera->response = NULL;
    igi_free(path);
    IGI_TRY_GOTO(igi_strprintf(ctx, &path, "%s/lens.json", folder));
    IGI_TRY_GOTO(igi_calibration_save(ctx, camera, path));
cleanup:
    camera->response = response;
    igi_image_destroy(wall);
    igi_free(path);
    return status;
}

igi_status photos_save(igi_context *ctx, const char *folder, const igi_camera *lens,
                       const char *basis, igi_image **pictures, size_t count)
{
    igi_status status = IGI_OK;
    igi_calibration *camera = NULL;
    IGI_TRY_GOTO(make_camera(ctx, pictures[0], lens, basis, &camera));
    IGI_TRY_GOTO(save_brackets(ctx, folder, pictures, count, camera));
    IGI_TRY_GOTO(save_list(ctx, folder, count));
    IGI_TRY_GOTO(save_calibration(ctx, folder, camera, pictures[0]->channels));
cleanup:
    igi_calibration_destroy(camera);
    return status;
}
