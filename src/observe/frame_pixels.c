/* SPDX-License-Identifier: Apache-2.0
 *
 * One photograph: load, trace, keep.
 */
#include "observe/frame_pixels.h"

#include "base/rng.h"
#include "image/resample.h"
#include "observe/visible.h"

#include <igi/image.h>
#include <string.h>

/* A photograph with more broken pixels than this share is refused. */
#define BROKEN_SHARE 0.1
/* Noise about zero is data; what lies farther below zero than this share of the mean is not. */
#define NEGATIVE_SHARE 0.05f

static bool is_broken(const float *radiance, int bands, float lowest)
{
    for (int b = 0; b < bands; b++)
        if (!isfinite(radiance[b]) || radiance[b] < lowest) return true;
    return false;
}

static bool is_kept(const observing *j, size_t frame, uint32_t pixel)
{
    if (j->keep_below == UINT32_MAX) return true;
    return (uint32_t)igi_hash64((uint64_t)frame << 32 | pixel) < j->keep_below;
}

/* The channel in which igi merge marks what even the shortest exposure saw saturated; -1: none. */
static int saturation_channel(const igi_image *image)
{
    for (int c = 0; c < image->channels; c++)
        if (strcmp(image->names[c], "saturated") == 0) return c;
    return -1;
}

static void collect(const observing *j, size_t frame, const igi_image *image,
                    const igi_visible *visible)
{
    frame_pixels *f = &j->frames[frame];
    int bands = j->scene->bands;
    double mean = igi_image_mean(image, bands, j->mean + frame * (size_t)bands);
    float lowest = -NEGATIVE_SHARE * fmaxf(0, (float)mean);
    uint32_t pixels = (uint32_t)(image->width * image->height);
    int saturated = saturation_channel(image);
    for (uint32_t i = 0; i < pixels; i++) {
        const float *radiance = image->samples + (size_t)i * (size_t)image->channels;
        if (saturated >= 0 && !(radiance[saturated] <= 0)) { /* NaN: beyond the lens */
            j->saturated[frame] += radiance[saturated] > 0 ? 1.0 / pixels : 0;
            continue;
        }
        if (is_broken(radiance, bands, lowest)) {
            if (f->broken++ == 0) f->first_broken = i;
            continue;
        }
        const igi_hit *hit = &visible->hits[i];
        if (hit->triangle == IGI_NO_HIT || !is_kept(j, frame, i)) continue;
        f->grade[f->count] = visible->near_edge[i];
        f->surface[f->count] = igi_surface_of(hit);
        f->pixel[f->count] = i;
        f->uv[2 * f->count] = hit->u;
        f->uv[2 * f->count + 1] = hit->v;
        memcpy(f->radiance + f->count * (size_t)bands, radiance, (size_t)bands * sizeof(float));
        f->count++;
    }
}

static igi_status check_photograph(igi_context *ctx, const igi_scene *scene, size_t frame,
                                   const igi_image *image)
{
    const igi_frame *f = &scene->frames[frame];
    if (image->width != f->camera.width || image->height != f->camera.height)
        return igi_fail(
            ctx, IGI_E_DATA,
            "%s: the image is %d x %d pixels, its camera %d x %d; scale one to the other", f->path,
            image->width, image->height, f->camera.width, f->camera.height);
    if (image->channels < scene->bands)
        return igi_fail(ctx, IGI_E_DATA, "%s: %d channels where %d bands are needed", f->path,
                        image->channels, scene->bands);
    return IGI_OK;
}

static igi_status check_pixels(igi_context *ctx, const igi_scene *scene, size_t frame,
                               frame_pixels *f, const igi_visible *visible)
{
    const igi_frame *meta = &scene->frames[frame];
    size_t pixels = (size_t)visible->width * (size_t)visible->height;
    if ((double)f->broken > BROKEN_SHARE * (double)pixels)
        return igi_fail(ctx, IGI_E_DATA,
                        "%s: %zu of %zu pixels are negative, infinite or not a number (first at "
                        "column %u, row %u); export it again, or leave it out of the cameras' file",
                        meta->path, f->broken, pixels, f->first_broken % (uint32_t)visible->width,
                        f->first_broken / (uint32_t)visible->width);
    for (size_t i = 0; i < pixels; i++) {
        bool hit = visible->hits[i].triangle != IGI_NO_HIT;
        f->hits += hit;
        f->back += hit && visible->hits[i].back;
    }
    if (f->hits > 0) return IGI_OK;
    return igi_fail(ctx, IGI_E_DATA,
                    "%s: this camera sees nothing of the mesh; mesh and cameras must share one "
                    "frame and one unit, metres: mind which axis is up (modellers export glTF and "
                    "OBJ with +Y up), or bring cameras there with igi register --points",
                    meta->path);
}

static igi_status allocate_frame(igi_context *ctx, frame_pixels *f, size_t pixels, int bands)
{
    IGI_TRY(IGI_ALLOC(ctx, pixels, &f->grade));
    IGI_TRY(IGI_ALLOC(ctx, pixels, &f->surface));
    IGI_TRY(IGI_ALLOC(ctx, pixels, &f->pixel));
    IGI_TRY(IGI_ALLOC(ctx, 2 * pixels, &f->uv));
    return IGI_ALLOC(ctx, (size_t)bands * pixels, &f->radiance);
}

igi_status observe_frame(igi_context *ctx, void *user, size_t frame, int worker)
{
    (void)worker;
    observing *j = user;
    igi_image *image = NULL;
    igi_visible visible = {0};
    igi_status status = IGI_OK;
    const igi_frame *meta = &j->scene->frames[frame];
    IGI_TRY_GOTO(
        igi_photographs_load(ctx, j->photographs, frame, &image, &j->frames[frame].warning));
    IGI_TRY_GOTO(check_photograph(ctx, j->scene, frame, image));
    IGI_TRY_GOTO(igi_visible_create(ctx, j->scene, j->tracer, &meta->camera, &visible));
    size_t pixels = (size_t)image->width * (size_t)image->height;
    IGI_TRY_GOTO(allocate_frame(ctx, &j->frames[frame], pixels, j->scene->bands));
    collect(j, frame, image, &visible);
    IGI_TRY_GOTO(check_pixels(ctx, j->scene, frame, &j->frames[frame], &visible));
    IGI_TRY_GOTO(igi_registration_measure(ctx, j->scene, j->tracer, &meta->camera, image, &visible,
                                          &j->registrations[frame]));
    frame_pixels *f = &j->frames[frame];
    IGI_TRY_GOTO(igi_outlines_measure(ctx, j->scene, j->tracer, &meta->camera, image, &visible,
                                      &f->outlines, &f->outline_count));
    IGI_TRY_GOTO(igi_lamps_measure(ctx, j->scene, j->tracer, frame, image, &visible, &f->readings,
                                   &f->reading_count));
    f->deviation = (double)image->deviation;
    igi_glow_measure(image, j->scene->bands, j->glow + frame * IGI_GLOW_CELLS);
    f->lit_gaps = igi_lit_gaps(j->scene, image, &visible);
    if (j->previews)
        IGI_TRY_GOTO(igi_image_reduce(ctx, image, j->preview_side, &j->previews[frame]));
cleanup:
    igi_visible_clear(&visible);
    igi_image_destroy(image);
    return status;
}
