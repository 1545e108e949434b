/* SPDX-License-Identifier: Apache-2.0
 *
 * Inside src/hdr.
 */
#ifndef IGI_SRC_HDR_PRIVATE_H
#define IGI_SRC_HDR_PRIVATE_H

#include "hdr/hdr.h"

#include <math.h>

/* The content of the second photograph stands (x,y) pixels further right and down than in the first;
 * what the pictures show beyond whole pixels comes on top: parts of one, and a turn about the picture's
 * centre, radians from +x to +y (down). */
typedef struct igi_shift {
    int x, y;
    double part_x, part_y, angle;
} igi_shift;

static inline igi_shift igi_shift_of(double x, double y, double angle)
{
    igi_shift s = {(int)lround(x), (int)lround(y), 0, 0, angle};
    s.part_x = x - s.x, s.part_y = y - s.y;
    return s;
}

static inline bool igi_shift_is_whole(const igi_shift *s)
{
    return s->part_x == 0 && s->part_y == 0 && s->angle == 0;
}

/* How often code a of one photograph meets code b, of the same channel, at the same place of the
 * next longer one: counts[channels][256][256]. Codes of 16 bits are cut to 8. */
#define IGI_HDR_BINS 256
typedef struct igi_comparagram {
    uint32_t *counts;
} igi_comparagram;

/* Of every pixel, or of a regular grid of at most about `most` of them. */
IGI_MUST_USE igi_status igi_comparagram_fill(igi_context *ctx, const igi_photo *a,
                                             const igi_photo *b, const igi_shift *shift,
                                             double most, igi_comparagram *out);

/* Of a bracket of `count` photographs, the shortest first: pairs are (i, i+1). */
typedef struct igi_bracket {
    size_t count;
    int channels, levels;
    bool linear;
    double *log_h;          /* [count] stated, natural */
    double *log_ratio;      /* [count-1] as the pictures show it; NaN: they do not */
    igi_comparagram *pairs; /* [count-1] */
    igi_shift *shifts;      /* [count] against the shortest */
    double *unsaturated;    /* [count] fraction of the pixels, roughly */
} igi_bracket;

/* ln exposure of each code, but for a constant; and how much the bracket has to say about it. */
typedef struct igi_log_curve {
    double g[IGI_HDR_BINS], used[IGI_HDR_BINS];
} igi_log_curve;

/* Of each channel, from the comparagrams and the stated exposures; fills log_ratio. *deviation: as
 * igi_response's. */
IGI_MUST_USE igi_status igi_hdr_solve_response(igi_context *ctx, igi_bracket *bracket,
                                               igi_log_curve *curves, double *deviation);
/* The response by that. */
IGI_MUST_USE igi_status igi_hdr_recover_response(igi_context *ctx, igi_bracket *bracket,
                                                 igi_response **response);

/* The same from few numbers: a polynomial (Mitsunaga and Nayar), and, with a table, the nearest curve
 * of the space of known responses (Grossberg and Nayar).
 *response keeps its ranges of
 * known codes, which igi_hdr_recover_response found. */
IGI_MUST_USE igi_status igi_hdr_fit_basis(igi_context *ctx, const igi_bracket *bracket,
                                          const double (*table)[IGI_HDR_TABLE],
                                          igi_response *response);
/* Exposure of b / exposure of a, natural logarithm, by a known response. NaN when too few pixels
 * are well exposed in both. `expected`: the stated one. */
IGI_MUST_USE igi_status igi_hdr_measure_ratio(igi_context *ctx, const igi_photo *a,
                                              const igi_photo *b, const igi_shift *shift,
                                              const igi_response *response, double expected,
                                              double *log_ratio);

/* Whole-pixel shift of b against a, or none where one does not make the pictures agree better. */
void igi_hdr_align(const igi_photo *a, const igi_photo *b, igi_shift *shift);

/* Adds parts of a pixel and a turn, where they are significant; else *shift stays. By the response, or by
 * the pair's comparagram where that is NULL. */
IGI_MUST_USE igi_status igi_hdr_refine_shift(igi_context *ctx, const igi_photo *a,
                                             const igi_photo *b, const igi_response *response,
                                             double expected, const igi_comparagram *pair,
                                             igi_shift *shift);

/* Debevec's or Robertson's method, OpenCV's: the response, and the radiance by any response. */
IGI_MUST_USE igi_status igi_hdr_compare_response(igi_context *ctx, const igi_exposure *exposures,
                                                 size_t count, bool robertson,
                                                 igi_response **response);
IGI_MUST_USE igi_status igi_hdr_compare_merge(igi_context *ctx, const igi_exposure *exposures,
                                              size_t count, const igi_response *response,
                                              bool robertson, igi_image **image);

/* A shift as it is followed from pixel to pixel: where b shows what a shows. */
typedef struct igi_motion {
    const igi_photo *b;
    int x, y;
    bool turned;
    double cosine, sine, centre[2], by[2];
} igi_motion;

static inline igi_motion igi_motion_of(const igi_photo *b, const igi_shift *s)
{
    return (igi_motion){.b = b,
                        .x = s->x,
                        .y = s->y,
                        .turned = s->angle != 0,
                        .cosine = cos(s->angle),
                        .sine = sin(s->angle),
                        .centre = {(b->width - 1) / 2., (b->height - 1) / 2.},
                        .by = {s->x + s->part_x, s->y + s->part_y}};
}

/* The place of b that shows (x,y) of a, in pixels from the centre of pixel (0,0). */
static inline void igi_motion_place(const igi_motion *m, double x, double y, double place[2])
{
    double px = x - m->centre[0], py = y - m->centre[1];
    place[0] = m->centre[0] + m->cosine * px - m->sine * py + m->by[0];
    place[1] = m->centre[1] + m->sine * px + m->cosine * py + m->by[1];
}

/* The index of the pixel of b nearest to that place; SIZE_MAX outside. */
static inline size_t igi_motion_pixel(const igi_motion *m, int x, int y)
{
    int u = x + m->x, v = y + m->y;
    if (m->turned) {
        double place[2];
        igi_motion_place(m, x, y, place);
        u = (int)lround(place[0]), v = (int)lround(place[1]);
    }
    if (u < 0 || v < 0 || u >= m->b->width || v >= m->b->height) return SIZE_MAX;
    return (size_t)v * (size_t)m->b->width + (size_t)u;
}

#endif
