/* SPDX-License-Identifier: Apache-2.0
 *
 * A scene: mesh, regions, lights and calibrated cameras, as read from a folder (formats in
 * include/FORMATS.md). Plain data; owned by the igi_scene and freed with it.
 */
#ifndef IGI_SCENE_H
#define IGI_SCENE_H

#include <igi/hdr.h>

#ifdef __cplusplus
extern "C" {
#endif

/* Triangles, metres, right-handed world. The front of a triangle is its counter-clockwise side. */
typedef struct igi_mesh {
    size_t vertex_count, triangle_count;
    float *positions;    /* [vertex_count][3] */
    uint32_t *triangles; /* [triangle_count][3], vertex indices */
    uint32_t *regions;   /* [triangle_count], index into igi_scene.regions */
    float *uvs; /* [triangle_count][3][2], origin at the bottom left; NULL: the mesh has none */
} igi_mesh;

typedef enum igi_tristate { IGI_AUTO = -1, IGI_NO = 0, IGI_YES = 1 } igi_tristate;

typedef struct igi_region {
    char *name;            /* the mesh's material */
    bool emitter;          /* emits and reflects nothing */
    igi_tristate textured; /* IGI_AUTO: as the photographs show it */
    bool has_uvs;          /* every triangle of it has texture coordinates, most of its area more
                              than a line or a point of them */
    bool uvs_wrap;         /* its texture coordinates leave [0,1]: textures repeat */
} igi_region;

typedef enum igi_light_type {
    IGI_LIGHT_AREA,        /* value: mean radiance, W m^-2 sr^-1, front side only */
    IGI_LIGHT_POINT,       /* value: intensity, W sr^-1 */
    IGI_LIGHT_SPOT,        /* value: intensity within the beam, W sr^-1 */
    IGI_LIGHT_LINE,        /* value: intensity per length, W sr^-1 m^-1 */
    IGI_LIGHT_GONIOMETRIC, /* value: scale of the profile */
    IGI_LIGHT_DIRECTIONAL, /* value: irradiance on a surface that faces it, W m^-2 */
    IGI_LIGHT_ENV,         /* value: scale of the image, 1 by default */
    IGI_LIGHT_AMBIENT      /* value: radiance, W m^-2 sr^-1 */
} igi_light_type;

/* A sky reckoned, not photographed: Preetham's for the clear part, CIE's for the overcast one. */
typedef struct igi_sky {
    bool given;
    double sun_elevation_deg,
        sun_azimuth_deg; /* above the horizon; from north (+Y) over east (+X) */
    double turbidity;    /* 1.7..10: haze */
    double cloudiness;   /* 0 clear .. 1 overcast */
} igi_sky;

typedef struct igi_light {
    igi_light_type type;
    int region;         /* area: index of the emitter region; else -1 */
    double profile;     /* area: n of its radiance, value (n + 2)/2 cos^n; 0: alike everywhere */
    double position[3]; /* point, spot, goniometric; line: its one end */
    double end[3];      /* line: its other end */
    double
        position_std[3]; /* of position (line: of it as a whole), metres; 0: it is exact. A manifest
                               states one number, and recovery finds its own */
    double direction[3]; /* spot, directional: unit, in which the light travels */
    double cutoff_deg,
        beam_deg;        /* spot: half angles; full inside beam, linear in angle to 0 at cutoff */
    double rotation_deg; /* env: about +Z */
    igi_sky sky;         /* env: in place of an image */
    char *file;          /* goniometric: profile; env: image; absolute or relative to the process */
    bool known;          /* value was given */
    double value[IGI_MAX_BANDS];
} igi_light;

/* A pinhole with OpenCV's distortion (k1 k2 p1 p2 k3). Pixel (0,0) covers [0,1)x[0,1): its centre
 * is (.5,.5). camera_to_world has OpenGL axes: +X right, +Y up, looks along -Z. */
typedef struct igi_camera {
    int width, height;
    double fl_x, fl_y, cx, cy; /* pixels */
    double k1, k2, k3, p1, p2;
    double camera_to_world[3][4]; /* rotation columns, then the centre in metres */
} igi_camera;

typedef struct igi_frame {
    char *name; /* as the cameras' file names the image, without folder and ending */
    char *path; /* of the image; names nothing when the image is merged from exposures */
    igi_camera camera;
    const igi_camera *taken; /* the image's own, where `camera` has fewer pixels: the image is
                              * averaged down to those; NULL: they are one */
    size_t exposure_count;   /* 0: the image is there, at `path` */
    igi_exposure *exposures;
} igi_frame;

typedef struct igi_scene {
    char *name;
    char *folder;
    int bands; /* 1..IGI_MAX_BANDS, that of the photographs and the lights */
    igi_mesh mesh;
    size_t region_count;
    igi_region *regions;
    size_t light_count;
    igi_light *lights;
    size_t frame_count;
    igi_frame *frames;
    char *calibration;                    /* file of what the camera did to the images; or NULL */
    igi_response_kind exposures_response; /* of the exposures, where the calibration has none */
    size_t file_count; /* paths of what was read besides the photographs: manifest, mesh, cameras
                        * (a folder, of COLMAP's) */
    char **files;
    size_t warning_count; /* sentences about what was odd but usable in the input */
    char **warnings;
} igi_scene;

/* Reads and checks the folder of scene.json (or that file itself). Everything that can be known
 * before the long work is checked here: keys, types, sizes; that images exist and have their
 * camera's size and one number of bands; that meshes have area; that lights name regions. */
IGI_API IGI_MUST_USE igi_status igi_scene_load(igi_context *context, const char *path,
                                               igi_scene **scene);
IGI_API void igi_scene_destroy(igi_scene *scene);

/* Reads a cameras' file alone (transforms.json, or a COLMAP folder). Images need not exist.
 * *frames is the caller's, to be freed with igi_frames_destroy. */
IGI_API IGI_MUST_USE igi_status igi_frames_load(igi_context *context, const char *path,
                                                igi_frame **frames, size_t *count);
/* Writes cameras as a transforms.json that igi_frames_load reads, each with its own intrinsics. The
 * images are named relative to the file where they lie below its folder. */
IGI_API IGI_MUST_USE igi_status igi_frames_save(igi_context *context, const igi_frame *frames,
                                                size_t count, const char *path);
IGI_API void igi_frames_destroy(igi_frame *frames, size_t count);

/* Reads a file { "lights": [...] } as under relit/: the lights that are on. Regions are looked up
 * in `scene`. *lights is the caller's, to be freed with igi_lights_destroy. */
IGI_API IGI_MUST_USE igi_status igi_lights_load(igi_context *context, const igi_scene *scene,
                                                const char *path, igi_light **lights,
                                                size_t *count);
IGI_API void igi_lights_destroy(igi_light *lights, size_t count);

#ifdef __cplusplus
}
#endif
#endif
