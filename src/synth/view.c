/* SPDX-License-Identifier: Apache-2.0
 *
 * One camera: where it looks, and what it sees.
 */
#include "synth/synth.h"

#include "scene/camera.h"

#include <math.h>

igi_camera view_camera(const view_set *views, igi_vec eye, igi_vec target)
{
    igi_vec back = igi_normalize(igi_sub(eye, target));
    igi_vec up = fabsf(back.z) > 0.999f ? igi_v(0, 1, 0) : igi_v(0, 0, 1);
    igi_vec right = igi_normalize(igi_cross(up, back));
    up = igi_cross(back, right);
    double focal = views->width / (2 * tan(views->fov_deg * IGI_PI / 360));
    igi_camera c = {.width = views->width,
                    .height = views->height,
                    .fl_x = focal,
                    .fl_y = focal,
                    .cx = views->width / 2.0,
                    .cy = views->height / 2.0};
    const igi_vec columns[4] = {right, up, back, eye};
    for (int k = 0; k < 4; k++) {
        c.camera_to_world[0][k] = (double)columns[k].x;
        c.camera_to_world[1][k] = (double)columns[k].y;
        c.camera_to_world[2][k] = (double)columns[k].z;
    }
    return c;
}

bool view_sees(const igi_camera *camera, const igi_tracer *tracer, igi_vec point)
{
    double x, y;
    if (!igi_camera_project(camera, point, &x, &y)) return false;
    if (!(x >= 0 && y >= 0 && x < camera->width && y < camera->height)) return false;
    return !igi_occluded(tracer, igi_camera_centre(camera), point);
}
