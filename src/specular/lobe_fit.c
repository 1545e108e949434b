/* SPDX-License-Identifier: Apache-2.0
 *
 * The specular coefficient and roughness of one region: lobe_search.c finds the likeliest basin,
 * lobe_polish.c its bottom. Standard deviations hold what the residuals tell, by pieces left out in
 * turn, and what they cannot (widen).
 */
#include "specular/lobe_fit.h"

#include "brdf/brdf.h"
#include "specular/lobe_colour.h"
#include "specular/lobe_polish.h"
#include "specular/lobe_search.h"

#include <string.h>

#define POLISHES 3
#define TINTS 3
#define MODEL_GAIN 10
#define MODEL_SHARE 0.02
#define NOTHING 0.5 /* of -2 ln likelihood */
#define FEWEST_RESIDUALS 10
#define FINEST_RATIO 1.003

/* Relative errors, fitted on the odd ones of rooms 1 to 49 of scripts/random_rooms and judged on the even
 * ones (to 126): what pieces of the surface tell by their scatter (they do not tell what they share: a little
 * more); what is not known of surfaces that the lobe mirrors, since they are known by patches; and what is
 * common to all pixels of a region. rho_s follows alpha some of the way. */
#define TOLD 1.15
#define BLIND_SPECULAR 0.04 /* where no lamp tells of it */
#define BLIND_ALPHA 1.4     /* likewise, times a patch over the lobe's width */
#define BLIND_POWER 4       /* the more so the less lamps tell */
#define COMMON 0.004
#define ALONG 0.7
/* Of a pixel's angle: a roughness as small is not known, since its square is what pixels blur. */
#define UNRESOLVED 0.23
#define PIXELS_ASKED 8 /* every so many for a patch's size in the lobe */

double igi_lobe_margin(const igi_lobe_estimate *e)
{
    return MODEL_GAIN + MODEL_SHARE * e->residuals;
}

/* How much of <S_perp, S_perp> lamps bring, at the table's only roughness. */
static double find_lamp_share(igi_profile *f, const igi_lobe_table *one)
{
    igi_profile_column column = igi_profile_column_of(f, one, 0);
    igi_profile_column alone = {one->lamps, NULL, NULL, f->bands};
    double all = igi_profile_evaluate(f, &column).information;
    double part = igi_profile_evaluate(f, &alone).information;
    return all > 0 ? fmin(1, fmax(0, part / all)) : 0;
}

/* A patch over the lobe's width where the lobe meets it, by what the surfaces send. */
static double patch_in_lobe(const igi_profile *f, const igi_lobe_estimate *e)
{
    const igi_highlights *h = f->h;
    double sum = 0, far = 0;
    for (size_t i = 0; i < h->count; i += PIXELS_ASKED)
        for (size_t m = 0; m < (size_t)h->lobe_samples; m++) {
            size_t k = i * (size_t)h->samples + m;
            const igi_direction_sample *d = &h->directions[k];
            float scale, base;
            if (!(d->weight > 0 && d->patches > 0 && d->in.z > 0 && d->out.z > 0)) continue;
            igi_lobe_terms(e->model, (float)e->alpha, d->in, d->out, &scale, &base);
            for (size_t b = 0; b < f->bands; b++) {
                double sent = (double)(scale * d->weight * h->incident[k * f->bands + b]);
                double carried = (double)f->weight[i * f->bands + b] * sent * sent;
                sum += carried;
                far += carried * (double)d->patches;
            }
        }
    return far > 0 ? sum / (far * e->alpha) : 0;
}

/* What the residuals do not tell. Of the surfaces that it mirrors a patch at a time is known, which hides
 * how sharp a lobe is; least is told by a highlight that is sharper than the pixels. */
static void widen(const igi_profile *f, igi_lobe_estimate *e)
{
    const igi_highlights *h = f->h;
    double sharp = pow(UNRESOLVED * (double)h->pixel_angle / e->alpha, 2);
    double blind = BLIND_ALPHA * patch_in_lobe(f, e) * pow(1 - e->alpha_lamp_share, BLIND_POWER);
    double alpha = hypot(hypot(blind, COMMON), sharp);
    double told = e->alpha_std / e->alpha;
    double specular = hypot(hypot(BLIND_SPECULAR * (1 - e->lamp_share), COMMON), ALONG * told);
    e->specular_std = hypot(TOLD * e->specular_std, specular * e->specular);
    e->alpha_std = e->alpha * hypot(TOLD * told, alpha);
    for (int b = 0; b < h->bands && h->tint; b++)
        e->colour.std[b] = hypot(TOLD * e->colour.std[b], specular * e->specular * h->tint[b]);
}

/* Takes the polished values as long as they are the likelier ones, judged by a table of their own,
 * with the weights that they ask for. *likelier: by how much. */
static igi_status take_polished(igi_context *ctx, igi_profile *f, igi_lobe_estimate *polished,
                                igi_lobe_estimate *e, double *likelier)
{
    igi_status status = IGI_OK;
    igi_lobe_table one = {.model = e->model};
    igi_lobe_estimate now = *polished;
    IGI_TRY_GOTO(igi_lobe_table_create(ctx, f->h, e->model, &polished->alpha, 1, &one));
    (void)igi_lobe_settle(f, &one, &now);
    *likelier = e->deviance - now.deviance;
    if (*likelier < -NOTHING) { /* the table's polynomials led astray */
        polished->alpha = e->alpha;
        polished->specular = e->specular;
        igi_lobe_table_clear(&one);
        IGI_TRY_GOTO(igi_lobe_table_create(ctx, f->h, e->model, &e->alpha, 1, &one));
        (void)igi_lobe_settle(f, &one, &now);
    }
    now.alpha = polished->alpha;
    now.specular = polished->specular;
    for (size_t b = 0; b < f->bands; b++) now.albedo[b] = f->albedo[b];
    igi_profile_column column = igi_profile_column_of(f, &one, 0);
    (void)igi_profile_evaluate(f, &column);
    igi_lobe_colour_look(f, &column, &now.colour);
    now.lamp_share = find_lamp_share(f, &one);
    *e = now;
cleanup:
    igi_lobe_table_clear(&one);
    return status;
}

static igi_status fit_finely(igi_context *ctx, igi_profile *f, igi_model model,
                             igi_lobe_estimate *e)
{
    igi_status status = IGI_OK;
    igi_lobe_table table = {.model = model};
    double likelier = (double)INFINITY;
    IGI_TRY_GOTO(igi_lobe_locate(ctx, f, model, FINEST_RATIO, &table, e));
    for (size_t b = 0; b < f->bands; b++) e->albedo[b] = f->albedo[b];
    for (int round = 0; round < POLISHES && likelier > NOTHING && e->specular > 0; round++) {
        igi_lobe_estimate polished = *e;
        IGI_TRY_GOTO(igi_lobe_polish(ctx, f, &table, &polished));
        IGI_TRY_GOTO(take_polished(ctx, f, &polished, e, &likelier));
    }
    if (e->specular > 0) widen(f, e);
cleanup:
    igi_lobe_table_clear(&table);
    return status;
}

/* What no lobe at all leaves, with whose weights a search begins; false: there is too little to judge by. */
static bool judge_plain(igi_profile *f, igi_model model, igi_lobe_estimate *estimate)
{
    size_t unknowns = f->h->groups * f->bands + 2;
    *estimate = (igi_lobe_estimate){.model = model, .at_bound = true};
    estimate->residuals = (double)(f->n * f->bands) - (double)unknowns;
    if (estimate->residuals < FEWEST_RESIDUALS) return false;
    igi_profile_column none = {NULL, NULL, NULL, 0};
    for (int round = 0; round < 2; round++) {
        (void)igi_profile_evaluate(f, &none);
        estimate->plain_deviance = igi_profile_reweigh(f, &none, 0, false, &estimate->noise);
    }
    estimate->plain_noise = estimate->noise;
    memcpy(f->start, f->weight, f->n * f->bands * sizeof *f->weight);
    return true;
}

igi_status igi_lobe_glance(igi_context *ctx, const igi_highlights *highlights, igi_model model,
                           igi_lobe_estimate *estimate)
{
    igi_profile f;
    IGI_TRY(igi_profile_create(ctx, highlights, &f));
    igi_status status = IGI_OK;
    igi_lobe_table table = {.model = model};
    if (!judge_plain(&f, model, estimate)) goto cleanup;
    IGI_TRY_GOTO(igi_lobe_tabulate_coarsely(ctx, &f, model, &table));
    (void)igi_lobe_settle(&f, &table, estimate);
    if (estimate->deviance > estimate->plain_deviance) { /* hardly the best that there is */
        (void)judge_plain(&f, model, estimate);
        IGI_TRY_GOTO(igi_lobe_search(ctx, &f, model, estimate));
    }
cleanup:
    igi_lobe_table_clear(&table);
    igi_profile_clear(&f);
    return status;
}

/* The same lobe in the colour that the bands ask for, where that gains enough. The tint of a lobe is told
 * by how bright it is in each band, its width by what all bands show with that tint: in turn. */
static igi_status try_colour(igi_context *ctx, const igi_highlights *highlights,
                             igi_lobe_estimate *e)
{
    igi_status status = IGI_OK;
    igi_highlights tinted = *highlights;
    double tint[IGI_MAX_BANDS];
    igi_profile f;
    igi_lobe_estimate found = *e;
    for (int b = 0; b < tinted.bands; b++) tint[b] = 1;
    tinted.tint = tint;
    IGI_TRY(igi_profile_create(ctx, &tinted, &f));
    for (int round = 0; round < TINTS && found.specular > 0; round++) {
        double mean = 0;
        for (int b = 0; b < tinted.bands; b++) {
            tint[b] *= found.colour.tint[b];
            mean += tint[b] / tinted.bands;
        }
        for (int b = 0; b < tinted.bands; b++) tint[b] /= mean;
        double near_alpha = found.alpha;
        if (!judge_plain(&f, e->model, &found)) goto cleanup;
        found.alpha = near_alpha;
        IGI_TRY_GOTO(fit_finely(ctx, &f, e->model, &found));
    }
    e->colour.gain = e->deviance - found.deviance;
    e->colour.gain = fmin(e->colour.gain, e->colour.gain + e->excused - found.excused);
    if (!(found.specular > 0) || found.at_bound > e->at_bound) goto cleanup;
    if (!(e->colour.gain > igi_lobe_colour_margin(e, tinted.bands))) goto cleanup;
    found.colour.found = true;
    found.colour.gain = e->colour.gain;
    for (int b = 0; b < tinted.bands; b++) found.colour.tint[b] = tint[b];
    *e = found;
cleanup:
    igi_profile_clear(&f);
    return status;
}

igi_status igi_lobe_fit(igi_context *ctx, const igi_highlights *highlights, igi_model model,
                        double near_alpha, igi_lobe_estimate *estimate)
{
    igi_status status = IGI_OK;
    igi_profile f;
    IGI_TRY(igi_profile_create(ctx, highlights, &f));
    if (!judge_plain(&f, model, estimate)) goto cleanup;
    estimate->alpha = near_alpha;
    if (!(near_alpha > 0)) IGI_TRY_GOTO(igi_lobe_search(ctx, &f, model, estimate));
    IGI_TRY_GOTO(fit_finely(ctx, &f, model, estimate));
    if (estimate->specular > 0 &&
        estimate->colour.gain > igi_lobe_colour_margin(estimate, highlights->bands))
        IGI_TRY_GOTO(try_colour(ctx, highlights, estimate));
cleanup:
    igi_profile_clear(&f);
    return status;
}
