/* SPDX-License-Identifier: Apache-2.0 */
#include "recover/target.h"

#include "recover/findings.h"

#include <math.h>

#define DARK_ALBEDO 0.02 /* errors of darker surfaces are judged as if they were this bright */

typedef struct mean {
    double sum, count;
} mean;

static void add(mean *m, double std, double value)
{
    if (!(value > 0) || !isfinite(std)) return;
    m->sum += std / value;
    m->count++;
}

static double value_of(const mean *m)
{
    return m->count > 0 ? m->sum / m->count : 0;
}

igi_status igi_target_judge(igi_context *ctx, double target, igi_materials *materials)
{
    mean albedo = {0, 0}, specular = {0, 0}, alpha = {0, 0};
    char *sentence;
    for (size_t r = 0; r < materials->count; r++) {
        const igi_material *m = &materials->materials[r];
        if (m->emitter || !m->determined) continue;
        for (int b = 0; b < materials->bands; b++)
            add(&albedo, m->albedo_std[b], fmax(m->albedo[b], DARK_ALBEDO));
        if (m->model == IGI_LAMBERT) continue;
        add(&specular, m->specular_std, m->specular);
        add(&alpha, m->alpha_std, m->alpha);
    }
    double worst = fmax(value_of(&albedo), fmax(value_of(&specular), value_of(&alpha)));
    if (!(target > 0) || worst <= target) return IGI_OK;
    IGI_TRY(igi_strprintf(
        ctx, &sentence,
        "an error of %.2g %% was asked for; on average one standard deviation is "
        "%.2g %% of albedo, %.2g %% of rho_s and %.2g %% of alpha (0: no lobe); a "
        "smaller --target-error spends more",
        100 * target, 100 * value_of(&albedo), 100 * value_of(&specular), 100 * value_of(&alpha)));
    return igi_add_sentence(ctx, &materials->warnings, &materials->warning_count, sentence);
}
