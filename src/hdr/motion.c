/* SPDX-License-Identifier: Apache-2.0
 *
 * How far two photographs of one bracket are shifted by parts of a pixel, and turned.
 *
 * Gauss and Newton on the brightness, as Lucas and Kanade (1981), from the whole-pixel shift on: with q =
 * (shift, turn) and W(p; q) the place in the longer photograph b that shows p of the shorter one a,
 *     a(p) - b(W(p; q)) = grad a . dW/dq dq + g a(p),
 * after a's codes were brought to b's scale, by the response where it is known and else by what codes of
 * b they meet on average; g is what is wrong with that scale. Residuals count by Cauchy's weights, so that
 * what moved is outvoted. A few ten thousand places are enough, and most brackets end after the first
 * look: only where it finds something the longer way follows, from coarse means of pixels to fine.
 * In the end it must explain what the pictures disagree on at their edges: hand-held photographs and
 * scanned film differ by more than one motion, and resampling them gains nothing.
 * (OpenCV's findTransformECC has no such weights and looks at every pixel many times.)
 */
#include "base/context.h"
#include "base/order.h"
#include "base/solve.h"
#include "hdr/hdr_private.h"

#include <math.h>
#include <string.h>

#define FIRST_LOOK 2e4 /* places */
#define PLACES 6e4
#define MOST_ROUNDS 8
/* Pixels, at the picture's corners: what is not worth resampling, where rounds end, and what is no small
 * misalignment any more. */
#define LEAST_MOTION .1
#define SETTLED .006
#define FARTHEST 30.0
#define CLEAR_SIGMAS 6.0
/* Of full scale: what counts as well exposed in the longer photograph. */
#define DIMMEST .02f
#define BRIGHTEST .85f
/* Of the disagreement at edges, what a motion may leave: true ones leave .05 to .65, the
 * memorial church's scanned film .73 and more. */
#define MOST_LEFT .7
/* Of the places; fewer that are well exposed in both photographs cannot tell a motion. */
#define LEAST_SHARE .05
#define FEWEST 100 /* places, to tell anything */
#define UNKNOWNS 4 /* x, y, turn, scale */

typedef struct matcher {
    const igi_photo *a, *b;
    size_t channel;
    float *value_a, *value_b; /* [levels] on one scale; NaN: too dark or too bright */
    bool photons;             /* they are proportional to light */
    double centre[2], radius; /* pixels */
    igi_shift start;
    double *residuals; /* some of them */
    int block;         /* pixels are means over block x block of them */
    double places;
} matcher;

typedef struct motion {
    double q[3]; /* x, y, turn times radius: pixels beyond the start */
    double covariance[3][3];
    double scale; /* robust standard deviation of the residuals; 0: not known yet */
    size_t count; /* of places that told */
} motion;

/* The mean over the block whose first pixel is (x,y), or over every second pixel of a large one. */
static float block_at(const igi_photo *photo, const float *values, const matcher *m, int x, int y)
{
    int n = m->block, step = n > 4 ? 2 : 1, across = n / step;
    float sum = 0;
    if (x < 0 || y < 0 || x + n > photo->width || y + n > photo->height) return NAN;
    for (int v = y; v < y + n; v += step) {
        size_t row = (size_t)v * (size_t)photo->width;
        for (int u = x; u < x + n; u += step)
            sum += values[photo->codes[(row + (size_t)u) * (size_t)photo->channels + m->channel]];
    }
    return sum / (float)(across * across);
}

static float interpolate(const matcher *m, double x, double y)
{
    int x0 = (int)floor(x), y0 = (int)floor(y);
    float u = (float)(x - x0), v = (float)(y - y0);
    return (1 - v) * ((1 - u) * block_at(m->b, m->value_b, m, x0, y0) +
                      u * block_at(m->b, m->value_b, m, x0 + 1, y0)) +
           v * ((1 - u) * block_at(m->b, m->value_b, m, x0, y0 + 1) +
                u * block_at(m->b, m->value_b, m, x0 + 1, y0 + 1));
}

typedef struct sums {
    double normal[UNKNOWNS][UNKNOWNS], right[UNKNOWNS];
    double edges; /* squared residuals, softly cut, weighted by squared gradients */
} sums;

/* One place: its residual, whitened, and what it says. False where it cannot be seen. */
static bool add_place(const matcher *m, const motion *now, const igi_motion *way, int x, int y,
                      sums *s, double *residual)
{
    double half = (m->block - 1) / 2., at[2];
    double px = x + half - m->centre[0], py = y + half - m->centre[1];
    igi_motion_place(way, x + half, y + half, at);
    int h = m->block > 2 ? m->block / 2 : 1;
    float a = block_at(m->a, m->value_a, m, x, y);
    float dx = block_at(m->a, m->value_a, m, x + h, y) - block_at(m->a, m->value_a, m, x - h, y);
    float dy = block_at(m->a, m->value_a, m, x, y + h) - block_at(m->a, m->value_a, m, x, y - h);
    if (isnan(dx) || isnan(dy) || isnan(a)) return false;
    float b = interpolate(m, at[0] - half, at[1] - half);
    if (isnan(b)) return false;
    double gx = (double)dx / (2 * h), gy = (double)dy / (2 * h);
    double j[UNKNOWNS] = {gx, gy, (gy * px - gx * py) / m->radius, (double)a};
    double white = m->photons ? 1 / ((double)a + (double)DIMMEST) : 1, r = (double)(a - b);
    *residual = r * sqrt(white);
    if (now->scale > 0) {
        double u = *residual / (2.385 * now->scale);
        s->edges += white * (gx * gx + gy * gy) * u * u / (1 + u * u / 9);
        white /= 1 + u * u;
    }
    for (int i = 0; i < UNKNOWNS; i++) {
        s->right[i] += white * j[i] * r;
        for (int k = 0; k <= i; k++) s->normal[i][k] += white * j[i] * j[k];
    }
    return true;
}

static void look(const matcher *m, motion *now, sums *s)
{
    double residual;
    int stride = (int)ceil(sqrt((double)m->a->width * m->a->height / m->places));
    const igi_shift shift = {m->start.x, m->start.y, now->q[0], now->q[1], now->q[2] / m->radius};
    const igi_motion way = igi_motion_of(m->b, &shift);
    *s = (sums){.edges = 0};
    now->count = 0;
    for (int y = stride / 2; y < m->a->height; y += stride)
        for (int x = stride / 2; x < m->a->width; x += stride)
            if (add_place(m, now, &way, x, y, s, &residual))
                m->residuals[now->count++] = fabs(residual);
}

/* One round. `step`: how far the corners went, pixels; false where nothing is told. */
static bool improve(const matcher *m, motion *now, double *step)
{
    sums s;
    double solution[UNKNOWNS][UNKNOWNS] = {{0}};
    look(m, now, &s);
    if (now->count < FEWEST) return false;
    /* Rows: the step, and three columns of the inverse. */
    memcpy(solution[0], s.right, sizeof s.right);
    for (int i = 0; i < 3; i++) solution[i + 1][i] = 1;
    if (!igi_solve_cholesky(&s.normal[0][0], UNKNOWNS, &solution[0][0], UNKNOWNS)) return false;
    now->scale = 1.4826 * igi_median(m->residuals, now->count);
    for (int i = 0; i < 3; i++) {
        now->q[i] += solution[0][i];
        for (int k = 0; k < 3; k++)
            now->covariance[i][k] = solution[i + 1][k] * now->scale * now->scale;
    }
    *step = hypot(solution[0][0], solution[0][1]) + fabs(solution[0][2]);
    return isfinite(*step) && hypot(now->q[0], now->q[1]) + fabs(now->q[2]) < FARTHEST;
}

static bool is_clear(const motion *m)
{
    double far = hypot(m->q[0], m->q[1]) + fabs(m->q[2]), sigmas = 0;
    for (int i = 0; i < 3; i++)
        sigmas = fmax(sigmas, fabs(m->q[i]) / sqrt(fmax(m->covariance[i][i], 1e-12)));
    return far > LEAST_MOTION && sigmas > CLEAR_SIGMAS;
}

/* From coarse to fine; false where it leads nowhere. */
static bool follow(matcher *m, motion *found)
{
    int least = m->a->width < m->a->height ? m->a->width : m->a->height;
    for (m->block = 8; m->block > 1; m->block /= 2) {
        double step = HUGE_VAL;
        m->places = m->block > 2 ? PLACES / 4 : PLACES;
        if (m->block > 2 && least < 32 * m->block) continue;
        found->scale = 0;
        for (int round = 0; round < MOST_ROUNDS && step > SETTLED * m->block; round++)
            if (!improve(m, found, &step)) return false;
    }
    m->block = 2;
    return is_clear(found);
}

static bool explains(const matcher *m, const motion *found)
{
    motion none = {.scale = found->scale}, moved = *found;
    sums before, after;
    look(m, &none, &before);
    look(m, &moved, &after);
    double places = fmin(m->places, (double)m->a->width * m->a->height);
    if ((double)none.count < LEAST_SHARE * places || moved.count == 0) return false;
    return after.edges / (double)moved.count < MOST_LEFT * before.edges / (double)none.count;
}

static void tabulate_response(matcher *m, const igi_response *response, double expected)
{
    const float *curve = response->exposure + m->channel * (size_t)response->levels;
    float ratio = (float)exp(expected);
    /* The same limits for both: an edge of which one side is beyond them is then left out as a whole, by
     * a's gradient. Half an edge would pull. */
    for (int z = 0; z < response->levels; z++) {
        float a = curve[z] * ratio, b = curve[z];
        m->value_a[z] = a < DIMMEST || a > BRIGHTEST ? NAN : a;
        m->value_b[z] = b < DIMMEST || b > BRIGHTEST ? NAN : b;
    }
    m->photons = true;
}

/* The codes of b that a code of a meets on average. */
#define END 24
static void tabulate_codes(matcher *m, const igi_comparagram *pair, int levels)
{
    const uint32_t *counts = pair->counts + m->channel * IGI_HDR_BINS * IGI_HDR_BINS;
    float met[IGI_HDR_BINS];
    for (int i = 0; i < IGI_HDR_BINS; i++) {
        double n = 0, sum = 0;
        for (int k = 0; k < IGI_HDR_BINS; k++) {
            n += counts[i * IGI_HDR_BINS + k];
            sum += k * (double)counts[i * IGI_HDR_BINS + k];
        }
        met[i] = n > 20 && i >= END ? (float)(sum / n / (IGI_HDR_BINS - 1)) : NAN;
        if (met[i] < END / 255.f || met[i] > 1 - END / 255.f) met[i] = NAN;
    }
    for (int z = 0; z < levels; z++) {
        double at = fmax(0, (z + .5) * IGI_HDR_BINS / levels - .5);
        int i = at < IGI_HDR_BINS - 2 ? (int)at : IGI_HDR_BINS - 2;
        float t = (float)(at - i), code = (float)z / (float)(levels - 1);
        m->value_a[z] = t > 0 ? (1 - t) * met[i] + t * met[i + 1] : met[i];
        m->value_b[z] = code < END / 255.f || code > 1 - END / 255.f ? NAN : code;
    }
}

igi_status igi_hdr_refine_shift(igi_context *ctx, const igi_photo *a, const igi_photo *b,
                                const igi_response *response, double expected,
                                const igi_comparagram *pair, igi_shift *shift)
{
    igi_status status = IGI_OK;
    matcher m = {.a = a,
                 .b = b,
                 .channel = a->channels == 3,
                 .start = *shift,
                 .block = 2,
                 .places = FIRST_LOOK};
    motion found = {.scale = 0};
    double step = 0;
    m.centre[0] = (a->width - 1) / 2., m.centre[1] = (a->height - 1) / 2.;
    m.radius = hypot(m.centre[0], m.centre[1]) + 1;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, (size_t)a->levels, &m.value_a));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, (size_t)a->levels, &m.value_b));
    IGI_TRY_GOTO(
        IGI_ALLOC(ctx, (size_t)(2 * PLACES) + (size_t)(a->width + a->height), &m.residuals));
    if (response) tabulate_response(&m, response, expected);
    else tabulate_codes(&m, pair, a->levels);
    for (int round = 0; round < 2; round++)
        if (!improve(&m, &found, &step)) goto cleanup;
    if (!is_clear(&found)) goto cleanup;
    found = (motion){.scale = 0};
    if (!follow(&m, &found) || !explains(&m, &found)) goto cleanup;
    *shift = igi_shift_of(shift->x + found.q[0], shift->y + found.q[1], found.q[2] / m.radius);
cleanup:
    igi_free(m.value_a);
    igi_free(m.value_b);
    igi_free(m.residuals);
    return status;
}
