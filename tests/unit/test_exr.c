/* SPDX-License-Identifier: Apache-2.0
 *
 * OpenEXR: round trips, official conformance images, broken files.
 */
#include "test.h"

#include "base/context.h"
#include "base/rng.h"
#include "image/image_private.h"

#include <dirent.h>
#include <sys/resource.h>
#include <unistd.h>

static const char *const SCRATCH = "test_exr_scratch.exr";

static igi_image *make_image(igi_context *ctx, int width, int height, int channels)
{
    igi_image *image = NULL;
    CHECK_OK(ctx, igi_image_create(ctx, width, height, channels, &image));
    igi_rng rng = igi_rng_make(7, (uint64_t)channels);
    size_t count = (size_t)width * (size_t)height * (size_t)channels;
    for (size_t i = 0; i < count; i++) image->samples[i] = 8 * igi_rng_float(&rng) - 1;
    return image;
}

static uint8_t *read_file(const char *path, size_t *size)
{
    FILE *file = fopen(path, "rb");
    if (!file) return NULL;
    fseek(file, 0, SEEK_END);
    *size = (size_t)ftell(file);
    rewind(file);
    uint8_t *bytes = malloc(*size ? *size : 1);
    if (!bytes || fread(bytes, 1, *size, file) != *size) abort();
    fclose(file);
    return bytes;
}

static void round_trip_at(int width, int height, int channels, igi_exr_depth depth)
{
    igi_context *ctx = test_context(1);
    igi_image *image = make_image(ctx, width, height, channels), *back = NULL;
    image->deviation = channels == 3 ? .0123f : 0;
    int w = 0, h = 0, c = 0, bands = 0, names_alike = 0;
    CHECK_OK(ctx, igi_image_save_exr(ctx, image, depth, SCRATCH));
    CHECK_OK(ctx, igi_image_probe_exr(ctx, SCRATCH, &w, &h, &c, &bands));
    CHECK(w == width && h == height && c == channels);
    CHECK(bands == (channels == 4 ? 3 : channels)); /* the fourth is A */
    CHECK_OK(ctx, igi_image_load_exr(ctx, SCRATCH, &back));
    if (back && back->width == width && back->height == height && back->channels == channels) {
        double worst = 0;
        for (size_t i = 0; i < (size_t)width * (size_t)height * (size_t)channels; i++) {
            double want = (double)image->samples[i];
            worst = fmax(worst, fabs((double)back->samples[i] - want) / fmax(fabs(want), 1e-3));
        }
        /* half keeps 11 bits: rounding is within 2^-11 */
        CHECK(worst <= (depth == IGI_EXR_HALF ? 0x1.01p-11 : 0));
        for (int k = 0; k < channels; k++) names_alike += !strcmp(back->names[k], image->names[k]);
        CHECK(names_alike == channels);
        CHECK(back->deviation == image->deviation);
    }
    igi_image_destroy(back);
    igi_image_destroy(image);
    igi_context_destroy(ctx);
}

/* Floats are written as halves where these hold a channel to the bit, and come back so either way. */
static void floats_as_halves(void)
{
    static const float held[] = {0, 0x1p-14f, 65504, -.5f, 0x1.ffcp3f};
    static const float others[] = {65536, 0x1p-15f, 1 + 0x1p-11f, INFINITY, 1e-30f};
    igi_context *ctx = test_context(1);
    for (int k = 0; k < 5; k++) {
        igi_image *image = make_image(ctx, 5, 1, 2), *back = NULL;
        size_t size;
        snprintf(image->names[0], IGI_CHANNEL_NAME_SIZE, "held");
        snprintf(image->names[1], IGI_CHANNEL_NAME_SIZE, "kept");
        for (int i = 0; i < 5; i++) {
            image->samples[2 * i] = held[i];
            image->samples[2 * i + 1] = i == k ? others[k] : held[i];
        }
        CHECK_OK(ctx, igi_image_save_exr(ctx, image, IGI_EXR_FLOAT, SCRATCH));
        CHECK_OK(ctx, igi_image_load_exr(ctx, SCRATCH, &back));
        if (back) CHECK(memcmp(back->samples, image->samples, 10 * sizeof(float)) == 0);
        uint8_t *bytes = read_file(SCRATCH, &size);
        int types[2] = {0, 0}; /* behind each name in the header; 1: half, 2: float */
        for (size_t i = 0; bytes && i + 6 < size; i++)
            for (int c = 0; c < 2; c++)
                if (memcmp(bytes + i, c ? "kept" : "held", 5) == 0) types[c] = bytes[i + 5];
        CHECK(types[0] == 1 && types[1] == 2);
        free(bytes);
        igi_image_destroy(back);
        igi_image_destroy(image);
    }
    remove(SCRATCH);
    igi_context_destroy(ctx);
}

static void round_trips(void)
{
    static const int channels[] = {1, 2, 3, 4, 5, 16, 17};
    for (size_t i = 0; i < sizeof channels / sizeof channels[0]; i++) {
        round_trip_at(37, 35, channels[i], IGI_EXR_FLOAT);
        round_trip_at(64, 16, channels[i], IGI_EXR_HALF);
    }
    round_trip_at(1, 1, 3, IGI_EXR_HALF);
    remove(SCRATCH);
}

/* From incompressible to compressible, so that some chunk compresses to just its own size. */
static void barely_compressible(void)
{
    igi_context *ctx = test_context(1);
    for (int repeats = 0; repeats < 200; repeats++) {
        igi_image *image = NULL, *back = NULL;
        CHECK_OK(ctx, igi_image_create(ctx, 200, 1, 1, &image));
        igi_rng rng = igi_rng_make(3, (uint64_t)repeats);
        for (int i = 0; i < 200; i++)
            image->samples[i] = i < repeats / 4 ? 1 : 1 + 1e-3f * igi_rng_float(&rng);
        CHECK_OK(ctx, igi_image_save_exr(ctx, image, IGI_EXR_FLOAT, SCRATCH));
        CHECK_OK(ctx, igi_image_load_exr(ctx, SCRATCH, &back));
        CHECK(memcmp(image->samples, back->samples, 200 * sizeof(float)) == 0);
        igi_image_destroy(image);
        igi_image_destroy(back);
    }
    igi_context_destroy(ctx);
    remove(SCRATCH);
}

static void same_image_same_bytes(void)
{
    igi_context *ctx = test_context(1);
    igi_image *image = make_image(ctx, 50, 40, 3);
    size_t sizes[2] = {0, 1};
    uint8_t *bytes[2] = {NULL, NULL};
    for (int i = 0; i < 2; i++) {
        CHECK_OK(ctx, igi_image_save_exr(ctx, image, IGI_EXR_HALF, SCRATCH));
        bytes[i] = read_file(SCRATCH, &sizes[i]);
    }
    CHECK(sizes[0] == sizes[1] && memcmp(bytes[0], bytes[1], sizes[0]) == 0);
    free(bytes[0]);
    free(bytes[1]);
    remove(SCRATCH);
    igi_image_destroy(image);
    igi_context_destroy(ctx);
}

/* A name in the current folder that ends in ".part". */
static bool leftover(const char *folder)
{
    DIR *dir = opendir(folder);
    bool found = false;
    for (struct dirent *entry; dir && (entry = readdir(dir));)
        found = found || strstr(entry->d_name, ".part");
    if (dir) closedir(dir);
    return found;
}

static void failed_saves_leave_nothing(void)
{
    igi_context *ctx = test_context(1);
    igi_image *image = make_image(ctx, 8, 8, 3);
    char folder[] = "test_exr_XXXXXX";
    if (!mkdtemp(folder)) abort();
    CHECK(igi_image_save_exr(ctx, image, IGI_EXR_HALF, folder) == IGI_E_SYSTEM);
    CHECK_CONTAINS(igi_context_message(ctx), folder);
    CHECK(!leftover("."));
    CHECK_OK(ctx, igi_image_save_exr(ctx, image, IGI_EXR_HALF, SCRATCH));
    char below[300];
    snprintf(below, sizeof below, "%s/below.exr", SCRATCH);
    CHECK(igi_image_save_exr(ctx, image, IGI_EXR_HALF, below) == IGI_E_SYSTEM);
    CHECK_CONTAINS(igi_context_message(ctx), "below.exr: cannot be written");
    remove(SCRATCH);
    rmdir(folder);
    igi_image_destroy(image);
    igi_context_destroy(ctx);
}

static void wrong_sizes_are_refused(void)
{
    igi_context *ctx = test_context(1);
    igi_image *image = (igi_image *)1;
    CHECK(igi_image_create(ctx, 0, 5, 3, &image) == IGI_E_USAGE && !image);
    CHECK(igi_image_create(ctx, 5, 5, 18, &image) == IGI_E_USAGE && !image);
    CHECK(igi_image_create(ctx, 100000, 100000, 3, &image) == IGI_E_SYSTEM && !image);
    CHECK(igi_image_load_exr(ctx, "nosuch.exr", &image) == IGI_E_DATA && !image);
    CHECK_CONTAINS(igi_context_message(ctx), "nosuch.exr: cannot be opened");
    CHECK(igi_image_load_exr(ctx, ".", &image) == IGI_E_DATA);
    igi_context_destroy(ctx);
}

/* Writes a little-endian box after the attribute `name` of a header. */
static bool patch_window(uint8_t *bytes, size_t size, const char *name, const int32_t box[4])
{
    size_t length = strlen(name) + 1, skip = length + sizeof "box2i" + 4;
    for (size_t i = 0; i + skip + 16 <= size; i++)
        if (memcmp(bytes + i, name, length) == 0) {
            memcpy(bytes + i + skip, box, 16);
            return true;
        }
    return false;
}

static void giants_are_refused_unallocated(void)
{
    static const int32_t boxes[][4] = {{0, 0, 99999, 99999},  {0, 0, 60000, 60000},
                                       {0, 0, 2147483647, 0}, {-2147483647 - 1, 0, 2147483647, 9},
                                       {5, 5, 4, 4},          {2147483600, 0, 2147483647, 9}};
    igi_context *ctx = test_context(1);
    igi_image *image = make_image(ctx, 16, 16, 3);
    CHECK_OK(ctx, igi_image_save_exr(ctx, image, IGI_EXR_HALF, SCRATCH));
    igi_image_destroy(image);
    for (size_t i = 0; i < 2 * sizeof boxes / sizeof boxes[0]; i++) {
        size_t size;
        uint8_t *bytes = read_file(SCRATCH, &size);
        CHECK(patch_window(bytes, size, i % 2 ? "dataWindow" : "displayWindow", boxes[i / 2]));
        if (i / 2 != 5 || i % 2) { /* a display window far from the data is odd, and legal */
            CHECK(igi_exr_load_memory(ctx, "giant.exr", bytes, size, &image) == IGI_E_DATA);
            CHECK_CONTAINS(igi_context_message(ctx), "giant.exr: ");
        }
        free(bytes);
    }
    remove(SCRATCH);
    igi_context_destroy(ctx);
}

static void truncated_at_every_byte(void)
{
    igi_context *ctx = test_context(1);
    igi_image *image = make_image(ctx, 9, 20, 3);
    size_t size;
    int refused = 0;
    CHECK_OK(ctx, igi_image_save_exr(ctx, image, IGI_EXR_HALF, SCRATCH));
    igi_image_destroy(image);
    uint8_t *bytes = read_file(SCRATCH, &size);
    for (size_t cut = 0; cut < size; cut++) {
        uint8_t *part = malloc(cut ? cut : 1); /* its own block: reading beyond shows under ASan */
        if (!part) abort();
        memcpy(part, bytes, cut);
        refused += igi_exr_load_memory(ctx, "cut.exr", part, cut, &image) == IGI_E_DATA;
        free(part);
    }
    CHECK(refused == (int)size);
    free(bytes);
    remove(SCRATCH);
    igi_context_destroy(ctx);
}

static void flipped_bits_never_crash(void)
{
    igi_context *ctx = test_context(1);
    igi_image *image = make_image(ctx, 9, 20, 3);
    size_t size;
    int odd = 0;
    CHECK_OK(ctx, igi_image_save_exr(ctx, image, IGI_EXR_HALF, SCRATCH));
    igi_image_destroy(image);
    uint8_t *bytes = read_file(SCRATCH, &size);
    for (size_t i = 0; i < size; i++) {
        uint8_t keep = bytes[i];
        bytes[i] = (uint8_t)(keep ^ (1u << (i % 8)));
        igi_status status = igi_exr_load_memory(ctx, "flipped.exr", bytes, size, &image);
        odd += status != IGI_OK && status != IGI_E_DATA;
        igi_image_destroy(image);
        bytes[i] = keep;
    }
    CHECK(odd == 0);
    free(bytes);
    remove(SCRATCH);
    igi_context_destroy(ctx);
}

static void every_allocation_may_fail(void)
{
    igi_context *ctx = test_context(1);
    igi_image *image = make_image(ctx, 9, 9, 3), *back = NULL;
    CHECK_OK(ctx, igi_image_save_exr(ctx, image, IGI_EXR_HALF, SCRATCH));
    igi_fail_allocation_after(ctx, 0);
    CHECK(igi_image_save_exr(ctx, image, IGI_EXR_HALF, SCRATCH) == IGI_E_SYSTEM);
    igi_image_destroy(image);
    long failures = 0;
    for (igi_status status = IGI_E_SYSTEM; status != IGI_OK && failures < 100; failures++) {
        igi_fail_allocation_after(ctx, failures);
        status = igi_image_load_exr(ctx, SCRATCH, &back);
        if (status != IGI_OK) CHECK(status == IGI_E_SYSTEM && !back);
    }
    CHECK(back && failures == 3); /* the image, its samples, then success */
    igi_fail_allocation_after(ctx, -1);
    igi_image_destroy(back);
    remove(SCRATCH);
    igi_context_destroy(ctx);
}

/* Written down from OpenEXR's own Python module (3.5.3): a pixel, or the colour that the formulas
 * of its channels give. */
static const struct fact {
    const char *file;
    int width, height, channels, x, y;
    double value[4], tolerance;
} facts[] = {
    {"ScanLines/Cannon.exr",
     780,
     566,
     3,
     100,
     200,
     {0.408935546875, 0.34228515625, 0.252685546875},
     0},
    {"ScanLines/Cannon.exr",
     780,
     566,
     3,
     779,
     565,
     {0.2237548828125, 0.2366943359375, 0.244140625},
     0},
    {"Chromaticities/Rec709.exr",
     610,
     406,
     3,
     300,
     200,
     {1.3857421875, 0.25244140625, 0.26123046875},
     0},
    /* XYZ .70898 .49414 .30518 by IEC 61966-2-1's matrix */
    {"Chromaticities/XYZ.exr", 610, 406, 3, 300, 200, {1.38590, 0.25241, 0.26142}, 5e-4},
    /* R = 2.625 Y, B = .421875 Y, G from Y = .2126 R + .7152 G + .0722 B */
    {"Chromaticities/Rec709_YC.exr", 610, 406, 3, 300, 200, {1.297119, 0.284298, 0.208466}, 3e-4},
    {"LuminanceChroma/Flowers.exr", 784, 734, 3, 300, 200, {0.0913675, 0.1094973, 0.526264}, 1e-4},
    {"LuminanceChroma/Garden.exr", 874, 493, 1, 400, 300, {1.234375}, 0},
    {"MultiResolution/WavyLinesLatLong.exr",
     1024,
     512,
     3,
     1000,
     17,
     {0.9873046875, 0.9873046875, 0.9873046875},
     0},
    {"MultiResolution/WavyLinesCube.exr",
     256,
     1536,
     3,
     128,
     768,
     {0.9580078125, 0.9580078125, 0.9580078125},
     0},
    {"MultiResolution/ColorCodedLevels.exr",
     512,
     512,
     4,
     100,
     300,
     {0.99951171875, 0.99951171875, 0.99951171875, 1},
     0},
    {"TestImages/WideFloatRange.exr", 500, 500, 1, 7, 450, {8.776499661669162e+22}, 0},
    {"TestImages/BrightRings.exr", 800, 800, 3, 400, 500, {1, 1, 1}, 0},
    {"TestImages/stripes.exr", 100, 50, 4, 3, 7, {0.5, 0.5, 0.5, 1}, 0},
    {"Beachball/multipart.0001.exr", 2048, 1556, 4, 0, 0, {0, 0, 0, 0}, 0},
};

static void conformance_values(void)
{
    igi_context *ctx = test_context(1);
    for (size_t i = 0; i < sizeof facts / sizeof facts[0]; i++) {
        const struct fact *fact = &facts[i];
        char name[200], path[600];
        igi_image *image = NULL;
        snprintf(name, sizeof name, "real/exr_conformance/%s", fact->file);
        if (!test_shared_data(name, path, sizeof path)) continue;
        CHECK_OK(ctx, igi_image_load_exr(ctx, path, &image));
        if (!image) continue;
        CHECK(image->width == fact->width && image->height == fact->height &&
              image->channels == fact->channels);
        const float *at = image->samples +
                          ((size_t)fact->y * (size_t)image->width + (size_t)fact->x) *
                              (size_t)image->channels;
        for (int c = 0; c < fact->channels; c++)
            CHECK_NEAR((double)at[c], fact->value[c], fact->tolerance);
        igi_image_destroy(image);
    }
    igi_context_destroy(ctx);
}

/* t01's 400 x 300 pixels, seen through the other files' windows: display pixel (0,0) is data pixel
 * (dx,dy). */
static void display_windows(void)
{
    static const struct {
        int number, width, height, dx, dy;
    } windows[] = {{5, 340, 260, 30, 20},
                   {7, 481, 371, -40, -40},
                   {8, 501, 401, -30, -40},
                   {13, 101, 101, 399, 299},
                   {14, 101, 101, -100, -100}};
    char path[600], name[100];
    igi_context *ctx = test_context(1);
    igi_image *whole = NULL;
    if (test_shared_data("real/exr_conformance/DisplayWindow/t01.exr", path, sizeof path))
        CHECK_OK(ctx, igi_image_load_exr(ctx, path, &whole));
    for (size_t i = 0; whole && i < sizeof windows / sizeof windows[0]; i++) {
        igi_image *seen = NULL, *photograph = NULL;
        int wrong = 0, lit = 0, unlike = 0;
        snprintf(name, sizeof name, "real/exr_conformance/DisplayWindow/t%02d.exr",
                 windows[i].number);
        if (!test_shared_data(name, path, sizeof path)) continue;
        CHECK_OK(ctx, igi_image_load_exr(ctx, path, &seen));
        CHECK_OK(ctx, igi_image_load_photograph(ctx, path, &photograph));
        if (!seen || !photograph) continue;
        CHECK(photograph->channels == 4);
        CHECK_STR(photograph->names[3], "saturated");
        CHECK(seen->width == windows[i].width && seen->height == windows[i].height);
        for (int y = 0; y < seen->height; y++)
            for (int x = 0; x < seen->width; x++) {
                int wx = x + windows[i].dx, wy = y + windows[i].dy;
                bool inside = wx >= 0 && wy >= 0 && wx < whole->width && wy < whole->height;
                for (int c = 0; c < 3; c++) {
                    float want = inside ? whole->samples[(wy * whole->width + wx) * 3 + c] : 0;
                    int at = (y * seen->width + x) * 3 + c;
                    float measured = photograph->samples[at / 3 * 4 + c];
                    wrong += seen->samples[at] != want;
                    unlike += inside ? measured != want : !isnan(measured);
                    lit += want > 0;
                }
                float mark = photograph->samples[(y * seen->width + x) * 4 + 3];
                unlike += inside ? mark != 0 : !isnan(mark);
            }
        CHECK(wrong == 0 && unlike == 0 && lit > 0);
        igi_image_destroy(seen);
        igi_image_destroy(photograph);
    }
    igi_image_destroy(whole);
    igi_context_destroy(ctx);
}

/* Calls `each` for every file below a folder. */
static int walk(const char *folder, int (*each)(igi_context *, const char *), igi_context *ctx)
{
    int count = 0;
    DIR *dir = opendir(folder);
    for (struct dirent *entry; dir && (entry = readdir(dir));) {
        char path[1200];
        if (entry->d_name[0] == '.') continue;
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        DIR *below = opendir(path);
        if (below) {
            closedir(below);
            count += walk(path, each, ctx);
        } else if (!strstr(path, ".rst") && !strstr(path, "LICENSE")) {
            count += each(ctx, path);
        }
    }
    if (dir) closedir(dir);
    return count;
}

static int load_valid(igi_context *ctx, const char *path)
{
    igi_image *image = NULL;
    igi_status status = igi_image_load_exr(ctx, path, &image);
    if (strstr(path, "Trunks")) {
        CHECK(status == IGI_E_DATA);
        CHECK_CONTAINS(igi_context_message(ctx), "deep data");
    } else {
        CHECK_OK(ctx, status);
    }
    igi_image_destroy(image);
    return 1;
}

static int load_damaged(igi_context *ctx, const char *path)
{
    igi_image *image = NULL;
    igi_status status = igi_image_load_exr(ctx, path, &image);
    CHECK(status == IGI_OK ? image != NULL : status == IGI_E_DATA && !image);
    if (status == IGI_E_DATA) CHECK_CONTAINS(igi_context_message(ctx), path);
    igi_image_destroy(image);
    return 1;
}

static void conformance_all_load(void)
{
    char path[600];
    igi_context *ctx = test_context(1);
    if (test_shared_data("real/exr_conformance", path, sizeof path))
        CHECK(walk(path, load_valid, ctx) == 39);
    igi_context_destroy(ctx);
}

static void damaged_files_are_survived(void)
{
    char path[600];
    igi_context *ctx = test_context(1);
    struct rusage usage;
    if (test_shared_data("real/bad_inputs/exr_damaged", path, sizeof path)) {
        CHECK(walk(path, load_damaged, ctx) >= 80);
        getrusage(RUSAGE_SELF, &usage);
        CHECK(usage.ru_maxrss < 2l << 20); /* KiB; what they claim adds up to far more */
    }
    igi_context_destroy(ctx);
}

TEST_MAIN({"round_trips", round_trips}, {"floats_as_halves", floats_as_halves},
          {"barely_compressible", barely_compressible},
          {"same_image_same_bytes", same_image_same_bytes},
          {"failed_saves_leave_nothing", failed_saves_leave_nothing},
          {"wrong_sizes_are_refused", wrong_sizes_are_refused},
          {"giants_are_refused_unallocated", giants_are_refused_unallocated},
          {"truncated_at_every_byte", truncated_at_every_byte},
          {"flipped_bits_never_crash", flipped_bits_never_crash},
          {"every_allocation_may_fail", every_allocation_may_fail},
          {"conformance_values", conformance_values}, {"display_windows", display_windows},
          {"conformance_all_load", conformance_all_load},
          {"damaged_files_are_survived", damaged_files_are_survived})
