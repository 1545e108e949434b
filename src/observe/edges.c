/* SPDX-License-Identifier: Apache-2.0
 *
 * A photograph against the mesh by four numbers: shifted, magnified and turned about its middle. An
 * edge says how far it lies off across itself: weighted least squares over the sites, those far off
 * having less of a say (shadows that look like edges). Weak priors stand for what no edge tells.
 */
#include "observe/edges.h"

#include "base/order.h"
#include "base/solve.h"

#include <math.h>
#include <string.h>

#define REACH_PX 4.0
#define ENOUGH_EDGES 60
#define FEWEST_EDGES 8
#define HUBER 2.0 /* robust standard deviations */
#define ROUNDS 6
/* Standard deviations before anything is seen, pixels: of a shift; of the corners, magnified. */
#define SHIFT_PX 4.0
#define CORNER_PX 2.0
/* Mean square distance from a picture's middle, of that of its corner. */
#define MEAN_SQUARE (1 / 3.0)

enum { SHIFT_X, SHIFT_Y, MAGNIFIED, TURNED, NUMBERS };

typedef struct fit {
    const igi_edge_sites *sites;
    double middle[2], corner; /* pixels */
    double spread;            /* of residuals times weights */
    double together;          /* so many sites count as one */
    double *scratch;          /* [sites] */
} fit;

static double weight_of(const igi_edge_site *s)
{
    return 1 / hypot(s->sigma, s->corner ? IGI_CORNER_ERROR : IGI_SITE_ERROR);
}

static void row_of(const fit *f, const igi_edge_site *s, double row[NUMBERS])
{
    double x = (s->seen[0] - f->middle[0]) / f->corner, y = (s->seen[1] - f->middle[1]) / f->corner;
    row[SHIFT_X] = s->normal[0];
    row[SHIFT_Y] = s->normal[1];
    row[MAGNIFIED] = s->normal[0] * x + s->normal[1] * y;
    row[TURNED] = s->normal[1] * x - s->normal[0] * y;
}

static double residual_of(const fit *f, const igi_edge_site *s, const double p[NUMBERS])
{
    double row[NUMBERS], r = s->offset;
    row_of(f, s, row);
    for (int k = 0; k < NUMBERS; k++) r -= row[k] * p[k];
    return r;
}

/* *pixels: the same without weights. */
static void find_spread(fit *f, const double p[NUMBERS], double *pixels)
{
    size_t n = f->sites->count;
    for (size_t i = 0; i < n; i++) f->scratch[i] = fabs(residual_of(f, &f->sites->sites[i], p));
    *pixels = 1.4826 * igi_median(f->scratch, n);
    for (size_t i = 0; i < n; i++)
        f->scratch[i] = fabs(residual_of(f, &f->sites->sites[i], p)) *
                        weight_of(&f->sites->sites[i]);
    f->spread = fmax(1, 1.4826 * igi_median(f->scratch, n));
}

/* One step of reweighted least squares; variances of the four. */
static bool improve(const fit *f, double p[NUMBERS], double variances[NUMBERS])
{
    double m[NUMBERS * NUMBERS] = {0}, right[(NUMBERS + 1) * NUMBERS] = {0};
    for (int k = 0; k < NUMBERS; k++) {
        double prior = k < MAGNIFIED ? SHIFT_PX : CORNER_PX;
        m[NUMBERS * k + k] = 1 / (prior * prior);
        right[NUMBERS * (1 + k) + k] = 1;
    }
    for (size_t i = 0; i < f->sites->count; i++) {
        const igi_edge_site *s = &f->sites->sites[i];
        double row[NUMBERS], w = weight_of(s), r = fabs(residual_of(f, s, p)) * w;
        row_of(f, s, row);
        w *= w / (f->spread * f->spread * f->together);
        if (r > HUBER * f->spread) w *= HUBER * f->spread / r;
        for (int a = 0; a < NUMBERS; a++) {
            for (int b = 0; b < NUMBERS; b++) m[NUMBERS * a + b] += w * row[a] * row[b];
            right[a] += w * row[a] * s->offset;
        }
    }
    if (!igi_solve_cholesky(m, NUMBERS, right, NUMBERS + 1)) return false;
    memcpy(p, right, NUMBERS * sizeof *p);
    for (int k = 0; k < NUMBERS; k++) variances[k] = right[NUMBERS * (1 + k) + k];
    return true;
}

static void find_shift(fit *f, igi_registration *r)
{
    double p[NUMBERS] = {0}, variances[NUMBERS];
    for (int round = 0; round < ROUNDS; round++) {
        find_spread(f, p, &r->residual);
        if (!improve(f, p, variances)) return;
    }
    find_spread(f, p, &r->residual);
    r->edges = f->sites->count;
    r->offset[0] = p[SHIFT_X];
    r->offset[1] = p[SHIFT_Y];
    r->offset_error = sqrt(fmax(variances[SHIFT_X], variances[SHIFT_Y]));
    r->magnified = p[MAGNIFIED];
    r->turned = p[TURNED];
    r->corner_error = sqrt(fmax(variances[MAGNIFIED], variances[TURNED]));
    for (int k = 0; k < NUMBERS; k++) {
        double share = k < MAGNIFIED ? 1 : MEAN_SQUARE;
        r->shift += share * p[k] * p[k];
        r->shift_error += share * variances[k];
    }
    r->shift = sqrt(r->shift);
    r->shift_error = sqrt(r->shift_error);
}

igi_status igi_registration_measure(igi_context *ctx, const igi_scene *scene,
                                    const igi_tracer *tracer, const igi_camera *camera,
                                    const igi_image *image, const igi_visible *visible,
                                    igi_registration *registration)
{
    igi_status status = IGI_OK;
    igi_edge_sites sites = {0};
    igi_edge_search search = {scene, tracer, camera, image, visible, REACH_PX, ENOUGH_EDGES};
    fit f = {.sites = &sites, .middle = {camera->width / 2.0, camera->height / 2.0}};
    f.corner = hypot(f.middle[0], f.middle[1]);
    *registration = (igi_registration){0};
    IGI_TRY_GOTO(igi_edge_sites_find(ctx, &search, &sites));
    if (sites.count < FEWEST_EDGES) goto cleanup;
    f.together = fmax(1, IGI_SITES_AS_ONE * camera->height / sites.step);
    IGI_TRY_GOTO(IGI_ALLOC(ctx, sites.count, &f.scratch));
    find_shift(&f, registration);
cleanup:
    igi_free(f.scratch);
    igi_free(sites.sites);
    return status;
}
