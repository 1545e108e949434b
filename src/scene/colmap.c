/* SPDX-License-Identifier: Apache-2.0
 *
 * COLMAP's sparse models, text and binary: cameras and images. COLMAP keeps world-to-camera with
 * OpenCV's axes; its pixel centres are at .5, like ours. Frames come sorted by name, since COLMAP
 * writes them in no particular order.
 */
#include "scene/colmap_camera.h"
#include "scene/colmap_private.h"

#include "base/file.h"

#include <stdlib.h>
#include <string.h>

#define MAX_MODEL_BYTES ((size_t)2 << 30)

static igi_status open_part(igi_colmap *r, const char *name)
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

static igi_status read_model(igi_colmap *r)
{
    bool is_binary, is_text;
    IGI_TRY(has_part(r->ctx, r->folder, "images.bin", &is_binary));
    IGI_TRY(has_part(r->ctx, r->folder, "images.txt", &is_text));
    if (is_binary) {
        IGI_TRY(open_part(r, "cameras.bin"));
        IGI_TRY(igi_colmap_read_binary(r, false));
        igi_colmap_sort_cameras(r);
        IGI_TRY(open_part(r, "images.bin"));
        IGI_TRY(igi_colmap_read_binary(r, true));
    } else if (is_text) {
        IGI_TRY(open_part(r, "cameras.txt"));
        IGI_TRY(igi_colmap_read_text(r, false));
        igi_colmap_sort_cameras(r);
        IGI_TRY(open_part(r, "images.txt"));
        IGI_TRY(igi_colmap_read_text(r, true));
    } else {
        return igi_fail(r->ctx, IGI_E_DATA,
                        "%s: neither images.bin nor images.txt; name the folder of COLMAP's model",
                        r->folder);
    }
    if (r->frame_count == 0) return igi_colmap_fail(r, "no image in the model");
    qsort(r->frames, r->frame_count, sizeof *r->frames, by_name);
    return IGI_OK;
}

igi_status igi_colmap_read(igi_context *ctx, const char *folder, igi_frame **frames, size_t *count)
{
    static const char *const below[] = {"sparse/0/images.bin", "sparse/0/images.txt",
                                        "0/images.bin", "0/images.txt"};
    char *inner = NULL;
    igi_colmap r = {.ctx = ctx, .folder = folder};
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

igi_status igi_colmap_read_camera(igi_context *ctx, const char *path, igi_camera *camera)
{
    igi_status status = IGI_OK;
    char *folder = NULL;
    igi_colmap r = {.ctx = ctx};
    IGI_TRY_GOTO(igi_path_folder(ctx, path, &folder));
    r.folder = folder;
    IGI_TRY_GOTO(open_part(&r, igi_file_name(path)));
    IGI_TRY_GOTO(igi_ends_with(path, ".bin") ? igi_colmap_read_binary(&r, false)
                                             : igi_colmap_read_text(&r, false));
    if (r.camera_count == 0) IGI_TRY_GOTO(igi_colmap_fail(&r, "no camera in it"));
    *camera = r.cameras[0].camera;
cleanup:
    igi_free(folder);
    igi_free(r.file);
    igi_free(r.text.bytes);
    igi_free(r.cameras);
    return status;
}
