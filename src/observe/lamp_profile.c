/* SPDX-License-Identifier: Apache-2.0 */
#include "observe/lamp_profile.h"

#include "scene/camera.h"
#include "scene/light_profile.h"

#define DIM 0.1 /* of what it shows head-on */

double igi_lamp_profile_seen(const igi_scene *scene, const igi_light *light,
                             const igi_camera *camera, uint32_t triangle, float u, float v)
{
    if (!(light->profile > 0)) return 1;
    igi_vec point = igi_triangle_point(&scene->mesh, triangle, u, v);
    igi_vec toward = igi_normalize(igi_sub(igi_camera_centre(camera), point));
    float cosine = fabsf(igi_dot(toward, igi_triangle_normal(&scene->mesh, triangle)));
    return (double)igi_light_profile(light, cosine);
}

double igi_observation_profile(const igi_scene *scene, const igi_observations *o, size_t i)
{
    uint32_t triangle = igi_surface_triangle(o->surface[i]);
    uint32_t region = scene->mesh.regions[triangle];
    if (!scene->regions[region].emitter || igi_surface_is_back(o->surface[i])) return 1;
    for (size_t l = 0; l < scene->light_count; l++) {
        const igi_light *light = &scene->lights[l];
        if (light->region != (int)region || !(light->profile > 0)) continue;
        const igi_camera *camera = &scene->frames[igi_observation_frame(o, i)].camera;
        double profile = igi_lamp_profile_seen(scene, light, camera, triangle, o->uv[2 * i],
                                               o->uv[2 * i + 1]);
        return igi_lamp_is_dim(light, profile) ? 0 : profile;
    }
    return 1;
}

bool igi_lamp_is_dim(const igi_light *light, double profile)
{
    return profile < DIM * (double)igi_light_profile(light, 1);
}
