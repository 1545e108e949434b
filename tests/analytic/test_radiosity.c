/* SPDX-License-Identifier: Apache-2.0
 *
 * The radiosity system against rooms whose light is known in closed form.
 */
#include "test.h"

#include "base/vec.h"
#include "rooms.h"
#include "transport/form_factor.h"
#include "transport/radiosity.h"

/* A room with its form factors and the arrays of a system. */
typedef struct setting {
    igi_context *ctx;
    room *room;
    igi_elements *elements;
    double *factors, *areas, *albedo, *sent, *radiosity;
    igi_radiosity_system system;
} setting;

static double *doubles(size_t n)
{
    double *p = calloc(n, sizeof *p);
    if (!p) abort();
    return p;
}

static setting begin(room *r, double size, igi_factor_way way)
{
    setting s = {.ctx = test_context(2), .room = r};
    igi_tracer *tracer = NULL;
    CHECK_OK(s.ctx, igi_tracer_create(s.ctx, &r->mesh, &tracer));
    CHECK_OK(s.ctx, igi_elements_create(s.ctx, &r->mesh, size, 4000, false, &s.elements));
    size_t n = s.elements->count;
    s.factors = doubles(n * n);
    s.areas = doubles(n);
    s.albedo = doubles(n);
    s.sent = doubles(n);
    s.radiosity = doubles(n);
    igi_factor_options o;
    igi_factor_options_init(&o, way);
    CHECK_OK(s.ctx, igi_form_factors(s.ctx, s.elements, tracer, &o, s.factors));
    for (size_t i = 0; i < n; i++) s.areas[i] = s.elements->elements[i].area;
    s.system = (igi_radiosity_system){n, s.factors, s.areas, s.albedo, s.sent, 0};
    igi_tracer_destroy(tracer);
    return s;
}

static void end(setting *s)
{
    free(s->factors);
    free(s->areas);
    free(s->albedo);
    free(s->sent);
    free(s->radiosity);
    igi_elements_destroy(s->elements);
    igi_context_destroy(s->ctx);
    free(s->room);
}

static room *cube(double side, int n)
{
    room *r = room_new();
    room_cube(r, side, n);
    return r;
}

static void fill(setting *s, double albedo, uint32_t emitting_region)
{
    for (size_t i = 0; i < s->system.count; i++) {
        s->albedo[i] = albedo;
        s->sent[i] = s->elements->elements[i].region == emitting_region ? 1 : 0;
    }
}

static double mean_over(const setting *s, const double *values, uint32_t region)
{
    double sum = 0, area = 0;
    for (size_t i = 0; i < s->system.count; i++) {
        if (s->elements->elements[i].region != region) continue;
        sum += s->areas[i] * values[i];
        area += s->areas[i];
    }
    return sum / area;
}

/* The ceiling emits 1 W m^-2, everything reflects rho: the floor's radiosity, to 0.1 %. */
static void emitting_ceiling(void)
{
    static const double rho[4] = {.2, .5, .8, .95}, floor[4] = {.04804, .18175, .68955, 3.19316};
    setting coarse = begin(cube(1, 2), 2, IGI_FACTOR_CLOSED);
    CHECK(coarse.system.count == 6);
    for (int k = 0; k < 4; k++) {
        fill(&coarse, rho[k], 1);
        for (int way = IGI_RADIOSITY_GAUSS_SEIDEL; way <= IGI_RADIOSITY_LU; way++) {
            CHECK_OK(coarse.ctx, igi_radiosity_solve(coarse.ctx, &coarse.system,
                                                     (igi_radiosity_way)way, coarse.radiosity));
            CHECK_NEAR(mean_over(&coarse, coarse.radiosity, 0), floor[k], 1e-3 * floor[k]);
        }
    }
    end(&coarse);
}

/* The three ways solve the same system, on 300 elements and unlike albedos. */
static void ways_agree(void)
{
    setting s = begin(cube(1, 1), .16, IGI_FACTOR_CLOSED);
    size_t n = s.system.count;
    double *lu = doubles(n);
    fill(&s, 0, 1);
    for (size_t i = 0; i < n; i++) s.albedo[i] = .1 + .15 * (double)(i % 6);
    CHECK_OK(s.ctx, igi_radiosity_solve(s.ctx, &s.system, IGI_RADIOSITY_LU, lu));
    for (int way = IGI_RADIOSITY_GAUSS_SEIDEL; way <= IGI_RADIOSITY_SHOOTING; way++) {
        CHECK_OK(s.ctx, igi_radiosity_solve(s.ctx, &s.system, (igi_radiosity_way)way, s.radiosity));
        double worst = 0;
        for (size_t i = 0; i < n; i++) worst = fmax(worst, fabs(s.radiosity[i] - lu[i]));
        CHECK_NEAR(worst, 0, 2e-9);
    }
    /* What they return satisfies the equation. */
    for (size_t i = 0; i < n; i++) {
        double sum = s.sent[i];
        for (size_t j = 0; j < n; j++) sum += s.albedo[i] * s.factors[i * n + j] * lu[j];
        CHECK_NEAR(lu[i], sum, 1e-12);
    }
    free(lu);
    end(&s);
}

/* Solid angle of a triangle (Van Oosterom & Strackee 1983): a point light of intensity 1 sends as
 * much power through it. */
static double solid_angle(const igi_facet *facet, const double *eye)
{
    double v[3][3], l[3], det = 0, dots[3];
    for (int c = 0; c < 3; c++) {
        for (int k = 0; k < 3; k++) v[c][k] = facet->corner[c][k] - eye[k];
        l[c] = sqrt(v[c][0] * v[c][0] + v[c][1] * v[c][1] + v[c][2] * v[c][2]);
    }
    for (int c = 0; c < 3; c++) {
        const double *a = v[c], *b = v[(c + 1) % 3];
        dots[c] = a[0] * b[0] + a[1] * b[1] + a[2] * b[2];
        det += v[0][c] *
               (v[1][(c + 1) % 3] * v[2][(c + 2) % 3] - v[1][(c + 2) % 3] * v[2][(c + 1) % 3]);
    }
    double below = l[0] * l[1] * l[2] + dots[0] * l[2] + dots[1] * l[0] + dots[2] * l[1];
    return fabs(2 * atan2(det, below));
}

/* Irradiance of each element by a point light, and the mean of all irradiance over a region. */
static void light_by_point(const setting *s, const double *eye, double intensity,
                           double *irradiance)
{
    for (size_t i = 0; i < s->system.count; i++) {
        const igi_element *e = &s->elements->elements[i];
        irradiance[i] = 0;
        for (size_t f = 0; f < e->facet_count; f++)
            irradiance[i] += intensity / e->area *
                             solid_angle(&s->elements->facets[e->first_facet + f], eye);
    }
}

/* CIE 171:2006 section 5.8: a cube of 4 m, 10000 lm isotropic at its centre; mean illuminance is
 * 104.17/(1 - rho) lx. The mean over each face is, too. */
static void cie_171_5_8(void)
{
    static const double rho[6] = {0, .5, .8, .9, .95, .99};
    const double centre[3] = {2, 2, 2};
    for (int way = IGI_FACTOR_CLOSED; way <= IGI_FACTOR_RAYS; way++) {
        setting s = begin(cube(4, 1), 1, (igi_factor_way)way);
        size_t n = s.system.count;
        double *direct = doubles(n), *all = doubles(n);
        light_by_point(&s, centre, 10000 / (4 * IGI_PI), direct);
        for (int k = 0; k < 6; k++) {
            for (size_t i = 0; i < n; i++) {
                s.albedo[i] = rho[k];
                s.sent[i] = rho[k] * direct[i];
            }
            CHECK_OK(s.ctx, igi_radiosity_solve(s.ctx, &s.system, IGI_RADIOSITY_GAUSS_SEIDEL,
                                                s.radiosity));
            double mean = 0, want = 10000.0 / 96 / (1 - rho[k]);
            for (size_t i = 0; i < n; i++) {
                all[i] = direct[i];
                for (size_t j = 0; j < n; j++) all[i] += s.factors[i * n + j] * s.radiosity[j];
                mean += s.areas[i] * all[i] / 96;
            }
            CHECK_NEAR(mean, want, (way == IGI_FACTOR_CLOSED ? 1e-6 : 5e-3) * want);
            for (uint32_t face = 0; face < 6; face++)
                CHECK_NEAR(mean_over(&s, all, face), want,
                           (way == IGI_FACTOR_CLOSED ? 1e-6 : 2e-2) * want);
        }
        free(direct);
        free(all);
        end(&s);
    }
}

/* Inside a diffuse sphere the reflected irradiance is uniform, wherever light enters. */
static void sphere_inside(void)
{
    double last = HUGE_VAL;
    for (int n = 2; n <= 8; n *= 2) {
        room *r = room_new();
        room_sphere(r, n, true);
        setting s = begin(r, 2, IGI_FACTOR_CLOSED);
        fill(&s, .8, 0); /* one facet emits 1 */
        CHECK_OK(s.ctx, igi_radiosity_solve(s.ctx, &s.system, IGI_RADIOSITY_LU, s.radiosity));
        double area = 0, error = 0, mean;
        for (size_t i = 0; i < s.system.count; i++) area += s.areas[i];
        mean = s.areas[0] / area * .8 / (1 - .8); /* of what the others send on */
        for (size_t i = 0; i < s.system.count; i++) {
            double d = (s.radiosity[i] - s.sent[i]) / mean - 1;
            error += s.areas[i] / area * d * d;
        }
        printf("   %4zu facets: %.5f\n", s.system.count, sqrt(error));
        CHECK(sqrt(error) < last / 1.6);
        last = sqrt(error);
        end(&s);
    }
    CHECK(last < 0.02);
}

/* What is emitted is absorbed, to the last percent, when hardly anything is absorbed at a time. */
static void energy_at_high_albedo(void)
{
    setting s = begin(cube(2, 1), .5, IGI_FACTOR_RAYS); /* rows close, columns only about */
    fill(&s, .99, 1);
    for (int way = IGI_RADIOSITY_GAUSS_SEIDEL; way <= IGI_RADIOSITY_LU; way++) {
        CHECK_OK(s.ctx, igi_radiosity_solve(s.ctx, &s.system, (igi_radiosity_way)way, s.radiosity));
        double absorbed = 0;
        for (size_t i = 0; i < s.system.count; i++)
            absorbed += s.areas[i] * (s.radiosity[i] - s.sent[i]) * (1 - .99) / .99;
        CHECK_NEAR(absorbed, 4, .04);
    }
    end(&s);
}

static void refuses_what_has_no_answer(void)
{
    setting s = begin(cube(1, 2), 2, IGI_FACTOR_RAYS);
    for (int way = IGI_RADIOSITY_GAUSS_SEIDEL; way <= IGI_RADIOSITY_LU; way++) {
        fill(&s, 1.2, 1);
        CHECK(igi_radiosity_solve(s.ctx, &s.system, (igi_radiosity_way)way, s.radiosity) ==
              IGI_E_NO_ANSWER);
        CHECK_CONTAINS(igi_context_message(s.ctx), "does not die out");
        fill(&s, 1, 9); /* albedo 1, and no light at all */
        if (way != IGI_RADIOSITY_LU)
            CHECK_OK(s.ctx,
                     igi_radiosity_solve(s.ctx, &s.system, (igi_radiosity_way)way, s.radiosity));
        CHECK_NEAR(s.radiosity[0], 0, way == IGI_RADIOSITY_LU ? HUGE_VAL : 0);
    }
    CHECK(igi_radiosity_solve(s.ctx, &s.system, (igi_radiosity_way)7, s.radiosity) == IGI_E_USAGE);
    igi_context_cancel(s.ctx);
    fill(&s, .9999999, 1);
    CHECK(igi_radiosity_solve(s.ctx, &s.system, IGI_RADIOSITY_SHOOTING, s.radiosity) ==
          IGI_E_CANCELLED);
    end(&s);
}

TEST_MAIN({"emitting_ceiling", emitting_ceiling}, {"ways_agree", ways_agree},
          {"cie_171_5_8", cie_171_5_8}, {"sphere_inside", sphere_inside},
          {"energy_at_high_albedo", energy_at_high_albedo},
          {"refuses_what_has_no_answer", refuses_what_has_no_answer})
