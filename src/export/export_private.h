/* SPDX-License-Identifier: Apache-2.0
 *
 * What the writers of src/export share.
 */
#ifndef IGI_SRC_EXPORT_PRIVATE_H
#define IGI_SRC_EXPORT_PRIVATE_H

#include "material/material.h"

#include <igi/export.h>

#include <stdio.h>

/* An export under way. */
typedef struct igi_exporter {
    igi_context *ctx;
    const igi_scene *scene;
    const igi_materials *materials; /* in the order of the regions, with the lights that are on */
    const igi_frame *frames;        /* the cameras; may be none */
    size_t frame_count;
    FILE *file;         /* the main file */
    const char *folder; /* where meshes and textures are written now */
    const char *files;  /* what the main file calls that folder */
} igi_exporter;

/* The formats: each writes the main file, and what it needs beside. */
IGI_MUST_USE igi_status igi_write_obj(const igi_exporter *e);
IGI_MUST_USE igi_status igi_write_mitsuba(const igi_exporter *e);
IGI_MUST_USE igi_status igi_write_pbrt(const igi_exporter *e);
IGI_MUST_USE igi_status igi_write_radiance(const igi_exporter *e);

/* Three numbers for R, G and B out of any number of bands. */
void igi_export_rgb(const double *value, int bands, double rgb[3]);
/* Does its map come along? */
bool igi_export_is_textured(const igi_scene *scene, const igi_material *material, size_t region);
/* The light of an area of this region that is on, or NULL. */
const igi_light *igi_export_lamp(const igi_exporter *e, size_t region);
/* A point a metre along a spot's beam, and a direction that is not along it. */
void igi_export_target(const igi_light *light, double target[3], double up[3]);

/* Points that stand for a line light, which renderers lack. */
enum { IGI_LINE_POINTS = 16 };
void igi_export_line_point(const igi_light *line, int k, int bands, double at[3], double rgb[3]);
/* Warns, once each, of what all three renderers lack: lines, goniometric profiles. */
void igi_export_warn_lights(const igi_exporter *e, const char *program);
/* Mean over all directions of a goniometric light's intensity, for a scale of one. */
IGI_MUST_USE igi_status igi_export_mean_intensity(const igi_exporter *e, const igi_light *light,
                                                  double *mean);

/* A surface in the words of renderers that blend two materials but add none:
 * f = (1 - share) diffuse/pi + share D G F/(4 cos_i cos_o), with F = specular/share. */
typedef struct igi_blend {
    double share;   /* 0: no lobe */
    double diffuse; /* 1/(1 - share): the factor of albedos and maps */
    double specular[3];
    bool is_ggx;      /* D is Trowbridge and Reitz's; else Beckmann's */
    bool has_fresnel; /* F rises to 1/share at grazing angles; else it is constant */
    double alpha;
} igi_blend;

igi_blend igi_export_blend(const igi_exporter *e, size_t region);
/* Index of refraction whose reflectance at normal incidence is f0. */
double igi_export_index(double f0);

typedef enum igi_picture { IGI_PICTURE_PNG, IGI_PICTURE_EXR, IGI_PICTURE_HDR } igi_picture;
/* FOLDER/NAME.png, .exr or .hdr of the map times `scale` (PNG: 1); NAME is the region's. */
IGI_MUST_USE igi_status igi_export_texture(const igi_exporter *e, size_t region, igi_picture format,
                                           double scale);
/* FOLDER/light_N.exr or .hdr: an environment map times its light's scale. Also its size. */
IGI_MUST_USE igi_status igi_export_sky(const igi_exporter *e, size_t light, igi_picture format,
                                       int size[2]);
/* The same on an equal-area octahedral square (Clarberg 2008), as pbrt-v4 wants it. */
IGI_MUST_USE igi_status igi_export_square_sky(const igi_exporter *e, size_t light);

/* FOLDER/NAME.ply: the region's triangles, little-endian, with texture coordinates if textured. */
IGI_MUST_USE igi_status igi_export_ply(const igi_exporter *e, size_t region);

#endif
