/* SPDX-License-Identifier: Apache-2.0
 *
 * A diffuse surface looks the same from everywhere: the scatter of the photographs' means of one
 * side, beyond that of the pixels, is what a lobe, a wrong pose or a passer-by left. What in it goes
 * with the distance from the picture's middle is vignetting; what goes with the brightness of the
 * whole picture over that of the place is glare:
 *     (L_f - L) / L = -k (r_f^2 - r^2) + s (M_f - M) / L
 * with means over the pixels that show the place; k and s by least squares.
 */
#include "recover/residuals.h"

#include "base/order.h"

#define FEWEST_PIXELS 30 /* of one photograph on one region */
#define CALM 2.0
#define ALWAYS_CALM 0.002
#define CHANCE 3.0  /* standard deviations */
#define OUTLIER 0.5 /* a pixel off by more is no word about the camera */

/* What one photograph shows of one region, or of all, against the means of the sides. */
typedef struct view_sums {
    double off, square, whole, count;
} view_sums;

typedef struct camera_sums {
    double product[2][2], slope[2], square, count; /* of the two regressors, with what is off */
} camera_sums;

typedef struct viewer {
    const igi_problem *p;
    const igi_region_residual *regions; /* the calm ones count for the camera, */
    bool second;                        /* in a second round */
    size_t frames;
    view_sums *views;   /* [regions][frames] */
    view_sums *all;     /* [frames] of diffuse regions */
    double *brightness; /* [frames] mean of the picture */
    camera_sums camera;
} viewer;

static double brightness_of(const igi_problem *p, size_t observation)
{
    return igi_mean(p->observations->radiance + observation * (size_t)p->bands, (size_t)p->bands);
}

/* Squared distance from the middle of the picture, 1 in its corners. */
static double radius2(const igi_problem *p, size_t frame, size_t observation)
{
    const igi_camera *c = &p->scene->frames[frame].camera;
    uint32_t pixel = p->observations->pixel[observation];
    double x = pixel % (uint32_t)c->width + .5 - c->width / 2.0,
           y = pixel / (uint32_t)c->width + .5 - c->height / 2.0;
    return 4 * (x * x + y * y) / ((double)c->width * c->width + (double)c->height * c->height);
}

static void add_view(view_sums *v, double off, double whole)
{
    v->off += off;
    v->square += off * off;
    v->whole += whole;
    v->count++;
}

static void add_camera(camera_sums *c, double radius, double share, double off)
{
    const double x[2] = {-radius, share};
    if (fabs(off) > OUTLIER) return;
    for (int i = 0; i < 2; i++) {
        for (int j = 0; j < 2; j++) c->product[i][j] += x[i] * x[j];
        c->slope[i] += x[i] * off;
    }
    c->square += off * off;
    c->count++;
}

/* Sides that one photograph alone shows say nothing. */
static bool is_shared(const igi_problem *p, uint32_t side)
{
    size_t first = p->site_begin[side], next = p->site_begin[side + 1];
    return next - first > 1 && igi_observation_frame(p->observations, p->order[first]) !=
                                   igi_observation_frame(p->observations, p->order[next - 1]);
}

static void look_at_side(viewer *v, uint32_t side)
{
    const igi_problem *p = v->p;
    size_t region = igi_patch_region(p->patches, side >> 1), first = p->site_begin[side],
           next = p->site_begin[side + 1];
    double mean = igi_mean(p->seen + side * (size_t)p->bands, (size_t)p->bands), radius = 0,
           light = 0;
    if (!(mean > 0) || !is_shared(p, side)) return;
    bool counts = v->second && v->regions[region].calm;
    if (v->second && !counts) return;
    for (size_t k = first; k < next && counts; k++) {
        size_t f = igi_observation_frame(p->observations, p->order[k]);
        radius += radius2(p, f, p->order[k]) / (double)(next - first);
        light += v->brightness[f] / (double)(next - first);
    }
    for (size_t k = first; k < next; k++) {
        size_t i = p->order[k], f = igi_observation_frame(p->observations, i);
        double off = brightness_of(p, i) - mean;
        if (!counts) add_view(&v->views[region * v->frames + f], off, mean);
        if (!counts) continue;
        add_view(&v->all[f], off, mean);
        add_camera(&v->camera, radius2(p, f, i) - radius, (v->brightness[f] - light) / mean,
                   off / mean);
    }
}

/* The scatter of the photographs' means about the sides', less what their pixels' scatter would
 * give (`squares` would be chi-square's, of the number of photographs); and what it does to the mean
 * over all of them: photographs are clusters of errors (Liang & Zeger 1986), a sum of w_f off_f with
 * the share w_f of the pixels. */
static void differ(const view_sums *views, size_t count, igi_region_residual *r)
{
    double squares = 0, noise = 0, weight = 0, mean_off = 0, mean_noise = 0, used = 0;
    for (size_t f = 0; f < count; f++) {
        const view_sums *v = &views[f];
        if (v->count < FEWEST_PIXELS) continue;
        double off = v->off / v->whole, mean = v->whole / v->count;
        double pixel = v->square / v->count / (mean * mean);
        squares += v->count * off * off;
        noise += pixel; /* times count over count */
        mean_off += v->count * v->count * off * off;
        mean_noise += v->count * pixel;
        weight += v->count;
        used++;
    }
    if (used < 2) return;
    r->differ = sqrt(fmax(0, (squares - noise) / weight));
    r->by_chance = sqrt(CHANCE * sqrt(2 / used) * noise / weight);
    r->mean_error = sqrt(fmax(0, mean_off - mean_noise) * used / (used - 1)) / weight;
}

static void find_camera(const camera_sums *c, igi_residuals *out)
{
    const double(*a)[2] = c->product;
    double determinant = a[0][0] * a[1][1] - a[0][1] * a[1][0];
    if (c->count < FEWEST_PIXELS || !(determinant > 1e-9 * a[0][0] * a[1][1])) return;
    out->vignetting = (a[1][1] * c->slope[0] - a[0][1] * c->slope[1]) / determinant;
    out->glare = (a[0][0] * c->slope[1] - a[1][0] * c->slope[0]) / determinant;
    double rest = (c->square - out->vignetting * c->slope[0] - out->glare * c->slope[1]) / c->count;
    out->vignetting_error = sqrt(fmax(0, rest * a[1][1] / determinant));
    out->glare_error = sqrt(fmax(0, rest * a[0][0] / determinant));
}

/* Calm are diffuse regions about which photographs differ hardly more than about the calmest quarter
 * of the diffuse surface: a highlight that was missed would pass for a fault of the camera. */
static void find_calm(igi_residuals *r, const bool *diffuse)
{
    double all = 0;
    for (size_t i = 0; i < r->region_count; i++)
        if (diffuse[i]) all += r->regions[i].sides;
    r->usual_differ = HUGE_VAL;
    for (size_t i = 0; i < r->region_count; i++) {
        double below = 0;
        for (size_t k = 0; k < r->region_count; k++)
            if (diffuse[k] && r->regions[k].differ <= r->regions[i].differ)
                below += r->regions[k].sides;
        if (diffuse[i] && 4 * below >= all)
            r->usual_differ = fmin(r->usual_differ, r->regions[i].differ);
    }
    for (size_t i = 0; i < r->region_count; i++)
        r->regions[i].calm = diffuse[i] &&
                             r->regions[i].differ <= fmax(ALWAYS_CALM, CALM * r->usual_differ);
}

static void find_brightness(const igi_problem *p, double *brightness)
{
    const igi_observations *o = p->observations;
    for (size_t f = 0; f < o->frame_count; f++) {
        double count = (double)(o->frame_begin[f + 1] - o->frame_begin[f]);
        for (size_t i = o->frame_begin[f]; i < o->frame_begin[f + 1]; i++)
            brightness[f] += brightness_of(p, i) / count;
    }
}

static void look_at_all(viewer *v)
{
    for (uint32_t side = 0; side < 2 * v->p->patches->count; side++)
        if (v->p->patches->triangle[side >> 1] != IGI_NO_HIT) look_at_side(v, side);
}

igi_status igi_residuals_compare_views(igi_context *ctx, const igi_problem *p, const bool *diffuse,
                                       igi_residuals *out)
{
    igi_status status = IGI_OK;
    viewer v = {.p = p, .regions = out->regions, .frames = p->observations->frame_count};
    igi_region_residual all = {0};
    IGI_TRY_GOTO(IGI_ALLOC(ctx, v.frames * out->region_count, &v.views));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, v.frames, &v.all));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, v.frames, &v.brightness));
    find_brightness(p, v.brightness);
    look_at_all(&v);
    for (size_t r = 0; r < out->region_count; r++)
        differ(v.views + r * v.frames, v.frames, &out->regions[r]);
    find_calm(out, diffuse);
    v.second = true;
    look_at_all(&v);
    differ(v.all, v.frames, &all);
    out->drift = all.differ;
    find_camera(&v.camera, out);
cleanup:
    igi_free(v.views);
    igi_free(v.all);
    igi_free(v.brightness);
    return status;
}
