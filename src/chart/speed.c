/* SPDX-License-Identifier: Apache-2.0
 *
 * Speed against accuracy.
 */
#include "chart/case.h"

igi_status igi_chart_speed(igi_context *ctx, const igi_chart_options *options, const char *folder)
{
    (void)options;
    (void)folder;
    return igi_fail(ctx, IGI_E_USAGE, "chart speed: does not exist yet");
}
