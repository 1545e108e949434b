/* SPDX-License-Identifier: Apache-2.0
 *
 * Five faces, each a perspective picture with (s,t) = (right, up)/forward: the top with s and t in
 * [-1,1], the four sides with t in [0,1]. A pixel of area dA stands for the form factor
 *   top   dA / (pi (s^2 + t^2 + 1)^2)        side  t dA / (pi (s^2 + t^2 + 1)^2)
 * (Cohen & Greenberg 1985, eq. 12-13), scaled so that all sum to 1. Facets are clipped to a face's
 * pyramid and drawn row by row; the inverse of the distance forward is linear on the picture and
 * decides what is in front. The error is that of counting pixel centres along outlines: between
 * res^-1 (outlines along pixel rows) and res^-1.5 (all directions), which is why each cube is
 * turned at random about its normal.
 */
#include "transport/hemicube.h"

#include "base/rng.h"

#define FACES 5
#define MAX_CORNERS 9 /* three, and one more for each of the planes that clip */

struct igi_hemicube {
    int resolution;
    double *top, *side; /* [res][res], [res/2][res] */
};

struct igi_hemicube_buffer {
    double *nearness; /* [3 res^2], top, then the sides; 0: nothing */
    uint32_t *item;
};

igi_status igi_hemicube_create(igi_context *ctx, int resolution, igi_hemicube **hemicube)
{
    igi_status status = IGI_OK;
    igi_hemicube *h = NULL;
    *hemicube = NULL;
    if (resolution < 2 || resolution > 4096 || resolution % 2)
        return igi_fail(ctx, IGI_E_USAGE,
                        "hemicube: resolution %d; give an even one from 2 to 4096", resolution);
    size_t res = (size_t)resolution;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &h));
    h->resolution = resolution;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, res * res, &h->top));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, res * res / 2, &h->side));
    double sum = 0;
    for (size_t p = 0; p < res * res; p++) {
        double s = 2 * ((double)(p % res) + .5) / (double)res - 1;
        double t = 2 * ((double)(p / res) + .5) / (double)res;
        double top = s * s + (t - 1) * (t - 1) + 1, side = s * s + t * t + 1;
        sum += h->top[p] = 1 / (top * top);
        if (p < res * res / 2) sum += 4 * (h->side[p] = t / (side * side));
    }
    for (size_t p = 0; p < res * res; p++) h->top[p] /= sum;
    for (size_t p = 0; p < res * res / 2; p++) h->side[p] /= sum;
    *hemicube = h;
    h = NULL;
cleanup:
    igi_hemicube_destroy(h);
    return status;
}

void igi_hemicube_destroy(igi_hemicube *hemicube)
{
    if (!hemicube) return;
    igi_free(hemicube->top);
    igi_free(hemicube->side);
    igi_free(hemicube);
}

igi_status igi_hemicube_buffer_create(igi_context *ctx, const igi_hemicube *hemicube,
                                      igi_hemicube_buffer **buffer)
{
    igi_status status = IGI_OK;
    igi_hemicube_buffer *b = NULL;
    size_t pixels = 3 * (size_t)hemicube->resolution * (size_t)hemicube->resolution;
    *buffer = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &b));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, pixels, &b->nearness));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, pixels, &b->item));
    *buffer = b;
    b = NULL;
cleanup:
    igi_hemicube_buffer_destroy(b);
    return status;
}

void igi_hemicube_buffer_destroy(igi_hemicube_buffer *buffer)
{
    if (!buffer) return;
    igi_free(buffer->nearness);
    igi_free(buffer->item);
    igi_free(buffer);
}

/* One face of the buffer, and the convex polygon that is being drawn on it. */
typedef struct drawing {
    int width, height;
    double low_t; /* of the picture: -1 or 0 */
    double *nearness;
    uint32_t *item;
    size_t count;
    double corner[MAX_CORNERS][3]; /* right, up, forward */
    double plane[3];               /* nearness = plane . (s, t, 1) */
    uint32_t element;
} drawing;

/* Keeps what has weight . corner >= 0 (Sutherland & Hodgman 1974). */
static void clip(drawing *d, double right, double up, double forward)
{
    double kept[MAX_CORNERS][3], height[MAX_CORNERS];
    size_t count = 0;
    for (size_t i = 0; i < d->count; i++)
        height[i] = right * d->corner[i][0] + up * d->corner[i][1] + forward * d->corner[i][2];
    for (size_t i = 0; i < d->count; i++) {
        size_t j = (i + 1) % d->count;
        if (height[i] >= 0 && count < MAX_CORNERS) {
            for (int k = 0; k < 3; k++) kept[count][k] = d->corner[i][k];
            count++;
        }
        if ((height[i] >= 0) != (height[j] >= 0) && count < MAX_CORNERS) {
            double f = height[i] / (height[i] - height[j]);
            for (int k = 0; k < 3; k++)
                kept[count][k] = d->corner[i][k] + f * (d->corner[j][k] - d->corner[i][k]);
            count++;
        }
    }
    d->count = count;
    for (size_t i = 0; i < count; i++)
        for (int k = 0; k < 3; k++) d->corner[i][k] = kept[i][k];
}

/* Where the polygon, its corners now in pixels, crosses the row y; false: nowhere. The slack closes
 * the cracks that rounding would leave between neighbours; overlap does no harm. */
static bool find_span(const drawing *d, double y, double *from, double *to)
{
    const double slack = 1e-9;
    *from = HUGE_VAL;
    *to = -HUGE_VAL;
    for (size_t i = 0; i < d->count; i++) {
        const double *a = d->corner[i], *b = d->corner[(i + 1) % d->count];
        if (y < fmin(a[1], b[1]) - slack || y > fmax(a[1], b[1]) + slack) continue;
        double rise = b[1] - a[1];
        double f = fabs(rise) > slack ? fmin(fmax((y - a[1]) / rise, 0), 1) : 0;
        double x = a[0] + f * (b[0] - a[0]), end = fabs(rise) > slack ? x : b[0];
        *from = fmin(*from, fmin(x, end) - slack);
        *to = fmax(*to, fmax(x, end) + slack);
    }
    return *from <= *to;
}

static void fill(drawing *d)
{
    double low = HUGE_VAL, high = -HUGE_VAL, pixel = 2.0 / d->width;
    for (size_t i = 0; i < d->count; i++) {
        double *c = d->corner[i];
        c[0] = (c[0] / c[2] + 1) / pixel;
        c[1] = (c[1] / c[2] - d->low_t) / pixel;
        low = fmin(low, c[1]);
        high = fmax(high, c[1]);
    }
    int last = (int)fmin(floor(high), d->height - 1);
    for (int y = (int)fmax(floor(low), 0); y <= last; y++) {
        double from, to, t = d->low_t + (y + .5) * pixel;
        if (!find_span(d, y + .5, &from, &to)) continue;
        int end = (int)fmin(floor(to - .5), d->width - 1);
        for (int x = (int)fmax(ceil(from - .5), 0); x <= end; x++) {
            double s = (x + .5) * pixel - 1;
            double nearness = d->plane[0] * s + d->plane[1] * t + d->plane[2];
            size_t p = (size_t)y * (size_t)d->width + (size_t)x;
            if (nearness <= d->nearness[p]) continue;
            d->nearness[p] = nearness;
            d->item[p] = d->element;
        }
    }
}

/* The facet, with corners and normal in the cube's frame, on one face. axis, sign: which coordinate
 * of that frame is right, up and forward on the face. */
static void draw(const igi_hemicube *h, igi_hemicube_buffer *buffer, int face, double (*corner)[3],
                 const double plane[3], uint32_t element)
{
    static const int axis[FACES][3] = {{0, 1, 2}, {1, 2, 0}, {0, 2, 1}, {1, 2, 0}, {0, 2, 1}};
    static const int sign[FACES][3] = {{1, 1, 1}, {1, 1, 1}, {-1, 1, 1}, {-1, 1, -1}, {1, 1, -1}};
    size_t pixels = (size_t)h->resolution * (size_t)h->resolution;
    size_t first = face == 0 ? 0 : pixels + (size_t)(face - 1) * pixels / 2;
    drawing d = {.width = h->resolution,
                 .height = face == 0 ? h->resolution : h->resolution / 2,
                 .low_t = face == 0 ? -1 : 0,
                 .nearness = buffer->nearness + first,
                 .item = buffer->item + first,
                 .count = 3,
                 .element = element};
    for (int k = 0; k < 3; k++) {
        d.plane[k] = sign[face][k] * plane[axis[face][k]];
        for (int c = 0; c < 3; c++) d.corner[c][k] = sign[face][k] * corner[c][axis[face][k]];
    }
    clip(&d, 0, face == 0 ? 1 : 0, 1); /* for a side: forward alone, up is clipped below */
    clip(&d, 1, 0, 1);
    clip(&d, -1, 0, 1);
    clip(&d, 0, -1, 1);
    if (face > 0) clip(&d, 0, 1, 0);
    for (size_t i = 0; i < d.count; i++)
        if (!(d.corner[i][2] > 0)) return; /* it reaches the point itself: seen edge-on */
    if (d.count >= 3) fill(&d);
}

static void to_frame(const double v[3], double (*axes)[3], double out[3])
{
    for (int k = 0; k < 3; k++) out[k] = v[0] * axes[k][0] + v[1] * axes[k][1] + v[2] * axes[k][2];
}

static void make_frame(const double normal[3], double turn, double axes[3][3])
{
    igi_vec t, b;
    igi_frame_of(igi_v_ofd(normal), &t, &b);
    const double ta[3] = {(double)t.x, (double)t.y, (double)t.z};
    const double ba[3] = {(double)b.x, (double)b.y, (double)b.z};
    for (int k = 0; k < 3; k++) {
        axes[0][k] = cos(turn) * ta[k] + sin(turn) * ba[k];
        axes[1][k] = cos(turn) * ba[k] - sin(turn) * ta[k];
        axes[2][k] = normal[k];
    }
}

static void draw_facet(const igi_facet *facet, const igi_hemicube *h, igi_hemicube_buffer *buffer,
                       const double point[3], double (*axes)[3])
{
    double corner[3][3], plane[3], away = 0, height = 0, reach = 0;
    for (int c = 0; c < 3; c++) {
        double to[3];
        for (int k = 0; k < 3; k++) to[k] = facet->corner[c][k] - point[k];
        to_frame(to, axes, corner[c]);
        height = fmax(height, corner[c][2]);
        for (int k = 0; k < 3; k++) reach = fmax(reach, fabs(corner[c][k]));
    }
    if (height <= 1e-6 * reach) return; /* below, or in the point's own plane but for rounding */
    to_frame(facet->normal, axes, plane);
    for (int k = 0; k < 3; k++) away += plane[k] * corner[0][k];
    if (away == 0) return;
    for (int k = 0; k < 3; k++) plane[k] /= away;
    uint32_t element = facet->element[away > 0 ? 1 : 0]; /* a normal that points away: the back */
    for (int face = 0; face < FACES; face++) draw(h, buffer, face, corner, plane, element);
}

void igi_hemicube_add(const igi_elements *elements, const igi_hemicube *hemicube,
                      igi_hemicube_buffer *buffer, const double point[3], const double normal[3],
                      double turn, double weight, double *row)
{
    size_t pixels = (size_t)hemicube->resolution * (size_t)hemicube->resolution;
    double axes[3][3];
    make_frame(normal, turn, axes);
    for (size_t p = 0; p < 3 * pixels; p++) buffer->nearness[p] = 0;
    for (size_t f = 0; f < elements->facet_count; f++)
        draw_facet(&elements->facets[f], hemicube, buffer, point, axes);
    for (size_t p = 0; p < 3 * pixels; p++) {
        if (buffer->nearness[p] == 0 || buffer->item[p] == IGI_NO_ELEMENT) continue;
        double f = p < pixels ? hemicube->top[p] : hemicube->side[(p - pixels) % (pixels / 2)];
        row[buffer->item[p]] += weight * f;
    }
}

void igi_form_factor_row_by_hemicube(const igi_elements *elements, const igi_hemicube *hemicube,
                                     igi_hemicube_buffer *buffer, uint32_t e, int points,
                                     uint64_t key, double *row)
{
    igi_rng rng = igi_rng_make(key, e);
    const igi_element *element = &elements->elements[e];
    double shift[4];
    for (int d = 0; d < 4; d++) shift[d] = (double)igi_rng_float(&rng);
    for (int k = 0; k < points; k++) {
        double x[3], point[3], normal[3];
        igi_kronecker(shift, k, 3, x);
        const igi_facet *facet = igi_elements_facet(elements, e, (k + shift[3]) / points);
        igi_facet_point(facet, x[0], x[1], 0, point);
        for (int c = 0; c < 3; c++)
            normal[c] = element->back ? -facet->normal[c] : facet->normal[c];
        igi_hemicube_add(elements, hemicube, buffer, point, normal, 2 * IGI_PI * x[2], 1.0 / points,
                         row);
    }
}
