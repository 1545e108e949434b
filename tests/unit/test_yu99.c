/* SPDX-License-Identifier: Apache-2.0
 *
 * The 1999 algorithm: its fit on points whose light is known, and the whole on a photographed room.
 */
#include "test.h"

#include "base/rng.h"
#include "brdf/brdf.h"
#include "specular/yu99.h"

#define POINTS 240
#define LINKS 33 /* a lamp near the mirror direction, and the rest of the hemisphere */
#define BANDS 2

typedef struct made {
    igi_yu99_samples samples;
    igi_vec out[POINTS];
    float radiance[POINTS * BANDS], irradiance[POINTS * BANDS];
    igi_yu99_link link[POINTS * LINKS];
} made;

static made *make(double specular, float alpha, double noise, const double albedo[BANDS])
{
    made *m = calloc(1, sizeof *m);
    if (!m) abort();
    m->samples = (igi_yu99_samples){POINTS,      LINKS,         BANDS,  m->out,
                                    m->radiance, m->irradiance, m->link};
    igi_rng rng = igi_rng_make(5, 1);
    for (int i = 0; i < POINTS; i++) {
        float tilt = 0.9f * igi_rng_float(&rng), scale, base;
        igi_vec out = igi_v(sinf(tilt), 0, cosf(tilt));
        double gloss[BANDS] = {0};
        m->out[i] = out;
        for (int k = 0; k < LINKS; k++) {
            igi_yu99_link *link = &m->link[i * LINKS + k];
            igi_vec mirror = igi_v(-out.x, -out.y, out.z);
            float off = 0.6f * igi_rng_float(&rng), around = 6.28f * igi_rng_float(&rng);
            link->in = igi_cosine_direction(igi_v(0, 0, 1), igi_rng_float(&rng),
                                            igi_rng_float(&rng));
            link->weight = IGI_PIF / (LINKS - 1);
            if (k == 0) {
                link->in = igi_v(mirror.x + off * cosf(around), mirror.y + off * sinf(around),
                                 mirror.z);
                link->in = igi_normalize(link->in);
                link->weight = 0.002f * link->in.z;
            }
            igi_lobe_terms(IGI_WARD, alpha, link->in, out, &scale, &base);
            for (int b = 0; b < BANDS; b++) {
                link->incident[b] = k == 0 ? 150.0f : 0.5f + 0.3f * (float)b;
                m->irradiance[i * BANDS + b] += link->weight * link->incident[b];
                gloss[b] += (double)(link->weight * scale * link->incident[b]);
            }
        }
        for (int b = 0; b < BANDS; b++) {
            double l = albedo[b] * (double)m->irradiance[i * BANDS + b] / IGI_PI +
                       specular * gloss[b];
            double error = (double)(igi_rng_float(&rng) + igi_rng_float(&rng) - 1) *
                           2.449; /* var 1 */
            m->radiance[i * BANDS + b] = (float)(l * (1 + noise * error));
        }
    }
    return m;
}

static const double albedo[BANDS] = {.5, .2};

static void finds_the_lobe(void)
{
    static const double specular[3] = {.04, .1, .3};
    static const float alpha[3] = {.25f, .12f, .05f};
    igi_context *ctx = test_context(1);
    for (int k = 0; k < 3; k++) {
        made *m = make(specular[k], alpha[k], .01, albedo);
        igi_lobe_estimate e;
        CHECK_OK(ctx, igi_yu99_fit_lobe(ctx, &m->samples, &e));
        CHECK(e.model == IGI_WARD);
        CHECK_NEAR(e.specular, specular[k], fmax(4 * e.specular_std, .01 * specular[k]));
        CHECK_NEAR(e.alpha, (double)alpha[k], fmax(4 * e.alpha_std, .01 * (double)alpha[k]));
        CHECK(e.specular_std > 0 && e.specular_std < .1 * specular[k]);
        CHECK(e.alpha_std > 0 && e.alpha_std < .1 * (double)alpha[k]);
        igi_lobe lobe = {.model = IGI_WARD, .alpha = (float)e.alpha};
        for (int b = 0; b < BANDS; b++) lobe.specular[b] = (float)e.specular;
        double found[IGI_MAX_BANDS], std[IGI_MAX_BANDS];
        CHECK(igi_yu99_albedo(&m->samples, &lobe, found, std));
        for (int b = 0; b < BANDS; b++)
            CHECK_NEAR(found[b], albedo[b], .01 * albedo[b] + 4 * std[b]);
        free(m);
    }
    igi_context_destroy(ctx);
}

/* No lobe, no light, hardly a point, or photographs that are spoilt here and there. */
static void stays_sober(void)
{
    igi_context *ctx = test_context(1);
    igi_lobe_estimate e;
    made *m = make(0, .1f, .02, albedo);
    CHECK_OK(ctx, igi_yu99_fit_lobe(ctx, &m->samples, &e));
    CHECK(e.model == IGI_LAMBERT);
    memset(m->irradiance, 0, sizeof m->irradiance);
    memset(m->link, 0, sizeof m->link);
    CHECK_OK(ctx, igi_yu99_fit_lobe(ctx, &m->samples, &e));
    CHECK(e.model == IGI_LAMBERT);
    double found[IGI_MAX_BANDS], std[IGI_MAX_BANDS];
    igi_lobe none = {.model = IGI_LAMBERT};
    CHECK(!igi_yu99_albedo(&m->samples, &none, found, std));
    free(m);
    m = make(.1, .12f, .01, albedo);
    for (int i = 0; i < POINTS; i += 20) m->radiance[i * BANDS] *= 5;
    CHECK_OK(ctx, igi_yu99_fit_lobe(ctx, &m->samples, &e));
    CHECK(e.model == IGI_WARD);
    CHECK_NEAR(e.specular, .1, .006);
    CHECK_NEAR(e.alpha, .12, .006);
    m->samples.count = 5;
    CHECK_OK(ctx, igi_yu99_fit_lobe(ctx, &m->samples, &e));
    CHECK(e.model == IGI_LAMBERT);
    free(m);
    igi_context_destroy(ctx);
}

/* The cubical room, which the photographs' renderer knows the materials of. */
static void cubical_room(void)
{
    static const struct {
        const char *name;
        double albedo, specular, alpha;
    } truth[] = {{"wall_s", .35, .05, .2}, {"wall_e", .6, .12, .15}, {"wall_w", .25, .2, .05},
                 {"block_a", .7, 0, 0},    {"block_b", .3, .1, .08}, {"block_c", .5, 0, 0}};
    char path[512];
    if (!test_shared_data("scenes/cubical-room", path, sizeof path)) return;
    igi_context *ctx = test_context(2);
    igi_scene *scene = NULL;
    igi_tracer *tracer = NULL;
    igi_observations *observations = NULL;
    igi_patches *patches = NULL;
    igi_problem *problem = NULL;
    igi_diffuse *diffuse = NULL;
    igi_specular *specular = NULL;
    igi_recover_options options;
    igi_recover_options_init(&options);
    CHECK_OK(ctx, igi_scene_load(ctx, path, &scene));
    CHECK_OK(ctx, igi_tracer_create(ctx, &scene->mesh, &tracer));
    CHECK_OK(ctx, igi_observe(ctx, scene, tracer, 0, &observations));
    CHECK_OK(ctx, igi_patches_create(ctx, &scene->mesh, .04f, &patches));
    CHECK_OK(ctx,
             igi_problem_create(ctx, scene, tracer, observations, patches, &options, &problem));
    CHECK_OK(ctx, igi_diffuse_create(ctx, problem, &diffuse));
    CHECK_OK(ctx, igi_yu99_create(ctx, problem, diffuse, &specular));
    for (size_t k = 0; k < sizeof truth / sizeof truth[0]; k++) {
        size_t r = 0;
        while (r < scene->region_count && strcmp(scene->regions[r].name, truth[k].name) != 0) r++;
        CHECK(r < scene->region_count);
        const igi_lobe_estimate *e = &specular->estimates[r];
        CHECK_NEAR(diffuse->albedo[r][0], truth[k].albedo, .04 * truth[k].albedo);
        CHECK((e->model == IGI_LAMBERT) == (truth[k].specular <= 0));
        if (e->model == IGI_LAMBERT) continue;
        CHECK_NEAR(e->specular, truth[k].specular, .1 * truth[k].specular);
        CHECK_NEAR(e->alpha, truth[k].alpha, .1 * truth[k].alpha);
    }
    igi_specular_destroy(specular);
    igi_diffuse_destroy(diffuse);
    igi_problem_destroy(problem);
    igi_patches_destroy(patches);
    igi_observations_destroy(observations);
    igi_tracer_destroy(tracer);
    igi_scene_destroy(scene);
    igi_context_destroy(ctx);
}

TEST_MAIN({"cubical_room", cubical_room}, {"finds_the_lobe", finds_the_lobe},
          {"stays_sober", stays_sober})
