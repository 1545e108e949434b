/* SPDX-License-Identifier: Apache-2.0
 *
 * Cameras moved until the edges come together: for each site the distance, across the edge, of
 * where the photograph shows it from where the camera projects it. Six numbers a camera, or seven
 * for all cameras at once (a similarity), by robust least squares; what is far off after a first
 * fit (a shadow taken for an edge) has no say in the second.
 */
#include "base/context.h"
#include "base/order.h"
#include "bridge/least_squares.h"
#include "register/register_private.h"
#include "scene/camera.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* What one similarity of all cameras is expected to move the picture by, pixels. */
#define TOGETHER_PX 2.0
/* Fewer sites leave a camera where it was. */
#define FEWEST_SITES 12
/* In standard deviations: where the loss turns linear, and what is left out. */
#define LOSS 2.0
#define OUTLIER 3.5

typedef struct problem {
    const igi_camera *cameras;   /* [frame_count] where they are */
    const igi_edge_sites *sites; /* [frame_count] */
    size_t *begin;               /* [frame_count + 1] blocks */
    size_t frame_count;
    bool *dropped;      /* [blocks] */
    pose_units units;   /* of one camera */
    double expected_px; /* of each number that tells where a camera is, before edges tell */
    double as_one;      /* so many sites are one */
    bool together;      /* one similarity about `pivot`, in units of the first camera's */
    igi_vec pivot;
} problem;

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

/* The similarity of seven changes: turn, move, and the logarithm of the scale, about the pivot. */
static void similarity_of(const problem *p, const double change[7], igi_similarity *s)
{
    const double pivot[3] = {(double)p->pivot.x, (double)p->pivot.y, (double)p->pivot.z};
    double turn[3];
    for (int i = 0; i < 3; i++) turn[i] = change[i] * p->units.turn_rad;
    rotation_of(turn, s->rotation);
    s->scale = exp(change[6] * p->units.turn_rad);
    for (int i = 0; i < 3; i++) {
        s->offset[i] = pivot[i] + change[3 + i] * p->units.move_m;
        for (int k = 0; k < 3; k++) s->offset[i] -= s->scale * s->rotation[i][k] * pivot[k];
    }
}

static void move_camera(igi_camera *camera, const igi_similarity *s)
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
        move_camera(&scene->frames[i].camera, similarity);
}

static void changed_camera(const problem *p, size_t frame, const double *change, igi_camera *camera)
{
    igi_similarity s;
    if (!p->together) {
        pose_change(&p->cameras[frame], &p->units, change, camera);
        return;
    }
    similarity_of(p, change, &s);
    *camera = p->cameras[frame];
    move_camera(camera, &s);
}

double pose_distance(const igi_edge_site *site, const igi_camera *camera)
{
    double x, y;
    if (!igi_camera_project(camera, site->point, &x, &y)) return (double)NAN;
    return site->normal[0] * (site->seen[0] - x) + site->normal[1] * (site->seen[1] - y);
}

static double weight_of(const igi_edge_site *site)
{
    return 1 / hypot(site->sigma, IGI_SITE_ERROR);
}

/* Blocks are sites; behind them one prior a parameter. */
static bool residuals(void *user, size_t block, const double *x, double *r, double *jacobian)
{
    const problem *p = user;
    size_t count = p->together ? 7 : 6, sites = p->begin[p->frame_count], frame = 0;
    if (block >= sites) {
        size_t k = block - sites;
        double weight = sqrt(p->as_one) / p->expected_px;
        r[0] = x[k] * weight;
        for (size_t i = 0; jacobian && i < count; i++) jacobian[i] = i == k ? weight : 0;
        return true;
    }
    while (p->begin[frame + 1] <= block) frame++;
    const igi_edge_site *site = &p->sites[frame].sites[block - p->begin[frame]];
    double weight = p->dropped[block] ? 0 : weight_of(site);
    igi_camera camera;
    changed_camera(p, frame, x, &camera);
    r[0] = weight * pose_distance(site, &camera);
    for (size_t i = 0; jacobian && i < count; i++) {
        const double h = 1e-2; /* pixels: projection is smooth, and points are floats */
        double moved[7], ends[2];
        for (int side = 0; side < 2; side++) {
            memcpy(moved, x, count * sizeof *moved);
            moved[i] += side ? h : -h;
            changed_camera(p, frame, moved, &camera);
            ends[side] = pose_distance(site, &camera);
        }
        jacobian[i] = weight * (ends[1] - ends[0]) / (2 * h);
    }
    return isfinite(r[0]);
}

/* The robust standard deviation of distances times weights. */
static igi_status spread_of(igi_context *ctx, const problem *p, const double *change, bool weighted,
                            double *spread)
{
    size_t count = 0;
    double *all;
    *spread = 0;
    IGI_TRY(IGI_ALLOC(ctx, p->begin[p->frame_count], &all));
    for (size_t f = 0; f < p->frame_count; f++) {
        igi_camera camera;
        changed_camera(p, f, change, &camera);
        for (size_t i = 0; i < p->sites[f].count; i++) {
            double d = fabs(pose_distance(&p->sites[f].sites[i], &camera));
            if (weighted) d *= weight_of(&p->sites[f].sites[i]);
            if (isfinite(d)) all[count++] = d;
        }
    }
    if (count) *spread = 1.4826 * igi_median(all, count);
    igi_free(all);
    return IGI_OK;
}

static void drop_outliers(problem *p, const double *change, double spread)
{
    for (size_t f = 0; f < p->frame_count; f++) {
        igi_camera camera;
        changed_camera(p, f, change, &camera);
        for (size_t i = 0; i < p->sites[f].count; i++) {
            const igi_edge_site *site = &p->sites[f].sites[i];
            double d = fabs(pose_distance(site, &camera)) * weight_of(site);
            p->dropped[p->begin[f] + i] = !(d <= OUTLIER * fmax(1, spread));
        }
    }
}

static igi_status solve(igi_context *ctx, problem *p, double *change, double *covariance)
{
    double spread;
    igi_least_squares_result result;
    size_t parameters = p->together ? 7 : 6;
    igi_least_squares fit = {.parameter_count = parameters,
                             .block_count = p->begin[p->frame_count] + parameters,
                             .residuals = residuals,
                             .user = p,
                             .tolerance = 1e-6,
                             .max_iterations = 30};
    for (int round = 0; round < 2; round++) {
        IGI_TRY(spread_of(ctx, p, change, true, &spread));
        fit.loss_scale = LOSS * fmax(1, spread);
        if (round > 0) drop_outliers(p, change, spread);
        IGI_TRY(igi_least_squares_solve(ctx, &fit, change, covariance, &result));
    }
    return IGI_OK;
}

static igi_status prepare(igi_context *ctx, problem *p)
{
    IGI_TRY(IGI_ALLOC(ctx, p->frame_count + 1, &p->begin));
    double depth = 0;
    size_t count = 0;
    igi_vec sum = {0, 0, 0};
    for (size_t f = 0; f < p->frame_count; f++) {
        igi_vec centre = igi_camera_centre(&p->cameras[f]);
        p->begin[f + 1] = p->begin[f] + p->sites[f].count;
        for (size_t i = 0; i < p->sites[f].count; i++, count++) {
            depth += (double)igi_length(igi_sub(p->sites[f].sites[i].point, centre));
            sum = igi_add(sum, p->sites[f].sites[i].point);
        }
    }
    if (count < FEWEST_SITES)
        return igi_fail(ctx, IGI_E_NO_ANSWER, "%zu edges are too few to place a camera by", count);
    p->units.turn_rad = 1 / p->cameras[0].fl_x;
    p->units.move_m = depth / (double)count / p->cameras[0].fl_x;
    p->pivot = igi_scale(sum, 1 / (float)count);
    p->as_one = fmax(1, IGI_SITES_AS_ONE * p->cameras[0].height);
    return IGI_ALLOC(ctx, count, &p->dropped);
}

static void clear(problem *p)
{
    igi_free(p->begin);
    igi_free(p->dropped);
}

/* How far the camera's uncertainty moves the image at a typical site. */
static double image_sigma(problem *p, const double *change, const double *covariance)
{
    double sum = 0;
    size_t count = p->begin[1], used = 0;
    for (size_t i = 0; i < count; i++) {
        double r, j[6], variance = 0, w = weight_of(&p->sites[0].sites[i]);
        if (p->dropped[i] || !residuals(p, i, change, &r, j)) continue;
        for (int a = 0; a < 6; a++)
            for (int b = 0; b < 6; b++) variance += j[a] * j[b] * covariance[6 * a + b];
        sum += variance / (w * w);
        used++;
    }
    return used ? sqrt(p->as_one * fmax(0, sum / (double)used)) : (double)INFINITY;
}

igi_status pose_refine(igi_context *ctx, const igi_edge_sites *sites, double expected_px,
                       igi_camera *camera, double *sigma_px)
{
    igi_status status = IGI_OK;
    problem p = {.cameras = camera, .sites = sites, .frame_count = 1, .expected_px = expected_px};
    double change[7] = {0}, covariance[36];
    igi_camera changed;
    *sigma_px = (double)INFINITY;
    IGI_TRY_GOTO(prepare(ctx, &p));
    IGI_TRY_GOTO(solve(ctx, &p, change, covariance));
    *sigma_px = image_sigma(&p, change, covariance);
    pose_change(camera, &p.units, change, &changed);
    *camera = changed;
cleanup:
    clear(&p);
    return status;
}

igi_status pose_residual(igi_context *ctx, const igi_edge_sites *sites, const igi_camera *camera,
                         double *rms_px)
{
    const double none[7] = {0};
    problem p = {.cameras = camera, .sites = sites, .frame_count = 1};
    *rms_px = (double)NAN;
    igi_status status = prepare(ctx, &p);
    if (status == IGI_OK) status = spread_of(ctx, &p, none, false, rms_px);
    clear(&p);
    return status;
}

/* Of squared distances, those of outliers cut. */
static double misfit(const problem *p, const igi_camera *camera, double unit)
{
    double sum = 0;
    for (size_t i = 0; i < p->sites->count; i++) {
        double d = fabs(pose_distance(&p->sites->sites[i], camera)) *
                   weight_of(&p->sites->sites[i]);
        sum += isfinite(d) ? fmin(d * d, OUTLIER * OUTLIER * unit * unit)
                           : OUTLIER * OUTLIER * unit * unit;
    }
    return sum / (unit * unit * p->as_one);
}

igi_status pose_gain(igi_context *ctx, const igi_edge_sites *sites, const igi_camera *before,
                     const igi_camera *after, double *gain, double *spread)
{
    const double none[7] = {0};
    problem p = {.cameras = after, .sites = sites, .frame_count = 1};
    *gain = 0;
    igi_status status = prepare(ctx, &p);
    if (status == IGI_OK) status = spread_of(ctx, &p, none, true, spread);
    if (status == IGI_OK)
        *gain = misfit(&p, before, fmax(1, *spread)) - misfit(&p, after, fmax(1, *spread));
    clear(&p);
    return status;
}

bool pose_units_of(const igi_edge_sites *sites, const igi_camera *camera, pose_units *units)
{
    double depth = 0;
    igi_vec centre = igi_camera_centre(camera);
    for (size_t i = 0; i < sites->count; i++)
        depth += (double)igi_length(igi_sub(sites->sites[i].point, centre));
    units->turn_rad = 1 / camera->fl_x;
    units->move_m = depth / (double)sites->count / camera->fl_x;
    return sites->count >= FEWEST_SITES;
}

igi_status pose_refine_together(igi_context *ctx, const igi_edge_sites *sites, igi_scene *scene,
                                igi_similarity *similarity)
{
    igi_status status = IGI_OK;
    igi_camera *cameras = NULL;
    double change[7] = {0};
    problem p = {.sites = sites,
                 .frame_count = scene->frame_count,
                 .expected_px = TOGETHER_PX,
                 .together = true};
    IGI_TRY_GOTO(IGI_ALLOC(ctx, scene->frame_count, &cameras));
    for (size_t i = 0; i < scene->frame_count; i++) cameras[i] = scene->frames[i].camera;
    p.cameras = cameras;
    IGI_TRY_GOTO(prepare(ctx, &p));
    IGI_TRY_GOTO(solve(ctx, &p, change, NULL));
    similarity_of(&p, change, similarity);
    igi_scene_move_cameras(scene, similarity);
cleanup:
    clear(&p);
    igi_free(cameras);
    return status;
}
