/* SPDX-License-Identifier: Apache-2.0
 *
 * What COLMAP's text and binary records share; for colmap*.c.
 */
#ifndef IGI_SRC_SCENE_COLMAP_PRIVATE_H
#define IGI_SRC_SCENE_COLMAP_PRIVATE_H

#include "scene/frame.h"

#define IGI_COLMAP_MAX_PARAMETERS 16

typedef struct igi_colmap_camera {
    uint64_t id;
    igi_camera camera; /* intrinsics */
} igi_colmap_camera;

typedef struct igi_colmap {
    igi_context *ctx;
    const char *folder; /* of the model */
    char *file;         /* the one that is read */
    igi_text text;
    const char *at, *end;
    unsigned line; /* 0 in binary files */
    igi_colmap_camera *cameras;
    size_t camera_count, camera_capacity;
    igi_frame *frames;
    size_t frame_count, frame_capacity;
    const char *images; /* where, from the folder, the last image that was found lies, or NULL */
} igi_colmap;

#define IGI_COLMAP_NO_MODEL SIZE_MAX
/* The camera model of that name (`length` bytes), or that number where `name` is NULL. */
size_t igi_colmap_find_model(const char *name, size_t length, uint64_t number);
size_t igi_colmap_parameter_count(size_t model);

/* IGI_E_DATA with the file and the line or byte. */
igi_status igi_colmap_fail(const igi_colmap *r, const char *what);

IGI_MUST_USE igi_status igi_colmap_add_camera(igi_colmap *r, igi_colmap_camera **camera);
IGI_MUST_USE igi_status igi_colmap_set_camera(const igi_colmap *r, igi_colmap_camera *c,
                                              size_t model, const double *values);
/* By number, which igi_colmap_add_frame asks for. */
void igi_colmap_sort_cameras(igi_colmap *r);
/* pose: the quaternion w x y z, then the translation. */
IGI_MUST_USE igi_status igi_colmap_add_frame(igi_colmap *r, const double pose[7], uint64_t camera,
                                             const char *name);

/* Read the whole of r->text: cameras, or images. */
IGI_MUST_USE igi_status igi_colmap_read_text(igi_colmap *r, bool images);
IGI_MUST_USE igi_status igi_colmap_read_binary(igi_colmap *r, bool images);

#endif
