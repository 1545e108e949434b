/* SPDX-License-Identifier: Apache-2.0
 *
 * igi_merge: from photographs and stated exposures to one radiance image, in two passes over the
 * files. The first, from the shortest to the longest, sees neighbours side by side (neighbours.c). The
 * second adds them up.
 */
#include "base/context.h"
#include "base/vec.h"
#include "hdr/bracket_private.h"
#include "hdr/merge_private.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

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
    out->image->deviation = (float)j->response->deviation;
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
    IGI_TRY_GOTO(igi_hdr_compare_exposures(ctx, &j));
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
