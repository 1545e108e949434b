/* SPDX-License-Identifier: Apache-2.0
 *
 * The light that a lobe mirrors is known by few rays: their noise, which the weights follow, must bias neither rho_s nor alpha, be
 * the lobe all that a pixel shows or a small part of it.
 */
#include "test.h"

#include "base/rng.h"
#include "brdf/brdf.h"
#include "specular/lobe_fit.h"

#define PIXELS 3000
#define DIRECTIONS 4 /* two, which each half looks along */
#define NOISE 0.25   /* of a direction's light */
#define SEEDS 12

typedef struct pixels {
    igi_highlights h;
    uint32_t group[PIXELS], observation[PIXELS], piece[PIXELS];
    float radiance[PIXELS], irradiance[PIXELS];
    igi_direction_sample directions[PIXELS * DIRECTIONS];
    float incident[PIXELS * DIRECTIONS];
} pixels;

static igi_vec tilted(igi_rng *rng, igi_vec about, double angle)
{
    double turn = 2 * IGI_PI * (double)igi_rng_float(rng);
    igi_vec t, b;
    igi_frame_of(about, &t, &b);
    return igi_normalize(igi_madd(igi_madd(about, t, (float)(tan(angle) * cos(turn))), b,
                                  (float)(tan(angle) * sin(turn))));
}

static void draw(pixels *p, uint64_t seed, double albedo, double specular, double alpha)
{
    for (size_t i = 0; i < PIXELS; i++) {
        igi_rng rng = igi_rng_make(seed, i);
        double light = 0.3 + (double)igi_rng_float(&rng), seen = 0;
        p->piece[i] = (uint32_t)(i % 60);
        p->irradiance[i] = (float)(IGI_PI * (0.5 + (double)igi_rng_float(&rng)));
        igi_vec out = tilted(&rng, igi_v(0, 0, 1), 0.6 * (double)igi_rng_float(&rng));
        igi_vec mirrored = igi_v(-out.x, -out.y, out.z);
        for (size_t m = 0; m < DIRECTIONS; m++) {
            size_t k = i * DIRECTIONS + m;
            double angle = (m & 1 ? 4 : 1.5) * alpha * (double)igi_rng_float(&rng);
            igi_direction_sample *d = &p->directions[k];
            *d = (igi_direction_sample){tilted(&rng, mirrored, angle), out, 0.02f, 0, 0};
            if (m >= DIRECTIONS / 2) *d = p->directions[k - DIRECTIONS / 2];
            float scale, base;
            igi_lobe_terms(IGI_WARD, (float)alpha, d->in, d->out, &scale, &base);
            seen += specular * (double)(scale * d->weight) * light;
            double off = sqrt(3) * NOISE * (2 * (double)igi_rng_float(&rng) - 1);
            p->incident[k] = (float)(light * (1 + off));
        }
        p->radiance[i] = (float)((albedo * (double)p->irradiance[i] / IGI_PI + seen) *
                                 (1 + 0.05 * (2 * (double)igi_rng_float(&rng) - 1)));
    }
    p->h = (igi_highlights){.count = PIXELS,
                            .samples = DIRECTIONS,
                            .lobe_samples = DIRECTIONS,
                            .bands = 1,
                            .groups = 1,
                            .group = p->group,
                            .observation = p->observation,
                            .piece = p->piece,
                            .radiance = p->radiance,
                            .irradiance = p->irradiance,
                            .directions = p->directions,
                            .incident = p->incident};
}

/* Means over seeds: a single fit scatters by some per cent. Before weights that follow the noise were
 * reckoned with, rho_s came out 2.4 % too high where the lobe is all that is seen. */
static void noise_does_not_bias(void)
{
    static const double albedos[] = {0, 0.03, 0.2};
    igi_context *ctx = test_context(1);
    static pixels p;
    for (size_t c = 0; c < sizeof albedos / sizeof albedos[0]; c++) {
        double specular = 0, alpha = 0;
        for (uint64_t seed = 0; seed < SEEDS; seed++) {
            igi_lobe_estimate e;
            draw(&p, seed, albedos[c], 0.3, 0.1);
            CHECK_OK(ctx, igi_lobe_fit(ctx, &p.h, IGI_WARD, 0.1, &e));
            specular += e.specular / 0.3 / SEEDS;
            alpha += e.alpha / 0.1 / SEEDS;
        }
        printf("albedo %.2f: rho_s %.4f, alpha %.4f of what they are\n", albedos[c], specular,
               alpha);
        CHECK_NEAR(specular, 1, 0.012);
        CHECK_NEAR(alpha, 1, 0.012);
    }
    igi_context_destroy(ctx);
}

TEST_MAIN({"noise_does_not_bias", noise_does_not_bias})
