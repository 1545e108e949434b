/* SPDX-License-Identifier: Apache-2.0
 *
 * Lenses out of lensfun's database, against the numbers that stand in it (Debian's, version 0.3.3).
 */
#include "test.h"

#include <igi/lens.h>

#define WIDTH 600
#define HEIGHT 400
#define LENS "Canon EF 16-35mm f/2.8L II USM"

static void write_photograph(igi_context *ctx, const char *path, const char *camera, double focal)
{
    static uint16_t codes[WIDTH * HEIGHT];
    igi_photo photo = {.width = WIDTH,
                       .height = HEIGHT,
                       .channels = 1,
                       .levels = 256,
                       .codes = codes,
                       .time_s = .01,
                       .f_number = 8,
                       .iso = 100,
                       .focal_mm = focal};
    snprintf(photo.camera, sizeof photo.camera, "%s", camera);
    CHECK_OK(ctx, igi_photo_save_png(ctx, &photo, path));
}

static void a_lens_as_the_database_has_it(void)
{
    static const double a = .00983, b = -.01708, c3 = .01203;              /* PTLens, 35 mm */
    static const double k[3] = {-.2781, -.0341, .0800};                    /* 35 mm, f/8 */
    const double f = 35 * sqrt(WIDTH * WIDTH + HEIGHT * HEIGHT) / 43.2666; /* full frame */
    const int size[2] = {WIDTH, HEIGHT};
    igi_context *ctx = test_context(1);
    igi_calibration *c = NULL;
    write_photograph(ctx, "test_lensfun.png", "EOS 5D Mark II", 35);
    CHECK_OK(ctx, igi_calibrate_lensfun(ctx, "test_lensfun.png", LENS, &c));
    if (c) {
        CHECK(c->has_lens && c->vignetting.known && c->width == WIDTH && c->view_count == 1);
        CHECK_STR(c->views[0].file, "lensfun: " LENS);
        CHECK_NEAR(c->lens.cx, WIDTH / 2., 1e-9);
        /* r_d / r_u; the unit of the database's radius is half the shorter side. */
        for (double r = .1; r < 1.8; r += .1) {
            double want = r * (a * r * r * r + b * r * r + c3 * r + 1 - a - b - c3) * HEIGHT / 2;
            double x = r * HEIGHT / 2 / f, x2 = x * x;
            double got = c->lens.fl_x * x *
                         (1 + x2 * (c->lens.k1 + x2 * (c->lens.k2 + x2 * c->lens.k3)));
            CHECK_NEAR(got, want, .15);
        }
        for (int i = 0; i < 3; i++) {
            double x = WIDTH / 2. * (1 + i / 2.), y = HEIGHT / 2. * (1 + i / 2.), r2 = i * i / 4.;
            CHECK_NEAR(igi_vignetting_at(&c->vignetting, x, y, size),
                       1 + r2 * (k[0] + r2 * (k[1] + r2 * k[2])), .003);
        }
    }
    igi_calibration_destroy(c);
    c = NULL;
    CHECK(igi_calibrate_lensfun(ctx, "test_lensfun.png", NULL, &c) == IGI_E_DATA && !c);
    CHECK_CONTAINS(igi_context_message(ctx), "name it with --lens");
    CHECK(igi_calibrate_lensfun(ctx, "test_lensfun.png", "Lensless 1000mm", &c) == IGI_E_NO_ANSWER);
    CHECK_CONTAINS(igi_context_message(ctx), "knows no lens 'Lensless 1000mm'");
    write_photograph(ctx, "test_lensfun.png", "Box with a hole", 35);
    CHECK(igi_calibrate_lensfun(ctx, "test_lensfun.png", LENS, &c) == IGI_E_NO_ANSWER && !c);
    CHECK_CONTAINS(igi_context_message(ctx), "knows no camera 'Box with a hole'");
    write_photograph(ctx, "test_lensfun.png", "EOS 5D Mark II", 0);
    CHECK(igi_calibrate_lensfun(ctx, "test_lensfun.png", LENS, &c) == IGI_E_DATA && !c);
    remove("test_lensfun.png");
    igi_context_destroy(ctx);
}

TEST_MAIN({"a_lens_as_the_database_has_it", a_lens_as_the_database_has_it})
