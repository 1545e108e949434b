/* SPDX-License-Identifier: Apache-2.0
 *
 * Changes of cameras: one turned and moved, all by one similarity, all by the lens that they share.
 */
#include "base/context.h"
#include "register/register_private.h"
#include "scene/camera.h"

#include <math.h>
#include <string.h>

static void multiply(double a[3][3], double b[3][3], double out[3][3])
{
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) {
            out[i][j] = 0;
            for (int k = 0; k < 3; k++) out[i][j] += a[i][k] * b[k][j];
        }
}

/* Of a rotation vector (Rodrigues). */
static void rotation_of(const double w[3], double r[3][3])
{
    double angle = sqrt(w[0] * w[0] + w[1] * w[1] + w[2] * w[2]);
    double s = angle > 1e-12 ? sin(angle) / angle : 1;
    double c = angle > 1e-12 ? (1 - cos(angle)) / (angle * angle) : .5;
    double k[3][3] = {{0, -w[2], w[1]}, {w[2], 0, -w[0]}, {-w[1], w[0], 0}};
    double k2[3][3];
    multiply(k, k, k2);
    for (int i = 0; i < 3; i++)
        for (int j = 0; j < 3; j++) r[i][j] = (i == j) + s * k[i][j] + c * k2[i][j];
}

void pose_change(const igi_camera *camera, const pose_units *units, const double change[6],
                 igi_camera *changed)
{
    double turn[3], r[3][3], old[3][3], now[3][3];
    *changed = *camera;
    for (int i = 0; i < 3; i++) {
        turn[i] = change[i] * units->turn_rad;
        memcpy(old[i], camera->camera_to_world[i], sizeof old[i]);
    }
    rotation_of(turn, r);
    multiply(old, r, now);
    for (int i = 0; i < 3; i++) {
        memcpy(changed->camera_to_world[i], now[i], sizeof now[i]);
        for (int k = 0; k < 3; k++)
            changed->camera_to_world[i][3] += old[i][k] * change[3 + k] * units->move_m;
    }
}

void similarity_of(const shared_units *units, const double change[7], igi_similarity *s)
{
    const double pivot[3] = {(double)units->pivot.x, (double)units->pivot.y,
                             (double)units->pivot.z};
    double turn[3];
    for (int i = 0; i < 3; i++) turn[i] = change[i] * units->pose.turn_rad;
    rotation_of(turn, s->rotation);
    s->scale = exp(change[6] * units->pose.turn_rad);
    for (int i = 0; i < 3; i++) {
        s->offset[i] = pivot[i] + change[3 + i] * units->pose.move_m;
        for (int k = 0; k < 3; k++) s->offset[i] -= s->scale * s->rotation[i][k] * pivot[k];
    }
}

void similarity_move(const igi_similarity *s, igi_camera *camera)
{
    double old[3][4];
    memcpy(old, camera->camera_to_world, sizeof old);
    for (int i = 0; i < 3; i++) {
        for (int j = 0; j < 4; j++) {
            double sum = 0;
            for (int k = 0; k < 3; k++) sum += s->rotation[i][k] * old[k][j];
            camera->camera_to_world[i][j] = j < 3 ? sum : s->scale * sum + s->offset[i];
        }
    }
}

void igi_scene_move_cameras(igi_scene *scene, const igi_similarity *similarity)
{
    for (size_t i = 0; i < scene->frame_count; i++)
        similarity_move(similarity, &scene->frames[i].camera);
}

void similarity_compose(const igi_similarity *then, igi_similarity *s)
{
    igi_similarity first = *s;
    s->scale = then->scale * first.scale;
    for (int i = 0; i < 3; i++) {
        s->offset[i] = then->offset[i];
        for (int j = 0; j < 3; j++) {
            s->rotation[i][j] = 0;
            s->offset[i] += then->scale * then->rotation[i][j] * first.offset[j];
            for (int k = 0; k < 3; k++)
                s->rotation[i][j] += then->rotation[i][k] * first.rotation[k][j];
        }
    }
}

void lens_change(const double change[3], igi_camera *camera)
{
    double larger = 1 + change[2] / hypot(camera->width / 2.0, camera->height / 2.0);
    camera->cx += change[0];
    camera->cy += change[1];
    camera->fl_x *= larger;
    camera->fl_y *= larger;
}

double pose_distance(const igi_edge_site *site, const igi_camera *camera)
{
    double x, y;
    if (!igi_camera_project(camera, site->point, &x, &y)) return (double)NAN;
    return site->normal[0] * (site->seen[0] - x) + site->normal[1] * (site->seen[1] - y);
}

bool pose_units_of(const igi_edge_sites *sites, const igi_camera *camera, pose_units *units)
{
    double depth = 0;
    igi_vec centre = igi_camera_centre(camera);
    for (size_t i = 0; i < sites->count; i++)
        depth += (double)igi_length(igi_sub(sites->sites[i].point, centre));
    units->turn_rad = 1 / camera->fl_x;
    units->move_m = depth / (double)sites->count / camera->fl_x;
    return sites->count >= POSE_FEWEST_SITES;
}
