/* SPDX-License-Identifier: Apache-2.0
 *
 * The pinhole with OpenCV's distortion,
 *     r^2 = a^2 + b^2,  d = 1 + k1 r^2 + k2 r^4 + k3 r^6,
 *     a' = a d + 2 p1 a b + p2 (r^2 + 2 a^2),   b' = b d + p1 (r^2 + 2 b^2) + 2 p2 a b,
 *     x = fl_x a' + cx,  y = fl_y b' + cy,
 * for a point (a, b, 1) in OpenCV's axes (x right, y down, z forward). Undone by fixed-point
 * iteration, which converges for the distortions of real lenses inside the image.
 */
#include "scene/camera.h"

igi_vec igi_camera_centre(const igi_camera *camera)
{
    return igi_v((float)camera->camera_to_world[0][3], (float)camera->camera_to_world[1][3],
                 (float)camera->camera_to_world[2][3]);
}

static bool is_distorted(const igi_camera *c)
{
    return c->k1 != 0 || c->k2 != 0 || c->k3 != 0 || c->p1 != 0 || c->p2 != 0;
}

static void distortion(const igi_camera *c, const double p[2], double *radial, double shift[2])
{
    double a = p[0], b = p[1], r2 = a * a + b * b;
    *radial = 1 + r2 * (c->k1 + r2 * (c->k2 + r2 * c->k3));
    shift[0] = 2 * c->p1 * a * b + c->p2 * (r2 + 2 * a * a);
    shift[1] = c->p1 * (r2 + 2 * b * b) + 2 * c->p2 * a * b;
}

static void undistort(const igi_camera *c, double p[2])
{
    const double seen[2] = {p[0], p[1]};
    for (int i = 0; i < 50; i++) {
        double radial, shift[2], before[2] = {p[0], p[1]};
        distortion(c, p, &radial, shift);
        for (int k = 0; k < 2; k++) p[k] = (seen[k] - shift[k]) / radial;
        if (fabs(p[0] - before[0]) + fabs(p[1] - before[1]) < 1e-10) return;
    }
}

igi_vec igi_camera_direction(const igi_camera *camera, double x, double y)
{
    double p[2] = {(x - camera->cx) / camera->fl_x, (y - camera->cy) / camera->fl_y};
    if (is_distorted(camera)) undistort(camera, p);
    const double local[3] = {p[0], -p[1], -1}; /* OpenGL axes: y up, looks along -z */
    double scale = 1 / sqrt(p[0] * p[0] + p[1] * p[1] + 1), world[3];
    for (int i = 0; i < 3; i++) {
        world[i] = 0;
        for (int k = 0; k < 3; k++) world[i] += camera->camera_to_world[i][k] * local[k] * scale;
    }
    return igi_v_ofd(world);
}

bool igi_camera_project(const igi_camera *camera, igi_vec point, double *x, double *y)
{
    const double world[3] = {(double)point.x, (double)point.y, (double)point.z};
    double local[3] = {0, 0, 0};
    for (int k = 0; k < 3; k++)
        for (int i = 0; i < 3; i++)
            local[k] += camera->camera_to_world[i][k] * (world[i] - camera->camera_to_world[i][3]);
    if (local[2] >= -1e-9) return false;
    double p[2] = {local[0] / -local[2], -local[1] / -local[2]}, radial, shift[2];
    distortion(camera, p, &radial, shift);
    *x = camera->fl_x * (p[0] * radial + shift[0]) + camera->cx;
    *y = camera->fl_y * (p[1] * radial + shift[1]) + camera->cy;
    return true;
}
