/* SPDX-License-Identifier: Apache-2.0
 *
 * The kernel of the lobe fit on random small problems, no rays: never a number that is not finite,
 * never worse than a dense search over roughness. `test_lobe_fit_many COUNT FIRST` runs COUNT of them
 * from number FIRST on; a single one tells more of itself. `scripts/lobe_fits` runs a million.
 */
#include "test.h"

#include "base/rng.h"
#include "brdf/brdf.h"
#include "specular/lobe_fit.h"
#include "specular/lobe_profile.h"

#define PIXELS 24
#define DIRECTIONS 8
#define BANDS 3
#define DENSE 100

static uint64_t wanted = 2000, first;

/* Storage of one problem. */
typedef struct problem {
    igi_highlights h;
    uint32_t group[PIXELS], observation[PIXELS], piece[PIXELS];
    float radiance[PIXELS * BANDS], irradiance[PIXELS * BANDS];
    igi_direction_sample directions[PIXELS * DIRECTIONS];
    float incident[PIXELS * DIRECTIONS * BANDS];
    igi_model model;
    double noise;
} problem;

static double uniform(igi_rng *rng, double low, double high)
{
    return low + (high - low) * (double)igi_rng_float(rng);
}

static igi_vec direction(igi_rng *rng)
{
    return igi_cosine_direction(igi_v(0, 0, 1), igi_rng_float(rng), igi_rng_float(rng));
}

/* A direction about the mirrored one, as lamps that are seen in a surface are. */
static igi_vec about_mirror(igi_rng *rng, igi_vec out, float spread)
{
    igi_vec mirrored = igi_v(-out.x, -out.y, out.z), d = direction(rng);
    igi_vec in = igi_normalize(igi_madd(mirrored, igi_sub(d, mirrored), spread));
    return in.z > 0.05f ? in : mirrored;
}

static void add_lobe(problem *p, size_t i, double specular, double alpha)
{
    for (size_t m = 0; m < DIRECTIONS; m++) {
        const igi_direction_sample *d = &p->directions[i * DIRECTIONS + m];
        float scale, base;
        igi_lobe_terms(p->model, (float)alpha, d->in, d->out, &scale, &base);
        for (size_t b = 0; b < BANDS; b++)
            p->radiance[i * BANDS + b] += ((float)specular * scale + base) * d->weight *
                                          p->incident[(i * DIRECTIONS + m) * BANDS + b];
    }
}

/* Everything is drawn: geometry, light, materials, noise from none to plenty, groups, and now and
 * then nothing to go by at all. */
static void draw(problem *p, uint64_t number)
{
    igi_rng rng = igi_rng_make(7, number);
    size_t n = (size_t)uniform(&rng, 1, PIXELS + 1);
    bool grouped = igi_rng_float(&rng) < 0.3f;
    double albedo[BANDS], specular = pow(10, uniform(&rng, -3, 0)), group = 0;
    double alpha = exp(uniform(&rng, log(0.005), log(0.8)));
    float bright = (float)pow(10, uniform(&rng, -2, 4));
    memset(p, 0, sizeof *p);
    p->model = (igi_model)(IGI_WARD + (int)uniform(&rng, 0, 3));
    p->noise = igi_rng_float(&rng) < 0.2f ? 0 : pow(10, uniform(&rng, -4, -0.5));
    if (igi_rng_float(&rng) < 0.3f) specular = 0;
    if (p->model == IGI_GGX) specular = fmin(specular, 0.9);
    for (size_t b = 0; b < BANDS; b++) albedo[b] = uniform(&rng, 0, 0.9);
    for (size_t i = 0; i < n; i++) {
        igi_vec out = direction(&rng);
        if (i > 0 && grouped && igi_rng_float(&rng) < 0.3f) group++;
        p->group[i] = (uint32_t)group;
        p->piece[i] = (uint32_t)uniform(&rng, 0, 6);
        for (size_t m = 0; m < DIRECTIONS; m++) {
            igi_direction_sample *d = &p->directions[i * DIRECTIONS + m];
            *d = (igi_direction_sample){about_mirror(&rng, out, igi_rng_float(&rng)), out, 0, 0, 0};
            d->weight = igi_rng_float(&rng) < 0.1f ? 0 : (float)uniform(&rng, 0, 0.05);
            for (size_t b = 0; b < BANDS; b++)
                p->incident[(i * DIRECTIONS + m) * BANDS + b] = bright * igi_rng_float(&rng);
        }
        for (size_t b = 0; b < BANDS; b++) {
            float *e = &p->irradiance[i * BANDS + b];
            *e = igi_rng_float(&rng) < 0.02f ? 0 : bright * (float)uniform(&rng, 0.01, 0.2);
            p->radiance[i * BANDS + b] = (float)(albedo[b] / IGI_PI) * *e;
        }
        add_lobe(p, i, specular, alpha);
        for (size_t b = 0; b < BANDS; b++)
            p->radiance[i * BANDS + b] *= (float)(1 + p->noise * uniform(&rng, -1.7, 1.7));
    }
    p->h = (igi_highlights){.count = n,
                            .samples = DIRECTIONS,
                            .bands = BANDS,
                            .groups = (size_t)group + 1,
                            .group = p->group,
                            .observation = p->observation,
                            .piece = p->piece,
                            .radiance = p->radiance,
                            .irradiance = p->irradiance,
                            .directions = p->directions,
                            .incident = p->incident};
}

static bool is_finite(const igi_lobe_estimate *e)
{
    bool finite = isfinite(e->specular) && isfinite(e->alpha) && isfinite(e->deviance) &&
                  isfinite(e->plain_deviance) && isfinite(e->noise) && isfinite(e->lamp_share);
    for (size_t b = 0; b < BANDS; b++) finite = finite && isfinite(e->albedo[b]);
    return finite && !isnan(e->specular_std) && !isnan(e->alpha_std); /* infinite: not known */
}

/* The best that one roughness allows; `settle`: with weights of its own, else with those there are. */
static igi_profile_outcome fit_at(igi_context *ctx, igi_profile *f, igi_model model, double alpha,
                                  bool settle, double *deviance)
{
    igi_lobe_table table;
    double noise;
    CHECK_OK(ctx, igi_lobe_table_create(ctx, f->h, model, &alpha, 1, &table));
    igi_profile_column c = igi_profile_column_of(f, &table, 0);
    for (size_t k = 0; k < f->n * f->bands && settle; k++) f->weight[k] = 1;
    igi_profile_outcome o = igi_profile_evaluate(f, &c);
    for (int i = 0; i < 4 && settle; i++) {
        *deviance = igi_profile_reweigh(f, &c, o.specular, i > 0, &noise);
        o = igi_profile_evaluate(f, &c);
    }
    igi_lobe_table_clear(&table);
    return o;
}

/* How much better the best of many roughnesses fits than the one that was found, with the weights of
 * the latter, and how much likelier it is with weights of its own (than the lobe that was found, or
 * than none where the fit calls that likelier): the lesser of both, in units of -2 ln likelihood. A
 * thousandth of what the lobe explains is forgiven: tables are interpolated. */
static double excess(igi_context *ctx, const problem *p, const igi_lobe_estimate *e, double *at)
{
    const igi_profile_column none = {NULL, NULL, NULL, 0};
    igi_profile f;
    double top = p->model == IGI_PHONG ? 1 : IGI_FIT_ALPHA_HIGH, worst = 0;
    double deviance, other;
    CHECK_OK(ctx, igi_profile_create(ctx, &p->h, &f));
    double found = fit_at(ctx, &f, p->model, e->alpha, true, &deviance).misfit;
    double explained = igi_profile_evaluate(&f, &none).misfit - found;
    for (int a = 0; a < DENSE; a++) {
        double alpha = IGI_FIT_ALPHA_LOW * pow(top / IGI_FIT_ALPHA_LOW, a / (DENSE - 1.0));
        double better = found - fit_at(ctx, &f, p->model, alpha, false, &other).misfit;
        if (!(better > worst)) continue;
        worst = better;
        *at = alpha;
    }
    if (wanted == 1)
        printf(
            "found: alpha %.6g, misfit %.6g of %.6g without a lobe, deviance %.6g (its own %.6g, "
            "%.6g without); least misfit at %.6g: %.6g less\n",
            e->alpha, found, found + explained, deviance, e->deviance, e->plain_deviance, *at,
            worst);
    worst -= 1e-3 * fmax(0, explained);
    if (worst > 1) {
        (void)fit_at(ctx, &f, p->model, *at, true, &other);
        deviance = fmin(deviance, fmin(e->deviance, e->plain_deviance));
        if (wanted == 1) printf("deviance there %.6g\n", other);
        worst = fmin(worst, deviance - other);
    }
    igi_profile_clear(&f);
    return worst;
}

static void never_worse(void)
{
    igi_context *ctx = test_context(1);
    uint64_t worse = 0, judged = 0;
    for (uint64_t i = first; i < first + wanted; i++) {
        problem p;
        igi_lobe_estimate e;
        double alpha = 0;
        draw(&p, i);
        CHECK_OK(ctx, igi_lobe_fit(ctx, &p.h, p.model, 0, &e));
        CHECK(is_finite(&e));
        if (!(e.residuals >= 10) || !(e.specular > 0)) continue;
        judged++;
        double much = excess(ctx, &p, &e, &alpha);
        if (much <= 1) continue;
        worse++;
        if (worse > 50) continue;
        printf("problem %llu: %s, %zu pixels: alpha %.4g, rho_s %.3g; %.3g likelier at %.4g\n",
               (unsigned long long)i, igi_model_name(p.model), p.h.count, e.alpha, e.specular, much,
               alpha);
    }
    printf("%llu problems, %llu judged, %llu worse than a dense search\n",
           (unsigned long long)wanted, (unsigned long long)judged, (unsigned long long)worse);
    CHECK(judged > wanted / 3 || wanted < 100);
    CHECK(worse == 0);
    igi_context_destroy(ctx);
}

int main(int argc, char **argv)
{
    if (argc > 1) wanted = strtoull(argv[1], NULL, 10);
    if (argc > 2) first = strtoull(argv[2], NULL, 10);
    never_worse();
    printf("%d checks, %d failures\n", test_checks, test_failures);
    return test_failures > 0;
}
