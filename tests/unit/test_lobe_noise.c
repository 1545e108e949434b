/* SPDX-License-Identifier: Apache-2.0
 *
 * What a few directions tell of the lobe's light is noisy, and noise in a regressor draws the
 * coefficient toward zero by var S / (var S + noise): known noise is taken out, unknown noise is not.
 */
#include "test.h"

#include "base/rng.h"
#include "specular/lobe_profile.h"

#define PIXELS 20000
#define SPECULAR 0.1
#define ALBEDO 0.4

static float radiance[PIXELS], irradiance[PIXELS], lobe[PIXELS], noise[PIXELS];
static uint32_t group[PIXELS];

static void known_noise_does_not_bias(void)
{
    igi_context *ctx = test_context(1);
    igi_highlights h = {.count = PIXELS,
                        .bands = 1,
                        .groups = 1,
                        .group = group,
                        .radiance = radiance,
                        .irradiance = irradiance};
    igi_profile f;
    igi_rng rng = igi_rng_make(5, 6);
    for (int i = 0; i < PIXELS; i++) { /* uniform: variances of 1/12 and of 1.2^2/12 */
        float s = 1 + igi_rng_float(&rng), error = 1.2f * (igi_rng_float(&rng) - 0.5f);
        irradiance[i] = 3 * (1 + igi_rng_float(&rng));
        radiance[i] = (float)(ALBEDO / IGI_PI) * irradiance[i] + (float)SPECULAR * s;
        lobe[i] = s + error;
        noise[i] = 1.2f * 1.2f / 12;
    }
    CHECK_OK(ctx, igi_profile_create(ctx, &h, &f));
    igi_profile_column column = {lobe, NULL, NULL, 1};
    igi_profile_outcome drawn = igi_profile_evaluate(&f, &column);
    column.noise = noise;
    igi_profile_outcome right = igi_profile_evaluate(&f, &column);
    CHECK(drawn.specular < 0.75 * SPECULAR && drawn.specular > 0.25 * SPECULAR);
    CHECK_NEAR(right.specular, SPECULAR, 0.003);
    CHECK_NEAR(f.albedo[0], ALBEDO, 0.01);
    CHECK_NEAR(igi_profile_noise(&f, &column), PIXELS * 0.12, 1);
    igi_profile_clear(&f);
    igi_context_destroy(ctx);
}

TEST_MAIN({"known_noise_does_not_bias", known_noise_does_not_bias})
