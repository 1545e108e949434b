/* SPDX-License-Identifier: Apache-2.0
 *
 * What a pixel says of a lamp that does not shine alike in all directions.
 */
#ifndef IGI_SRC_OBSERVE_LAMP_PROFILE_H
#define IGI_SRC_OBSERVE_LAMP_PROFILE_H

#include "observe/observations.h"

/* How many times its light's value a pixel shows: the profile toward its camera; 1 of what is no lamp or has
 * none; 0 where the lamp is so dim from there that the pixel says nothing. */
double igi_observation_profile(const igi_scene *scene, const igi_observations *observations,
                               size_t observation);
/* The profile toward the camera at a point of a triangle of the lamp. */
double igi_lamp_profile_seen(const igi_scene *scene, const igi_light *light,
                             const igi_camera *camera, uint32_t triangle, float u, float v);
/* Too dim from there to say much of the lamp. */
bool igi_lamp_is_dim(const igi_light *light, double profile);

#endif
