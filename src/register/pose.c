/* SPDX-License-Identifier: Apache-2.0
 *
 * Cameras moved until the edges come together: for each site the distance, across the edge, of
 * where the photograph shows it from where the camera projects it. Six numbers a camera, or for all
 * cameras at once seven (a similarity) or three (their lens), by robust least squares; what is far off
 * after a first fit (a shadow taken for an edge) has no say in the second.
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
/* In standard deviations: where the loss turns linear, and what is left out. */
#define LOSS 2.0
#define OUTLIER 3.5

typedef struct problem {
    const igi_camera *cameras;   /* [frame_count] where they are */
    const igi_edge_sites *sites; /* [frame_count] */
    size_t *begin;               /* [frame_count + 1] blocks */
    size_t frame_count;
    bool *dropped; /* [blocks] */
    shared_units units;
    double expected_px; /* of each number that tells where a camera is, before edges tell */
    double as_one;      /* so many sites are one */
    pose_kind kind;
} problem;

static size_t numbers_of(pose_kind kind)
{
    return kind == POSE_OF_ONE ? 6 : kind == POSE_OF_ALL ? 7 : 3;
}

static void changed_camera(const problem *p, size_t frame, const double *change, igi_camera *camera)
{
    igi_similarity s;
    *camera = p->cameras[frame];
    if (p->kind == POSE_OF_ONE) pose_change(&p->cameras[frame], &p->units.pose, change, camera);
    if (p->kind == POSE_OF_LENS) lens_change(change, camera);
    if (p->kind != POSE_OF_ALL) return;
    similarity_of(&p->units, change, &s);
    similarity_move(&s, camera);
}

static double weight_of(const igi_edge_site *site)
{
    return 1 / hypot(site->sigma, IGI_SITE_ERROR);
}

/* Blocks are sites; behind them one prior a parameter. */
static bool residuals(void *user, size_t block, const double *x, double *r, double *jacobian)
{
    const problem *p = user;
    size_t count = numbers_of(p->kind), sites = p->begin[p->frame_count], frame = 0;
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
    size_t parameters = numbers_of(p->kind);
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
    if (count < POSE_FEWEST_SITES)
        return igi_fail(ctx, IGI_E_NO_ANSWER, "%zu edges are too few to place a camera by", count);
    p->units.pose.turn_rad = 1 / p->cameras[0].fl_x;
    p->units.pose.move_m = depth / (double)count / p->cameras[0].fl_x;
    p->units.pivot = igi_scale(sum, 1 / (float)count);
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
    pose_change(camera, &p.units.pose, change, &changed);
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

/* Of squared distances after a change, those of outliers cut. */
static double misfit(const problem *p, const double *change, double unit)
{
    double sum = 0;
    for (size_t f = 0; f < p->frame_count; f++) {
        igi_camera camera;
        changed_camera(p, f, change, &camera);
        for (size_t i = 0; i < p->sites[f].count; i++) {
            const igi_edge_site *site = &p->sites[f].sites[i];
            double d = fabs(pose_distance(site, &camera)) * weight_of(site) / unit;
            sum += isfinite(d) ? fmin(d * d, OUTLIER * OUTLIER) : OUTLIER * OUTLIER;
        }
    }
    return sum / p->as_one;
}

igi_status pose_gain(igi_context *ctx, const igi_edge_sites *sites, const igi_camera *before,
                     const igi_camera *after, double *gain, double *spread)
{
    const double none[7] = {0};
    problem p = {.cameras = after, .sites = sites, .frame_count = 1};
    *gain = 0;
    igi_status status = prepare(ctx, &p);
    if (status == IGI_OK) status = spread_of(ctx, &p, none, true, spread);
    if (status == IGI_OK) {
        double unit = fmax(1, *spread), there = misfit(&p, none, unit);
        p.cameras = before;
        *gain = misfit(&p, none, unit) - there;
    }
    clear(&p);
    return status;
}

/* Bayes' information criterion: what is left, and what the numbers cost. */
static double criterion_of(const problem *p, const double *change)
{
    double count = (double)p->begin[p->frame_count] / p->as_one;
    return misfit(p, change, 1) + (double)numbers_of(p->kind) * log(fmax(count, 1));
}

igi_status pose_criterion_each(igi_context *ctx, const igi_edge_sites *sites,
                               const igi_scene *scene, double *criterion)
{
    *criterion = 0;
    for (size_t f = 0; f < scene->frame_count; f++) {
        double change[7] = {0};
        problem p = {.cameras = &scene->frames[f].camera,
                     .sites = &sites[f],
                     .frame_count = 1,
                     .expected_px = TOGETHER_PX};
        igi_status status = prepare(ctx, &p);
        if (status == IGI_OK) status = solve(ctx, &p, change, NULL);
        if (status == IGI_OK) *criterion += criterion_of(&p, change);
        clear(&p);
        if (status != IGI_OK && status != IGI_E_NO_ANSWER) return status;
    }
    return IGI_OK;
}

igi_status pose_refine_shared(igi_context *ctx, const igi_edge_sites *sites, const igi_scene *scene,
                              pose_kind kind, pose_shared *shared)
{
    igi_status status = IGI_OK;
    igi_camera *cameras = NULL;
    problem p = {.sites = sites,
                 .frame_count = scene->frame_count,
                 .expected_px = TOGETHER_PX,
                 .kind = kind};
    *shared = (pose_shared){.kind = kind};
    IGI_TRY_GOTO(IGI_ALLOC(ctx, scene->frame_count, &cameras));
    for (size_t i = 0; i < scene->frame_count; i++) cameras[i] = scene->frames[i].camera;
    p.cameras = cameras;
    IGI_TRY_GOTO(prepare(ctx, &p));
    IGI_TRY_GOTO(solve(ctx, &p, shared->change, NULL));
    shared->criterion = criterion_of(&p, shared->change);
    if (kind == POSE_OF_ALL) similarity_of(&p.units, shared->change, &shared->similarity);
cleanup:
    clear(&p);
    igi_free(cameras);
    return status;
}
