/* SPDX-License-Identifier: Apache-2.0
 *
 * The forward direction: pictures of a scene with given materials under given lights.
 */
#ifndef IGI_RENDER_H
#define IGI_RENDER_H

#include <igi/material.h>

#ifdef __cplusplus
extern "C" {
#endif

typedef struct igi_render_options {
    size_t struct_size;
    int samples;   /* paths a pixel; default 64 */
    int max_depth; /* edges of a path; default 1024 (Russian roulette from the 5th) */
} igi_render_options;

IGI_API void igi_render_options_init(igi_render_options *options);

/* Path tracing with next-event estimation and multiple importance sampling (Veach 1997).
 * materials->materials are those of scene->regions, in order; `lights` are the lights that are on:
 * an emitter region that they leave out is dark. *variance (may be NULL) receives the variance of
 * each pixel's mean. */
IGI_API IGI_MUST_USE igi_status igi_render(igi_context *context, const igi_scene *scene,
                                           const igi_materials *materials, const igi_light *lights,
                                           size_t light_count, const igi_camera *camera,
                                           const igi_render_options *options, igi_image **picture,
                                           igi_image **variance);

/* The forward methods of the textbooks. */
typedef enum igi_render_method {
    IGI_RENDER_PATH,       /* all light (Kajiya 1986) */
    IGI_RENDER_DIRECT,     /* ray casting: light that has met one surface at most */
    IGI_RENDER_WHITTED,    /* that, and mirror images in what is glossy (Whitted 1980) */
    IGI_RENDER_RADIOSITY,  /* patches that gather, one brightness each (Goral et al. 1984) */
    IGI_RENDER_PROGRESSIVE /* patches that shoot, the brightest first (Cohen et al. 1988) */
} igi_render_method;

IGI_API const char *igi_render_method_name(igi_render_method method);
IGI_API bool igi_render_method_from_name(const char *name, igi_render_method *method);

typedef struct igi_relight_options {
    size_t struct_size;
    igi_render_options render;
    igi_render_method method; /* default IGI_RENDER_PATH */
    const char *lights;       /* a file of the lights that are on; NULL: the scene's own */
    const char *insert;  /* a mesh to be put into the scene, an OBJ with its MTL; may be NULL */
    const char *edits;   /* a file { "regions": { .. } } with what is changed of materials.json's
                          * "model", "albedo", "albedo_map", "specular", "specular_rgb", "alpha", in
                          * any region, or "albedo_hsv": [hue, saturation, value]; may be NULL */
    const char *sensors; /* a file of points that measure light, a line each: X Y Z and the way it
                          * faces; they are written as illuminance.csv, each by 64 paths for one of
                          * a pixel; may be NULL */
    double target_error; /* passes of render.samples go on until the mean standard deviation of a
                          * pixel is this share of the mean pixel; 0: one pass (default) */
    bool variance;       /* also NAME.variance.exr, the variance of each pixel's mean */
    bool layers;         /* also NAME.layers.exr: albedo, direct (light that has met one surface at
                          * most), indirect (the rest) and variance */
    bool preview;  /* quick: radiosity for all but the light that has met one surface, which is
                          * smoothed; render.samples of 8 will do. Noise and variance are those from
                          * before the smoothing */
    bool png;      /* also NAME.png, sRGB; one exposure for all: the first frame's 95th
                          * percentile becomes .8 */
    bool sigma;    /* also NAME.sigma.exr: one standard deviation of each pixel, from those that
                          * the materials and the solved lights have; and sigma.json, for each picture
                          * "pixel", of its pixels over its mean, and "picture", of that mean */
    double *doubt; /* [2] if not NULL, and sigma: receives the largest "pixel" and "picture" */
    double *noise; /* if not NULL: receives the noise of the noisiest frame, the mean standard
                          * deviation of a pixel over the mean pixel; 0 when it is not known */
} igi_relight_options;

IGI_API void igi_relight_options_init(igi_relight_options *options);

/* Writes a picture of each frame of `cameras` (a cameras' file, or NULL) into the existing folder `output`,
 * named as its image, as OpenEXR: what `folder` holds, the result of a recovery or the truth of a
 * scene. */
IGI_API IGI_MUST_USE igi_status igi_relight(igi_context *context, const char *folder,
                                            const char *cameras, const igi_relight_options *options,
                                            const char *output);

typedef struct igi_basis_options {
    size_t struct_size;
    igi_render_options render;
    int views; /* at most so many of the cameras; default 2 */
    int side;  /* of a picture, pixels at most; default 320 */
} igi_basis_options;

IGI_API void igi_basis_options_init(igi_basis_options *options);

/* Writes FOLDER/relight/: a picture of each view by each lamp alone, for igi_report's page to relight
 * by hand. `cameras` is a cameras' file; NULL: those that the result was recovered from. */
IGI_API IGI_MUST_USE igi_status igi_basis_save(igi_context *context, const char *folder,
                                               const char *cameras,
                                               const igi_basis_options *options);

#ifdef __cplusplus
}
#endif
#endif
