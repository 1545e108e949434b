/* SPDX-License-Identifier: Apache-2.0
 *
 * ChArUco boards: rendered through a known lens, partly out of the picture, and the lens found again.
 */
#include "test.h"

#include "base/context.h"
#include "bridge/opencv.h"

#include <igi/lens.h>

#define WIDTH 560
#define HEIGHT 420
#define SIDE 40 /* of a square of the board's picture, pixels */
#define VIEWS 9

static const igi_cv_charuco kind = {7, 5, .75, "5X5_100"};
static const double truth[9] = {520, 517, 285, 206, -.22, .06, .001, -.0008, 0};

/* The direction that pixel (x,y) sees, by fixed-point iteration of the distortion. */
static void undistort(double x, double y, double out[2])
{
    double u = (x - truth[2]) / truth[0], v = (y - truth[3]) / truth[1], a = u, b = v;
    for (int i = 0; i < 12; i++) {
        double r2 = a * a + b * b, d = 1 + r2 * (truth[4] + r2 * truth[5]);
        double dx = 2 * truth[6] * a * b + truth[7] * (r2 + 2 * a * a);
        double dy = truth[6] * (r2 + 2 * b * b) + 2 * truth[7] * a * b;
        a = (u - dx) / d;
        b = (v - dy) / d;
    }
    out[0] = a;
    out[1] = b;
}

static double board_at(const uint8_t *picture, double u, double v)
{
    int width = (kind.columns + 1) * SIDE, height = (kind.rows + 1) * SIDE;
    double x = u * SIDE, y = v * SIDE; /* u, v: squares from the board's corner */
    if (!(x >= -SIDE / 2. && y >= -SIDE / 2. && x < width + SIDE / 2. && y < height + SIDE / 2.))
        return 90;
    if (x < 0 || y < 0 || x >= width || y >= height) return 255; /* white paper around it */
    return picture[(int)y * width + (int)x];
}

/* View k: tilted, turned, and from some on reaching beyond the picture. */
static void render(const uint8_t *picture, int k, igi_photo *photo)
{
    double tx = .55 * sin(k * 1.7), ty = .55 * cos(k * 2.3), turn = .4 * sin(k * 1.1);
    double right[3] = {cos(turn) * cos(ty), sin(turn) * cos(ty), -sin(ty)};
    double down[3] = {-sin(turn) * cos(tx), cos(turn) * cos(tx), sin(tx)};
    double dot = right[0] * down[0] + right[1] * down[1] + right[2] * down[2], norm = 0;
    for (int i = 0; i < 3; i++) down[i] -= dot * right[i], norm += down[i] * down[i];
    for (int i = 0; i < 3; i++) down[i] /= sqrt(norm);
    double normal[3] = {right[1] * down[2] - right[2] * down[1],
                        right[2] * down[0] - right[0] * down[2],
                        right[0] * down[1] - right[1] * down[0]};
    double centre[3] = {(k % 3 - 1) * (k < 5 ? .6 : 2.6), (k / 3 - 1) * 1.2, 8.2 + .5 * (k % 4)};
    double height = centre[0] * normal[0] + centre[1] * normal[1] + centre[2] * normal[2];
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        double sum = 0;
        for (int s = 0; s < 4; s++) {
            double ray[3] = {0, 0, 1}, u = 4, v = 3;
            undistort(i % WIDTH + (s % 2 - .5) / 2, i / WIDTH + (s / 2 - .5) / 2, ray);
            double t = height / (ray[0] * normal[0] + ray[1] * normal[1] + ray[2] * normal[2]);
            for (int a = 0; a < 3; a++) {
                u += (ray[a] * t - centre[a]) * right[a];
                v += (ray[a] * t - centre[a]) * down[a];
            }
            sum += board_at(picture, u, v) / 4;
        }
        photo->codes[i] = (uint16_t)(30 + .8 * sum);
    }
}

static void a_lens_from_parts_of_the_board(void)
{
    static uint8_t picture[6 * SIDE * 8 * SIDE];
    static uint16_t codes[WIDTH * HEIGHT];
    static char names[VIEWS][40];
    const char *paths[VIEWS];
    igi_photo photo = {
        .width = WIDTH, .height = HEIGHT, .channels = 1, .levels = 256, .codes = codes};
    const igi_chessboard board = {7, 5, .03, kind.dictionary, .75 * .03};
    igi_calibration *c = NULL;
    igi_context *ctx = test_context(1);
    igi_status status = igi_cv_draw_charuco(ctx, &kind, SIDE, picture);
    if (status == IGI_E_USAGE && strstr(igi_context_message(ctx), "built without")) {
        printf("skipped: %s\n", igi_context_message(ctx));
        test_skips++;
        igi_context_destroy(ctx);
        return;
    }
    CHECK(status == IGI_OK);
    for (int k = 0; k < VIEWS; k++) {
        snprintf(names[k], sizeof names[k], "test_charuco_%d.png", k);
        paths[k] = names[k];
        render(picture, k, &photo);
        CHECK_OK(ctx, igi_photo_save_png(ctx, &photo, paths[k]));
    }
    CHECK_OK(ctx, igi_calibrate_chessboard(ctx, paths, VIEWS, &board, &c));
    if (c) {
        const double got[9] = {c->lens.fl_x,    c->lens.fl_y, c->lens.cx - .5,
                               c->lens.cy - .5, c->lens.k1,   c->lens.k2,
                               c->lens.p1,      c->lens.p2,   c->lens.k3};
        for (int i = 0; i < 9; i++)
            printf("%.5f +- %.5f, truth %.5f\n", got[i], c->deviations[i], truth[i]);
        printf("rms %.3f px\n", c->rms_px);
        CHECK(c->rms_px < .15);
        for (int i = 0; i < 9; i++) CHECK_NEAR(got[i], truth[i], 4 * c->deviations[i]);
        CHECK_NEAR(got[0], truth[0], 2);
        size_t used = 0;
        for (size_t i = 0; i < c->view_count; i++) used += c->views[i].used;
        CHECK(used >= 6);
    }
    igi_calibration_destroy(c);
    c = NULL;
    igi_chessboard other = board;
    other.markers = "9X9_1";
    CHECK(igi_calibrate_chessboard(ctx, paths, VIEWS, &other, &c) == IGI_E_USAGE && !c);
    CHECK_CONTAINS(igi_context_message(ctx), "no markers 9X9_1");
    /* A plain chessboard is not seen whole in the parts. */
    other.markers = NULL;
    CHECK(igi_calibrate_chessboard(ctx, paths + 5, 4, &other, &c) == IGI_E_DATA && !c);
    for (int k = 0; k < VIEWS; k++) remove(paths[k]);
    igi_context_destroy(ctx);
}

TEST_MAIN({"a_lens_from_parts_of_the_board", a_lens_from_parts_of_the_board})
