/* SPDX-License-Identifier: Apache-2.0
 *
 * Colours of spectra against the tables of CIE and colour-science, lights in photometric units
 * against what they mean.
 */
#include "base/spectrum.h"
#include "base/vec.h"
#include "scene/sun.h"
#include "scene_fixture.h"

#define FOLDER "scratch_light_units"

typedef struct table {
    int count;
    double nm[1000], value[1000][3];
} table;

static bool load_table(const char *name, int columns, table *t)
{
    char path[1024], line[256];
    if (!test_shared_data(name, path, sizeof path)) return false;
    FILE *file = fopen(path, "r");
    t->count = 0;
    while (file && fgets(line, sizeof line, file)) {
        double *v = t->value[t->count];
        int got = sscanf(line, "%lf,%lf,%lf,%lf", &t->nm[t->count], &v[0], &v[1], &v[2]);
        if (got == columns + 1) t->count++;
    }
    if (file) fclose(file);
    CHECK(t->count > 10);
    return t->count > 10;
}

static double at(const void *user, double nm)
{
    const table *t = user;
    for (int i = 0; i + 1 < t->count; i++)
        if (t->nm[i] <= nm && nm <= t->nm[i + 1])
            return t->value[i][0] + (nm - t->nm[i]) / (t->nm[i + 1] - t->nm[i]) *
                                        (t->value[i + 1][0] - t->value[i][0]);
    return 0;
}

/* The fit is as far from the tables as the header says. */
static void observer(void)
{
    static table t;
    static const double said[] = {0.015, 0.008, 0.024};
    double most[3] = {0}, sums[2][3] = {{0}};
    if (!load_table("real/spectral/cie1931_2deg_xyz_1nm.csv", 3, &t)) return;
    for (int i = 0; i < t.count; i++) {
        double xyz[3];
        igi_cie_1931(t.nm[i], xyz);
        for (int k = 0; k < 3; k++) {
            most[k] = fmax(most[k], fabs(xyz[k] - t.value[i][k]));
            sums[0][k] += xyz[k];
            sums[1][k] += t.value[i][k];
        }
    }
    for (int k = 0; k < 3; k++) {
        printf("observer %c: largest error %.4f, of the integral %.3f %%\n", "xyz"[k], most[k],
               100 * (sums[0][k] / sums[1][k] - 1));
        CHECK(most[k] <= said[k]);
        CHECK_NEAR(sums[0][k] / sums[1][k], 1, 0.005);
    }
}

static void check_chromaticity(const double xyz[3], double x, double y)
{
    double sum = xyz[0] + xyz[1] + xyz[2];
    CHECK_NEAR(xyz[0] / sum, x, 0.003);
    CHECK_NEAR(xyz[1] / sum, y, 0.003);
}

static double black_body(const void *user, double nm)
{
    return igi_planck(nm, *(const double *)user);
}

/* Chromaticities of CIE 15:2004, table T.3; illuminant A is a black body of 2856 K. */
static void colours(void)
{
    static table t;
    double xyz[3], rgb[3], kelvin = 2855.5;
    igi_xyz_of_spectrum(black_body, &kelvin, xyz);
    check_chromaticity(xyz, 0.44758, 0.40745);
    if (load_table("real/spectral/illuminant_A.csv", 1, &t)) {
        igi_xyz_of_spectrum(at, &t, xyz);
        check_chromaticity(xyz, 0.44758, 0.40745);
    }
    if (load_table("real/spectral/illuminant_D65.csv", 1, &t)) {
        igi_xyz_of_spectrum(at, &t, xyz);
        check_chromaticity(xyz, 0.31272, 0.32903);
        igi_colour_of_spectrum(at, &t, rgb);
        for (int k = 0; k < 3; k++) CHECK_NEAR(rgb[k], 1, 0.015); /* the white of the primaries */
    }
    static const struct {
        const char *file;
        double x, y;
    } others[] = {{"real/spectral/illuminant_D50.csv", 0.34567, 0.35851},
                  {"real/spectral/illuminant_E.csv", 1. / 3, 1. / 3},
                  {"real/spectral/illuminant_FL11.csv", 0.38052, 0.37713}};
    for (int i = 0; i < 3; i++)
        if (load_table(others[i].file, 1, &t)) {
            igi_xyz_of_spectrum(at, &t, xyz);
            check_chromaticity(xyz, others[i].x, others[i].y);
        }
    if (load_table("real/spectral/cie1924_V_lambda_1nm.csv", 1, &t))
        for (int i = 0; i < t.count; i++) {
            igi_cie_1931(t.nm[i], xyz);
            CHECK(fabs(xyz[1] - t.value[i][0]) <= 0.008);
        }
    if (load_table("real/spectral/illuminant_FL2.csv", 1, &t)) {
        igi_xyz_of_spectrum(at, &t, xyz);
        check_chromaticity(xyz, 0.37208, 0.37529);
    }
    igi_colour_of_temperature(6504, rgb);
    CHECK_NEAR(0.2126729 * rgb[0] + 0.7151522 * rgb[1] + 0.0721750 * rgb[2], 1, 1e-6);
    CHECK(rgb[0] > 0.9 && rgb[0] < 1.1 && rgb[2] > 0.9 && rgb[2] < 1.1);
    igi_colour_of_temperature(2700, rgb);
    CHECK(rgb[0] > 1.5 && rgb[2] < 0.4);
}

typedef struct product {
    const table *light, *reflectance;
} product;

static double reflected(const void *user, double nm)
{
    const product *p = user;
    return at(p->light, nm) * (p->reflectance ? at(p->reflectance, nm) : 1);
}

/* XYZ of a surface under a light, Y of the perfect diffuser 1. */
static void colour_of_surface(const table *light, const table *reflectance, double xyz[3])
{
    double white[3];
    product p = {light, NULL};
    igi_xyz_of_spectrum(reflected, &p, white);
    p.reflectance = reflectance;
    igi_xyz_of_spectrum(reflected, &p, xyz);
    for (int k = 0; k < 3; k++) xyz[k] /= white[1];
}

/* The ColorChecker's measured spectra under D50 against its published chromaticities and Y, and
 * the Cornell box's under D65 against the linear RGB that colour-science has of them. */
static void surfaces(void)
{
    static table light, patch;
    char path[1024], line[2048];
    double want[24][3], xyz[3], rgb[3], worst = 0;
    int patches = 0;
    if (!test_shared_data("real/spectral/colorchecker24_xyY_D50.csv", path, sizeof path)) return;
    FILE *file = fopen(path, "r");
    while (file && patches < 24 && fgets(line, sizeof line, file)) {
        double *w = want[patches];
        patches += sscanf(line, "%*[^,],%lf,%lf,%lf", &w[0], &w[1], &w[2]) == 3;
    }
    if (file) fclose(file);
    CHECK(patches == 24);
    CHECK(load_table("real/spectral/illuminant_D50.csv", 1, &light));
    for (int k = 0; k < patches; k++) {
        patch.count = 0;
        if (!test_shared_data("real/spectral/colorchecker_babelcolor_average.csv", path,
                              sizeof path))
            return;
        file = fopen(path, "r");
        while (file && fgets(line, sizeof line, file)) {
            char *number = line;
            double *v = patch.value[patch.count];
            patch.nm[patch.count] = atof(number);
            for (int c = 0; c <= k && number; c++) number = strchr(number + 1, ',');
            if (number && patch.nm[patch.count] > 0 && sscanf(number + 1, "%lf", v) == 1)
                patch.count++;
        }
        if (file) fclose(file);
        colour_of_surface(&light, &patch, xyz);
        double sum = xyz[0] + xyz[1] + xyz[2];
        double off = fmax(fabs(xyz[0] / sum - want[k][0]), fabs(xyz[1] / sum - want[k][1]));
        worst = fmax(worst, off);
        CHECK(off < 0.01);
        CHECK_NEAR(xyz[1] / want[k][2], 1, 0.07); /* other paints since 2014 */
    }
    printf("ColorChecker: chromaticities within %.4f\n", worst);

    static const double box[3][3] = {
        {.737, .736, .739}, {.493, .049, .051}, {.068, .399, .086}}; /* white, red, green */
    static table all;
    CHECK(load_table("real/spectral/illuminant_D65.csv", 1, &light));
    for (int i = 0; i < light.count; i++) /* the box was measured from 400 to 700 nm */
        if (light.nm[i] < 400 || light.nm[i] > 700) light.value[i][0] = 0;
    CHECK(load_table("real/spectral/cornell_box_measured_reflectance.csv", 3, &all));
    for (int k = 0; k < 3; k++) {
        patch = all;
        for (int i = 0; i < all.count; i++) patch.value[i][0] = all.value[i][k];
        colour_of_surface(&light, &patch, xyz);
        igi_rgb_of_xyz(xyz, rgb);
        for (int b = 0; b < 3; b++) CHECK_NEAR(rgb[b], box[k][b], 0.012);
        igi_xyz_of_rgb(rgb, want[0]);
        for (int b = 0; b < 3; b++) CHECK_NEAR(want[0][b], xyz[b], 1e-5);
    }
}

/* Codes of sRGB in 1/255, as CSS Color 3 (W3C) lists them: hue, saturation and value beside. */
static void hues(void)
{
    static const struct {
        double hsv[3];
        int code[3];
    } named[] = {{{0, 1, 1}, {255, 0, 0}},
                 {{38.82, 1, 1}, {255, 165, 0}},
                 {{60, 1, 1}, {255, 255, 0}},
                 {{120, 1, .5020}, {0, 128, 0}},
                 {{174, .7143, .8784}, {64, 224, 208}},
                 {{240, 1, 1}, {0, 0, 255}},
                 {{302.26, .4862, .8549}, {218, 112, 214}},
                 {{360, 1, 1}, {255, 0, 0}},
                 {{25, .8633, .5451}, {139, 69, 19}},
                 {{0, 0, .5020}, {128, 128, 128}}};
    for (size_t i = 0; i < sizeof named / sizeof *named; i++) {
        double rgb[3];
        igi_rgb_of_hsv(named[i].hsv, rgb);
        for (int k = 0; k < 3; k++)
            CHECK_NEAR(rgb[k], igi_linear_of_srgb(named[i].code[k] / 255.0), 0.002);
    }
    CHECK_NEAR(igi_linear_of_srgb(.5), .214041, 1e-6);
    CHECK_NEAR(igi_linear_of_srgb(.04), .04 / 12.92, 1e-12);
}

static igi_status load_lights(igi_context *ctx, const char *lights, igi_scene **scene)
{
    write_fixture(FOLDER);
    char text[2048];
    snprintf(text, sizeof text, BOX_SCENE, lights, BOX_REGIONS);
    write_bytes("scene.json", text, strlen(text));
    return igi_scene_load(ctx, FOLDER, scene);
}

static void units(void)
{
    igi_context *ctx = test_context(1);
    igi_scene *scene = NULL;
    CHECK_OK(ctx, load_lights(
                      ctx,
                      "{\"type\":\"area\",\"region\":\"lamp\",\"power_lm\":1000},"
                      "{\"type\":\"point\",\"position\":[0,0,0.5],\"power_lm\":1790},"
                      "{\"type\":\"spot\",\"position\":[0,0,0.5],\"direction\":[0,0,-1],"
                      "\"cutoff_deg\":30,\"intensity_cd\":358,\"temperature_k\":2700},"
                      "{\"type\":\"line\",\"from\":[0,0,0.5],\"to\":[0,2,0.5],\"power_lm\":1790},"
                      "{\"type\":\"directional\",\"direction\":[0,0,-1],\"illuminance_lx\":1e5},"
                      "{\"type\":\"ambient\",\"luminance_cd_m2\":179}",
                      &scene));
    if (scene) {
        static const double want[] = {1000 / IGI_PI / 179, 10 / (4 * IGI_PI), 0,
                                      5 / (4 * IGI_PI),    1e5 / 179,         1};
        for (int l = 0; l < 6; l++)
            for (int b = 0; b < 3 && l != 2; b++) {
                CHECK(scene->lights[l].known);
                CHECK_NEAR(scene->lights[l].value[b] / want[l], 1, 1e-6);
            }
        const double *rgb = scene->lights[2].value;
        CHECK_NEAR(0.2126729 * rgb[0] + 0.7151522 * rgb[1] + 0.0721750 * rgb[2], 2, 1e-6);
        CHECK(rgb[0] > 2 * rgb[2]);
    }
    igi_scene_destroy(scene);
    /* Sodium's lines; the chromaticity of illuminant A; a pure red. */
    CHECK_OK(ctx, load_lights(ctx,
                              "{\"type\":\"ambient\",\"luminance_cd_m2\":179,\"lines\":[[589.0,2],"
                              "[589.6,1]]},"
                              "{\"type\":\"point\",\"position\":[0,0,0.5],\"intensity_cd\":179,"
                              "\"xy\":[0.44758,0.40745]},"
                              "{\"type\":\"directional\",\"direction\":[0,0,-1],\"illuminance_lx\":"
                              "179,\"hsv\":[0,1,0.5]}",
                              &scene));
    if (scene) {
        double want[3], xyz[3];
        for (int l = 0; l < 3; l++) CHECK_NEAR(igi_luminance(scene->lights[l].value), 1, 1e-6);
        CHECK(scene->lights[0].value[2] == 0 && scene->lights[0].value[0] > 1.5);
        igi_xyz_of_rgb(scene->lights[1].value, xyz);
        check_chromaticity(xyz, 0.44758, 0.40745);
        igi_colour_of_temperature(2855.5, want);
        for (int b = 0; b < 3; b++) CHECK_NEAR(scene->lights[1].value[b], want[b], 0.02);
        CHECK_NEAR(scene->lights[2].value[0], 1 / 0.2126729, 1e-6);
        CHECK(scene->lights[2].value[1] == 0);
    }
    igi_scene_destroy(scene);
    static const struct {
        const char *light, *sentence;
    } bad[] = {
        {"{\"type\":\"ambient\",\"luminance_cd_m2\":1,\"hsv\":[400,1,1]}", "is no colour"},
        {"{\"type\":\"ambient\",\"luminance_cd_m2\":1,\"hsv\":[40,1,0]}", "is black"},
        {"{\"type\":\"ambient\",\"luminance_cd_m2\":1,\"xy\":[1,1]}", "no chromaticity"},
        {"{\"type\":\"ambient\",\"luminance_cd_m2\":1,\"lines\":[[200,1]]}", "is no line"},
        {"{\"type\":\"ambient\",\"luminance_cd_m2\":1,\"lines\":[]}", "an eye sees"},
        {"{\"type\":\"ambient\",\"luminance_cd_m2\":1,\"xy\":[0.3,0.3],\"hsv\":[1,1,1]}",
         "beside \"xy\""},
        {"{\"type\":\"volume\",\"region\":\"lamp\",\"emission\":[1,1,1]}", "is open"},
        {"{\"type\":\"ambient\",\"radiance\":[1,1,1],\"luminance_cd_m2\":1}",
         "beside \"radiance\""},
        {"{\"type\":\"ambient\",\"illuminance_lx\":1}", "unknown key"},
        {"{\"type\":\"ambient\",\"temperature_k\":3000}", "a colour without a strength"},
        {"{\"type\":\"ambient\",\"luminance_cd_m2\":-1}", "cannot be negative"},
        {"{\"type\":\"ambient\",\"luminance_cd_m2\":1,\"temperature_k\":3}",
         "500 to 100000 kelvin"},
        {"{\"type\":\"ambient\",\"luminance_cd_m2\":1,\"spectrum\":\"none.csv\"}", "none.csv"},
        {"{\"type\":\"ambient\",\"luminance_cd_m2\":1,\"spectrum\":\"falling.csv\"}",
         "falling.csv:3: no wavelength in nm above the last one"}};
    write_fixture(FOLDER);
    write_bytes("falling.csv", "nm,power\n500,1\n400,1\n", 21);
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) {
        scene = NULL;
        CHECK(load_lights(ctx, bad[i].light, &scene) == IGI_E_DATA);
        CHECK_CONTAINS(igi_context_message(ctx), bad[i].sentence);
        igi_scene_destroy(scene);
    }
    igi_context_destroy(ctx);
}

/* NREL's example (Reda and Andreas 2008): zenith 50.11162 (with .014 of refraction), azimuth
 * 194.34024 degrees; and at the equator at an equinox the sun passes overhead. */
static void sun(void)
{
    double days, elevation, azimuth, utc;
    CHECK(igi_days_of_time("2003-10-17T12:30:30-07:00", &days));
    igi_sun_position(days, 39.742476, -105.1786, &elevation, &azimuth);
    CHECK_NEAR(elevation, 90 - 50.11162, 0.03);
    CHECK_NEAR(azimuth, 194.34024, 0.03);
    CHECK(igi_days_of_time("2003-10-17T19:30:30Z", &utc));
    CHECK_NEAR(utc, days, 1e-9);
    CHECK(igi_days_of_time("2020-03-20T12:07:30Z", &days));
    igi_sun_position(days, 0, 0, &elevation, &azimuth);
    CHECK(elevation > 89.5);
    CHECK(igi_days_of_time("2000-01-01T12:00Z", &days));
    CHECK_NEAR(days, 0, 0);
    static const char *const bad[] = {"",
                                      "noon",
                                      "2020-13-01T12:00Z",
                                      "2020-01-01T12:00",
                                      "2020-01-01T12:00+2",
                                      "2020-01-01T12:00:00Zz"};
    for (size_t i = 0; i < sizeof bad / sizeof *bad; i++) CHECK(!igi_days_of_time(bad[i], &days));
    igi_context *ctx = test_context(1);
    igi_scene *scene = NULL;
    CHECK_OK(ctx, load_lights(ctx,
                              "{\"type\":\"sky\",\"latitude_deg\":50,\"longitude_deg\":8,"
                              "\"time\":\"2026-06-21T13:28:00+02:00\",\"cloudiness\":0.5}",
                              &scene));
    if (scene) {
        const igi_light *l = &scene->lights[0];
        CHECK(l->sky.given && l->known && l->value[0] == 1 && l->sky.turbidity == 3);
        CHECK_NEAR(l->sky.sun_elevation_deg, 90 - 50 + 23.44, 0.1);
        CHECK_NEAR(l->sky.sun_azimuth_deg, 180, 1.5);
    }
    igi_scene_destroy(scene);
    CHECK(load_lights(ctx,
                      "{\"type\":\"sky\",\"latitude_deg\":50,\"longitude_deg\":8,"
                      "\"time\":\"2026-06-21T01:00:00+02:00\"}",
                      &scene) == IGI_E_DATA);
    CHECK_CONTAINS(igi_context_message(ctx), "it is night");
    igi_context_destroy(ctx);
}

TEST_MAIN({"observer", observer}, {"colours", colours}, {"surfaces", surfaces}, {"hues", hues},
          {"units", units}, {"sun", sun})
