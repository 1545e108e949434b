/* SPDX-License-Identifier: Apache-2.0
 *
 * Light that strays about what is bright: what a picture shines around a place, and whether places are
 * brighter by it.
 */
#include "test.h"

#include "base/rng.h"
#include "observe/glare.h"

static void around_a_lamp(void)
{
    igi_context *ctx = test_context(1);
    igi_image *image = NULL;
    float glow[IGI_GLOW_CELLS];
    static const int size[2] = {160, 120};
    CHECK_OK(ctx, igi_image_create(ctx, 160, 120, 3, &image));
    for (int i = 0; i < 160 * 120 * 3; i++) image->samples[i] = 1;
    image->samples[0] = NAN;
    igi_glow_measure(image, 3, glow);
    CHECK_NEAR((double)igi_glow_at(glow, size, 60 * 160 + 80), 3, .03);
    CHECK_NEAR((double)igi_glow_at(glow, size, 60 * 160), 1.8,
               .1); /* beyond the picture it is dark */
    for (int i = 0; i < 160 * 120 * 3; i++) image->samples[i] = i / 3 == 60 * 160 + 80;
    igi_glow_measure(image, 3, glow);
    double at = (double)igi_glow_at(glow, size, 60 * 160 + 80);
    double off = (double)igi_glow_at(glow, size, 60 * 160 + 120); /* two bells away */
    CHECK(at > 0 && off < .3 * at && off > .05 * at);
    igi_image_destroy(image);
    igi_context_destroy(ctx);
}

enum { REGIONS = 4, PLACES = 200, FRAMES = 12 };

/* The sentence about places that are brighter by `share` of what shines around them; NULL: none. */
static char *sentence_about(igi_context *ctx, double share, uint64_t seed)
{
    static uint32_t region[PLACES];
    static size_t begin[PLACES + 1];
    static igi_glimpse glimpses[PLACES * FRAMES];
    const igi_glimpses g = {.place_count = PLACES,
                            .region = region,
                            .begin = begin,
                            .count = PLACES * FRAMES,
                            .glimpses = glimpses};
    const igi_scene scene = {.region_count = REGIONS};
    igi_observations o = {.frame_count = FRAMES};
    igi_rng rng = igi_rng_make(seed, 3);
    for (uint32_t p = 0; p < PLACES; p++) {
        double light = .2 + (double)igi_rng_float(&rng);
        region[p] = p % REGIONS;
        begin[p + 1] = (size_t)(p + 1) * FRAMES;
        for (uint32_t f = 0; f < FRAMES; f++) {
            double glow = 3 * (double)igi_rng_float(&rng);
            double noise = 1 + .04 * ((double)igi_rng_float(&rng) - .5);
            double seen = ((1 - share) * light + share * glow) * noise;
            glimpses[p * FRAMES + f] = (igi_glimpse){p, f, (float)log(seen), .01f, (float)glow};
        }
    }
    CHECK_OK(ctx, igi_observations_tell_uneven_veil(ctx, &scene, &g, &o));
    char *sentence = o.warning_count ? o.warnings[0] : NULL;
    free(o.warnings);
    return sentence;
}

static void what_strays_is_said(void)
{
    igi_context *ctx = test_context(1);
    for (uint64_t seed = 0; seed < 8; seed++) {
        char *sentence = sentence_about(ctx, .05, seed);
        CHECK_CONTAINS(sentence ? sentence : "", ": 5.");
        CHECK_CONTAINS(sentence ? sentence : "", "strays around what is bright");
        free(sentence);
        sentence = sentence_about(ctx, 0, seed);
        CHECK(!sentence);
        free(sentence);
    }
    igi_context_destroy(ctx);
}

TEST_MAIN({"around_a_lamp", around_a_lamp}, {"what_strays_is_said", what_strays_is_said})
