/* SPDX-License-Identifier: Apache-2.0
 *
 * Brackets: synthetic ones against the Cramér-Rao bound, real ones against their reference.
 */
#include "test.h"

#include "base/context.h"
#include "base/rng.h"

#include <igi/hdr.h>

#include <png.h>
#include <sys/resource.h>

static double gaussian(igi_rng *rng)
{
    double u = 1 - (double)igi_rng_float(rng), v = (double)igi_rng_float(rng);
    return sqrt(-2 * log(u)) * cos(2 * 3.14159265358979 * v);
}

static double poisson(igi_rng *rng, double mean)
{
    if (mean > 60) return floor(mean + sqrt(mean) * gaussian(rng) + .5);
    double limit = exp(-mean), product = 1;
    int count = -1;
    do {
        product *= 1 - (double)igi_rng_float(rng);
        count++;
    } while (product > limit);
    return count;
}

/* A linear grey camera of 16 bits. */
#define FULL_WELL 20000.
#define READ_CODES 10.
#define WIDTH 700
#define HEIGHT 160

/* Radiance: six decades along x. */
static double radiance_at(int x)
{
    return pow(10, -3 + 6. * (x + .5) / WIDTH) * .93;
}

/* Patches of 8 pixels, some dimmer: something to align by. */
static double texture_at(int x, int y)
{
    return igi_hash64((uint64_t)(x + 800) / 8 * 1000 + (uint64_t)y / 8) % 2 ? .6 : 1;
}

/* Something dark that passes through one photograph. */
static bool passer_by;

static bool is_passer_by(int x, int y)
{
    return x >= 200 && x < 320 && y >= 40 && y < 120;
}

static void write_exposure(const char *path, double h, uint64_t seed, int shift_x)
{
    static uint16_t codes[WIDTH * HEIGHT];
    igi_rng rng = igi_rng_make(seed, 1);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        int x = i % WIDTH - shift_x;
        double radiance = radiance_at(x < 0 ? 0 : x) * texture_at(x, i / WIDTH);
        if (passer_by && is_passer_by(i % WIDTH, i / WIDTH)) radiance *= .4;
        double e = poisson(&rng, FULL_WELL * radiance * h);
        double code = e * 65535 / FULL_WELL + READ_CODES * gaussian(&rng);
        codes[i] = (uint16_t)fmax(0, fmin(65535, floor(code + .5)));
    }
    png_image writer = {.version = PNG_IMAGE_VERSION,
                        .width = WIDTH,
                        .height = HEIGHT,
                        .format = PNG_FORMAT_LINEAR_Y};
    if (!png_image_write_to_file(&writer, path, 0, codes, 0, NULL)) abort();
}

#define FRAMES 6
static const double true_h[FRAMES] = {1, 1. / 4, 1. / 16, 1. / 64, 1. / 256, 1. / 1024};

static void make_bracket(igi_exposure exposures[FRAMES], char paths[FRAMES][40], int shift_x)
{
    for (int i = 0; i < FRAMES; i++) {
        snprintf(paths[i], 40, "test_hdr_%d.png", i);
        write_exposure(paths[i], true_h[i], 10 + (uint64_t)i, i == 0 ? shift_x : 0);
        exposures[i] = (igi_exposure){.path = paths[i], .time_s = true_h[i]};
    }
}

static void remove_bracket(char paths[FRAMES][40])
{
    for (int i = 0; i < FRAMES; i++) remove(paths[i]);
}

/* var(E) >= 1 / sum h^2/var(x) over the exposures that do not clip. */
static double bound_at(double radiance)
{
    double information = 0, read = READ_CODES / 65535;
    for (int i = 0; i < FRAMES; i++) {
        double x = radiance * true_h[i];
        if (x > .98) continue;
        information += true_h[i] * true_h[i] / (x / FULL_WELL + read * read);
    }
    return 1 / information;
}

static void merges_at_the_cramer_rao_bound(void)
{
    igi_context *ctx = test_context(1);
    igi_exposure exposures[FRAMES];
    char paths[FRAMES][40];
    igi_merge_options options;
    igi_merged *merged = NULL;
    make_bracket(exposures, paths, 0);
    igi_merge_options_init(&options);
    options.full_well_e = FULL_WELL;
    options.read_noise = READ_CODES;
    options.refine = false;
    CHECK_OK(ctx, igi_merge(ctx, exposures, FRAMES, &options, &merged));
    if (merged) {
        CHECK(merged->image->channels == 3 && merged->response->levels == 65536);
        CHECK_STR(merged->image->names[0], "Y");
        CHECK_STR(merged->image->names[1], "saturated");
        CHECK_STR(merged->image->names[2], "variance.Y");
        double loss = 0, stated = 0, worst = 0;
        for (int decade = 0; decade < 6; decade++) {
            double bias = 0;
            int count = 0;
            for (int x = decade * WIDTH / 6; x < (decade + 1) * WIDTH / 6; x++)
                for (int y = 0; y < HEIGHT; y++, count++) {
                    const float *p = merged->image->samples + (y * WIDTH + x) * 3;
                    double truth = radiance_at(x) * texture_at(x, y), off = (double)p[0] - truth;
                    bias += off / truth;
                    loss += off * off / bound_at(truth) / (WIDTH * HEIGHT);
                    stated += off * off / (double)p[2] / (WIDTH * HEIGHT);
                }
            CHECK_NEAR(bias / count, 0, .003);
            worst = fmax(worst, fabs(bias / count));
        }
        printf("variance %.3f of the Cramer-Rao bound, largest bias of a decade %.3f %%\n", loss,
               100 * worst);
        CHECK_NEAR(loss, 1, .05);
        CHECK_NEAR(stated, 1, .05);
        CHECK_NEAR(merged->scatter, 1, .05);
    }
    igi_merged_destroy(merged);
    remove_bracket(paths);
    igi_context_destroy(ctx);
}

static void ratios_are_recovered(void)
{
    static const double rounded[FRAMES] = {1.06, .95, 1, 1.05, .97, 1.03};
    igi_context *ctx = test_context(1);
    igi_exposure exposures[FRAMES];
    char paths[FRAMES][40];
    igi_merged *merged = NULL;
    make_bracket(exposures, paths, 6);
    for (int i = 0; i < FRAMES; i++) exposures[i].time_s *= rounded[i];
    CHECK_OK(ctx, igi_merge(ctx, exposures, FRAMES, NULL, &merged));
    for (int i = 0; merged && i + 1 < FRAMES; i++) {
        CHECK_NEAR(merged->frames[i].used / merged->frames[i + 1].used, 4, .005 * 4);
        CHECK_NEAR(merged->frames[i].stated, exposures[i].time_s, 1e-12);
    }
    if (merged) {
        double h = 1, worst = 0;
        for (int i = 0; i + 1 < FRAMES; i++)
            worst = fmax(worst, fabs(merged->frames[i].used / merged->frames[i + 1].used / 4 - 1));
        printf("exposure ratios within %.3f %%\n", 100 * worst);
        for (int i = 0; i < FRAMES; i++) h *= merged->frames[i].used / merged->frames[i].stated;
        CHECK_NEAR(h, 1, 1e-9); /* the unit stays */
        CHECK(merged->frames[0].shift_x - merged->frames[1].shift_x == 6);
        CHECK(merged->frames[0].shift_y == 0);
    }
    igi_merged_destroy(merged);
    merged = NULL;
    exposures[2].time_s *= 2;
    CHECK(igi_merge(ctx, exposures, FRAMES, NULL, &merged) == IGI_E_DATA && !merged);
    CHECK_CONTAINS(igi_context_message(ctx), "test_hdr_2.png: false exposures");
    remove_bracket(paths);
    igi_context_destroy(ctx);
}

/* The same through a curve and 8 bits, both well known. */
static void write_srgb(const char *path, double h, uint64_t seed)
{
    static uint8_t codes[WIDTH * HEIGHT];
    igi_rng rng = igi_rng_make(seed, 1);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        double light = radiance_at(i % WIDTH) * texture_at(i % WIDTH, i / WIDTH);
        double x = fmax(0, fmin(1, poisson(&rng, FULL_WELL * light * h) / FULL_WELL));
        double code = x <= .0031308 ? 12.92 * x : 1.055 * pow(x, 1 / 2.4) - .055;
        codes[i] = (uint8_t)floor(255 * code + .5);
    }
    png_image writer = {
        .version = PNG_IMAGE_VERSION, .width = WIDTH, .height = HEIGHT, .format = PNG_FORMAT_GRAY};
    if (!png_image_write_to_file(&writer, path, 0, codes, 0, NULL)) abort();
}

static void ratios_by_a_known_curve(void)
{
    static const double rounded[4] = {1.05, .96, 1.02, .97};
    igi_context *ctx = test_context(1);
    igi_exposure exposures[4];
    char paths[4][40];
    igi_merged *merged = NULL;
    igi_merge_options options;
    for (int i = 0; i < 4; i++) {
        snprintf(paths[i], 40, "test_hdr_srgb_%d.png", i);
        write_srgb(paths[i], true_h[i], 70 + (uint64_t)i);
        exposures[i] = (igi_exposure){.path = paths[i], .time_s = true_h[i] * rounded[i]};
    }
    igi_merge_options_init(&options);
    options.response = IGI_RESPONSE_SRGB;
    CHECK_OK(ctx, igi_merge(ctx, exposures, 4, &options, &merged));
    for (int i = 0; merged && i + 1 < 4; i++)
        CHECK_NEAR(merged->frames[i].used / merged->frames[i + 1].used, 4, .005 * 4);
    igi_merged_destroy(merged);
    for (int i = 0; i < 4; i++) remove(paths[i]);
    igi_context_destroy(ctx);
}

static void what_all_clip_is_marked(void)
{
    igi_context *ctx = test_context(1);
    char path[] = "test_hdr_one.png";
    igi_exposure exposure = {.path = path, .time_s = 10};
    igi_merged *merged = NULL;
    write_exposure(path, 1, 1, 0);
    CHECK_OK(ctx, igi_merge(ctx, &exposure, 1, NULL, &merged));
    for (int x = 0; merged && x < WIDTH; x++) {
        const float *p = merged->image->samples + x * 3;
        double truth = radiance_at(x) * texture_at(x, 0) /
                       10; /* the time was stated ten times too long */
        if (truth > .101) CHECK(p[1] == 1 && p[0] == .1f);
        if (truth < .085) CHECK(p[1] == 0);
    }
    if (merged) CHECK(merged->frames[0].saturated > .4 && merged->frames[0].saturated < .6);
    igi_merged_destroy(merged);
    remove(path);
    igi_context_destroy(ctx);
}

/* A thing that only the shorter exposures show is left out, and the pixels are marked. */
static void what_moves_is_marked(void)
{
    igi_context *ctx = test_context(1);
    char paths[3][40];
    igi_exposure exposures[3];
    igi_merged *merged = NULL;
    for (int i = 0; i < 3; i++) {
        snprintf(paths[i], 40, "test_hdr_moving_%d.png", i);
        passer_by = i == 1;
        write_exposure(paths[i], true_h[i], 30 + (uint64_t)i, 0);
        exposures[i] = (igi_exposure){.path = paths[i], .time_s = true_h[i]};
    }
    passer_by = false;
    CHECK_OK(ctx, igi_merge(ctx, exposures, 3, NULL, &merged));
    int marked = 0, wrong = 0, inside = 0;
    for (int i = 0; merged && i < WIDTH * HEIGHT; i++) {
        const float *p = merged->image->samples + 3 * (size_t)i;
        double truth = radiance_at(i % WIDTH) * texture_at(i % WIDTH, i / WIDTH);
        bool there = is_passer_by(i % WIDTH, i / WIDTH);
        if (truth < .25 || truth > .8) continue;
        inside += there;
        marked += there && p[1] == .5f;
        wrong += (there && !(fabs((double)p[0] / truth - 1) < .1)) || (!there && p[1] != 0);
    }
    if (merged) {
        CHECK(inside > 500 && marked > inside * 9 / 10);
        CHECK(wrong < 20);
        CHECK(merged->frames[1].moved > .005 && merged->frames[2].moved < .001);
    }
    igi_merged_destroy(merged);
    for (int i = 0; i < 3; i++) remove(paths[i]);
    igi_context_destroy(ctx);
}

/* A picture of turned squares, some of them fifty times as bright as others, moved and turned about the
 * picture's centre. */
#define SIDE_X 330
#define SIDE_Y 250

typedef struct movement {
    double x, y, deg;
} movement;

static double scene_at(double x, double y)
{
    double u = .94 * x + .34 * y + 2000, v = .94 * y - .34 * x + 2000;
    uint64_t cell = igi_hash64((uint64_t)(u / 13) * 1000 + (uint64_t)(v / 13));
    return .008 * pow(60, (double)(cell % 1000) / 999);
}

static double moved_scene_at(const movement *m, double x, double y)
{
    double angle = m->deg * 3.14159265358979 / 180;
    double px = x - m->x - SIDE_X / 2., py = y - m->y - SIDE_Y / 2.;
    return scene_at(cos(angle) * px + sin(angle) * py, cos(angle) * py - sin(angle) * px);
}

/* The mean over two by two pixels, as a lens that resolves no more than the sensor throws it. */
static double pixel_of(const movement *m, int x, int y)
{
    double sum = 0;
    for (int k = 0; k < 16; k++)
        sum += moved_scene_at(m, x - .5 + (k % 4 + .5) / 2, y - .5 + (k / 4 + .5) / 2) / 16;
    return sum;
}

/* 8 bits with a curve, or 16 linear ones. */
static void write_moved(const char *path, double h, const movement *m, int bits, uint64_t seed)
{
    static uint16_t wide[SIDE_X * SIDE_Y];
    static uint8_t narrow[SIDE_X * SIDE_Y];
    igi_rng rng = igi_rng_make(seed, 1);
    for (int i = 0; i < SIDE_X * SIDE_Y; i++) {
        double x = h * pixel_of(m, i % SIDE_X, i / SIDE_X);
        x = (poisson(&rng, FULL_WELL * x) + 6 * gaussian(&rng)) / FULL_WELL;
        x = fmax(0, fmin(1, x));
        narrow[i] = (uint8_t)(255 * pow(x, 1 / 2.2) + .5);
        wide[i] = (uint16_t)(65535 * x + .5);
    }
    png_image writer = {.version = PNG_IMAGE_VERSION,
                        .width = SIDE_X,
                        .height = SIDE_Y,
                        .format = bits == 8 ? PNG_FORMAT_GRAY : PNG_FORMAT_LINEAR_Y};
    const void *codes = bits == 8 ? (const void *)narrow : (const void *)wide;
    if (!png_image_write_to_file(&writer, path, 0, codes, 0, NULL)) abort();
}

#define MOVED 3

static igi_merged *merge_moved(igi_context *ctx, const movement moves[MOVED], int bits, bool align)
{
    char paths[MOVED][40];
    igi_exposure exposures[MOVED];
    igi_merge_options options;
    igi_merged *merged = NULL;
    igi_merge_options_init(&options);
    options.align = align;
    for (int i = 0; i < MOVED; i++) {
        snprintf(paths[i], 40, "test_hdr_moved_%d.png", i);
        write_moved(paths[i], pow(3, i), &moves[i], bits, 40 + (uint64_t)i);
        exposures[i] = (igi_exposure){.path = paths[i], .time_s = pow(3, i)};
    }
    CHECK_OK(ctx, igi_merge(ctx, exposures, MOVED, &options, &merged));
    for (int i = 0; i < MOVED; i++) remove(paths[i]);
    if (!merged) abort();
    return merged;
}

/* Root mean square of the relative error against the scene as the last photograph stands to it. */
static double error_of(const igi_merged *merged, const movement *reference)
{
    double sum = 0;
    int count = 0;
    for (int y = 8; y < SIDE_Y - 8; y++)
        for (int x = 8; x < SIDE_X - 8; x++, count++) {
            const float *p = merged->image->samples + (y * SIDE_X + x) * merged->image->channels;
            double truth = pixel_of(reference, x, y);
            sum += ((double)p[0] / truth - 1) * ((double)p[0] / truth - 1);
        }
    return sqrt(sum / count);
}

static void parts_of_a_pixel_and_turns(void)
{
    static const movement cases[][MOVED] = {{{.3, 0, 0}, {0, .3, 0}, {0, 0, 0}},
                                            {{1.7, -.3, 0}, {-.6, 1.4, 0}, {0, 0, 0}},
                                            {{0, 0, .1}, {.3, .3, -.1}, {0, 0, 0}}};
    const double to_corner = hypot(SIDE_X, SIDE_Y) / 2 * 3.14159265358979 / 180;
    igi_context *ctx = test_context(1);
    for (int k = 0; k < 6; k++) {
        const movement *moves = cases[k / 2];
        int bits = k % 2 ? 16 : 8;
        igi_merged *merged = merge_moved(ctx, moves, bits, true);
        for (int i = 0; i < MOVED; i++) {
            const igi_merged_frame *f = &merged->frames[i], *last = &merged->frames[MOVED - 1];
            printf("%d bits: %+.3f %+.3f px, %+.4f deg\n", bits, f->shift_x, f->shift_y,
                   f->rotation_deg);
            CHECK_NEAR(f->shift_x - last->shift_x, moves[i].x, .05);
            CHECK_NEAR(f->shift_y - last->shift_y, moves[i].y, .05);
            CHECK_NEAR(f->rotation_deg * to_corner, moves[i].deg * to_corner, .05);
        }
        if (bits == 16) {
            /* The last one shows most; it is not resampled. */
            const igi_merged_frame *f = &merged->frames[MOVED - 1];
            CHECK(f->shift_x == rint(f->shift_x) && f->rotation_deg == 0);
            movement at = {-f->shift_x, -f->shift_y, 0};
            igi_merged *left = merge_moved(ctx, moves, bits, false);
            double with = error_of(merged, &at), without = error_of(left, &moves[MOVED - 1]);
            printf("error %.4f, without aligning %.4f\n", with, without);
            CHECK(with < .7 * without);
            igi_merged_destroy(left);
        }
        igi_merged_destroy(merged);
    }
    igi_context_destroy(ctx);
}

/* Not a bit changes where nothing has moved. */
static void what_lies_still_is_not_resampled(void)
{
    static const movement still[MOVED];
    igi_context *ctx = test_context(1);
    for (int bits = 8; bits <= 16; bits += 8) {
        igi_merged *a = merge_moved(ctx, still, bits, true),
                   *b = merge_moved(ctx, still, bits, false);
        size_t size = (size_t)(SIDE_X * SIDE_Y * a->image->channels) * sizeof(float);
        CHECK(memcmp(a->image->samples, b->image->samples, size) == 0);
        igi_merged_destroy(a);
        igi_merged_destroy(b);
    }
    igi_context_destroy(ctx);
}

/* Brackets that are none, each with a sentence. */
static void write_even(const char *path, int bits, double light)
{
    static uint16_t wide[80 * 60];
    static uint8_t narrow[80 * 60];
    for (int i = 0; i < 80 * 60; i++) {
        double x = fmin(1, light * (.2 + .8 * (i % 80 / 79.)));
        wide[i] = (uint16_t)(65535 * pow(x, bits == 16 ? 1 : 1 / 2.2) + .5);
        narrow[i] = (uint8_t)(255 * x + .5);
    }
    png_image writer = {.version = PNG_IMAGE_VERSION,
                        .width = 80,
                        .height = 60,
                        .format = bits == 8 ? PNG_FORMAT_GRAY : PNG_FORMAT_LINEAR_Y};
    const void *codes = bits == 8 ? (const void *)narrow : (const void *)wide;
    if (!png_image_write_to_file(&writer, path, 0, codes, 0, NULL)) abort();
}

static void what_is_wrong_is_said(void)
{
    enum { GAMMA_16 = 17 }; /* 16 bits with a curve */
    static const struct {
        int bits;
        double light[2], time_s[2];
        const char *sentence;
    } cases[] = {
        {16, {9, 36}, {1, 4}, "test_hdr_wrong_0.png: saturated everywhere"},
        {8, {9, 36}, {1, 4}, "test_hdr_wrong_0.png: saturated everywhere"},
        {16, {1e-4, 4e-4}, {1, 4}, "test_hdr_wrong_1.png: black everywhere"},
        {8, {.005, .02}, {1, 4}, "test_hdr_wrong_1.png: black everywhere"},
        {16, {.5, .5}, {1, 1}, "test_hdr_wrong_1.png: the same picture as test_hdr_wrong_0.png"},
        {8, {.5, .5}, {1, 1}, "test_hdr_wrong_1.png: the same picture as test_hdr_wrong_0.png"},
        {GAMMA_16, {.1, .4}, {1, 4}, "or say --response recovered"},
    };
    igi_context *ctx = test_context(1);
    char paths[2][40];
    igi_exposure exposures[2];
    igi_merged *merged = NULL;
    for (size_t k = 0; k < sizeof cases / sizeof cases[0]; k++) {
        for (int i = 0; i < 2; i++) {
            snprintf(paths[i], 40, "test_hdr_wrong_%d.png", i);
            write_even(paths[i], cases[k].bits, cases[k].light[i]);
            exposures[i] = (igi_exposure){.path = paths[i], .time_s = cases[k].time_s[i]};
        }
        CHECK(igi_merge(ctx, exposures, 2, NULL, &merged) == IGI_E_DATA && !merged);
        CHECK_CONTAINS(igi_context_message(ctx), cases[k].sentence);
    }
    write_even(paths[0], 8, .9);
    CHECK_OK(ctx, igi_merge(ctx, exposures, 1, NULL, &merged));
    CHECK(merged && merged->warning);
    if (merged && merged->warning) CHECK_CONTAINS(merged->warning, "sRGB's is assumed");
    igi_merged_destroy(merged);
    remove(paths[0]);
    remove(paths[1]);
    igi_context_destroy(ctx);
}

static void every_allocation_may_fail(void)
{
    igi_context *ctx = test_context(1);
    char path[] = "test_hdr_one.png", other[] = "test_hdr_two.png";
    igi_exposure exposures[2] = {{.path = path, .time_s = 1}, {.path = other, .time_s = .25}};
    igi_merge_options options;
    igi_merged *merged = NULL;
    igi_merge_options_init(&options);
    options.response = IGI_RESPONSE_RECOVERED;
    options.align = false;
    write_exposure(path, 1, 1, 0);
    write_exposure(other, .25, 2, 0);
    long failures = 0;
    for (igi_status status = IGI_E_SYSTEM; status != IGI_OK && failures < 200; failures++) {
        igi_fail_allocation_after(ctx, failures);
        status = igi_merge(ctx, exposures, 2, &options, &merged);
        if (status != IGI_OK) CHECK(status == IGI_E_SYSTEM && !merged);
    }
    CHECK(merged && failures > 10 && failures < 200);
    igi_fail_allocation_after(ctx, -1);
    igi_merged_destroy(merged);
    remove(path);
    remove(other);
    igi_context_destroy(ctx);
}

static void write_text(const char *path, const char *text)
{
    FILE *file = fopen(path, "w");
    if (!file) abort();
    fputs(text, file);
    fclose(file);
}

static void lists(void)
{
    static const char *const bad[][2] = {
        {"a.png\n", "test_hdr.txt:1: no exposure time for 'a.png'"},
        {"# x\n\na.png 1\nb.png 0\n", "test_hdr.txt:4: no exposure time for 'b.png'"},
        {"a.png 1 8 100 7\n", "test_hdr.txt:1: 'a.png' is followed by"},
        {"a.png 1s\n", "test_hdr.txt:1: no exposure time"},
        {"a.png 1 0.0625\n", "test_hdr.txt:1: 0.0625 is no f-number"},
        {"# nothing\n", "test_hdr.txt: it lists no image"},
    };
    igi_context *ctx = test_context(1);
    igi_exposure *exposures = NULL;
    size_t count = 0;
    write_text("test_hdr.txt", "# name seconds f iso\nsub/a.png 1/60 5.6 200 # first\n/b.png .5\n");
    CHECK_OK(ctx, igi_exposures_read(ctx, "./test_hdr.txt", &exposures, &count));
    CHECK(count == 2);
    if (count == 2) {
        CHECK_STR(exposures[0].path, "./sub/a.png");
        CHECK_NEAR(exposures[0].time_s, 1. / 60, 1e-15);
        CHECK_NEAR(exposures[0].f_number, 5.6, 0);
        CHECK_NEAR(exposures[0].iso, 200, 0);
        CHECK_STR(exposures[1].path, "/b.png");
        CHECK(exposures[1].time_s == .5 && exposures[1].iso == 0 && !exposures[1].from_camera);
    }
    igi_exposures_destroy(exposures, count);
    for (size_t i = 0; i < sizeof bad / sizeof bad[0]; i++) {
        write_text("test_hdr.txt", bad[i][0]);
        CHECK(igi_exposures_read(ctx, "test_hdr.txt", &exposures, &count) == IGI_E_DATA);
        CHECK(!exposures && count == 0);
        CHECK_CONTAINS(igi_context_message(ctx), bad[i][1]);
    }
    remove("test_hdr.txt");
    igi_context_destroy(ctx);
}

/* The frames of a list of others, "name a b", whose time is column `column`, or 1 over it. */
static size_t read_foreign_list(const char *list, const char *folder, int column, bool inverse,
                                igi_exposure *exposures, char paths[][700], size_t most)
{
    FILE *file = fopen(list, "r");
    char line[300], name[100];
    double numbers[2];
    size_t count = 0;
    while (file && count < most && fgets(line, sizeof line, file)) {
        if (sscanf(line, "%99s %lf %lf", name, &numbers[0], &numbers[1]) != 3) continue;
        char *end = strstr(name, ".ppm");
        if (end) memcpy(end, ".png", 4);
        snprintf(paths[count], 700, "%s/%s", folder, name);
        double time = inverse ? 1 / numbers[column] : numbers[column];
        exposures[count] = (igi_exposure){.path = paths[count], .time_s = time};
        count++;
    }
    if (file) fclose(file);
    return count;
}

/* Radiance's RGBE with new run-length encoding (Ward 1991). */
static float *read_rgbe(const char *path, int *width, int *height)
{
    char line[200];
    FILE *file = fopen(path, "rb");
    if (!file) abort();
    while (fgets(line, sizeof line, file) && sscanf(line, "-Y %d +X %d", height, width) != 2) {}
    size_t w = (size_t)*width, h = (size_t)*height;
    float *pixels = calloc(w * h * 3, sizeof *pixels);
    uint8_t *row = malloc(w * 4);
    if (!pixels || !row) abort();
    for (size_t y = 0; y < h; y++) {
        for (int k = 0; k < 4; k++) (void)fgetc(file); /* 2 2 width */
        for (size_t c = 0; c < 4; c++)
            for (size_t x = 0; x < w;) {
                int n = fgetc(file), value = n > 128 ? fgetc(file) : 0;
                if (n <= 0) abort();
                for (int k = n > 128 ? n - 128 : n; k-- > 0 && x < w; x++)
                    row[c * w + x] = (uint8_t)(n > 128 ? value : fgetc(file));
            }
        for (size_t x = 0; x < w; x++)
            for (size_t c = 0; c < 3; c++)
                pixels[(y * w + x) * 3 + c] = (float)ldexp(row[c * w + x] + .5,
                                                           row[3 * w + x] - 136);
    }
    free(row);
    fclose(file);
    return pixels;
}

static int by_value(const void *a, const void *b)
{
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

/* Correlation of the logarithms, and the median of |log2 difference| after one scale. */
static void compare(const double *got, const double *want, size_t count, double *correlation,
                    double *stops)
{
    double sx = 0, sy = 0, sxx = 0, syy = 0, sxy = 0, n = (double)count;
    double *difference = malloc(count * sizeof *difference);
    if (!difference) abort();
    for (size_t i = 0; i < count; i++) {
        sx += got[i], sy += want[i];
        sxx += got[i] * got[i], syy += want[i] * want[i], sxy += got[i] * want[i];
        difference[i] = got[i] - want[i];
    }
    *correlation = (n * sxy - sx * sy) / sqrt((n * sxx - sx * sx) * (n * syy - sy * sy));
    qsort(difference, count, sizeof *difference, by_value);
    double scale = difference[count / 2];
    for (size_t i = 0; i < count; i++) difference[i] = fabs(difference[i] - scale);
    qsort(difference, count, sizeof *difference, by_value);
    *stops = difference[count / 2];
    free(difference);
}

/* Where no photograph has the pure blue of registration's padding, nor next to it. */
static uint8_t *inside_mask(igi_context *ctx, const igi_exposure *exposures, size_t count, int w,
                            int h)
{
    uint8_t *mask = malloc((size_t)(w * h));
    if (!mask) abort();
    memset(mask, 1, (size_t)(w * h));
    for (size_t i = 0; i < count; i++) {
        igi_photo *photo = NULL;
        CHECK_OK(ctx, igi_photo_load(ctx, exposures[i].path, &photo));
        for (int k = 0; photo && k < w * h; k++) {
            const uint16_t *p = photo->codes + k * 3;
            if (p[0] || p[1] || p[2] != 255) continue;
            for (int y = k / w - 1; y <= k / w + 1; y++)
                for (int x = k % w - 1; x <= k % w + 1; x++)
                    if (x >= 0 && y >= 0 && x < w && y < h) mask[y * w + x] = 0;
        }
        igi_photo_destroy(photo);
    }
    for (int k = 0; k < w * h; k++)
        if (k % w < 4 || k % w >= w - 4 || k / w < 4 || k / w >= h - 4) mask[k] = 0;
    return mask;
}

/* Merges, and compares each colour with the reference: correlation and stops. */
static void judge_memorial(igi_context *ctx, const igi_exposure *exposures, size_t count,
                           const igi_merge_options *options, const float *want, const uint8_t *mask,
                           double result[3][2])
{
    igi_merged *merged = NULL;
    CHECK_OK(ctx, igi_merge(ctx, exposures, count, options, &merged));
    if (!merged) return;
    const igi_image *image = merged->image;
    size_t pixels = (size_t)image->width * (size_t)image->height;
    double *a = malloc(pixels * sizeof *a), *b = malloc(pixels * sizeof *b);
    if (!a || !b) abort();
    for (size_t c = 0; c < 3; c++) {
        size_t used = 0;
        for (size_t k = 0; k < pixels; k++) {
            double x = (double)image->samples[k * (size_t)image->channels + c];
            double y = (double)want[k * 3 + c];
            if (!mask[k] || !(x > 0) || y < 2e-4) continue; /* a hundredth of the median */
            a[used] = log2(x);
            b[used++] = log2(y);
        }
        compare(a, b, used, &result[c][0], &result[c][1]);
        printf("memorial %c: correlation %.4f, %.3f stop\n", "RGB"[c], result[c][0], result[c][1]);
    }
    free(a);
    free(b);
    igi_merged_destroy(merged);
}

static void memorial_church(void)
{
    char list[600], folder[600], reference[600];
    igi_exposure exposures[16];
    static char paths[16][700];
    double ours[3][2] = {{0}}, theirs[3][2] = {{0}};
    igi_merge_options options;
    int w = 0, h = 0;
    if (!test_shared_data("real/hdr_memorial/memorial.hdr_image_list.txt", list, sizeof list) ||
        !test_shared_data("real/hdr_memorial/memorial_reference.hdr", reference,
                          sizeof reference) ||
        !test_shared_data("real/hdr_memorial", folder, sizeof folder))
        return;
    igi_context *ctx = test_context(1);
    size_t count = read_foreign_list(list, folder, 0, true, exposures, paths, 16);
    CHECK(count == 16);
    float *want = read_rgbe(reference, &w, &h);
    uint8_t *mask = inside_mask(ctx, exposures, count, w, h);
    judge_memorial(ctx, exposures, count, NULL, want, mask, ours);
    for (int c = 0; c < 3; c++) CHECK(ours[c][0] > .9987 && ours[c][1] < .04);
    /* In one run with OpenCV's two methods, on every second exposure to save time. */
    for (size_t i = 0; i < 8; i++) exposures[i] = exposures[2 * i];
    igi_merge_options_init(&options);
    judge_memorial(ctx, exposures, 8, &options, want, mask, ours);
    options.align = false;
    for (int k = 0; k < 2; k++) {
        options.response = k ? IGI_RESPONSE_ROBERTSON : IGI_RESPONSE_DEBEVEC;
        options.method = k ? IGI_MERGE_ROBERTSON : IGI_MERGE_DEBEVEC;
        printf("OpenCV's %s:\n", k ? "Robertson" : "Debevec");
        judge_memorial(ctx, exposures, 8, &options, want, mask, theirs);
        for (int c = 0; c < 3; c++) CHECK(ours[c][0] > theirs[c][0] && ours[c][1] < theirs[c][1]);
    }
    free(mask);
    free(want);
    igi_context_destroy(ctx);
}

static void false_list_is_refused(void)
{
    char list[600], folder[600];
    igi_exposure exposures[9];
    static char paths[9][700];
    if (!test_shared_data("real/hdr_ssarcandy_living_room1/image_list.txt", list, sizeof list) ||
        !test_shared_data("real/hdr_ssarcandy_living_room1", folder, sizeof folder))
        return;
    igi_context *ctx = test_context(1);
    igi_merged *merged = NULL;
    size_t count = read_foreign_list(list, folder, 0, false, exposures, paths, 9);
    CHECK(count == 9);
    CHECK(igi_merge(ctx, exposures, count, NULL, &merged) == IGI_E_DATA && !merged);
    static const char *const frames[] = {"DSC_0071", "DSC_0072", "DSC_0073", "DSC_0074",
                                         "DSC_0075"};
    for (int i = 0; i < 5; i++) CHECK_CONTAINS(igi_context_message(ctx), frames[i]);
    CHECK(!strstr(igi_context_message(ctx), "DSC_0069"));
    CHECK(!strstr(igi_context_message(ctx), "DSC_0077"));
    igi_context_destroy(ctx);
}

static void merge_by_exif(const char *folder, const char *const *names, size_t count,
                          igi_merged **merged)
{
    char path[600], storage[8][700];
    const char *paths[8];
    igi_exposure *exposures = NULL;
    *merged = NULL;
    if (!test_shared_data(folder, path, sizeof path)) return;
    igi_context *ctx = test_context(1);
    for (size_t i = 0; i < count; i++) {
        snprintf(storage[i], sizeof storage[i], "%s/%s", path, names[i]);
        paths[i] = storage[i];
    }
    CHECK_OK(ctx, igi_exposures_probe(ctx, paths, count, &exposures));
    if (exposures) CHECK_OK(ctx, igi_merge(ctx, exposures, count, NULL, merged));
    igi_exposures_destroy(exposures, count);
    igi_context_destroy(ctx);
}

static void canon_by_exif(void)
{
    static const char *const names[] = {"IMG_2600.jpg", "IMG_2601.jpg", "IMG_2602.jpg"};
    igi_merged *merged = NULL;
    merge_by_exif("real/hdr_frobisher_canon", names, 3, &merged);
    if (!merged) return;
    CHECK(merged->image->width == 640 && merged->image->height == 426);
    CHECK_NEAR(merged->frames[0].stated, 1 / 8. / 64, 1e-9);
    CHECK(!merged->warning);
    igi_merged_destroy(merged);
}

static void phone_by_exif(void)
{
    static const char *const names[] = {"IMG_3873.jpeg", "IMG_3869.jpeg", "IMG_3871.jpeg"};
    igi_merged *merged = NULL;
    merge_by_exif("real/hdr_iphonexr", names, 3, &merged);
    if (!merged) return;
    CHECK(merged->image->width == 3024 && merged->image->height == 4032);
    /* Streaming: beside the result there are two photographs at a time, 6 bytes a pixel each. */
    struct rusage usage;
    double pixels = 3024. * 4032;
    if (getrusage(RUSAGE_SELF, &usage) != 0) abort();
    printf("phone: %.1f bytes a pixel, 28 of them the result\n",
           (double)usage.ru_maxrss * 1024 / pixels);
#ifndef __SANITIZE_ADDRESS__ /* which keeps what is freed for a while */
    CHECK((double)usage.ru_maxrss * 1024 < (28 + 3 * 8) * pixels);
#endif
    /* The hand that pressed the button moved the phone by some pixels. */
    CHECK(fabs(merged->frames[0].shift_x - merged->frames[1].shift_x) <= 8);
    CHECK(merged->frames[1].shift_x == 0 && merged->frames[1].shift_y == 0);
    CHECK_CONTAINS(merged->warning ? merged->warning : "", "processed the photographs differently");
    igi_merged_destroy(merged);
}

/* The response of bracket files by each way against the camera's, gamma 2.2 with a shoulder: the
 * largest error of ln exposure over the middle codes. */
static double response_error(igi_context *ctx, const igi_exposure *exposures, size_t count,
                             igi_response_kind kind, const char *basis)
{
    igi_merge_options options;
    igi_merged *merged = NULL;
    double worst = 1, first = 0;
    igi_merge_options_init(&options);
    options.response = kind;
    options.basis_path = basis;
    options.align = false;
    CHECK_OK(ctx, igi_merge(ctx, exposures, count, &options, &merged));
    for (int z = 8000; merged && z < 60000; z += 500) {
        double u = pow(z / 65535., 2.2), truth = 1.5 * u / (2.5 - u);
        double off = log((double)merged->response->exposure[z] / truth);
        if (z == 8000) first = off, worst = 0;
        worst = fmax(worst, fabs(off - first));
    }
    igi_merged_destroy(merged);
    return worst;
}

static void write_curved(const char *path, double h, uint64_t seed)
{
    static uint16_t codes[WIDTH * HEIGHT];
    igi_rng rng = igi_rng_make(seed, 1);
    for (int i = 0; i < WIDTH * HEIGHT; i++) {
        double light = radiance_at(i % WIDTH) * texture_at(i % WIDTH, i / WIDTH);
        double x = fmax(0, fmin(1, poisson(&rng, FULL_WELL * light * h) / FULL_WELL));
        codes[i] = (uint16_t)(65535 * pow(2.5 * x / (1.5 + x), 1 / 2.2));
    }
    png_image writer = {.version = PNG_IMAGE_VERSION,
                        .width = WIDTH,
                        .height = HEIGHT,
                        .format = PNG_FORMAT_LINEAR_Y};
    if (!png_image_write_to_file(&writer, path, 0, codes, 0, NULL)) abort();
}

/* Root mean square of what a recovered curve is off, but for a factor, in units of its deviation. */
static double sigmas_off(const igi_response *r)
{
    double sum = 0, square = 0;
    int count = 0;
    for (int z = 6500; z < 58000; z += 250, count++) { /* where a bracket has much to say */
        double u = pow(z / 65535., 2.2), truth = 1.5 * u / (2.5 - u);
        double off = log((double)r->exposure[z] / truth);
        sum += off, square += off * off;
    }
    double rms = sqrt(square / count - sum * sum / count / count);
    printf("off by %.4f, stated %.4f\n", rms, r->deviation);
    return rms / r->deviation;
}

static void deviation_of_a_response(void)
{
    igi_context *ctx = test_context(1);
    char paths[4][40];
    igi_exposure exposures[4];
    igi_merge_options options;
    igi_merge_options_init(&options);
    options.response = IGI_RESPONSE_RECOVERED;
    for (int k = 0; k < 5; k++) { /* the last two with false times, which three exposures show */
        igi_merged *merged = NULL;
        static const double rounded[4] = {1.02, .98, 1.01, .99};
        size_t count = 2 + (size_t)(k < 3 ? k : k - 2);
        for (int i = 0; i < 4; i++) {
            snprintf(paths[i], 40, "test_hdr_curved_%d.png", i);
            write_curved(paths[i], true_h[i], 50 + 4 * (uint64_t)k + (uint64_t)i);
            exposures[i] = (igi_exposure){.path = paths[i], .time_s = true_h[i]};
            if (k >= 3) exposures[i].time_s *= rounded[i];
        }
        printf("%zu exposures: ", count);
        CHECK_OK(ctx, igi_merge(ctx, exposures, count, &options, &merged));
        if (merged) CHECK(sigmas_off(merged->response) < 2.5);
        if (merged) CHECK(merged->response->deviation < (k < 3 ? .004 : .04));
        igi_merged_destroy(merged);
    }
    for (int i = 0; i < 4; i++) remove(paths[i]);
    igi_context_destroy(ctx);
}

static void responses_from_few_numbers(void)
{
    igi_context *ctx = test_context(1);
    char table[600], paths[4][40];
    igi_exposure exposures[4];
    for (int i = 0; i < 4; i++) {
        snprintf(paths[i], 40, "test_hdr_curved_%d.png", i);
        write_curved(paths[i], true_h[i], 50 + (uint64_t)i);
        exposures[i] = (igi_exposure){.path = paths[i], .time_s = true_h[i]};
    }
    double polynomial = response_error(ctx, exposures, 4, IGI_RESPONSE_POLYNOMIAL, NULL);
    printf("response: polynomial %.4f", polynomial);
    CHECK(polynomial < .05);
    if (test_shared_data("real/camera_response/invemor.txt", table, sizeof table)) {
        double emor = response_error(ctx, exposures, 4, IGI_RESPONSE_EMOR, table);
        printf(", EMoR %.4f\n", emor);
        CHECK(emor < .05);
    }
    igi_merge_options options;
    igi_merged *merged = NULL;
    igi_merge_options_init(&options);
    options.response = IGI_RESPONSE_EMOR;
    options.basis_path = paths[0];
    CHECK(igi_merge(ctx, exposures, 4, &options, &merged) == IGI_E_DATA && !merged);
    CHECK_CONTAINS(igi_context_message(ctx), "give the EMoR model's invemor.txt");
    for (int i = 0; i < 4; i++) remove(paths[i]);
    igi_context_destroy(ctx);
}

TEST_MAIN({"merges_at_the_cramer_rao_bound", merges_at_the_cramer_rao_bound},
          {"parts_of_a_pixel_and_turns", parts_of_a_pixel_and_turns},
          {"what_lies_still_is_not_resampled", what_lies_still_is_not_resampled},
          {"ratios_are_recovered", ratios_are_recovered},
          {"ratios_by_a_known_curve", ratios_by_a_known_curve},
          {"what_all_clip_is_marked", what_all_clip_is_marked},
          {"responses_from_few_numbers", responses_from_few_numbers},
          {"deviation_of_a_response", deviation_of_a_response},
          {"what_moves_is_marked", what_moves_is_marked},
          {"what_is_wrong_is_said", what_is_wrong_is_said},
          {"every_allocation_may_fail", every_allocation_may_fail}, {"lists", lists},
          {"memorial_church", memorial_church}, {"false_list_is_refused", false_list_is_refused},
          {"canon_by_exif", canon_by_exif}, {"phone_by_exif", phone_by_exif})
