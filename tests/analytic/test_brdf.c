/* SPDX-License-Identifier: Apache-2.0
 *
 * The lobes: energy, reciprocity, closed forms, and samples against their density.
 */
#include "test.h"

#include "base/rng.h"
#include "brdf/brdf.h"

static const igi_model models[] = {IGI_LAMBERT, IGI_WARD, IGI_GGX, IGI_PHONG};
static const char *const model_names[] = {"lambert", "ward", "ggx", "phong"};
static const float alphas[] = {.01f, .03f, .1f, .3f, .6f, 1};
static const float angles_deg[] = {0, 30, 60, 80, 87};
enum { MODELS = 4, ALPHAS = 6, ANGLES = 5 };

static igi_vec direction(float theta, float phi)
{
    return igi_v(sinf(theta) * cosf(phi), sinf(theta) * sinf(phi), cosf(theta));
}

static igi_vec out_at(int angle)
{
    return direction(angles_deg[angle] * IGI_PIF / 180, .7f);
}

/* Cells around the mirror direction, as fine as the lobe: tan(theta/2) = width s/(1-s). */
enum { RINGS = 40, SECTORS = 16, CELLS = RINGS * SECTORS, FINE = 12 };

typedef struct polar {
    igi_vec axis, t, b;
    double width;
} polar;

static polar polar_of(igi_model model, float alpha, igi_vec out)
{
    polar p = {.axis = igi_v(-out.x, -out.y, out.z),
               .width = model == IGI_LAMBERT ? 1 : (double)alpha};
    igi_frame_of(p.axis, &p.t, &p.b);
    return p;
}

/* The direction at (s, turn) of the unit square, and the solid angle per area of that square. */
static igi_vec polar_direction(const polar *p, double s, double turn, double *solid_angle)
{
    double q = p->width * s / (1 - s), theta = 2 * atan(q), phi = 2 * IGI_PI * turn;
    *solid_angle = sin(theta) * 2 / (1 + q * q) * p->width / ((1 - s) * (1 - s)) * 2 * IGI_PI;
    float sine = (float)sin(theta);
    igi_vec d = igi_madd(igi_scale(p->axis, (float)cos(theta)), p->t, sine * (float)cos(phi));
    return igi_normalize(igi_madd(d, p->b, sine * (float)sin(phi)));
}

static int polar_cell(const polar *p, igi_vec d)
{
    igi_vec apart = igi_sub(d, p->axis), sum = igi_add(d, p->axis);
    double q = sqrt((double)igi_dot(apart, apart) / fmax(1e-30, (double)igi_dot(sum, sum)));
    double s = q / (q + p->width);
    double turn = (double)atan2f(igi_dot(d, p->b), igi_dot(d, p->t)) / (2 * IGI_PI);
    int ring = (int)(s * RINGS), sector = (int)((turn - floor(turn)) * SECTORS);
    return (ring < RINGS ? ring : RINGS - 1) * SECTORS + (sector < SECTORS ? sector : SECTORS - 1);
}

/* Integrals over each cell of the density, and over all of f cos with rho_s = 1. */
static double integrate(igi_model model, float alpha, igi_vec out, double *mass)
{
    polar p = polar_of(model, alpha, out);
    double albedo = 0;
    for (int c = 0; c < CELLS; c++) {
        mass[c] = 0;
        for (int k = 0; k < FINE * FINE; k++) {
            double s = (c / SECTORS + (k / FINE + .5) / FINE) / RINGS;
            double turn = (c % SECTORS + (k % FINE + .5) / FINE) / SECTORS, solid_angle;
            igi_vec in = polar_direction(&p, s, turn, &solid_angle);
            double weight = solid_angle / ((double)CELLS * FINE * FINE);
            float scale, base;
            igi_lobe_terms(model, alpha, in, out, &scale, &base);
            mass[c] += (double)igi_lobe_pdf(model, alpha, in, out) * weight;
            albedo += (double)((scale + base) * fmaxf(0.0f, in.z)) * weight;
        }
    }
    return albedo;
}

/* Upper tail of chi-square by Wilson and Hilferty's cube root. */
static double chi_square_tail(double x, double freedom)
{
    double v = 2 / (9 * freedom);
    return .5 * erfc((cbrt(x / freedom) - (1 - v)) / sqrt(2 * v));
}

/* Cells that expect fewer than five are pooled; the last is what goes below the surface. */
static double p_value(const double *mass, const int *counts, int samples)
{
    double x = 0, pooled = 0, got = 0, total = 0;
    int cells = 0;
    for (int c = 0; c < CELLS; c++) total += mass[c];
    for (int c = 0; c <= CELLS; c++) {
        double expected = samples * (c < CELLS ? mass[c] : fmax(0.0, 1 - total));
        if (expected < 5) {
            pooled += expected;
            got += counts[c];
        } else {
            x += (counts[c] - expected) * (counts[c] - expected) / expected;
            cells++;
        }
    }
    if (pooled >= 5) {
        x += (got - pooled) * (got - pooled) / pooled;
        cells++;
    }
    return chi_square_tail(x, cells - 1);
}

static void samples_follow_density(void)
{
    enum { SAMPLES = 100000 };
    /* Sidak: 1 % over all tests together. */
    double limit = 1 - pow(.99, 1.0 / (MODELS * ALPHAS * ANGLES));
    static double mass[CELLS];
    static int counts[CELLS + 1];
    for (int m = 0; m < MODELS; m++)
        for (int a = 0; a < ALPHAS; a++)
            for (int o = 0; o < ANGLES; o++) {
                igi_vec out = out_at(o);
                polar p = polar_of(models[m], alphas[a], out);
                double energy = 0, albedo = integrate(models[m], alphas[a], out, mass), square = 0;
                memset(counts, 0, sizeof counts);
                igi_rng rng = igi_rng_make(1, (uint64_t)(m * 100 + a * 10 + o));
                for (int k = 0; k < SAMPLES; k++) {
                    float u = igi_rng_float(&rng), v = igi_rng_float(&rng), scale, base;
                    igi_vec in = igi_lobe_sample(models[m], alphas[a], out, u, v);
                    counts[in.z > 0 ? polar_cell(&p, in) : CELLS]++;
                    float pdf = igi_lobe_pdf(models[m], alphas[a], in, out);
                    igi_lobe_terms(models[m], alphas[a], in, out, &scale, &base);
                    double w = pdf > 0 ? (double)((scale + base) * in.z / pdf) : 0;
                    energy += w / SAMPLES;
                    square += w * w / SAMPLES;
                }
                double p_of = p_value(mass, counts, SAMPLES);
                CHECK(p_of > limit);
                if (!(p_of > limit))
                    printf("  %s alpha %g at %g deg: p = %g\n", model_names[m], (double)alphas[a],
                           (double)angles_deg[o], p_of);
                /* The sampler's albedo is the quadrature's, within 5 sigma. */
                if (models[m] != IGI_LAMBERT)
                    CHECK_NEAR(energy, albedo,
                               5 * sqrt(fmax(0, square - energy * energy) / SAMPLES) +
                                   2e-3 * albedo);
            }
}

static void energy(void)
{
    static double mass[CELLS];
    for (int a = 0; a < ALPHAS; a++)
        for (int o = 0; o < ANGLES; o++) {
            igi_vec out = out_at(o);
            double ggx = integrate(IGI_GGX, alphas[a], out, mass);
            double phong = integrate(IGI_PHONG, alphas[a], out, mass);
            CHECK(ggx > .3 && ggx < 1 + 1e-3); /* single scattering: .44 at alpha 1, normal */
            CHECK(phong > 0 && phong < 1 + 1e-3);
            /* Ward's 1992 normalisation and normalised Phong reflect cos(theta) of a mirror's light
             * where the lobe is sharp; neither gains energy at any of these angles. */
            double ward = integrate(IGI_WARD, alphas[a], out, mass);
            CHECK(ward > 0 && ward < 1 + 1e-3);
            if (alphas[a] > .05f) continue;
            CHECK_NEAR(ward / (double)out.z, 1, angles_deg[o] > 60 ? .2 : 5e-3);
            CHECK_NEAR(phong / (double)out.z, 1, angles_deg[o] > 60 ? .2 : 5e-3);
        }
    CHECK_NEAR(integrate(IGI_GGX, .01f, out_at(1), mass), 1, 1e-3); /* a mirror */
    CHECK_NEAR(integrate(IGI_PHONG, 1, out_at(0), mass), 1, 1e-3);  /* n = 0: diffuse */
}

static void reciprocity(void)
{
    igi_rng rng = igi_rng_make(1, 0);
    for (int k = 0; k < 20000; k++) {
        igi_vec i = direction(1.55f * igi_rng_float(&rng), 6 * igi_rng_float(&rng));
        igi_vec o = direction(1.55f * igi_rng_float(&rng), 6 * igi_rng_float(&rng));
        float alpha = alphas[k % ALPHAS], forth[2], back[2];
        igi_model m = models[1 + k % 3];
        igi_lobe_terms(m, alpha, i, o, &forth[0], &forth[1]);
        igi_lobe_terms(m, alpha, o, i, &back[0], &back[1]);
        for (int t = 0; t < 2; t++)
            CHECK_NEAR((double)forth[t], (double)back[t], 1e-4 * (double)forth[t] + 1e-9);
    }
}

/* What a lobe's own directions carry is the terms over the density, with no exponential. */
static void ratios(void)
{
    igi_rng rng = igi_rng_make(2, 0);
    for (int k = 0; k < 20000; k++) {
        float alpha = alphas[k % ALPHAS], scale, base, terms[2];
        igi_model m = models[1 + k % 3];
        igi_vec out = direction(1.5f * igi_rng_float(&rng), 6 * igi_rng_float(&rng));
        float u = igi_rng_float(&rng), v = igi_rng_float(&rng);
        igi_vec in = igi_lobe_sample(m, alpha, out, u, v);
        igi_lobe_ratios(m, alpha, in, out, &scale, &base);
        igi_lobe_terms(m, alpha, in, out, &terms[0], &terms[1]);
        double pdf = (double)igi_lobe_pdf(m, alpha, in, out), all = (double)(scale + base);
        CHECK_NEAR((double)scale * pdf, (double)terms[0], 1e-3 * (double)terms[0] + 1e-12);
        CHECK_NEAR((double)base * pdf, (double)terms[1], 1e-3 * all * pdf + 1e-12);
    }
}

/* At normal incidence and reflection the formulas of the formats are one line each. */
static void closed_forms(void)
{
    igi_vec n = {0, 0, 1};
    for (int a = 0; a < ALPHAS; a++) {
        float scale, base;
        double a2 = (double)alphas[a] * (double)alphas[a];
        igi_lobe_terms(IGI_WARD, alphas[a], n, n, &scale, &base);
        CHECK_NEAR((double)scale * 4 * IGI_PI * a2, 1, 1e-5);
        igi_lobe_terms(IGI_GGX, alphas[a], n, n, &scale, &base);
        CHECK_NEAR((double)scale * 4 * IGI_PI * a2, 1, 1e-5);
        CHECK(base == 0);
        igi_lobe_terms(IGI_PHONG, alphas[a], n, n, &scale, &base);
        CHECK_NEAR((double)scale * IGI_PI * a2, 1, 1e-5);
        igi_lobe_terms(IGI_WARD, alphas[a], igi_v(0, 0, -1), n, &scale, &base);
        CHECK(scale == 0 && base == 0);
    }
    /* Ward in 45 degrees, out 0, alpha .5: tan(22.5 deg)^2 = .171573. */
    float scale, base;
    igi_lobe_terms(IGI_WARD, .5f, direction(IGI_PIF / 4, 0), n, &scale, &base);
    CHECK_NEAR((double)scale, exp(-.171573 / .25) / (4 * IGI_PI * .25 * sqrt(sqrt(.5))), 1e-5);
    /* GGX there: D = .25/(pi (sin^2 + .25 cos^2)^2), Lambda_i = (sqrt(1.25) - 1)/2, Schlick of
     * (1 - cos 22.5)^5. */
    igi_lobe_terms(IGI_GGX, .5f, direction(IGI_PIF / 4, 0), n, &scale, &base);
    double s2 = .146446609, d = .25 / (IGI_PI * pow(s2 + .25 * (1 - s2), 2));
    double core = d / (1 + (sqrt(1.25) - 1) / 2) / (4 * sqrt(.5)), f = pow(1 - sqrt(1 - s2), 5);
    CHECK_NEAR((double)scale, core * (1 - f), 1e-5);
    CHECK_NEAR((double)base, core * f, 1e-9);
}

TEST_MAIN({"samples follow density", samples_follow_density}, {"energy", energy},
          {"reciprocity", reciprocity}, {"ratios", ratios}, {"closed forms", closed_forms})
