/* SPDX-License-Identifier: Apache-2.0
 *
 * igi_merge: from photographs and stated exposures to one radiance image, in two passes over the
 * files. The first, from the shortest to the longest, sees neighbours side by side: shifts,
 * comparagrams, ratios. The second adds them up.
 */
#include "base/file.h"
#include "base/vec.h"
#include "hdr/bracket_private.h"
#include "hdr/merge_private.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define NEARLY_SATURATED .92

static int by_exposure(const void *a, const void *b)
{
    const ordered *x = a, *y = b;
    if (x->h != y->h) return x->h < y->h ? -1 : 1;
    return (x->given > y->given) - (x->given < y->given);
}

static igi_status order_exposures(igi_context *ctx, const igi_exposure *exposures, size_t count,
                                  ordered *frames)
{
    for (size_t i = 0; i < count; i++) {
        const igi_exposure *e = &exposures[i];
        if (!(e->time_s > 0 && e->time_s < 1e6) ||
            (e->f_number > 0) != (exposures[0].f_number > 0) ||
            (e->iso > 0) != (exposures[0].iso > 0))
            return igi_fail(ctx, IGI_E_DATA,
                            "%s: its exposure time is not positive, or it alone has, or lacks, an "
                            "f-number or ISO; state the same of all photographs",
                            e->path);
        frames[i] = (ordered){e, igi_hdr_exposure(e), i};
    }
    qsort(frames, count, sizeof *frames, by_exposure);
    return IGI_OK;
}

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
    if (align) IGI_TRY(igi_hdr_align(ctx, a, b, &step));
    if (!j->response) IGI_TRY(igi_comparagram_fill(ctx, a, b, &step, 1e6, comparagram));
    if (align) IGI_TRY(igi_hdr_refine_shift(ctx, a, b, j->response, expected, comparagram, &step));
    bracket->shifts[pair + 1] = add_shifts(&bracket->shifts[pair], &step);
    if (j->response)
        return igi_hdr_measure_ratio(ctx, a, b, &step, j->response, expected,
                                     &bracket->log_ratio[pair]);
    if (igi_shift_is_whole(&step)) return IGI_OK;
    return igi_comparagram_fill(ctx, a, b, &step, 1e6, comparagram);
}

static igi_status first_pass(igi_context *ctx, job *j)
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

/* What the pictures say replaces what is stated; the mean logarithm, and so the unit, stays. */
static void use_measured_ratios(igi_bracket *bracket)
{
    double sum = 0, stated = 0, at = bracket->log_h[0], before = bracket->log_h[0];
    for (size_t i = 0; i < bracket->count; i++) {
        double here = bracket->log_h[i];
        if (i > 0) {
            double seen = bracket->log_ratio[i - 1];
            at += isnan(seen) ? here - before : seen;
        }
        before = here;
        stated += here;
        sum += at;
        bracket->log_h[i] = at;
    }
    for (size_t i = 0; i < bracket->count; i++)
        bracket->log_h[i] += (stated - sum) / (double)bracket->count;
}

/* The curve again, from few functions. */
static igi_status fit_basis(igi_context *ctx, job *j)
{
    double(*table)[IGI_HDR_TABLE] = NULL;
    if (j->options->response == IGI_RESPONSE_EMOR) {
        if (!j->options->basis_path)
            return igi_fail(ctx, IGI_E_USAGE,
                            "response: the EMoR model needs its table; give invemor.txt");
        IGI_TRY(igi_hdr_load_basis(ctx, j->options->basis_path, &table));
    }
    igi_status status = igi_hdr_fit_basis(ctx, &j->bracket, (const double(*)[IGI_HDR_TABLE])table,
                                          j->response);
    igi_free(table);
    return status;
}

/* Ratios seen through a response that was fitted to the same pictures are checks, no better
 * values: film and phones bend such a curve by more than a camera rounds its times. */
static igi_status settle_exposures(igi_context *ctx, job *j, char **warning)
{
    igi_bracket *bracket = &j->bracket;
    if (bracket->count < 2 && !j->response)
        return igi_fail(ctx, IGI_E_DATA,
                        "%s: one photograph alone tells no response; give it, or "
                        "say --response srgb",
                        j->frames[0].exposure->path);
    if (bracket->count < 2) return IGI_OK;
    j->fitted = !j->response;
    if (j->fitted) IGI_TRY(igi_hdr_recover_response(ctx, bracket, &j->response));
    IGI_TRY(igi_hdr_judge_exposures(ctx, j, warning));
    if (j->options->response == IGI_RESPONSE_POLYNOMIAL ||
        j->options->response == IGI_RESPONSE_EMOR)
        return fit_basis(ctx, j);
    if (!j->fitted && j->options->refine) use_measured_ratios(bracket);
    if (j->options->response != IGI_RESPONSE_DEBEVEC &&
        j->options->response != IGI_RESPONSE_ROBERTSON)
        return IGI_OK;
    igi_response_destroy(j->response);
    return igi_hdr_compare_response(ctx, j->exposures, bracket->count,
                                    j->options->response == IGI_RESPONSE_ROBERTSON, &j->response);
}

static igi_status second_pass(igi_context *ctx, job *j, igi_merged *out)
{
    igi_status status = IGI_OK;
    const igi_bracket *bracket = &j->bracket;
    const igi_merge_options *o = j->options;
    noise_model model = {o->full_well_e > 0 ? o->full_well_e : 5000, o->read_noise, j->fitted};
    accumulator *acc = NULL;
    igi_photo *photo = NULL;
    if (!(model.read_noise > 0)) model.read_noise = bracket->levels == 256 ? 2.5 : 12;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &acc));
    for (size_t i = bracket->count; i-- > 0;) {
        igi_merged_frame *frame = &out->frames[j->frames[i].given];
        IGI_TRY_GOTO(igi_progress(ctx, 1 - (double)(i + 1) / (2 * (double)bracket->count)));
        photo = j->longest;
        j->longest = NULL;
        if (!photo) IGI_TRY_GOTO(igi_photo_load(ctx, j->frames[i].exposure->path, &photo));
        if (!acc->image)
            IGI_TRY_GOTO(igi_accumulator_prepare(ctx, photo, j->response, &model, acc));
        frame->used = exp(bracket->log_h[i]);
        const igi_shift *shift = &bracket->shifts[i];
        frame->shift_x = shift->x + shift->part_x;
        frame->shift_y = shift->y + shift->part_y;
        frame->rotation_deg = shift->angle * 180 / IGI_PI;
        igi_accumulator_add(acc, photo, j->response, frame->used, shift);
        frame->saturated = (double)acc->saturated / (double)(acc->samples ? acc->samples : 1);
        frame->moved = (double)acc->moved * acc->channels /
                       (double)(acc->samples ? acc->samples : 1);
        igi_photo_destroy(photo);
        photo = NULL;
    }
    out->scatter = igi_accumulator_finish(acc, exp(bracket->log_h[0]), o->full_well_e > 0);
    out->image = acc->image;
    acc->image = NULL;
cleanup:
    if (acc) igi_accumulator_free(acc);
    igi_free(acc);
    igi_photo_destroy(photo);
    return status;
}

static igi_status prepare_job(igi_context *ctx, const igi_exposure *exposures, size_t count, job *j)
{
    IGI_TRY(IGI_ALLOC(ctx, count, &j->frames));
    IGI_TRY(order_exposures(ctx, exposures, count, j->frames));
    j->bracket.count = count;
    IGI_TRY(IGI_ALLOC(ctx, count, &j->bracket.log_h));
    IGI_TRY(IGI_ALLOC(ctx, count, &j->bracket.log_ratio));
    IGI_TRY(IGI_ALLOC(ctx, count, &j->bracket.pairs));
    IGI_TRY(IGI_ALLOC(ctx, count, &j->bracket.shifts));
    IGI_TRY(IGI_ALLOC(ctx, count, &j->bracket.unsaturated));
    for (size_t i = 0; i < count; i++) j->bracket.log_h[i] = log(j->frames[i].h);
    return IGI_OK;
}

static void free_job(job *j)
{
    for (size_t i = 0; j->bracket.pairs && i < j->bracket.count; i++)
        igi_free(j->bracket.pairs[i].counts);
    igi_free(j->bracket.pairs);
    igi_free(j->bracket.log_h);
    igi_free(j->bracket.log_ratio);
    igi_free(j->bracket.shifts);
    igi_free(j->bracket.unsaturated);
    igi_free(j->frames);
    igi_photo_destroy(j->longest);
    igi_response_destroy(j->response);
}

igi_status igi_merge(igi_context *ctx, const igi_exposure *exposures, size_t count,
                     const igi_merge_options *options, igi_merged **merged)
{
    igi_status status = IGI_OK;
    igi_merge_options defaults;
    igi_merged *made = NULL;
    job j = {0};
    *merged = NULL;
    if (count < 1) return igi_fail(ctx, IGI_E_USAGE, "merge: no photographs; name at least one");
    igi_merge_options_init(&defaults);
    j.options = options ? options : &defaults;
    j.exposures = exposures;
    igi_stage_begin(ctx, "merge");
    IGI_TRY_GOTO(prepare_job(ctx, exposures, count, &j));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &made));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, count, &made->frames));
    made->count = count;
    for (size_t i = 0; i < count; i++) made->frames[i].stated = igi_hdr_exposure(&exposures[i]);
    IGI_TRY_GOTO(first_pass(ctx, &j));
    IGI_TRY_GOTO(igi_hdr_judge_light(ctx, &j, &made->warning));
    IGI_TRY_GOTO(settle_exposures(ctx, &j, &made->warning));
    if (j.options->method == IGI_MERGE_PHOTON) IGI_TRY_GOTO(second_pass(ctx, &j, made));
    else
        IGI_TRY_GOTO(igi_hdr_compare_merge(ctx, exposures, count, j.response,
                                           j.options->method == IGI_MERGE_ROBERTSON, &made->image));
    made->response = j.response;
    j.response = NULL;
    *merged = made;
    made = NULL;
cleanup:
    igi_stage_begin(ctx, NULL);
    igi_merged_destroy(made);
    free_job(&j);
    return status;
}
