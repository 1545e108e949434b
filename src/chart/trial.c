/* SPDX-License-Identifier: Apache-2.0 */
#include "chart/trial.h"

#include <ctype.h>
#include <errno.h>
#include <stdio.h>
#include <string.h>
#include <sys/stat.h>

#define SILENT_SIGMAS (3 * 1.96)

/* Its bands, and the channel in which merging marks what is saturated. */
static igi_status load_photo(igi_context *ctx, const char *path, int bands, igi_image **photo)
{
    igi_image *file = NULL;
    igi_status status = IGI_OK;
    IGI_TRY_GOTO(igi_image_load_exr(ctx, path, &file));
    IGI_TRY_GOTO(igi_image_create(ctx, file->width, file->height, bands + 1, photo));
    size_t pixels = (size_t)file->width * (size_t)file->height, n = (size_t)bands;
    for (int b = 0; b < bands; b++) {
        memcpy((*photo)->names[b], file->names[b], sizeof file->names[b]);
        for (size_t i = 0; i < pixels; i++)
            (*photo)->samples[i * (n + 1) + (size_t)b] =
                file->samples[i * (size_t)file->channels + (size_t)b];
    }
    snprintf((*photo)->names[bands], IGI_CHANNEL_NAME_SIZE, "saturated");
cleanup:
    igi_image_destroy(file);
    return status;
}

static igi_status load_photos(igi_context *ctx, chart_subject *s)
{
    IGI_TRY(IGI_ALLOC(ctx, s->scene->frame_count, &s->photos));
    IGI_TRY(IGI_ALLOC(ctx, s->scene->frame_count, &s->spoilt));
    for (size_t f = 0; f < s->scene->frame_count; f++)
        IGI_TRY(load_photo(ctx, s->scene->frames[f].path, s->scene->bands, &s->photos[f]));
    return IGI_OK;
}

/* Writes the changed photographs into a folder of their own and has the frames name them. */
static igi_status save_photos(igi_context *ctx, const char *folder, chart_subject *s)
{
    if (mkdir(folder, 0777) != 0 && errno != EEXIST)
        return igi_fail(ctx, IGI_E_SYSTEM, "%s: cannot be made (%s); check the folder above it",
                        folder, strerror(errno));
    for (size_t f = 0; f < s->scene->frame_count; f++) {
        char *path;
        igi_frame *frame = &s->scene->frames[f];
        IGI_TRY(igi_strprintf(ctx, &path, "%s/%s.exr", folder, frame->name));
        igi_free(frame->path);
        frame->path = path;
        IGI_TRY(igi_image_save_exr(ctx, s->photos[f], IGI_EXR_FLOAT, path));
    }
    return IGI_OK;
}

static void remove_photos(const char *folder, const chart_subject *s)
{
    for (size_t f = 0; f < s->scene->frame_count; f++) remove(s->scene->frames[f].path);
    remove(folder);
}

static void clear_subject(chart_subject *s, size_t photos)
{
    for (size_t f = 0; s->photos && f < photos; f++) igi_image_destroy(s->photos[f]);
    igi_free(s->photos);
    igi_free(s->spoilt);
    igi_scene_destroy(s->scene);
    igi_materials_destroy(s->truth);
}

/* Digits vary with every severity: without them, sentences can be compared. */
static void cut_digits(char *text)
{
    char *to = text;
    for (; *text; text++)
        if (!isdigit((unsigned char)*text)) *to++ = *text;
    *to = 0;
}

static igi_status add_sign(igi_context *ctx, const char *region, const char *sentence,
                           chart_trial *t)
{
    IGI_TRY(igi_strprintf(ctx, &t->signs[t->sign_count], "%s%s%s", region, region[0] ? ": " : "",
                          sentence));
    t->sign_count++;
    return IGI_OK;
}

static igi_status collect_signs(igi_context *ctx, const igi_materials *m, chart_trial *t)
{
    size_t count = m->warning_count;
    for (size_t i = 0; i < m->count; i++) count += m->materials[i].warning_count;
    IGI_TRY(IGI_ALLOC(ctx, count, &t->signs));
    for (size_t i = 0; i < m->warning_count; i++) IGI_TRY(add_sign(ctx, "", m->warnings[i], t));
    for (size_t i = 0; i < m->count; i++)
        for (size_t k = 0; k < m->materials[i].warning_count; k++)
            IGI_TRY(add_sign(ctx, m->materials[i].region, m->materials[i].warnings[k], t));
    return IGI_OK;
}

/* Takes over the intervals. */
static igi_status note_result(igi_context *ctx, chart_case *c, chart_trial *t)
{
    t->status = c->status;
    if (c->status != IGI_OK) { /* without the folders, which differ from run to run */
        const char *colon = strstr(c->message, ": "), *at = c->message;
        for (const char *p = at; colon && p < colon; p++)
            if (*p == '/') at = p + 1;
        return igi_strdup(ctx, at, &t->message);
    }
    const igi_validation *v = c->validation;
    t->albedo = v->albedo_mean;
    t->albedo_median = v->albedo_median;
    t->albedo_max = v->albedo_max;
    t->specular = v->specular_mean;
    t->alpha = v->alpha_mean;
    t->models = v->models;
    t->models_right = v->models_right;
    t->intervals = c->intervals;
    t->interval_count = c->interval_count;
    c->intervals = NULL;
    IGI_TRY(collect_signs(ctx, c->materials, t));
    return chart_relit_error(ctx, &t->room->relit, c->materials, &t->relit);
}

/* A region of which the changed views see too little is not judged. */
static void lower_judged(const chart_case *c, igi_materials *truth)
{
    for (size_t i = 0; c->materials && i < truth->count; i++)
        for (size_t k = 0; k < c->materials->count; k++) {
            const igi_material *got = &c->materials->materials[k];
            igi_material *want = &truth->materials[i];
            if (strcmp(got->region, want->region) != 0) continue;
            want->observed = fmin(want->observed, got->observed);
        }
}

static igi_status recover(igi_context *ctx, chart_subject *s, chart_trial *t)
{
    igi_status status = IGI_OK;
    chart_case c;
    igi_recover_options options;
    igi_recover_options_init(&options);
    options.patch_m = t->patch_m;
    if (t->sweep) options.model = t->sweep->model;
    IGI_TRY(chart_case_recover(ctx, s->scene, &options, t->seed, &c));
    lower_judged(&c, s->truth);
    IGI_TRY_GOTO(chart_case_judge(ctx, s->truth, &c));
    IGI_TRY_GOTO(note_result(ctx, &c, t));
cleanup:
    chart_case_clear(&c);
    return status;
}

/* Warnings about photographs begin with their names. */
static void count_named(const chart_subject *s, chart_trial *t)
{
    char start[256];
    for (size_t f = 0; s->spoilt && f < s->scene->frame_count; f++) {
        if (!s->spoilt[f]) continue;
        int length = snprintf(start, sizeof start, "image %s:", s->scene->frames[f].name);
        bool named = false;
        for (size_t i = 0; i < t->sign_count; i++)
            named |= strncmp(t->signs[i], start, (size_t)length) == 0;
        t->spoilt++;
        t->named += named;
    }
}

static igi_status run(igi_context *ctx, const char *work, chart_trial *t)
{
    igi_status status = IGI_OK;
    chart_subject s = {.seed = t->seed};
    size_t photos = 0;
    char *truth = NULL;
    const chart_perturbation *kind = t->sweep ? t->sweep->change.kind : NULL;
    IGI_TRY_GOTO(igi_strprintf(ctx, &truth, "%s/truth", t->room->folder));
    IGI_TRY_GOTO(igi_scene_load(ctx, t->room->folder, &s.scene));
    IGI_TRY_GOTO(igi_materials_load(ctx, truth, &s.truth));
    photos = s.scene->frame_count;
    if (kind && kind->photos) IGI_TRY_GOTO(load_photos(ctx, &s));
    if (kind) {
        status = kind->run(ctx, &t->sweep->change, t->sweep->severities[t->point], &s);
        t->skipped = status == IGI_E_NO_ANSWER;
        if (t->skipped) status = IGI_OK;
        if (t->skipped || status != IGI_OK) goto cleanup;
    }
    if (s.photos) IGI_TRY_GOTO(save_photos(ctx, work, &s));
    status = recover(ctx, &s, t);
    count_named(&s, t);
    if (s.photos) remove_photos(work, &s);
cleanup:
    igi_free(truth);
    clear_subject(&s, photos);
    return status;
}

igi_status chart_trial_run(igi_context *ctx, const char *work, size_t number, chart_trial *t)
{
    igi_context *own = NULL;
    char *folder = NULL;
    igi_status status = IGI_OK;
    const double none = (double)NAN;
    t->albedo = t->albedo_median = t->albedo_max = t->specular = t->alpha = t->relit = none;
    IGI_TRY_GOTO(igi_strprintf(ctx, &folder, "%s/%zu", work, number));
    IGI_TRY_GOTO(chart_own_context(ctx, t->seed, &own));
    status = run(own, folder, t);
    if (status != IGI_OK) status = igi_fail(ctx, status, "%s", igi_context_message(own));
cleanup:
    igi_context_destroy(own);
    igi_free(folder);
    return status;
}

void chart_trial_clear(chart_trial *t)
{
    for (size_t i = 0; t->signs && i < t->sign_count; i++) igi_free(t->signs[i]);
    igi_free(t->signs);
    igi_free(t->message);
    igi_free(t->intervals);
}

static bool is_alike(const char *a, const char *b)
{
    char left[1024], right[1024];
    snprintf(left, sizeof left, "%s", a);
    snprintf(right, sizeof right, "%s", b);
    cut_digits(left);
    cut_digits(right);
    return strcmp(left, right) == 0;
}

const char *chart_trial_sign(const chart_trial *t)
{
    if (t->status != IGI_OK) return t->message;
    for (size_t i = 0; i < t->sign_count; i++) {
        bool old = !t->unperturbed;
        for (size_t k = 0; !old && k < t->unperturbed->sign_count; k++)
            old = is_alike(t->signs[i], t->unperturbed->signs[k]);
        if (!old) return t->signs[i];
    }
    return NULL;
}

double chart_trial_worst(const chart_trial *t, const char *what)
{
    double worst = 0;
    for (size_t i = 0; i < t->interval_count; i++)
        if (!what || strcmp(what, t->intervals[i].what) == 0)
            worst = fmax(worst, chart_interval_sigmas(&t->intervals[i]));
    return worst;
}

size_t chart_trial_covered(const chart_trial *t)
{
    size_t n = 0;
    for (size_t i = 0; i < t->interval_count; i++)
        n += chart_interval_sigmas(&t->intervals[i]) <= CHART_HALF_INTERVAL;
    return n;
}

bool chart_trial_is_silent(const chart_trial *t)
{
    return t->status == IGI_OK && chart_trial_worst(t, NULL) > SILENT_SIGMAS &&
           !chart_trial_sign(t);
}
