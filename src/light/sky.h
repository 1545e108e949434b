/* SPDX-License-Identifier: Apache-2.0
 *
 * Light by direction: environment maps around the scene, goniometric profiles around a lamp.
 */
#ifndef IGI_SRC_LIGHT_SKY_H
#define IGI_SRC_LIGHT_SKY_H

#include "base/context.h"
#include "base/vec.h"

#include <igi/scene.h>

/* A latitude-longitude map, +Z up: the middle column is +X, the columns to the left of it turn to
 * +Y (Blender's way); turned by the light's rotation, counter-clockwise from above. Constant within
 * a pixel, so that its samples are exact. */
typedef struct sky sky;

/* The map must have `bands` bands, or one. */
IGI_MUST_USE igi_status sky_load(igi_context *ctx, const char *path, int bands, double rotation_deg,
                                 sky **result);
/* The map of the light's image, or of the sky that it describes. */
IGI_MUST_USE igi_status sky_of_light(igi_context *ctx, const igi_light *light, int bands,
                                     sky **result);
/* A dark one, whose radiance[height][width][bands] is to be filled in, then finished. */
IGI_MUST_USE igi_status sky_create(igi_context *ctx, int width, int height, int bands,
                                   sky **result);
float *sky_pixels(sky *s);
void sky_finish(sky *s, double rotation_deg);
void sky_destroy(sky *s);
/* [bands] of radiance. */
const float *sky_radiance(const sky *s, igi_vec direction);
/* A direction in proportion to the bands' mean, with its density per solid angle. */
igi_vec sky_sample(const sky *s, float u, float v, float *pdf);
float sky_pdf(const sky *s, igi_vec direction);

/* An IES LM-63 file with photometry of type C, or EULUMDAT (NAME.ldt): 0 degrees is straight down,
 * horizontal 0 is +X. */
typedef struct profile profile;

IGI_MUST_USE igi_status profile_load(igi_context *ctx, const char *path, profile **result);
void profile_destroy(profile *p);
/* Intensity in that direction, candela as in the file. */
float profile_intensity(const profile *p, igi_vec direction);

#endif
