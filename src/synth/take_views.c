/* SPDX-License-Identifier: Apache-2.0
 *
 * Views of the scene: chosen, written, read again, rendered.
 */
#include "synth/maker.h"

#include "render/render.h"
#include "synth/photos.h"

#include <igi/image.h>

#include <errno.h>
#include <string.h>
#include <sys/stat.h>

igi_status maker_path(const maker *m, const char *name, char **path)
{
    return igi_strprintf(m->ctx, path, "%s/%s", m->folder, name);
}

igi_status maker_folder(const maker *m, const char *name)
{
    char *path = NULL;
    IGI_TRY(maker_path(m, name, &path));
    igi_status status = IGI_OK;
    if (mkdir(path, 0777) != 0 && errno != EEXIST)
        status = igi_fail(m->ctx, IGI_E_SYSTEM,
                          "%s: cannot be made (%s); check the folder above it", path,
                          strerror(errno));
    igi_free(path);
    return status;
}

static igi_status save_pictures(const maker *m, const char *folder, igi_image **pictures,
                                size_t count)
{
    for (size_t i = 0; i < count; i++) {
        char *path = NULL;
        IGI_TRY(igi_strprintf(m->ctx, &path, "%s/%simages/%04zu.exr", m->folder, folder, i));
        igi_status status = igi_image_save_exr(m->ctx, pictures[i], IGI_EXR_HALF, path);
        igi_free(path);
        IGI_TRY(status);
    }
    return IGI_OK;
}

static bool raw_photos(const maker *m, const char *folder)
{
    return m->photos && !folder[0];
}

static igi_status save_photos(const maker *m, const igi_camera *camera, igi_image **pictures,
                              size_t count)
{
    char *path = NULL;
    igi_status status = maker_folder(m, "photos");
    if (status == IGI_OK) status = maker_path(m, "photos", &path);
    if (status == IGI_OK) status = photos_save(m->ctx, path, camera, m->basis, pictures, count);
    igi_free(path);
    return status;
}

/* Renders the frames into `folder` ("" or "NAME/"). */
static igi_status take_pictures(maker *m, const char *folder, const view_set *views,
                                const lit_by *by, const igi_camera *cameras, size_t count)
{
    igi_status status = IGI_OK;
    igi_renderer *renderer = NULL;
    igi_image **pictures = NULL;
    igi_render_options options;
    igi_render_options_init(&options);
    options.samples = views->samples;
    IGI_TRY_GOTO(IGI_ALLOC(m->ctx, count, &pictures));
    for (size_t i = 0; i < count; i++)
        IGI_TRY_GOTO(
            igi_image_create(m->ctx, views->width, views->height, m->scene->bands, &pictures[i]));
    IGI_TRY_GOTO(
        igi_renderer_create(m->ctx, m->scene, m->spec.materials, by->lights, by->count, &renderer));
    igi_stage_begin(m->ctx, by->stage);
    IGI_TRY_GOTO(igi_renderer_frames(m->ctx, renderer, cameras, count, &options, views->seed,
                                     &(igi_layers){.pictures = pictures}));
    if (!folder[0] && m->spec.highlights)
        IGI_TRY_GOTO(highlights_count(m->ctx, m->scene, m->tracer, m->spec.materials, cameras,
                                      count, pictures, m->highlight));
    IGI_TRY_GOTO(raw_photos(m, folder) ? save_photos(m, &cameras[0], pictures, count)
                                       : save_pictures(m, folder, pictures, count));
cleanup:
    for (size_t i = 0; pictures && i < count; i++) igi_image_destroy(pictures[i]);
    igi_free(pictures);
    igi_renderer_destroy(renderer);
    return status;
}

igi_status maker_views(maker *m, const char *folder, const view_set *views, const lit_by *by,
                       igi_camera **cameras, size_t *camera_count)
{
    igi_status status = IGI_OK;
    igi_camera *chosen = NULL;
    igi_frame *frames = NULL;
    char *path = NULL, *images = NULL;
    size_t count = 0;
    IGI_TRY_GOTO(igi_strprintf(m->ctx, &images, "%simages", folder));
    IGI_TRY_GOTO(maker_folder(m, folder));
    IGI_TRY_GOTO(maker_folder(m, images));
    IGI_TRY_GOTO(igi_strprintf(m->ctx, &path, "%s/%stransforms.json", m->folder, folder));
    IGI_TRY_GOTO(views_choose(m->ctx, views, m->scene, m->tracer, &chosen, &count));
    IGI_TRY_GOTO(views_save(m->ctx, chosen, count, path));
    IGI_TRY_GOTO(igi_frames_load(m->ctx, path, &frames, &count));
    for (size_t i = 0; i < count; i++) {
        chosen[i] = frames[i].camera;
        if (raw_photos(m, folder)) photos_distort(&chosen[i]);
    }
    IGI_TRY_GOTO(take_pictures(m, folder, views, by, chosen, count));
    if (cameras) {
        *cameras = chosen;
        *camera_count = count;
        chosen = NULL;
    }
cleanup:
    igi_free(chosen);
    igi_frames_destroy(frames, count);
    igi_free(path);
    igi_free(images);
    return status;
}
