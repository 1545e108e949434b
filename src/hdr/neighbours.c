/* SPDX-License-Identifier: Apache-2.0
 *
 * The first pass over a bracket, from the shortest exposure to the longest: what neighbours tell of each
 * other, shifts, comparagrams and ratios; and by what codes are read.
 */
#include "base/file.h"
#include "hdr/bracket_private.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

#define NEARLY_SATURATED .92

static igi_status check_shape(igi_context *ctx, const char *path, const igi_photo *photo,
                              const char *first_path, const igi_photo *first)
{
    if (photo->width == first->width && photo->height == first->height &&
        photo->channels == first->channels && photo->levels == first->levels)
        return IGI_OK;
    return igi_fail(ctx, IGI_E_DATA,
                    "%s: %d x %d pixels, %d channels of %d levels, and %s has %d x %d, %d of %d; "
                    "a bracket is of one camera and one size",
                    path, photo->width, photo->height, photo->channels, photo->levels,
                    igi_file_name(first_path), first->width, first->height, first->channels,
                    first->levels);
}

static igi_response_kind choose_response(const igi_merge_options *options, const igi_photo *photo,
                                         size_t count)
{
    if (options->response != IGI_RESPONSE_AUTO) return options->response;
    if (photo->linear || photo->levels > 256) return IGI_RESPONSE_LINEAR;
    return count > 1 ? IGI_RESPONSE_RECOVERED : IGI_RESPONSE_SRGB;
}

static igi_status known_response(igi_context *ctx, igi_response_kind kind,
                                 const igi_merge_options *options, const igi_photo *photo,
                                 igi_response **response)
{
    const igi_response *given = options->given;
    if (kind == IGI_RESPONSE_GIVEN &&
        (!given || given->channels != photo->channels || given->levels != photo->levels))
        return igi_fail(ctx, IGI_E_DATA,
                        "response: it is given for %d channels of %d levels, and the photographs "
                        "have %d of %d; calibrate with such photographs",
                        given ? given->channels : 0, given ? given->levels : 0, photo->channels,
                        photo->levels);
    IGI_TRY(igi_response_create(ctx, photo->channels, photo->levels, response));
    size_t count = (size_t)photo->channels * (size_t)photo->levels;
    if (kind == IGI_RESPONSE_GIVEN) {
        memcpy((*response)->exposure, given->exposure, count * sizeof *given->exposure);
        memcpy((*response)->low, given->low, sizeof given->low);
        memcpy((*response)->high, given->high, sizeof given->high);
        (*response)->deviation = given->deviation;
    }
    for (size_t i = 0; kind == IGI_RESPONSE_SRGB && i < count; i++) {
        double v = (double)(*response)->exposure[i];
        (*response)->exposure[i] = (float)(v <= .04045 ? v / 12.92 : pow((v + .055) / 1.055, 2.4));
    }
    return IGI_OK;
}

/* First the one, then the other. */
static igi_shift add_shifts(const igi_shift *first, const igi_shift *then)
{
    double c = cos(then->angle), s = sin(then->angle);
    double x = first->x + first->part_x, y = first->y + first->part_y;
    return igi_shift_of(c * x - s * y + then->x + then->part_x,
                        s * x + c * y + then->y + then->part_y, first->angle + then->angle);
}

/* On a grid of some ten thousand pixels. */
static double measure_unsaturated(const igi_photo *photo)
{
    size_t pixels = (size_t)photo->width * (size_t)photo->height, step = pixels / 50000 + 1;
    size_t channels = (size_t)photo->channels, below = 0, seen = 0;
    for (size_t i = 0; i < pixels; i += step, seen++) {
        uint16_t highest = 0;
        for (size_t c = 0; c < channels; c++)
            if (photo->codes[i * channels + c] > highest) highest = photo->codes[i * channels + c];
        below += highest < NEARLY_SATURATED * photo->levels;
    }
    return (double)below / (double)seen;
}

/* Of the same grid; a part of the range of codes. */
static double brightest_code(const igi_photo *photo)
{
    size_t samples = (size_t)photo->width * (size_t)photo->height * (size_t)photo->channels;
    uint16_t highest = 0;
    for (size_t i = 0; i < samples; i += samples / 150000 + 1)
        if (photo->codes[i] > highest) highest = photo->codes[i];
    return (double)highest / (photo->levels - 1);
}

/* Parts of a pixel and turns are counted from the photograph in which the most pixels have their longest
 * unsaturated exposure, so that the least is resampled. Whole pixels stay counted from the shortest. */
static void keep_most_pixels(igi_bracket *bracket)
{
    size_t best = bracket->count - 1;
    double most = bracket->unsaturated[best];
    for (size_t i = 0; i + 1 < bracket->count; i++) {
        double here = bracket->unsaturated[i] - bracket->unsaturated[i + 1];
        if (here > most) most = here, best = i;
    }
    igi_shift part = bracket->shifts[best];
    double c = cos(part.angle), s = sin(part.angle);
    if (igi_shift_is_whole(&part)) return;
    /* First the inverse of p -> R p + part. */
    igi_shift back = {.part_x = -c * part.part_x - s * part.part_y,
                      .part_y = s * part.part_x - c * part.part_y,
                      .angle = -part.angle};
    for (size_t i = 0; i < bracket->count; i++)
        bracket->shifts[i] = add_shifts(&back, &bracket->shifts[i]);
    bracket->shifts[best] = (igi_shift){.x = part.x, .y = part.y};
}

/* Two neighbours: their shift, and what they say about the response or the ratio. */
static igi_status compare_neighbours(igi_context *ctx, job *j, size_t pair, const igi_photo *a,
                                     const igi_photo *b)
{
    igi_bracket *bracket = &j->bracket;
    igi_comparagram *comparagram = &bracket->pairs[pair];
    double expected = bracket->log_h[pair + 1] - bracket->log_h[pair];
    igi_shift step = {0};
    bool align = j->options->align;
    if (align) igi_hdr_align(a, b, &step);
    if (!j->response) IGI_TRY(igi_comparagram_fill(ctx, a, b, &step, 1e6, comparagram));
    if (align) IGI_TRY(igi_hdr_refine_shift(ctx, a, b, j->response, expected, comparagram, &step));
    bracket->shifts[pair + 1] = add_shifts(&bracket->shifts[pair], &step);
    if (j->response)
        return igi_hdr_measure_ratio(ctx, a, b, &step, j->response, expected,
                                     &bracket->log_ratio[pair]);
    if (igi_shift_is_whole(&step)) return IGI_OK;
    return igi_comparagram_fill(ctx, a, b, &step, 1e6, comparagram);
}

igi_status igi_hdr_compare_exposures(igi_context *ctx, job *j)
{
    igi_status status = IGI_OK;
    igi_bracket *bracket = &j->bracket;
    igi_photo *previous = NULL, *photo = NULL;
    for (size_t i = 0; i < bracket->count; i++) {
        const char *path = j->frames[i].exposure->path;
        IGI_TRY_GOTO(igi_progress(ctx, (double)i / (2 * (double)bracket->count)));
        IGI_TRY_GOTO(igi_photo_load(ctx, path, &photo));
        if (i == 0) {
            igi_response_kind kind = choose_response(j->options, photo, bracket->count);
            bracket->channels = photo->channels;
            bracket->levels = photo->levels;
            if (kind < IGI_RESPONSE_RECOVERED)
                IGI_TRY_GOTO(known_response(ctx, kind, j->options, photo, &j->response));
            j->guessed = kind == IGI_RESPONSE_SRGB && j->options->response == IGI_RESPONSE_AUTO;
            j->taken_as_linear = kind == IGI_RESPONSE_LINEAR && !photo->linear;
        } else {
            IGI_TRY_GOTO(check_shape(ctx, path, photo, j->frames[0].exposure->path, previous));
            IGI_TRY_GOTO(igi_hdr_refuse_twins(ctx, j, i, previous, photo));
            IGI_TRY_GOTO(compare_neighbours(ctx, j, i - 1, previous, photo));
        }
        bracket->unsaturated[i] = measure_unsaturated(photo);
        j->brightest = fmax(j->brightest, brightest_code(photo));
        igi_photo_destroy(previous);
        previous = photo;
        photo = NULL;
    }
    keep_most_pixels(bracket);
    j->longest = previous; /* which the second pass begins with */
    previous = NULL;
cleanup:
    igi_photo_destroy(previous);
    igi_photo_destroy(photo);
    return status;
}
