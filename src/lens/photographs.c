/* SPDX-License-Identifier: Apache-2.0 */
#include "lens/photographs.h"

#include "base/context.h"
#include "image/resample.h"
#include "lens/lens_private.h"

#include <math.h>
#include <string.h>

/* Vignetting changes with the aperture: beyond this ratio of f-numbers it is another. */
#define SAME_APERTURE 1.12

struct igi_photographs {
    const igi_scene *scene;
    igi_calibration *calibration; /* NULL: the images are as they are wanted */
    igi_merge_options merge;
    bool as_taken; /* neither corrected nor scaled */
    char *note;    /* about the first photograph that it holds for, and for others; NULL: nothing */
    size_t noted;
};

/* The camera that the file's image belongs to. */
static const igi_camera *camera_of(const igi_frame *frame)
{
    return frame->taken ? frame->taken : &frame->camera;
}

static igi_status check_size(igi_context *ctx, const igi_scene *scene, const igi_calibration *c)
{
    for (size_t i = 0; i < scene->frame_count; i++) {
        const igi_camera *camera = camera_of(&scene->frames[i]);
        if (camera->width == c->width && camera->height == c->height) continue;
        return igi_fail(ctx, IGI_E_DATA,
                        "%s: it is for %d x %d pixels, and image %s has %d x %d; calibrate with "
                        "photographs of that size, uncropped",
                        scene->calibration, c->width, c->height, scene->frames[i].name,
                        camera->width, camera->height);
    }
    return IGI_OK;
}

/* One response for all images, or each bracket would have a unit of its own. */
static igi_status choose_response(igi_context *ctx, igi_photographs *p)
{
    const igi_scene *scene = p->scene;
    const igi_response *given = p->calibration ? p->calibration->response : NULL;
    igi_photo *first;
    if (!scene->frame_count || !scene->frames[0].exposure_count) return IGI_OK;
    const char *path = scene->frames[0].exposures[0].path;
    IGI_TRY(igi_photo_probe(ctx, path, &first));
    int levels = first->levels, channels = first->channels;
    bool linear = first->linear;
    igi_photo_destroy(first);
    p->merge.response = scene->exposures_response;
    if (linear || p->merge.response != IGI_RESPONSE_AUTO) return IGI_OK;
    if (given && levels == given->levels && channels == given->channels) {
        p->merge.response = IGI_RESPONSE_GIVEN;
        p->merge.given = given;
    } else if (given) {
        return igi_fail(ctx, IGI_E_DATA,
                        "%s: its response is for %d channels of %d levels, and %s has %d of %d; "
                        "calibrate with such photographs",
                        scene->calibration, given->channels, given->levels, path, channels, levels);
    } else if (levels > 256) {
        p->merge.response = IGI_RESPONSE_LINEAR;
    } else {
        return igi_fail(ctx, IGI_E_DATA,
                        "%s: 8-bit codes tell light only through the camera's response, one for "
                        "all images; recover it with igi merge --save-response, and name that file "
                        "as scene.json's \"calibration\"",
                        path);
    }
    return IGI_OK;
}

/* Pixels are taken as stored, as COLMAP takes them; OpenCV's imread and many others turn them. Where that
 * changes the picture's sides, the cameras' sizes tell (merge_frame); a half turn or a mirrored picture
 * nothing tells. */
static igi_status note_turns(igi_context *ctx, igi_photographs *p)
{
    const igi_scene *scene = p->scene;
    size_t turned = 0;
    for (size_t i = 0; i < scene->frame_count; i++) {
        igi_photo *photo;
        if (!scene->frames[i].exposure_count) continue;
        IGI_TRY(igi_photo_probe(ctx, scene->frames[i].exposures[0].path, &photo));
        bool is_turned = photo->orientation > 1 &&
                         (photo->orientation < 5 || photo->width == photo->height);
        igi_photo_destroy(photo);
        if (is_turned && turned++ == 0) p->noted = i;
    }
    if (turned == 0) return IGI_OK;
    return igi_strprintf(
        ctx, &p->note,
        "EXIF asks to turn %s by half or to mirror it for display; pixels are taken as "
        "stored, as COLMAP takes them: where the cameras come from a program that "
        "turns photographs, turn the files first (exiftran -a)",
        turned > 1 ? "it and others" : "it");
}

/* Sizes that differ by a quarter turn alone. */
static igi_status refuse_size(igi_context *ctx, const igi_frame *frame, const igi_image *image)
{
    const igi_camera *camera = camera_of(frame);
    const char *path = frame->exposures[0].path;
    igi_photo *photo;
    IGI_TRY(igi_photo_probe(ctx, path, &photo));
    int orientation = photo->orientation;
    igi_photo_destroy(photo);
    if (orientation >= 5 && image->width == camera->height && image->height == camera->width)
        return igi_fail(
            ctx, IGI_E_DATA,
            "%s: its pixels are stored as %d x %d and EXIF asks to turn them (orientation "
            "%d), which its camera of %d x %d has done; estimate the cameras from pixels "
            "as stored, as COLMAP does, or turn the files first (exiftran -a)",
            path, image->width, image->height, orientation, camera->width, camera->height);
    return igi_fail(ctx, IGI_E_DATA, "%s: is %d x %d pixels, but its camera %d x %d; scale neither",
                    path, image->width, image->height, camera->width, camera->height);
}

static void warn_of_aperture(igi_context *ctx, const igi_scene *scene, const igi_vignetting *v)
{
    for (size_t i = 0; v->known && v->f_number > 0 && i < scene->frame_count; i++)
        for (size_t k = 0; k < scene->frames[i].exposure_count; k++) {
            const igi_exposure *e = &scene->frames[i].exposures[k];
            if (!(e->f_number > 0) || fabs(log(e->f_number / v->f_number)) <= log(SAME_APERTURE))
                continue;
            igi_warn(ctx,
                     "%s: vignetting was measured at f/%.3g, and %s was taken at f/%.3g, where it "
                     "differs; measure it at that aperture",
                     scene->calibration, v->f_number, e->path, e->f_number);
            return;
        }
}

igi_status igi_photographs_open(igi_context *ctx, const igi_scene *scene,
                                igi_photographs **photographs)
{
    igi_status status = IGI_OK;
    igi_photographs *p = NULL;
    *photographs = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &p));
    p->scene = scene;
    igi_merge_options_init(&p->merge);
    if (scene->calibration) {
        IGI_TRY_GOTO(igi_calibration_load(ctx, scene->calibration, &p->calibration));
        IGI_TRY_GOTO(check_size(ctx, scene, p->calibration));
        warn_of_aperture(ctx, scene, &p->calibration->vignetting);
    }
    IGI_TRY_GOTO(choose_response(ctx, p));
    IGI_TRY_GOTO(note_turns(ctx, p));
    *photographs = p;
    p = NULL;
cleanup:
    igi_photographs_close(p);
    return status;
}

igi_status igi_photographs_open_as_taken(igi_context *ctx, const igi_scene *scene,
                                         igi_photographs **photographs)
{
    IGI_TRY(igi_photographs_open(ctx, scene, photographs));
    (*photographs)->as_taken = true;
    return IGI_OK;
}

igi_camera igi_photographs_camera(const igi_photographs *photographs, size_t frame)
{
    const igi_camera *taken = camera_of(&photographs->scene->frames[frame]);
    const igi_calibration *c = photographs->calibration;
    if (!c || !c->has_lens) return *taken;
    igi_camera camera = c->lens;
    memcpy(camera.camera_to_world, taken->camera_to_world, sizeof camera.camera_to_world);
    return camera;
}

igi_status igi_photographs_check(igi_context *ctx, const igi_scene *scene)
{
    igi_photographs *photographs;
    IGI_TRY(igi_photographs_open(ctx, scene, &photographs));
    igi_photographs_close(photographs);
    return IGI_OK;
}

void igi_photographs_close(igi_photographs *photographs)
{
    if (!photographs) return;
    igi_calibration_destroy(photographs->calibration);
    igi_free(photographs->note);
    igi_free(photographs);
}

static igi_status merge_frame(igi_context *ctx, const igi_photographs *p, const igi_frame *frame,
                              igi_image **image, char **warning)
{
    igi_merged *merged;
    IGI_TRY(igi_merge(ctx, frame->exposures, frame->exposure_count, &p->merge, &merged));
    *image = merged->image;
    *warning = merged->warning;
    merged->image = NULL;
    merged->warning = NULL;
    igi_merged_destroy(merged);
    const igi_camera *camera = camera_of(frame);
    if ((*image)->width == camera->width && (*image)->height == camera->height) return IGI_OK;
    return refuse_size(ctx, frame, *image);
}

static igi_status add_note(igi_context *ctx, const char *note, char **warning)
{
    char *both;
    if (!*warning) return igi_strdup(ctx, note, warning);
    IGI_TRY(igi_strprintf(ctx, &both, "%s; %s", *warning, note));
    igi_free(*warning);
    *warning = both;
    return IGI_OK;
}

/* Averages a picture of more pixels than the frame's camera has; `image` is exchanged. */
static igi_status shrink(igi_context *ctx, const igi_frame *frame, igi_image **image)
{
    igi_image *small;
    const igi_camera *taken = frame->taken;
    if (!taken || (*image)->width != taken->width || (*image)->height != taken->height)
        return IGI_OK; /* whose sizes differ is refused by who asked */
    IGI_TRY(igi_image_resample(ctx, *image, frame->camera.width, frame->camera.height, &small));
    igi_image_destroy(*image);
    *image = small;
    return IGI_OK;
}

igi_status igi_photographs_load(igi_context *ctx, const igi_photographs *photographs, size_t frame,
                                igi_image **image, char **warning)
{
    const igi_frame *f = &photographs->scene->frames[frame];
    const igi_calibration *c = photographs->calibration;
    igi_status status = IGI_OK;
    igi_image *taken = NULL;
    *image = NULL;
    *warning = NULL;
    if (f->exposure_count) IGI_TRY_GOTO(merge_frame(ctx, photographs, f, &taken, warning));
    else IGI_TRY_GOTO(igi_image_load_photograph(ctx, f->path, &taken));
    if (photographs->note && frame == photographs->noted)
        IGI_TRY_GOTO(add_note(ctx, photographs->note, warning));
    if (!photographs->as_taken && c && (c->has_lens || c->vignetting.known)) {
        if (taken->width != c->width || taken->height != c->height) {
            status = igi_fail(ctx, IGI_E_DATA, "%s: %d x %d pixels, and %s is for %d x %d", f->path,
                              taken->width, taken->height, photographs->scene->calibration,
                              c->width, c->height);
            goto cleanup;
        }
        IGI_TRY_GOTO(igi_correct_for(ctx, c, taken, camera_of(f), image));
    } else {
        *image = taken;
        taken = NULL;
    }
    if (!photographs->as_taken) IGI_TRY_GOTO(shrink(ctx, f, image));
cleanup:
    igi_image_destroy(taken);
    if (status != IGI_OK) {
        igi_image_destroy(*image);
        *image = NULL;
        igi_free(*warning);
        *warning = NULL;
    }
    return status;
}
