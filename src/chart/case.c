/* SPDX-License-Identifier: Apache-2.0 */
#include "chart/case.h"

#include "base/vec.h"

#include <stdio.h>
#include <string.h>

/* The case's own context hears of the user's wish to stop through its progress. */
static bool go_on(void *user, const char *stage, double fraction)
{
    (void)stage;
    (void)fraction;
    return igi_progress(user, 0) == IGI_OK;
}

igi_status chart_own_context(igi_context *ctx, uint64_t seed, igi_context **own)
{
    igi_context_options o;
    igi_context_options_init(&o);
    o.threads = 1;
    o.seed = seed;
    o.progress = go_on;
    o.user = ctx;
    if (igi_context_create(&o, own) == IGI_OK) return IGI_OK;
    return igi_fail(ctx, IGI_E_SYSTEM, "no memory for a context");
}

double chart_interval_sigmas(const chart_interval *i)
{
    return fabs(i->got - i->want) / i->std;
}

static igi_status judge(igi_context *ctx, const char *region, const char *what, double got,
                        double want, double std, chart_case *c)
{
    if (!(std > 0) || isinf(std)) return IGI_OK;
    chart_interval *grown = igi_grow(ctx, c->intervals, &c->interval_capacity,
                                     c->interval_count + 1, sizeof *grown);
    if (!grown) return IGI_E_SYSTEM;
    c->intervals = grown;
    chart_interval *one = &grown[c->interval_count++];
    *one = (chart_interval){.got = got, .want = want, .std = std};
    snprintf(one->region, sizeof one->region, "%s", region);
    snprintf(one->what, sizeof one->what, "%s", what);
    return IGI_OK;
}

static const igi_material *find(const igi_materials *materials, const char *region)
{
    for (size_t i = 0; i < materials->count; i++)
        if (strcmp(materials->materials[i].region, region) == 0) return &materials->materials[i];
    return NULL;
}

/* Of a textured region the standard deviation holds its texture too: only lobes are judged. */
static igi_status judge_intervals(igi_context *ctx, const igi_materials *truth, chart_case *c)
{
    for (size_t i = 0; i < c->validation->region_count; i++) {
        const igi_region_error *e = &c->validation->regions[i];
        const igi_material *want = find(truth, e->region), *got = find(c->materials, e->region);
        if (!e->judged || e->missing || !want || !got) continue;
        for (int b = 0; b < truth->bands && !want->map && !got->textured; b++) {
            char what[24];
            snprintf(what, sizeof what, "albedo %d", b);
            IGI_TRY(judge(ctx, e->region, what, got->albedo[b], want->albedo[b], got->albedo_std[b],
                          c));
        }
        if (want->model == IGI_LAMBERT || got->model == IGI_LAMBERT) continue;
        IGI_TRY(judge(ctx, e->region, CHART_SPECULAR, got->specular, want->specular,
                      got->specular_std, c));
        IGI_TRY(judge(ctx, e->region, "alpha", got->alpha, want->alpha, got->alpha_std, c));
    }
    return IGI_OK;
}

static void add_costs(const igi_context *ctx, chart_case *c)
{
    const igi_stage *stages;
    size_t count = igi_context_stages(ctx, &stages);
    for (size_t i = 0; i < count; i++) {
        c->cpu_s += stages[i].cpu_s;
        c->rays += stages[i].rays;
        if (stages[i].peak_bytes > c->peak_bytes) c->peak_bytes = stages[i].peak_bytes;
    }
}

igi_status chart_case_recover(igi_context *ctx, const igi_scene *scene,
                              const igi_recover_options *options, uint64_t seed, chart_case *c)
{
    igi_status status = IGI_OK;
    igi_recovery *recovery = NULL;
    igi_context *own = NULL;
    *c = (chart_case){.status = IGI_OK};
    IGI_TRY(chart_own_context(ctx, seed, &own));
    c->status = igi_recover(own, scene, options, &recovery);
    add_costs(own, c);
    snprintf(c->message, sizeof c->message, "%s",
             c->status == IGI_OK ? "" : igi_context_message(own));
    bool refused = c->status == IGI_E_DATA || c->status == IGI_E_NO_ANSWER;
    if (c->status != IGI_OK && !refused) status = igi_fail(ctx, c->status, "%s", c->message);
    for (size_t f = 0; recovery && f < scene->frame_count; f++)
        c->photographs += !recovery->read || recovery->read[f];
    if (recovery) {
        c->materials = recovery->materials;
        recovery->materials = NULL;
    }
    igi_recovery_destroy(recovery);
    igi_context_destroy(own);
    return status;
}

igi_status chart_case_judge(igi_context *ctx, const igi_materials *truth, chart_case *c)
{
    if (!c->materials) return IGI_OK;
    IGI_TRY(igi_validate_materials(ctx, c->materials, truth, &c->validation));
    return judge_intervals(ctx, truth, c);
}

igi_status chart_case_run(igi_context *ctx, const igi_scene *scene, const igi_materials *truth,
                          const igi_recover_options *options, uint64_t seed, chart_case *c)
{
    IGI_TRY(chart_case_recover(ctx, scene, options, seed, c));
    igi_status status = chart_case_judge(ctx, truth, c);
    if (status != IGI_OK) chart_case_clear(c);
    return status;
}

void chart_case_clear(chart_case *c)
{
    igi_materials_destroy(c->materials);
    igi_validation_destroy(c->validation);
    igi_free(c->intervals);
    c->materials = NULL;
    c->validation = NULL;
    c->intervals = NULL;
}
