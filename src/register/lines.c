/* SPDX-License-Identifier: Apache-2.0 */
#include "register/lines.h"

#include "base/solve.h"

#include <math.h>
#include <string.h>

#define HUBER 2.0
#define CUT 3.5
#define ROUNDS 4
#define STEP_PX 1e-2

static void add(const igi_edge_site *s, double d, const double ends[2 * MOTION_NUMBERS],
                double unit, edge_lines *f)
{
    edge_line *l = &f->lines[f->count];
    bool finite = isfinite(d);
    l->d = d;
    for (int k = 0; k < MOTION_NUMBERS; k++) {
        l->jacobian[k] = (ends[2 * k + 1] - ends[2 * k]) / (2 * STEP_PX);
        finite = finite && isfinite(l->jacobian[k]);
    }
    l->weight = 1 / (hypot(s->sigma, IGI_SITE_ERROR) * unit);
    l->region = s->region;
    f->count += finite;
}

/* Of both ends of the step of a number. */
static void step(int end, double change[MOTION_NUMBERS])
{
    memset(change, 0, MOTION_NUMBERS * sizeof *change);
    change[end / 2] = end & 1 ? STEP_PX : -STEP_PX;
}

bool lines_of_camera(const igi_edge_sites *sites, const igi_camera *camera, double unit,
                     edge_lines *f)
{
    igi_camera moved[2 * MOTION_NUMBERS];
    double change[MOTION_NUMBERS], ends[2 * MOTION_NUMBERS];
    pose_units units;
    if (!pose_units_of(sites, camera, &units)) return false;
    for (int k = 0; k < 2 * MOTION_NUMBERS; k++) {
        step(k, change);
        pose_change(camera, &units, change, &moved[k]);
    }
    for (size_t i = 0; i < sites->count; i++) {
        const igi_edge_site *s = &sites->sites[i];
        for (int k = 0; k < 2 * MOTION_NUMBERS; k++) ends[k] = pose_distance(s, &moved[k]);
        add(s, pose_distance(s, camera), ends, unit, f);
    }
    return f->count > 0;
}

static igi_vec move_point(igi_vec p, const thing_units *u, const double change[MOTION_NUMBERS])
{
    double v[3] = {(double)(p.x - u->centre.x), (double)(p.y - u->centre.y),
                   (double)(p.z - u->centre.z)};
    const double *w = change, *t = change + 3;
    return (igi_vec){p.x + (float)(u->turn_rad * (w[1] * v[2] - w[2] * v[1]) + u->move_m * t[0]),
                     p.y + (float)(u->turn_rad * (w[2] * v[0] - w[0] * v[2]) + u->move_m * t[1]),
                     p.z + (float)(u->turn_rad * (w[0] * v[1] - w[1] * v[0]) + u->move_m * t[2])};
}

void lines_of_thing(const igi_edge_sites *sites, uint32_t region, const igi_camera *camera,
                    double unit, const thing_units *units, edge_lines *f)
{
    double change[MOTION_NUMBERS], ends[2 * MOTION_NUMBERS];
    for (size_t i = 0; i < sites->count; i++) {
        igi_edge_site moved = sites->sites[i];
        const igi_edge_site *s = &sites->sites[i];
        if (s->region != region) continue;
        for (int k = 0; k < 2 * MOTION_NUMBERS; k++) {
            step(k, change);
            moved.point = move_point(s->point, units, change);
            ends[k] = pose_distance(&moved, camera);
        }
        add(s, pose_distance(s, camera), ends, unit, f);
    }
}

static double distance_after(const edge_line *l, const double *x)
{
    double d = l->d;
    for (int k = 0; k < MOTION_NUMBERS; k++) d += l->jacobian[k] * x[k];
    return d * l->weight;
}

bool lines_solve(const edge_lines *f, uint32_t without, motion *p)
{
    *p = (motion){{0}, {0}};
    for (int round = 0; round < ROUNDS; round++) {
        double m[MOTION_NUMBERS * MOTION_NUMBERS] = {0},
                                  v[(1 + MOTION_NUMBERS) * MOTION_NUMBERS] = {0};
        for (int k = 0; k < MOTION_NUMBERS; k++) {
            m[MOTION_NUMBERS * k + k] = f->as_one / (f->expected_px * f->expected_px);
            v[MOTION_NUMBERS * (1 + k) + k] = f->as_one;
        }
        for (size_t i = 0; i < f->count; i++) {
            const edge_line *l = &f->lines[i];
            if (l->region == without) continue;
            double off = fabs(distance_after(l, p->x)), w = l->weight * l->weight;
            if (round > 0 && off > HUBER) w *= HUBER / off;
            for (int a = 0; a < MOTION_NUMBERS; a++) {
                for (int b = 0; b <= a; b++)
                    m[MOTION_NUMBERS * a + b] += w * l->jacobian[a] * l->jacobian[b];
                v[a] -= w * l->jacobian[a] * l->d;
            }
        }
        if (!igi_solve_cholesky(m, MOTION_NUMBERS, v, 1 + MOTION_NUMBERS)) return false;
        memcpy(p->x, v, sizeof p->x);
        memcpy(p->covariance, v + MOTION_NUMBERS, sizeof p->covariance);
    }
    return true;
}

double line_gain(const edge_line *l, const double x[MOTION_NUMBERS])
{
    const double none[MOTION_NUMBERS] = {0};
    double before = fmin(fabs(distance_after(l, none)), CUT);
    double after = fmin(fabs(distance_after(l, x)), CUT);
    return before * before - after * after;
}
