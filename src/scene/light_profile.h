/* SPDX-License-Identifier: Apache-2.0
 *
 * How a lamp of the mesh shines by direction: with cos^n of the angle from its normal. A light's value
 * is the mean radiance, that is exitance / pi, whatever the profile:
 *     L(theta) = value (n + 2)/2 cos^n(theta),   pi value = integral of L cos over the front's directions.
 */
#ifndef IGI_SRC_SCENE_LIGHT_PROFILE_H
#define IGI_SRC_SCENE_LIGHT_PROFILE_H

#include <igi/scene.h>

#include <math.h>

#define IGI_MOST_PROFILE 100 /* half as bright at 7 degrees */

/* Radiance over the light's value toward a direction at this cosine from the normal of a lamp's front. */
static inline float igi_light_profile(const igi_light *light, float cosine)
{
    float n = (float)light->profile;
    if (!(n > 0)) return 1;
    return 0.5f * (n + 2) * powf(cosine, n);
}

#endif
