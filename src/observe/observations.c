/* SPDX-License-Identifier: Apache-2.0
 *
 * One task a photograph: load, trace, keep. Pixels are kept in arrays of the frame's own, which
 * are then joined one kind at a time, so that the peak stays near the final size.
 */
#include "observe/observations.h"

#include "base/parallel.h"
#include "base/rng.h"
#include "image/resample.h"
#include "lens/photographs.h"
#include "observe/cover.h"
#include "observe/visible.h"

#include <igi/image.h>
#include <string.h>

#define DEFAULT_LIMIT ((size_t)8 << 20)
/* A photograph with more broken pixels than this share is refused. */
#define BROKEN_SHARE 0.1
/* Noise about zero is data; what lies farther below zero than this share of the mean is not. */
#define NEGATIVE_SHARE 0.05f
/* A camera that meets back sides alone, where the others together meet few, stands inside
 * something. */
#define ALL_BACK 0.9
#define FEW_BACK 0.5

/* A region of fewer clean pixels is too small to be without those near its edges: rays through each
 * of its pixels tell which show it alone. Where that leaves fewer than twenty, the next grade counts
 * as well (igi_visible), and so on: twenty are better than hundreds that mix. */
#define FEWEST_PIXELS 20
#define FEWEST_OF_PLENTY 200
#define GRADES 4

typedef struct frame_pixels {
    size_t count;
    uint8_t *grade;
    uint32_t *surface, *pixel;
    float *uv, *radiance;
    size_t broken;
    uint32_t first_broken;
    char *warning;     /* about the photograph; NULL: none */
    size_t hits, back; /* pixels that show a surface, and its clockwise side */
    size_t outline_count;
    igi_outline *outlines;
    size_t reading_count;
    igi_lamp_reading *readings;
    double lit_gaps;
} frame_pixels;

typedef struct job {
    const igi_scene *scene;
    igi_photographs *photographs;
    const igi_tracer *tracer;
    uint32_t keep_below; /* of a 32-bit hash; UINT32_MAX: all */
    frame_pixels *frames;
    igi_registration *registrations;
    double *saturated, *mean;
    bool *scarce; /* [regions] */
    int preview_side;
    igi_image **previews; /* [frames]; NULL: none */
} job;

static bool is_broken(const float *radiance, int bands, float lowest)
{
    for (int b = 0; b < bands; b++)
        if (!isfinite(radiance[b]) || radiance[b] < lowest) return true;
    return false;
}

static bool is_kept(const job *j, size_t frame, uint32_t pixel)
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

static void collect(const job *j, size_t frame, const igi_image *image, const igi_visible *visible)
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

static igi_status allocate_frame(igi_context *ctx, frame_pixels *f, size_t pixels, int bands)
{
    IGI_TRY(IGI_ALLOC(ctx, pixels, &f->grade));
    IGI_TRY(IGI_ALLOC(ctx, pixels, &f->surface));
    IGI_TRY(IGI_ALLOC(ctx, pixels, &f->pixel));
    IGI_TRY(IGI_ALLOC(ctx, 2 * pixels, &f->uv));
    return IGI_ALLOC(ctx, (size_t)bands * pixels, &f->radiance);
}

static igi_status observe_frame(igi_context *ctx, void *user, size_t frame, int worker)
{
    (void)worker;
    job *j = user;
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
    f->lit_gaps = igi_lit_gaps(j->scene, image, &visible);
    if (j->previews)
        IGI_TRY_GOTO(igi_image_reduce(ctx, image, j->preview_side, &j->previews[frame]));
cleanup:
    igi_visible_clear(&visible);
    igi_image_destroy(image);
    return status;
}

/* Drops the pixels of too high a grade for their region. */
static void drop_pixels(const job *j, frame_pixels *f, const uint8_t *highest)
{
    size_t kept = 0, bands = (size_t)j->scene->bands;
    for (size_t i = 0; i < f->count; i++) {
        uint32_t region = j->scene->mesh.regions[igi_surface_triangle(f->surface[i])];
        if (f->grade[i] > highest[region]) continue;
        f->surface[kept] = f->surface[i];
        f->pixel[kept] = f->pixel[i];
        memcpy(f->uv + 2 * kept, f->uv + 2 * i, 2 * sizeof *f->uv);
        memmove(f->radiance + kept * bands, f->radiance + i * bands, bands * sizeof *f->radiance);
        kept++;
    }
    f->count = kept;
    igi_free(f->grade);
    f->grade = NULL;
}

/* Of a region that has few clean pixels, each is judged by rays of its own. */
static igi_status regrade(igi_context *ctx, void *user, size_t frame, int worker)
{
    (void)worker;
    const job *j = user;
    frame_pixels *f = &j->frames[frame];
    const igi_camera *camera = &j->scene->frames[frame].camera;
    size_t rays = 0;
    for (size_t i = 0; i < f->count; i++) {
        if (!j->scarce[j->scene->mesh.regions[igi_surface_triangle(f->surface[i])]]) continue;
        igi_cover cover = igi_cover_of(j->scene, j->tracer, camera, f->pixel[i], &rays);
        if (cover == IGI_COVER_WIDE) f->grade[i] = 0;
        else if (cover == IGI_COVER_WHOLE) f->grade[i] = 1;
        else if (f->grade[i] < 2) f->grade[i] = 2;
    }
    igi_count_rays(ctx, rays);
    return IGI_OK;
}

/* Pixels of each region by grade: counts[regions][GRADES]. */
static void count_grades(const job *j, size_t *counts)
{
    memset(counts, 0, j->scene->region_count * GRADES * sizeof *counts);
    for (size_t k = 0; k < j->scene->frame_count; k++)
        for (size_t i = 0; i < j->frames[k].count; i++) {
            uint32_t triangle = igi_surface_triangle(j->frames[k].surface[i]);
            counts[j->scene->mesh.regions[triangle] * GRADES + j->frames[k].grade[i]]++;
        }
}

/* Pixels near edges go, but for regions that have no others to speak of. */
static igi_status drop_edges(igi_context *ctx, job *j)
{
    size_t regions = j->scene->region_count, *counts = NULL;
    uint8_t *highest = NULL;
    igi_status status = IGI_OK;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions * GRADES, &counts));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, regions, &highest));
    count_grades(j, counts);
    for (size_t r = 0; r < regions; r++) /* a lamp's edges are the worst */
        j->scarce[r] = counts[r * GRADES] < FEWEST_OF_PLENTY && !j->scene->regions[r].emitter;
    IGI_TRY_GOTO(igi_parallel_for(ctx, j->scene->frame_count, regrade, j));
    count_grades(j, counts);
    for (size_t r = 0; r < regions; r++) {
        size_t sum = counts[r * GRADES];
        j->scarce[r] = sum < FEWEST_OF_PLENTY;
        while (sum < FEWEST_PIXELS && highest[r] + 1 < GRADES)
            sum += counts[r * GRADES + ++highest[r]];
        if (j->scene->regions[r].emitter) highest[r] = 0;
    }
    for (size_t k = 0; k < j->scene->frame_count; k++) drop_pixels(j, &j->frames[k], highest);
cleanup:
    igi_free(counts);
    igi_free(highest);
    return status;
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

static igi_status join_all(igi_context *ctx, job *j, igi_observations *o)
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

static igi_status join_lamps(igi_context *ctx, const job *j, igi_observations *o)
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
        o->lit_gaps += f->lit_gaps / (double)o->frame_count;
    }
    return IGI_OK;
}

static igi_status collect_warnings(igi_context *ctx, const job *j, igi_observations *o)
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
    job j = {.scene = scene,
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
