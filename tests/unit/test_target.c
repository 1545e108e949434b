/* SPDX-License-Identifier: Apache-2.0
 *
 * A result whose standard deviations are above the error that was asked for says so.
 */
#include "test.h"

#include "recover/target.h"

#include <string.h>

/* Warnings for such a floor, one region. */
static size_t warnings_for(double target, double albedo_std, double specular_std, double alpha_std)
{
    igi_context *ctx = test_context(1);
    igi_material floor = {.determined = true,
                          .model = IGI_WARD,
                          .albedo = {0.5},
                          .albedo_std = {albedo_std},
                          .specular = 0.1,
                          .specular_std = specular_std,
                          .alpha = 0.1,
                          .alpha_std = alpha_std};
    igi_materials materials = {.bands = 1, .count = 1, .materials = &floor};
    CHECK_OK(ctx, igi_target_judge(ctx, target, &materials));
    size_t count = materials.warning_count;
    for (size_t i = 0; i < count; i++) {
        CHECK(strstr(materials.warnings[i], "was asked for") != NULL);
        igi_free(materials.warnings[i]);
    }
    igi_free(materials.warnings);
    igi_context_destroy(ctx);
    return count;
}

static void lobes_count(void)
{
    CHECK(warnings_for(0.01, 0.004, 0.0008, 0.0008) == 0);
    CHECK(warnings_for(0.01, 0.006, 0.0008, 0.0008) == 1);
    CHECK(warnings_for(0.01, 0.004, 0.002, 0.0008) == 1);
    CHECK(warnings_for(0.01, 0.004, 0.0008, 0.002) == 1);
    CHECK(warnings_for(0, 0.4, 0.4, 0.4) == 0);
}

TEST_MAIN({"lobes_count", lobes_count})
