/* SPDX-License-Identifier: Apache-2.0
 *
 * What the files of src/synth share: the spec (datasets-synthetic/README.md), read.
 */
#ifndef IGI_SRC_SYNTH_SYNTH_H
#define IGI_SRC_SYNTH_SYNTH_H

#include "base/vec.h"
#include "scene/json.h"
#include "trace/trace.h"

#include <igi/material.h>
#include <igi/synth.h>

typedef enum texture_kind {
    TEXTURE_NONE,
    TEXTURE_CHECKER,
    TEXTURE_STRIPES,
    TEXTURE_NOISE
} texture_kind;

typedef struct texture {
    texture_kind kind;
    double colours[2][IGI_MAX_BANDS];
    int cells; /* along each side of the map */
    int size;  /* texels along each side */
    uint64_t seed;
} texture;

/* Photographs to take: where from is said by exactly one of look, ring and neither. */
typedef struct view_set {
    int width, height, count, samples;
    double fov_deg; /* across the width */
    uint64_t seed;
    bool has_eyes, has_unseen, has_ring;
    double eyes[2][3], unseen[2][3]; /* low and high corners */
    double ring_centre[3], ring_radius, ring_height;
    double clearance; /* metres from an eye to any surface */
    size_t look_count;
    double (*look)[2][3]; /* eye and target */
} view_set;

typedef struct relit_set {
    igi_json lights;
    view_set views;
} relit_set;

/* A face of three or four corners. */
typedef struct face {
    int material, corners;
    double position[4][3], uv[4][2];
} face;

typedef struct spec {
    igi_json_file file;
    igi_json root; /* parent of every value kept here */
    const char *name;
    igi_materials *materials; /* as truth; of a region: albedo, model, lobe, map */
    texture *textures;        /* [materials->count] */
    igi_json lights;
    view_set views, heldout;
    bool has_heldout;
    bool highlights; /* count the pixels that show them */
    relit_set *relit;
    size_t relit_count;
    igi_json relit_array, *relit_elements; /* parents of relit[].lights */
    face *faces;
    size_t face_count, face_capacity;
} spec;

IGI_MUST_USE igi_status spec_load(igi_context *ctx, const char *path, spec *s);
void spec_clear(spec *s);

/* Makes "random", where there is one, into "materials", "shapes" and "lights". */
IGI_MUST_USE igi_status random_expand(igi_context *ctx, const igi_json *root);

/* Values that may be absent: then *value keeps its default. */
IGI_MUST_USE igi_status optional_number(igi_context *ctx, const igi_json *object, const char *key,
                                        double low, double high, double *value);
IGI_MUST_USE igi_status optional_int(igi_context *ctx, const igi_json *object, const char *key,
                                     int low, int high, int *value);
IGI_MUST_USE igi_status member_vector(igi_context *ctx, const igi_json *object, const char *key,
                                      double value[3]);
/* A number for all bands, one for each, or { "hsv": [hue, saturation, value] }. */
IGI_MUST_USE igi_status read_bands(igi_context *ctx, const igi_json *at, int bands, double *value);

/* Adds the faces of one element of "shapes". */
IGI_MUST_USE igi_status shape_read(igi_context *ctx, spec *s, const igi_json *at);
IGI_MUST_USE igi_status shapes_save(igi_context *ctx, const spec *s, const char *path);

IGI_MUST_USE igi_status views_read(igi_context *ctx, const igi_json *at, view_set *views);
/* *cameras [*count] is the caller's. */
IGI_MUST_USE igi_status views_choose(igi_context *ctx, const view_set *views,
                                     const igi_scene *scene, const igi_tracer *tracer,
                                     igi_camera **cameras, size_t *count);
IGI_MUST_USE igi_status views_save(igi_context *ctx, const igi_camera *cameras, size_t count,
                                   const char *path);
igi_camera view_camera(const view_set *views, igi_vec eye, igi_vec target);
/* Cameras at free places within the scene. */
IGI_MUST_USE igi_status views_place(igi_context *ctx, const view_set *views, const igi_scene *scene,
                                    const igi_tracer *tracer, igi_camera *cameras, size_t count);
bool view_sees(const igi_camera *camera, const igi_tracer *tracer, igi_vec point);

/* A map of the texture; `image` is made. */
IGI_MUST_USE igi_status texture_make(igi_context *ctx, const texture *t, int bands,
                                     igi_image **image);

/* Adds to pixels[regions] how many pixels of the photographs show a highlight of each region. */
IGI_MUST_USE igi_status highlights_count(igi_context *ctx, const igi_scene *scene,
                                         const igi_tracer *tracer, const igi_materials *materials,
                                         const igi_camera *cameras, size_t camera_count,
                                         igi_image *const *photos, size_t *pixels);

/* What photographs show of the regions. */
typedef struct shown {
    const igi_camera *cameras;
    size_t camera_count;
    const size_t *highlight; /* [regions] pixels; NULL: nobody counted them */
} shown;

/* Copies the files that the spec's lights name into the scene's folder; *lights, the caller's, names
 * them there. */
IGI_MUST_USE igi_status lights_keep(igi_context *ctx, const igi_json *array, const char *folder,
                                    json_t **lights);

/* truth.json */
IGI_MUST_USE igi_status truth_save(igi_context *ctx, const spec *s, const igi_scene *scene,
                                   const igi_tracer *tracer, const shown *by, const char *path);

#endif
