/* SPDX-License-Identifier: Apache-2.0 */
#include "scene/brackets.h"

#include "scene/scene_notes.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define MOST_EXPOSURES 1000

typedef struct reader {
    igi_context *ctx;
    igi_scene *scene;
    char *folder; /* that of brackets.json: names are relative to it */
} reader;

static igi_status read_positive(igi_context *ctx, const igi_json *at, const char *key,
                                double *value)
{
    igi_json member = igi_json_member(at, key);
    if (!member.value) return IGI_OK;
    IGI_TRY(igi_json_number(ctx, &member, value));
    if (*value > 0 && *value < 1e6) return IGI_OK;
    return igi_json_fail(ctx, &member, "is %g; give a number above 0", *value);
}

static igi_status read_exif(igi_context *ctx, const igi_json *at, igi_exposure *exposure)
{
    igi_photo *photo;
    IGI_TRY(igi_photo_probe(ctx, exposure->path, &photo));
    exposure->time_s = photo->time_s;
    exposure->f_number = photo->f_number;
    exposure->iso = photo->iso;
    exposure->from_camera = true;
    igi_photo_destroy(photo);
    if (exposure->time_s > 0) return IGI_OK;
    return igi_json_fail(ctx, at,
                         "no EXIF states the exposure time of %s; write { \"file\": ..., "
                         "\"seconds\": ... }",
                         exposure->path);
}

/* "NAME", whose exposure EXIF states, or { "file", "seconds", "f_number", "iso" }. */
static igi_status read_exposure(const reader *r, const igi_json *at, igi_exposure *exposure)
{
    static const char *const known[] = {"file", "seconds", "f_number", "iso"};
    bool stated = json_is_object(at->value);
    igi_json file = stated ? igi_json_member(at, "file") : *at;
    const char *name;
    if (stated) IGI_TRY(igi_json_check_keys(r->ctx, at, known, sizeof known / sizeof known[0]));
    IGI_TRY(igi_json_string(r->ctx, &file, &name));
    IGI_TRY(igi_path_join(r->ctx, r->folder, name, &exposure->path));
    if (!igi_file_exists(exposure->path))
        return igi_json_fail(r->ctx, &file,
                             "no readable file %s; correct the name, or put the file there",
                             exposure->path);
    if (!stated || !igi_json_member(at, "seconds").value) IGI_TRY(read_exif(r->ctx, at, exposure));
    if (!stated) return IGI_OK;
    IGI_TRY(read_positive(r->ctx, at, "seconds", &exposure->time_s));
    IGI_TRY(read_positive(r->ctx, at, "f_number", &exposure->f_number));
    IGI_TRY(read_positive(r->ctx, at, "iso", &exposure->iso));
    exposure->from_camera = exposure->from_camera && !igi_json_member(at, "f_number").value &&
                            !igi_json_member(at, "iso").value;
    return IGI_OK;
}

/* What states an f-number or an ISO has another unit than what does not. */
static igi_status check_unit(const reader *r, const igi_json *at, const igi_exposure *e)
{
    const igi_exposure *first = NULL;
    for (size_t i = 0; i < r->scene->frame_count && !first; i++)
        if (r->scene->frames[i].exposure_count) first = &r->scene->frames[i].exposures[0];
    if (!first || ((e->f_number > 0) == (first->f_number > 0) && (e->iso > 0) == (first->iso > 0)))
        return IGI_OK;
    return igi_json_fail(r->ctx, at,
                         "an f-number or ISO is stated of it or of %s, and not of both; state the "
                         "same of all, so that all images share one unit",
                         first->path);
}

static igi_status read_list(const reader *r, const igi_json *at, igi_frame *frame)
{
    const char *name;
    char *path = NULL;
    IGI_TRY(igi_json_string(r->ctx, at, &name));
    IGI_TRY(igi_path_join(r->ctx, r->folder, name, &path));
    igi_status status = igi_exposures_read(r->ctx, path, &frame->exposures, &frame->exposure_count);
    igi_free(path);
    for (size_t i = 0; i < frame->exposure_count && status == IGI_OK; i++)
        if (!igi_file_exists(frame->exposures[i].path))
            status = igi_json_fail(r->ctx, at, "lists %s, which is no readable file; correct it",
                                   frame->exposures[i].path);
    return status;
}

static igi_status read_bracket(const reader *r, const igi_json *at, igi_frame *frame)
{
    size_t count = 0;
    if (frame->exposure_count)
        return igi_json_fail(r->ctx, at, "names the frame %s a second time; remove one",
                             frame->name);
    if (json_is_string(at->value)) IGI_TRY(read_list(r, at, frame));
    else {
        IGI_TRY(igi_json_array(r->ctx, at, &count));
        if (count < 1 || count > MOST_EXPOSURES)
            return igi_json_fail(r->ctx, at, "has %zu exposures; give 1 to %d", count,
                                 MOST_EXPOSURES);
        IGI_TRY(IGI_ALLOC(r->ctx, count, &frame->exposures));
        frame->exposure_count = count;
    }
    for (size_t i = 0; i < count; i++) {
        igi_json element = igi_json_element(at, i);
        IGI_TRY(read_exposure(r, &element, &frame->exposures[i]));
    }
    for (size_t i = 0; i < frame->exposure_count; i++) {
        igi_json element = count ? igi_json_element(at, i) : *at;
        IGI_TRY(check_unit(r, &element, &frame->exposures[i]));
        IGI_TRY(igi_scene_note_file(r->ctx, r->scene, frame->exposures[i].path));
    }
    return IGI_OK;
}

/* Frames are named as the cameras' file names their images, with or without folder and ending. */
static igi_status read_images(const reader *r, const igi_json *images)
{
    const char *key;
    json_t *value;
    IGI_TRY(igi_json_object(r->ctx, images));
    json_object_foreach (images->value, key, value) {
        igi_json at = igi_json_member(images, key);
        igi_frame *frame = NULL;
        char *stem;
        IGI_TRY(igi_path_stem(r->ctx, key, &stem));
        for (size_t i = 0; i < r->scene->frame_count && !frame; i++)
            if (strcmp(r->scene->frames[i].name, stem) == 0) frame = &r->scene->frames[i];
        igi_free(stem);
        if (frame) IGI_TRY(read_bracket(r, &at, frame));
        else
            IGI_TRY(igi_scene_warn(r->ctx, r->scene, "%s:%d: no frame shows \"%s\"",
                                   images->file->path, igi_json_line(&at), key));
    }
    return IGI_OK;
}

static int by_path(const void *a, const void *b)
{
    return strcmp(*(const char *const *)a, *(const char *const *)b);
}

/* Every frame has exposures, and no photograph is of two. */
static igi_status check_all(const reader *r, const igi_json *images)
{
    size_t total = 0, count = 0;
    for (size_t i = 0; i < r->scene->frame_count; i++) {
        const igi_frame *f = &r->scene->frames[i];
        if (!f->exposure_count)
            return igi_json_fail(r->ctx, images,
                                 "has no exposures for the image \"%s\"; add them, or remove its "
                                 "frame from the cameras' file",
                                 f->name);
        total += f->exposure_count;
    }
    const char **paths;
    igi_status status = IGI_OK;
    IGI_TRY(IGI_ALLOC(r->ctx, total, &paths));
    for (size_t i = 0; i < r->scene->frame_count; i++)
        for (size_t k = 0; k < r->scene->frames[i].exposure_count; k++)
            paths[count++] = r->scene->frames[i].exposures[k].path;
    qsort(paths, total, sizeof *paths, by_path);
    for (size_t i = 1; i < total && status == IGI_OK; i++)
        if (strcmp(paths[i - 1], paths[i]) == 0)
            status = igi_json_fail(r->ctx, images, "names %s twice; each photograph counts once",
                                   paths[i]);
    igi_free(paths);
    return status;
}

static igi_status read_response(const reader *r, const igi_json *root)
{
    igi_json at = igi_json_member(root, "response");
    const char *name;
    r->scene->exposures_response = IGI_RESPONSE_AUTO;
    if (!at.value) return IGI_OK;
    IGI_TRY(igi_json_string(r->ctx, &at, &name));
    if (strcmp(name, "linear") == 0) r->scene->exposures_response = IGI_RESPONSE_LINEAR;
    else if (strcmp(name, "srgb") == 0) r->scene->exposures_response = IGI_RESPONSE_SRGB;
    else
        return igi_json_fail(r->ctx, &at,
                             "is \"%s\"; give \"linear\" or \"srgb\", or leave it to the "
                             "calibration",
                             name);
    return IGI_OK;
}

igi_status igi_brackets_read(igi_context *ctx, const char *path, igi_scene *scene)
{
    static const char *const known[] = {"igi", "images", "response"};
    igi_status status = IGI_OK;
    igi_json_file file;
    reader r = {ctx, scene, NULL};
    double version;
    IGI_TRY(igi_json_load(ctx, path, &file));
    igi_json root = igi_json_root(&file);
    igi_json igi = igi_json_member(&root, "igi"), images = igi_json_member(&root, "images");
    IGI_TRY_GOTO(igi_path_folder(ctx, path, &r.folder));
    IGI_TRY_GOTO(igi_json_check_keys(ctx, &root, known, sizeof known / sizeof known[0]));
    IGI_TRY_GOTO(igi_json_number(ctx, &igi, &version));
    if (version != 1) {
        status = igi_json_fail(ctx, &igi, "is %g; this program reads version 1", version);
        goto cleanup;
    }
    IGI_TRY_GOTO(read_response(&r, &root));
    IGI_TRY_GOTO(read_images(&r, &images));
    IGI_TRY_GOTO(check_all(&r, &images));
cleanup:
    igi_free(r.folder);
    igi_json_unload(&file);
    return status;
}
