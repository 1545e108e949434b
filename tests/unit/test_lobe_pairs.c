/* SPDX-License-Identifier: Apache-2.0
 *
 * A lobe's values for many pairs at once agree with those of one pair.
 */
#include "test.h"

#include "base/rng.h"
#include "brdf/lobe_pairs.h"

#define PAIRS 500

static void compare(igi_context *ctx, igi_model model)
{
    static const float alphas[] = {0.001f, 0.004f, 0.02f, 0.07f, 0.2f, 0.5f, 1.0f};
    igi_lobe_pairs p;
    igi_vec in[PAIRS], out[PAIRS];
    igi_rng rng = igi_rng_make(7, (uint64_t)model);
    CHECK_OK(ctx, igi_lobe_pairs_create(ctx, model, PAIRS, &p));
    for (int i = 0; i < PAIRS; i++) {
        float u = igi_rng_float(&rng), v = igi_rng_float(&rng);
        out[i] = igi_cosine_direction(igi_v(0, 0, 1), u, v);
        u = igi_rng_float(&rng), v = igi_rng_float(&rng);
        float width = alphas[i % 7]; /* about the mirror direction, as near as lobes are narrow */
        do in[i] = igi_lobe_sample(IGI_WARD, width, out[i], u *= 0.9f, v);
        while (!(in[i].z > 0));
        igi_lobe_pairs_add(&p, in[i], out[i]);
    }
    igi_lobe_pairs_pad(&p);
    CHECK(p.count % IGI_LOBE_LANES == 0 && p.count >= PAIRS && p.count <= p.room);
    igi_lobe_pairs_prepare(&p);
    for (size_t a = 0; a < sizeof alphas / sizeof *alphas; a++) {
        igi_lobe_pairs_evaluate(&p, alphas[a], 0, p.count);
        for (size_t i = 0; i < PAIRS; i++) {
            float scale, base, peak, rest, share = model == IGI_GGX ? p.schlick[i] : 0;
            igi_vec mirror = igi_v(-out[i].x, -out[i].y, out[i].z);
            igi_lobe_terms(model, alphas[a], in[i], out[i], &scale, &base);
            igi_lobe_terms(model, alphas[a], mirror, out[i], &peak, &rest);
            /* cut where e^-30 is left */
            double near = 2e-4 * (double)(scale + base) + 1e-12 * (double)(peak + rest);
            CHECK_NEAR((double)(p.values[i] * (1 - share)), (double)scale, near);
            CHECK_NEAR((double)(p.values[i] * share), (double)base, near);
        }
    }
    igi_lobe_pairs_clear(&p);
}

static void agree(void)
{
    igi_context *ctx = test_context(1);
    compare(ctx, IGI_WARD);
    compare(ctx, IGI_GGX);
    compare(ctx, IGI_PHONG);
    igi_context_destroy(ctx);
}

TEST_MAIN({"agree", agree})
