/* SPDX-License-Identifier: Apache-2.0
 *
 * Stability where the method's assumptions fail.
 */
#include "chart/case.h"

void igi_chart_options_init(igi_chart_options *options)
{
    *options = (igi_chart_options){.struct_size = sizeof *options,
                                   .datasets = "datasets-synthetic"};
}

igi_status igi_chart_stability(igi_context *ctx, const igi_chart_options *options,
                               const char *folder, igi_stability **result)
{
    (void)options;
    (void)folder;
    *result = NULL;
    return igi_fail(ctx, IGI_E_USAGE, "chart stability: does not exist yet");
}

void igi_stability_destroy(igi_stability *stability)
{
    if (!stability) return;
    for (size_t i = 0; stability->sweeps && i < stability->sweep_count; i++) {
        igi_sweep_result *s = &stability->sweeps[i];
        igi_free(s->name);
        igi_free(s->about);
        igi_free(s->label);
        igi_free(s->unit);
        igi_free(s->points);
    }
    igi_free(stability->sweeps);
    igi_free(stability);
}
