/* SPDX-License-Identifier: Apache-2.0
 *
 * One task a photograph keeps its pixels in arrays of the frame's own; they are then joined one kind at
 * a time, so that the peak stays near the final size.
 */
#include "observe/frame_pixels.h"

#include "base/parallel.h"

#include <igi/image.h>
#include <string.h>

#define DEFAULT_LIMIT ((size_t)8 << 20)
/* A camera that meets back sides alone, where the others together meet few, stands inside
 * something. */
#define ALL_BACK 0.9
#define FEW_BACK 0.5

static igi_status check_places(igi_context *ctx, const igi_scene *scene, const frame_pixels *frames)
{
    size_t hits = 0, back = 0;
    for (size_t i = 0; i < scene->frame_count; i++) {
        hits += frames[i].hits;
        back += frames[i].back;
    }
    if ((double)back > FEW_BACK * (double)hits) return IGI_OK; /* the mesh is inside out */
    for (size_t i = 0; i < scene->frame_count; i++)
        if ((double)frames[i].back > ALL_BACK * (double)frames[i].hits)
            return igi_fail(
                ctx, IGI_E_DATA,
                "%s: this camera sees back sides alone: it stands inside a wall or a "
                "piece of furniture; correct its place, or leave it out of the cameras' "
                "file",
                scene->frames[i].path);
    return IGI_OK;
}

/* Moves an array that every frame has, of `per` elements a pixel, into one of all frames. */
#define JOIN(field, per)                                                   \
    do {                                                                   \
        IGI_TRY(IGI_ALLOC(ctx, o->count *(size_t)(per), &o->field));       \
        for (size_t i = 0; i < o->frame_count; i++) {                      \
            frame_pixels *f = &j->frames[i];                               \
            memcpy(o->field + o->frame_begin[i] * (size_t)(per), f->field, \
                   f->count * (size_t)(per) * sizeof *f->field);           \
            igi_free(f->field);                                            \
            f->field = NULL;                                               \
        }                                                                  \
    } while (0)

static igi_status join_all(igi_context *ctx, observing *j, igi_observations *o)
{
    IGI_TRY(IGI_ALLOC(ctx, o->frame_count + 1, &o->frame_begin));
    for (size_t i = 0; i < o->frame_count; i++)
        o->frame_begin[i + 1] = o->frame_begin[i] + j->frames[i].count;
    o->count = o->frame_begin[o->frame_count];
    JOIN(surface, 1);
    JOIN(pixel, 1);
    JOIN(uv, 2);
    JOIN(radiance, o->bands);
    return IGI_OK;
}

static igi_status join_lamps(igi_context *ctx, const observing *j, igi_observations *o)
{
    size_t outlines = 0, readings = 0;
    for (size_t i = 0; i < o->frame_count; i++) {
        outlines += j->frames[i].outline_count;
        readings += j->frames[i].reading_count;
    }
    IGI_TRY(IGI_ALLOC(ctx, outlines, &o->outlines));
    IGI_TRY(IGI_ALLOC(ctx, readings, &o->readings));
    for (size_t i = 0; i < o->frame_count; i++) {
        const frame_pixels *f = &j->frames[i];
        for (size_t k = 0; k < f->outline_count; k++)
            o->outlines[o->outline_count++] = f->outlines[k];
        for (size_t k = 0; k < f->reading_count; k++)
            o->readings[o->reading_count++] = f->readings[k];
        o->response_deviation = fmax(o->response_deviation, f->deviation);
        o->lit_gaps += f->lit_gaps / (double)o->frame_count;
    }
    return IGI_OK;
}

static igi_status collect_warnings(igi_context *ctx, const observing *j, igi_observations *o)
{
    for (size_t i = 0; i < o->frame_count; i++) {
        const frame_pixels *f = &j->frames[i];
        if (f->warning) {
            char *about;
            IGI_TRY(
                igi_strprintf(ctx, &about, "image %s: %s", j->scene->frames[i].name, f->warning));
            IGI_TRY(igi_add_sentence(ctx, &o->warnings, &o->warning_count, about));
        }
        if (f->broken == 0) continue;
        uint32_t width = (uint32_t)j->scene->frames[i].camera.width;
        char *sentence;
        IGI_TRY(igi_strprintf(
            ctx, &sentence,
            "image %s: %zu pixels are negative, infinite or not a number and were "
            "left out (first at column %u, row %u)",
            j->scene->frames[i].name, f->broken, f->first_broken % width, f->first_broken / width));
        IGI_TRY(igi_add_sentence(ctx, &o->warnings, &o->warning_count, sentence));
    }
    return IGI_OK;
}

static uint32_t share_to_keep(const igi_scene *scene, size_t limit)
{
    double total = 0;
    for (size_t i = 0; i < scene->frame_count; i++)
        total += (double)scene->frames[i].camera.width * scene->frames[i].camera.height;
    double share = (double)(limit ? limit : DEFAULT_LIMIT) / fmax(total, 1);
    return share >= 1 ? UINT32_MAX : (uint32_t)(share * (double)UINT32_MAX);
}

static igi_status observe(igi_context *ctx, const igi_scene *scene, const igi_tracer *tracer,
                          size_t limit, int preview_side, igi_observations **observations)
{
    *observations = NULL;
    observing j = {.scene = scene,
                   .tracer = tracer,
                   .keep_below = share_to_keep(scene, limit),
                   .preview_side = preview_side};
    igi_observations *o = NULL;
    igi_status status = IGI_OK;
    IGI_TRY_GOTO(igi_photographs_open(ctx, scene, &j.photographs));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, scene->frame_count, &j.frames));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &o));
    o->bands = scene->bands;
    o->frame_count = scene->frame_count;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, scene->frame_count, &o->registrations));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, scene->frame_count, &o->saturated));
    j.registrations = o->registrations;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, scene->frame_count, &o->veils));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, scene->frame_count * (size_t)scene->bands, &o->mean));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, scene->frame_count * IGI_GLOW_CELLS, &o->glow));
    j.glow = o->glow;
    j.saturated = o->saturated;
    j.mean = o->mean;
    for (size_t i = 0; i < scene->frame_count; i++) o->veils[i].kept = 1;
    if (preview_side > 0) IGI_TRY_GOTO(IGI_ALLOC(ctx, scene->frame_count, &o->previews));
    j.previews = o->previews;
    IGI_TRY_GOTO(igi_parallel_for(ctx, scene->frame_count, observe_frame, &j));
    IGI_TRY_GOTO(check_places(ctx, scene, j.frames));
    IGI_TRY_GOTO(collect_warnings(ctx, &j, o));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, scene->region_count, &o->scarce));
    j.scarce = o->scarce;
    IGI_TRY_GOTO(drop_edges(ctx, &j));
    IGI_TRY_GOTO(join_all(ctx, &j, o));
    IGI_TRY_GOTO(join_lamps(ctx, &j, o));
    *observations = o;
    o = NULL;
cleanup:
    for (size_t i = 0; j.frames && i < scene->frame_count; i++) {
        igi_free(j.frames[i].grade);
        igi_free(j.frames[i].surface);
        igi_free(j.frames[i].pixel);
        igi_free(j.frames[i].uv);
        igi_free(j.frames[i].radiance);
        igi_free(j.frames[i].warning);
        igi_free(j.frames[i].outlines);
        igi_free(j.frames[i].readings);
    }
    igi_photographs_close(j.photographs);
    igi_free(j.frames);
    igi_observations_destroy(o);
    return status;
}

igi_status igi_observe(igi_context *ctx, const igi_scene *scene, const igi_tracer *tracer,
                       size_t limit, igi_observations **observations)
{
    return observe(ctx, scene, tracer, limit, 0, observations);
}

igi_status igi_observe_with_previews(igi_context *ctx, const igi_scene *scene,
                                     const igi_tracer *tracer, int side,
                                     igi_observations **observations)
{
    return observe(ctx, scene, tracer, 0, side, observations);
}

size_t igi_observation_at(const igi_observations *observations, size_t frame, uint32_t pixel)
{
    size_t low = observations->frame_begin[frame], high = observations->frame_begin[frame + 1];
    while (low < high) {
        size_t middle = low + (high - low) / 2;
        if (observations->pixel[middle] < pixel) low = middle + 1;
        else high = middle;
    }
    bool found = low < observations->frame_begin[frame + 1] && observations->pixel[low] == pixel;
    return found ? low : SIZE_MAX;
}

size_t igi_observation_frame(const igi_observations *observations, size_t observation)
{
    size_t low = 0, high = observations->frame_count;
    while (high - low > 1) {
        size_t middle = low + (high - low) / 2;
        if (observations->frame_begin[middle] <= observation) low = middle;
        else high = middle;
    }
    return low;
}

void igi_observations_destroy(igi_observations *observations)
{
    if (!observations) return;
    for (size_t i = 0; i < observations->warning_count; i++) igi_free(observations->warnings[i]);
    igi_free(observations->warnings);
    for (size_t i = 0; observations->previews && i < observations->frame_count; i++)
        igi_image_destroy(observations->previews[i]);
    igi_free(observations->previews);
    igi_free(observations->registrations);
    igi_free(observations->saturated);
    igi_free(observations->mean);
    igi_free(observations->glow);
    igi_free(observations->veils);
    igi_free(observations->outlines);
    igi_free(observations->readings);
    igi_free(observations->frame_begin);
    igi_free(observations->scarce);
    igi_free(observations->surface);
    igi_free(observations->uv);
    igi_free(observations->pixel);
    igi_free(observations->radiance);
    igi_free(observations);
}
