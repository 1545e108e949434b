/* SPDX-License-Identifier: Apache-2.0 */
#include "recover/findings.h"

#include <math.h>
#include <string.h>

/* No dielectric mirrors more of light that falls on it at right angles (diamond .17, rutile .2), or mirrors
 * it in a colour; metals do, and nothing comes back from inside of them. */
#define METAL_SPECULAR 0.25
/* So clear must a diffuse part be: a metal that has one (dirt, flaws) is rarer than a deviation of 2. */
#define METAL_SIGMAS 2.5

/* rho_s of plastic and varnish; less goes without saying. */
#define WORTH_A_WORD 0.03

/* Where one place alone shows the highlight, nothing says how far it is off: as much as it is. */
static igi_status set_lobe_errors(igi_context *ctx, const igi_lobe_estimate *e, igi_material *m)
{
    bool known = isfinite(e->specular_std) && isfinite(e->alpha_std);
    m->specular_std = known ? e->specular_std : e->specular;
    m->alpha_std = known ? e->alpha_std : e->alpha;
    if (known) return IGI_OK;
    char *sentence;
    IGI_TRY(
        igi_strprintf(ctx, &sentence,
                      "its highlight is seen in one place alone: nothing tells how far specular "
                      "and alpha are off (their standard deviations are the values themselves); "
                      "add photographs of lamps mirrored elsewhere in it"));
    return igi_add_sentence(ctx, &m->warnings, &m->warning_count, sentence);
}

/* Share of each region's area that photographs show, and how many photographs show it. */
static igi_status measure_coverage(igi_context *ctx, const igi_problem *p, igi_materials *m)
{
    size_t regions = p->scene->region_count;
    double *area;
    IGI_TRY(IGI_ALLOC(ctx, regions, &area));
    for (uint32_t patch = 0; patch < p->patches->count; patch++) {
        if (p->patches->triangle[patch] == IGI_NO_HIT) continue;
        uint32_t r = igi_patch_region(p->patches, patch);
        double a = (double)p->patches->area[patch];
        area[r] += a;
        if (igi_problem_seen_count(p, 2 * patch) + igi_problem_seen_count(p, 2 * patch + 1) > 0)
            m->materials[r].observed += a;
    }
    for (size_t r = 0; r < regions; r++)
        if (area[r] > 0) m->materials[r].observed /= area[r];
    igi_free(area);
    const igi_observations *o = p->observations;
    bool *shown;
    IGI_TRY(IGI_ALLOC(ctx, regions, &shown));
    for (size_t f = 0; f < o->frame_count; f++) {
        memset(shown, 0, regions * sizeof *shown);
        for (size_t i = o->frame_begin[f]; i < o->frame_begin[f + 1]; i++)
            shown[p->scene->mesh.regions[igi_surface_triangle(o->surface[i])]] = true;
        for (size_t r = 0; r < regions; r++) m->materials[r].views += shown[r];
    }
    igi_free(shown);
    return IGI_OK;
}

static igi_status make_material(igi_context *ctx, const igi_problem *p, const igi_diffuse *d,
                                size_t region, igi_material *m)
{
    const igi_region *r = &p->scene->regions[region];
    IGI_TRY(igi_strdup(ctx, r->name, &m->region));
    m->emitter = r->emitter;
    m->model = IGI_LAMBERT;
    m->determined = d->determined[region];
    for (int b = 0; b < p->bands; b++) {
        m->albedo[b] = d->albedo[region][b];
        m->albedo_std[b] = d->albedo_std[region][b];
    }
    if (r->emitter || m->determined) return IGI_OK;
    char *sentence;
    IGI_TRY(
        igi_strprintf(ctx, &sentence,
                      "no photograph determines it: the albedo is a guess from the other regions; "
                      "add a photograph that shows it"));
    return igi_add_sentence(ctx, &m->warnings, &m->warning_count, sentence);
}

/* A lobe that was overlooked is at most so strong; worth a word where that is as much as varnish. */
static igi_status set_bound(igi_context *ctx, const igi_lobe_doubt *doubt, int bands,
                            igi_material *m)
{
    double bound = doubt->bound;
    for (int b = 0; b < bands; b++) bound = fmin(bound, fmax(0, 1 - m->albedo[b]));
    m->specular_std = bound / IGI_BOUND_SIGMAS;
    if (bound < WORTH_A_WORD) return IGI_OK;
    char *sentence;
    IGI_TRY(igi_strprintf(ctx, &sentence,
                          "no view sees a highlight: specular is a bound, not an estimate: at most "
                          "%.2g for alpha up to %g; add a photograph of a lamp mirrored in it",
                          bound, (double)IGI_BOUND_ALPHA));
    return igi_add_sentence(ctx, &m->warnings, &m->warning_count, sentence);
}

static igi_status set_lobe(igi_context *ctx, const igi_lobe_estimate *e, int bands, igi_material *m)
{
    m->model = e->model;
    m->specular = e->specular;
    m->alpha = e->alpha;
    IGI_TRY(set_lobe_errors(ctx, e, m));
    m->specular_is_rgb = e->colour.found;
    for (int b = 0; b < bands; b++) {
        double std = igi_lobe_coefficient_std(e, b);
        m->specular_rgb[b] = igi_lobe_coefficient(e, b);
        m->specular_rgb_std[b] = isfinite(std) ? std : m->specular_rgb[b];
    }
    char *sentence;
    if (e->alpha < (double)IGI_SHARP_ALPHA && e->alpha < IGI_BOUND_SIGMAS * e->alpha_std) {
        IGI_TRY(igi_strprintf(
            ctx, &sentence,
            "its highlight is sharper than the photographs resolve: alpha is a bound, "
            "not an estimate: at most %.2g",
            e->alpha + IGI_BOUND_SIGMAS * e->alpha_std));
        IGI_TRY(igi_add_sentence(ctx, &m->warnings, &m->warning_count, sentence));
    }
    if (e->broader != IGI_LAMBERT) {
        IGI_TRY(igi_strprintf(
            ctx, &sentence,
            "its highlights are too broad to tell lobes' families apart: %s's, with "
            "alpha above %g, may fit as well: specular and alpha are those of %s's",
            igi_model_name(e->broader), IGI_FIT_ALPHA_HIGH, igi_model_name(e->model)));
        IGI_TRY(igi_add_sentence(ctx, &m->warnings, &m->warning_count, sentence));
    }
    if (e->rival == IGI_LAMBERT && e->alike != IGI_LAMBERT) {
        IGI_TRY(igi_strprintf(ctx, &sentence,
                              "its highlights do not tell lobes' families apart: %s's, with alpha "
                              "%.2g, fits as well as %s's, which was asked for: specular and alpha "
                              "are those of %s's",
                              igi_model_name(e->alike), e->alike_alpha, igi_model_name(e->model),
                              igi_model_name(e->model)));
        return igi_add_sentence(ctx, &m->warnings, &m->warning_count, sentence);
    }
    if (e->rival == IGI_LAMBERT) return IGI_OK;
    IGI_TRY(igi_strprintf(ctx, &sentence,
                          "its highlights have the shape of %s's lobe rather than %s's, which was "
                          "asked for: specular and alpha are those of the wrong family; use "
                          "--model auto",
                          igi_model_name(e->rival), igi_model_name(e->model)));
    return igi_add_sentence(ctx, &m->warnings, &m->warning_count, sentence);
}

igi_status igi_materials_of(igi_context *ctx, const igi_problem *p, const igi_diffuse *d,
                            const igi_specular *s, igi_materials **materials)
{
    igi_status status = IGI_OK;
    igi_materials *m = NULL;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, 1, &m));
    IGI_TRY_GOTO(igi_strdup(ctx, p->scene->name, &m->scene));
    m->bands = p->bands;
    IGI_TRY_GOTO(IGI_ALLOC(ctx, p->scene->region_count, &m->materials));
    m->count = p->scene->region_count;
    for (size_t r = 0; r < m->count; r++)
        IGI_TRY_GOTO(make_material(ctx, p, d, r, &m->materials[r]));
    for (size_t r = 0; s && r < m->count; r++) {
        igi_material *one = &m->materials[r];
        if (one->emitter) continue;
        if (s->estimates[r].model != IGI_LAMBERT)
            IGI_TRY_GOTO(set_lobe(ctx, &s->estimates[r], p->bands, one));
        else if (s->doubts && one->determined)
            IGI_TRY_GOTO(set_bound(ctx, &s->doubts[r], p->bands, one));
    }
    IGI_TRY_GOTO(measure_coverage(ctx, p, m));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, p->scene->light_count, &m->lights));
    IGI_TRY_GOTO(IGI_ALLOC(ctx, p->scene->light_count, &m->light_std));
    m->light_count = p->scene->light_count;
    for (size_t k = 0; k < p->light_count; k++) {
        size_t l = p->light_of[k];
        if (k > 0 && p->light_of[k - 1] == l) continue; /* another band of an environment */
        bool split = p->scene->lights[l].type == IGI_LIGHT_ENV;
        m->lights[l] = split ? p->scene->lights[l] : p->lights[k];
        m->lights[l].file = NULL;
        if (p->lights[k].file) IGI_TRY_GOTO(igi_strdup(ctx, p->lights[k].file, &m->lights[l].file));
        memcpy(m->light_std[l], p->light_std[k], sizeof m->light_std[l]);
    }
    IGI_TRY_GOTO(igi_copy_sentences(ctx, p->scene->warnings, p->scene->warning_count, &m->warnings,
                                    &m->warning_count));
    IGI_TRY_GOTO(igi_copy_sentences(ctx, p->observations->warnings, p->observations->warning_count,
                                    &m->warnings, &m->warning_count));
    IGI_TRY_GOTO(
        igi_copy_sentences(ctx, d->warnings, d->warning_count, &m->warnings, &m->warning_count));
    *materials = m;
    m = NULL;
cleanup:
    igi_materials_destroy(m);
    return status;
}

/* Sampling without replacement: a mean over a share f of a whole is off from that of the whole by
 * (1 - f) of the variance that a mean over some of infinitely many has (Cochran 1977). */
void igi_pattern_settle(const igi_diffuse *d, igi_materials *m)
{
    for (size_t r = 0; r < m->count; r++)
        for (int b = 0; b < m->bands && m->materials[r].textured; b++) {
            double *std = &m->materials[r].albedo_std[b], pattern = d->pattern_std[r][b];
            *std = sqrt(fmax(0, *std * *std - m->materials[r].observed * pattern * pattern));
        }
}

igi_status igi_metal_settle(igi_context *ctx, int bands, igi_material *m)
{
    double most = 0;
    if (m->model == IGI_LAMBERT || m->textured) return IGI_OK;
    if (m->specular < METAL_SPECULAR && !m->specular_is_rgb) return IGI_OK;
    for (int b = 0; b < bands; b++) {
        if (m->albedo[b] > METAL_SIGMAS * m->albedo_std[b]) return IGI_OK;
        most = fmax(most,
                    fmin(1 - m->specular_rgb[b], m->albedo[b] + METAL_SIGMAS * m->albedo_std[b]));
    }
    for (int b = 0; b < bands; b++) m->albedo[b] = 0;
    char *sentence;
    IGI_TRY(igi_strprintf(ctx, &sentence,
                          "it mirrors %s metals alone do, and what is seen beside its lobe "
                          "leaves open whether there is a diffuse part (at most %.2g): none is "
                          "assumed",
                          m->specular < METAL_SPECULAR ? "in a colour, as" : "as much as",
                          fmax(0, most)));
    return igi_add_sentence(ctx, &m->warnings, &m->warning_count, sentence);
}
