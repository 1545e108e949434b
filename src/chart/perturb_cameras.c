/* SPDX-License-Identifier: Apache-2.0
 *
 * Cameras that stand, look or magnify otherwise than stated, and cameras that are not there.
 */
#include "chart/sweep.h"

/* A direction in the image, for all frames or for each. */
static void shift_centre(igi_camera *camera, double severity, double turn)
{
    camera->cx += severity * cos(turn);
    camera->cy += severity * sin(turn);
}

static igi_status principal_point(igi_context *ctx, const chart_change *c, double severity,
                                  chart_subject *s)
{
    (void)ctx;
    igi_rng rng = chart_stream(s, c->kind->name);
    double turn = 2 * IGI_PI * (double)igi_rng_float(&rng);
    for (size_t f = 0; f < s->scene->frame_count; f++)
        shift_centre(&s->scene->frames[f].camera, severity, turn);
    return IGI_OK;
}

/* v turned about the unit axis by `angle` (Rodrigues). */
static igi_vec turned(igi_vec v, igi_vec axis, double angle)
{
    float c = (float)cos(angle), n = (float)sin(angle);
    igi_vec r = igi_madd(igi_scale(v, c), igi_cross(axis, v), n);
    return igi_madd(r, axis, igi_dot(axis, v) * (1 - c));
}

static void turn_camera(igi_camera *camera, igi_vec axis, double angle)
{
    double(*m)[4] = camera->camera_to_world;
    for (int k = 0; k < 3; k++) {
        igi_vec column = igi_v((float)m[0][k], (float)m[1][k], (float)m[2][k]);
        column = turned(column, axis, angle);
        m[0][k] = (double)column.x;
        m[1][k] = (double)column.y;
        m[2][k] = (double)column.z;
    }
}

/* Each camera turned so that the middle of its picture is off by `severity` pixels in a direction
 * of its own. */
static igi_status pose(igi_context *ctx, const chart_change *c, double severity, chart_subject *s)
{
    (void)ctx;
    igi_rng rng = chart_stream(s, c->kind->name);
    for (size_t f = 0; f < s->scene->frame_count; f++) {
        igi_camera *camera = &s->scene->frames[f].camera;
        double turn = 2 * IGI_PI * (double)igi_rng_float(&rng);
        double right = cos(turn), up = sin(turn), (*m)[4] = camera->camera_to_world;
        igi_vec axis = igi_normalize(igi_v((float)(right * m[0][0] + up * m[0][1]),
                                           (float)(right * m[1][0] + up * m[1][1]),
                                           (float)(right * m[2][0] + up * m[2][1])));
        turn_camera(camera, axis, atan(severity / camera->fl_x));
    }
    return IGI_OK;
}

/* Each camera's place off by `severity` metres. */
static igi_status place(igi_context *ctx, const chart_change *c, double severity, chart_subject *s)
{
    (void)ctx;
    igi_rng rng = chart_stream(s, c->kind->name);
    for (size_t f = 0; f < s->scene->frame_count; f++) {
        double d[3], length = 0;
        for (int k = 0; k < 3; k++) {
            d[k] = chart_normal(&rng);
            length += d[k] * d[k];
        }
        for (int k = 0; k < 3; k++)
            s->scene->frames[f].camera.camera_to_world[k][3] += severity * d[k] / sqrt(length);
    }
    return IGI_OK;
}

/* The focal length stated too long by the share `severity`. */
static igi_status focal(igi_context *ctx, const chart_change *c, double severity, chart_subject *s)
{
    (void)ctx;
    (void)c;
    for (size_t f = 0; f < s->scene->frame_count; f++) {
        s->scene->frames[f].camera.fl_x *= 1 + severity;
        s->scene->frames[f].camera.fl_y *= 1 + severity;
    }
    return IGI_OK;
}

/* The first `severity` views alone: where views were chosen to show the most, those do. */
static igi_status keep_views(igi_context *ctx, const chart_change *c, double severity,
                             chart_subject *s)
{
    (void)ctx;
    (void)c;
    size_t keep = (size_t)(severity + .5);
    if (keep < 1 || keep > s->scene->frame_count) return IGI_E_NO_ANSWER;
    for (size_t f = keep; f < s->scene->frame_count; f++) {
        igi_free(s->scene->frames[f].name);
        igi_free(s->scene->frames[f].path);
    }
    s->scene->frame_count = keep;
    return IGI_OK;
}

const chart_perturbation chart_perturb_cameras[] = {{"principal-point", false, principal_point},
                                                    {"pose", false, pose},
                                                    {"place", false, place},
                                                    {"focal-length", false, focal},
                                                    {"views", false, keep_views},
                                                    {NULL, false, NULL}};
