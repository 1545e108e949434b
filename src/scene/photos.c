/* SPDX-License-Identifier: Apache-2.0
 *
 * What can be known of the photographs from their headers alone.
 */
#include "scene/photos.h"

#include <igi/image.h>

#include <dirent.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* All images that are not there, in one sentence. */
static igi_status check_presence(igi_context *ctx, const igi_scene *scene, const char *cameras)
{
    char names[512] = "";
    size_t missing = 0, length = 0;
    for (size_t i = 0; i < scene->frame_count; i++) {
        if (scene->frames[i].exposure_count || igi_file_exists(scene->frames[i].path)) continue;
        if (missing++ >= 3 || length >= sizeof names) continue;
        int more = snprintf(names + length, sizeof names - length, "%s%s", length ? ", " : "",
                            scene->frames[i].path);
        length += more > 0 ? (size_t)more : 0;
    }
    if (missing == 0) return IGI_OK;
    return igi_fail(ctx, IGI_E_DATA,
                    "%s: %zu of %zu images cannot be opened: %s%s; put them there, or remove their "
                    "frames",
                    cameras, missing, scene->frame_count, names, missing > 3 ? ", ..." : "");
}

/* Of the image, or of the first of the exposures that it is merged from; merging compares them. */
static const char *first_file(const igi_frame *frame)
{
    return frame->exposure_count ? frame->exposures[0].path : frame->path;
}

static igi_status probe(igi_context *ctx, const igi_frame *frame, int *width, int *height,
                        int *bands)
{
    int channels;
    igi_photo *photo;
    if (!frame->exposure_count)
        return igi_image_probe_exr(ctx, frame->path, width, height, &channels, bands);
    IGI_TRY(igi_photo_probe(ctx, first_file(frame), &photo));
    *width = photo->width;
    *height = photo->height;
    *bands = photo->channels;
    igi_photo_destroy(photo);
    return IGI_OK;
}

static igi_status check_image(igi_context *ctx, igi_scene *scene, size_t number)
{
    const igi_frame *frame = &scene->frames[number];
    const char *file = first_file(frame);
    int width = 0, height = 0, bands = 0;
    IGI_TRY(probe(ctx, frame, &width, &height, &bands));
    if (width != frame->camera.width || height != frame->camera.height)
        return igi_fail(
            ctx, IGI_E_DATA,
            "%s: is %dx%d pixels, but its camera %dx%d; give w and h (and fl_x, cx ...) "
            "of the image",
            file, width, height, frame->camera.width, frame->camera.height);
    if (bands < 1 || bands > IGI_MAX_BANDS)
        return igi_fail(ctx, IGI_E_DATA, "%s: has %d bands; export 1 to %d of them", file, bands,
                        IGI_MAX_BANDS);
    if (number == 0) scene->bands = bands;
    if (bands != scene->bands)
        return igi_fail(ctx, IGI_E_DATA,
                        "%s: has %d bands, but %s has %d; all images must have the same", file,
                        bands, first_file(&scene->frames[0]), scene->bands);
    return IGI_OK;
}

static int by_path(const void *a, const void *b)
{
    const igi_frame *const *x = a, *const *y = b;
    return strcmp((*x)->path, (*y)->path);
}

/* A photograph counts once: its noise is not another's. */
static igi_status check_doubles(igi_context *ctx, const igi_scene *scene, const char *cameras)
{
    const igi_frame **order;
    igi_status status = IGI_OK;
    IGI_TRY(IGI_ALLOC(ctx, scene->frame_count, &order));
    for (size_t i = 0; i < scene->frame_count; i++) order[i] = &scene->frames[i];
    qsort(order, scene->frame_count, sizeof *order, by_path);
    for (size_t i = 1; i < scene->frame_count && status == IGI_OK; i++)
        if (strcmp(order[i - 1]->path, order[i]->path) == 0 && !order[i]->exposure_count)
            status = igi_fail(ctx, IGI_E_DATA, "%s: two frames name %s; remove one", cameras,
                              order[i]->path);
    igi_free(order);
    return status;
}

/* Of images that no camera took the result knows nothing, and is not wrong for it: said, and not kept. */
static igi_status note_strays(igi_context *ctx, const igi_scene *scene)
{
    igi_status status = IGI_OK;
    size_t strays = 0;
    char *folder = NULL, *path = NULL, *first = NULL;
    DIR *at = NULL;
    IGI_TRY_GOTO(igi_path_folder(ctx, scene->frames[0].path, &folder));
    at = opendir(folder);
    for (struct dirent *entry; at && (entry = readdir(at));) {
        const char *ending = strrchr(entry->d_name, '.');
        bool known = !ending || strcmp(ending, ".exr") != 0;
        if (!known) IGI_TRY_GOTO(igi_path_join(ctx, folder, entry->d_name, &path));
        for (size_t i = 0; i < scene->frame_count && !known; i++)
            known = strcmp(scene->frames[i].path, path) == 0;
        if (!known && (!first || strcmp(path, first) < 0)) {
            igi_free(first);
            first = path;
            path = NULL;
        }
        strays += !known;
        igi_free(path);
        path = NULL;
    }
    if (strays > 0)
        igi_warn(ctx, "%s: no camera took it%s; it is not used", first,
                 strays > 1 ? ", nor others beside it" : "");
cleanup:
    if (at) closedir(at);
    igi_free(folder);
    igi_free(path);
    igi_free(first);
    return status;
}

igi_status igi_photos_check(igi_context *ctx, igi_scene *scene, const char *cameras)
{
    IGI_TRY(check_presence(ctx, scene, cameras));
    IGI_TRY(check_doubles(ctx, scene, cameras));
    for (size_t i = 0; i < scene->frame_count; i++) IGI_TRY(check_image(ctx, scene, i));
    return scene->frame_count && !scene->frames[0].exposure_count ? note_strays(ctx, scene)
                                                                  : IGI_OK;
}
