/* SPDX-License-Identifier: Apache-2.0
 *
 * From one frame of reference to another by points.
 */
#include "test.h"

#include <math.h>

static const igi_similarity truth = {
    .scale = 2.5, .rotation = {{0, -1, 0}, {.6, 0, -.8}, {.8, 0, .6}}, .offset = {1, -2, 3}};

static void there(const double from[3], double to[3])
{
    for (int i = 0; i < 3; i++) {
        to[i] = truth.offset[i];
        for (int k = 0; k < 3; k++) to[i] += truth.scale * truth.rotation[i][k] * from[k];
    }
}

static void known_motion(void)
{
    static const double points[4][3] = {{0, 0, 0}, {1, 0, .2}, {0, 2, 0}, {.3, .4, 3}};
    igi_context *ctx = test_context(1);
    igi_point_pair pairs[4];
    igi_similarity found;
    double rms;
    for (int i = 0; i < 4; i++) {
        memcpy(pairs[i].from, points[i], sizeof points[i]);
        there(points[i], pairs[i].to);
    }
    for (size_t count = 3; count <= 4; count++) {
        CHECK_OK(ctx, igi_similarity_fit(ctx, pairs, count, &found, &rms));
        CHECK_NEAR(rms, 0, 1e-12);
        CHECK_NEAR(found.scale, truth.scale, 1e-12);
        for (int i = 0; i < 3; i++) {
            CHECK_NEAR(found.offset[i], truth.offset[i], 1e-12);
            for (int k = 0; k < 3; k++)
                CHECK_NEAR(found.rotation[i][k], truth.rotation[i][k], 1e-12);
        }
    }
    pairs[0].to[0] += .04;
    CHECK_OK(ctx, igi_similarity_fit(ctx, pairs, 4, &found, &rms));
    CHECK(rms > .001 && rms < .04);
    igi_context_destroy(ctx);
}

static void undetermined(void)
{
    igi_context *ctx = test_context(1);
    igi_similarity found;
    double rms;
    igi_point_pair pairs[3] = {
        {{0, 0, 0}, {0, 0, 0}}, {{1, 1, 1}, {2, 2, 2}}, {{3, 3, 3}, {6, 6, 6}}};
    CHECK(igi_similarity_fit(ctx, pairs, 3, &found, &rms) == IGI_E_NO_ANSWER);
    CHECK(igi_similarity_fit(ctx, pairs, 2, &found, &rms) == IGI_E_NO_ANSWER);
    CHECK_CONTAINS(igi_context_message(ctx), "three pairs");
    igi_context_destroy(ctx);
}

static igi_status read_text(igi_context *ctx, const char *text, size_t *count)
{
    static const char name[] = "test_similarity.txt";
    igi_point_pair *pairs = NULL;
    FILE *file = fopen(name, "w");
    if (!file || fputs(text, file) < 0 || fclose(file) != 0) abort();
    igi_status status = igi_point_pairs_read(ctx, name, &pairs, count);
    igi_point_pairs_destroy(pairs);
    (void)remove(name);
    return status;
}

static void lists(void)
{
    igi_context *ctx = test_context(1);
    size_t count = 0;
    CHECK_OK(ctx, read_text(ctx, "# corners\n\n1 2 3  4 5 6 # door\n 1,2,3,4,5,6\r\n0 0 0 0 0 1",
                            &count));
    CHECK(count == 3);
    CHECK(read_text(ctx, "1 2 3 4 5 6\n1 2 3 4 5\n6 1 2 3 4 5\n", &count) == IGI_E_DATA);
    CHECK_CONTAINS(igi_context_message(ctx), "test_similarity.txt:2: not six numbers");
    CHECK(read_text(ctx, "1 2 3 4 5 6 7\n", &count) == IGI_E_DATA);
    CHECK(read_text(ctx, "1 2 3 4 5 nan\n", &count) == IGI_E_DATA);
    igi_context_destroy(ctx);
}

TEST_MAIN({"known_motion", known_motion}, {"undetermined", undetermined}, {"lists", lists})
