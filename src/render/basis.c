/* SPDX-License-Identifier: Apache-2.0
 *
 * A picture per lamp and view. Light adds up, so that any setting of the lamps is a weighted sum of
 * these, which a browser makes at once.
 *
 * A picture is a PNG of 8 bits, twice as high as it is: above, mantissas of red, green and blue;
 * below, the exponent that they share (Ward, "Real pixels", 1991), three times. An alpha channel
 * would not do: browsers multiply colours by it.
 */
#include "image/srgb.h"
#include "base/file.h"
#include "material/material.h"
#include "material/result.h"
#include "render/layers.h"

#include <errno.h>
#include <jansson.h>
#include <math.h>
#include <string.h>
#include <sys/stat.h>

typedef struct basis {
    igi_context *ctx;
    const igi_scene *scene;
    const igi_materials *materials;
    const igi_basis_options *options;
    char *folder;
    float exposure; /* of the first view with all lamps on */
} basis;

void igi_basis_options_init(igi_basis_options *options)
{
    *options = (igi_basis_options){.struct_size = sizeof *options, .views = 2, .side = 320};
    igi_render_options_init(&options->render);
}

static igi_camera reduced(const igi_camera *camera, int side)
{
    igi_camera c = *camera;
    int longest = c.width > c.height ? c.width : c.height;
    double scale = longest > side ? (double)side / longest : 1;
    c.width = (int)fmax(1, floor(camera->width * scale + .5));
    c.height = (int)fmax(1, floor(camera->height * scale + .5));
    double x = (double)c.width / camera->width, y = (double)c.height / camera->height;
    c.fl_x *= x;
    c.cx *= x;
    c.fl_y *= y;
    c.cy *= y;
    return c;
}

static igi_status save_picture(const basis *s, const igi_image *picture, int view, int lamp)
{
    igi_status status = IGI_OK;
    size_t pixels = (size_t)picture->width * (size_t)picture->height, size;
    uint8_t *bytes, *png = NULL;
    char *path = NULL;
    IGI_TRY(IGI_ALLOC(s->ctx, 6 * pixels, &bytes));
    for (size_t i = 0; i < pixels; i++) {
        const float *x = picture->samples + i * (size_t)picture->channels;
        float rgb[3];
        uint8_t rgbe[4];
        for (int k = 0; k < 3; k++) rgb[k] = x[k < picture->channels ? k : picture->channels - 1];
        igi_rgbe(rgb, rgbe);
        memcpy(bytes + 3 * i, rgbe, 3);
        memset(bytes + 3 * (pixels + i), rgbe[3], 3);
    }
    IGI_TRY_GOTO(
        igi_image_encode_png(s->ctx, bytes, picture->width, 2 * picture->height, 3, &png, &size));
    IGI_TRY_GOTO(igi_strprintf(s->ctx, &path, "%s/%d.%d.png", s->folder, view, lamp));
    status = igi_file_save(s->ctx, path, png, size);
cleanup:
    igi_image_free_bytes(png);
    igi_free(bytes);
    igi_free(path);
    return status;
}

static bool shines(const igi_light *light, int bands)
{
    for (int b = 0; b < bands; b++)
        if (light->value[b] > 0) return true;
    return false;
}

/* The view by each lamp alone; the sum of all goes into `sum`. */
static igi_status render_view(basis *s, const igi_camera *camera, int view, igi_image *sum)
{
    int lamp = 0;
    size_t count = (size_t)sum->width * (size_t)sum->height * (size_t)sum->channels;
    for (size_t i = 0; i < s->materials->light_count; i++) {
        igi_renderer *renderer = NULL;
        layered_frame f;
        if (!shines(&s->materials->lights[i], s->scene->bands)) continue;
        IGI_TRY(igi_renderer_create(s->ctx, s->scene, s->materials, &s->materials->lights[i], 1,
                                    &renderer));
        igi_status status = layered_frame_render(s->ctx, renderer, camera, (uint64_t)view,
                                                 &s->options->render, 0, false, s->scene->bands,
                                                 &f);
        igi_renderer_destroy(renderer);
        IGI_TRY(status);
        for (size_t k = 0; k < count; k++) sum->samples[k] += f.layers[LAYER_PICTURE]->samples[k];
        status = save_picture(s, f.layers[LAYER_PICTURE], view, lamp++);
        layered_frame_clear(&f);
        IGI_TRY(status);
    }
    return IGI_OK;
}

static json_t *lamps_json(const basis *s)
{
    json_t *lamps = json_array();
    for (size_t i = 0; i < s->materials->light_count; i++) {
        const igi_light *l = &s->materials->lights[i];
        if (!shines(l, s->scene->bands)) continue;
        const char *type = igi_light_type_name(l->type);
        const char *name = l->region >= 0 ? s->scene->regions[l->region].name : type;
        json_array_append_new(
            lamps, json_pack("{s:s, s:s, s:i}", "type", type, "name", name, "light", (int)i));
    }
    return lamps;
}

/* Last, so that what the page shows is whole. */
static igi_status save_index(const basis *s, json_t *views)
{
    igi_status status = IGI_OK;
    char *path = NULL;
    json_t *root = json_pack("{s:f, s:o, s:O}", "exposure", (double)s->exposure, "lights",
                             lamps_json(s), "views", views);
    IGI_TRY_GOTO(igi_strprintf(s->ctx, &path, "%s/index.json", s->folder));
    status = igi_file_save_json(s->ctx, path, root, 9);
cleanup:
    json_decref(root);
    igi_free(path);
    return status;
}

static igi_status render_all(basis *s, const igi_frame *frames, size_t count)
{
    igi_status status = IGI_OK;
    json_t *views = json_array();
    igi_image *sum = NULL;
    int shown = (size_t)s->options->views < count ? s->options->views : (int)count;
    for (int v = 0; v < shown; v++) {
        const igi_frame *frame = &frames[count * (size_t)v / (size_t)shown];
        igi_camera camera = reduced(&frame->camera, s->options->side);
        igi_image_destroy(sum);
        IGI_TRY_GOTO(igi_image_create(s->ctx, camera.width, camera.height, s->scene->bands, &sum));
        IGI_TRY_GOTO(render_view(s, &camera, v, sum));
        layered_frame all = {.bands = s->scene->bands, .layers = {sum}};
        if (v == 0) IGI_TRY_GOTO(layered_frame_exposure(s->ctx, &all, &s->exposure));
        json_array_append_new(views, json_pack("{s:s, s:i, s:i}", "frame", frame->name, "width",
                                               camera.width, "height", camera.height));
    }
    status = save_index(s, views);
cleanup:
    igi_image_destroy(sum);
    json_decref(views);
    return status;
}

igi_status igi_basis_save(igi_context *ctx, const char *folder, const char *cameras,
                          const igi_basis_options *options)
{
    igi_status status = IGI_OK;
    igi_scene *scene = NULL;
    igi_materials *materials = NULL;
    igi_frame *frames = NULL;
    char *found = NULL;
    size_t count = 0;
    basis s = {.ctx = ctx, .options = options};
    igi_stage_begin(ctx, "lamp by lamp");
    IGI_TRY_GOTO(igi_result_load(ctx, folder, &scene, &materials));
    if (!cameras) IGI_TRY_GOTO(igi_result_cameras(ctx, folder, &found));
    if (!cameras && !found)
        IGI_TRY_GOTO(igi_fail(ctx, IGI_E_DATA,
                              "%s: its cameras are not where manifest.json says; give their file "
                              "with --cameras",
                              folder));
    IGI_TRY_GOTO(igi_frames_load(ctx, cameras ? cameras : found, &frames, &count));
    s.scene = scene;
    s.materials = materials;
    IGI_TRY_GOTO(igi_strprintf(ctx, &s.folder, "%s/relight", folder));
    if (mkdir(s.folder, 0777) && errno != EEXIST)
        IGI_TRY_GOTO(
            igi_fail(ctx, IGI_E_SYSTEM, "%s: cannot be made (%s)", s.folder, strerror(errno)));
    status = render_all(&s, frames, count);
cleanup:
    igi_stage_begin(ctx, NULL);
    igi_frames_destroy(frames, count);
    igi_materials_destroy(materials);
    igi_scene_destroy(scene);
    igi_free(s.folder);
    igi_free(found);
    return status;
}
