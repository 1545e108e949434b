/* SPDX-License-Identifier: Apache-2.0
 *
 * Inside src/hdr.
 */
#ifndef IGI_SRC_HDR_PRIVATE_H
#define IGI_SRC_HDR_PRIVATE_H

#include "hdr/hdr.h"

/* The content of the second photograph stands (x,y) pixels further right and down than in the
 * first. */
typedef struct igi_shift {
    int x, y;
} igi_shift;

/* How often code a of one photograph meets code b, of the same channel, at the same place of the
 * next longer one: counts[channels][256][256]. Codes of 16 bits are cut to 8. */
#define IGI_HDR_BINS 256
typedef struct igi_comparagram {
    uint32_t *counts;
} igi_comparagram;

/* Of every pixel, or of a regular grid of at most about `most` of them. */
IGI_MUST_USE igi_status igi_comparagram_fill(igi_context *ctx, const igi_photo *a,
                                             const igi_photo *b, igi_shift shift, double most,
                                             igi_comparagram *out);

/* Of a bracket of `count` photographs, the shortest first: pairs are (i, i+1). */
typedef struct igi_bracket {
    size_t count;
    int channels, levels;
    bool linear;
    double *log_h;          /* [count] stated, natural */
    double *log_ratio;      /* [count-1] as the pictures show it; NaN: they do not */
    igi_comparagram *pairs; /* [count-1] */
    igi_shift *shifts;      /* [count] against the shortest */
} igi_bracket;

/* The response from the comparagrams and the stated exposures; fills log_ratio. */
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
                                              const igi_photo *b, igi_shift shift,
                                              const igi_response *response, double expected,
                                              double *log_ratio);

/* Whole-pixel shift of b against a, or none where one does not make the pictures agree better. */
IGI_MUST_USE igi_status igi_hdr_align(igi_context *ctx, const igi_photo *a, const igi_photo *b,
                                      igi_shift *shift);

/* Debevec's or Robertson's method, OpenCV's: the response, and the radiance by any response. */
IGI_MUST_USE igi_status igi_hdr_compare_response(igi_context *ctx, const igi_exposure *exposures,
                                                 size_t count, bool robertson,
                                                 igi_response **response);
IGI_MUST_USE igi_status igi_hdr_compare_merge(igi_context *ctx, const igi_exposure *exposures,
                                              size_t count, const igi_response *response,
                                              bool robertson, igi_image **image);

/* The index of (x,y) in a photograph, or of the place in `b` that shows what (x,y) of `a` shows;
 * SIZE_MAX outside. */
static inline size_t igi_hdr_shifted(const igi_photo *b, int x, int y, igi_shift shift)
{
    int u = x + shift.x, v = y + shift.y;
    if (u < 0 || v < 0 || u >= b->width || v >= b->height) return SIZE_MAX;
    return (size_t)v * (size_t)b->width + (size_t)u;
}

#endif
