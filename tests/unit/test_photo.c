/* SPDX-License-Identifier: Apache-2.0
 *
 * Photographs: codes and EXIF of real files, written ones of each kind, broken ones by the hundred.
 */
#include "test.h"

#include <png.h>
#include <tiffio.h>

#include <dirent.h>

static void real_photographs(void)
{
    /* Codes as OpenCV 4.6 reads them; EXIF as SOURCES.md tells it. */
    static const struct {
        const char *file;
        int width, height, x, y, codes[3];
        double time_s, f_number, iso, focal_mm;
        const char *camera;
    } facts[] = {
        {"real/hdr_memorial/memorial0068.png", 512, 768, 200, 300, {25, 21, 19}, 0, 0, 0, 0, ""},
        {"real/hdr_frobisher_canon/IMG_2601.jpg",
         640,
         426,
         300,
         350,
         {25, 21, 10},
         1,
         8,
         100,
         16,
         "EOS 5D Mark II"},
        {"real/hdr_iphonexr/IMG_3871.jpeg",
         3024,
         4032,
         1200,
         2900,
         {25, 25, 1},
         1 / 59.,
         1.8,
         1000,
         4.25,
         "iPhone XR"},
    };
    igi_context *ctx = test_context(1);
    for (size_t i = 0; i < sizeof facts / sizeof facts[0]; i++) {
        char path[600];
        igi_photo *photo = NULL;
        if (!test_shared_data(facts[i].file, path, sizeof path)) continue;
        CHECK_OK(ctx, igi_photo_load(ctx, path, &photo));
        if (!photo) continue;
        CHECK(photo->width == facts[i].width && photo->height == facts[i].height);
        CHECK(photo->channels == 3 && photo->levels == 256 && !photo->linear);
        size_t at = ((size_t)facts[i].y * (size_t)photo->width + (size_t)facts[i].x) * 3;
        for (int c = 0; c < 3; c++) CHECK_NEAR(photo->codes[at + (size_t)c], facts[i].codes[c], 1);
        CHECK_NEAR(photo->time_s, facts[i].time_s, 1e-9);
        CHECK_NEAR(photo->f_number, facts[i].f_number, 1e-9);
        CHECK_NEAR(photo->iso, facts[i].iso, 0);
        CHECK_NEAR(photo->focal_mm, facts[i].focal_mm, 1e-9);
        CHECK_STR(photo->camera, facts[i].camera);
        igi_photo_destroy(photo);
    }
    igi_context_destroy(ctx);
}

static void png_of_16_bits(void)
{
    igi_context *ctx = test_context(1);
    uint16_t pixels[5 * 4 * 3];
    igi_photo *photo = NULL;
    for (unsigned i = 0; i < 60; i++) pixels[i] = (uint16_t)(i * 1111);
    png_image writer = {
        .version = PNG_IMAGE_VERSION, .width = 5, .height = 4, .format = PNG_FORMAT_LINEAR_RGB};
    CHECK(png_image_write_to_file(&writer, "test_photo.png", 0, pixels, 0, NULL));
    CHECK_OK(ctx, igi_photo_load(ctx, "test_photo.png", &photo));
    CHECK(photo && photo->width == 5 && photo->height == 4 && photo->levels == 65536);
    if (photo) CHECK(memcmp(photo->codes, pixels, sizeof pixels) == 0);
    igi_photo_destroy(photo);
    remove("test_photo.png");
    igi_context_destroy(ctx);
}

static int count_chunks(const char *path, const char *name)
{
    static char bytes[4096];
    FILE *file = fopen(path, "rb");
    size_t n = file ? fread(bytes, 1, sizeof bytes, file) : 0;
    int count = 0;
    for (size_t i = 0; i + 4 <= n; i++) count += memcmp(bytes + i, name, 4) == 0;
    if (file) fclose(file);
    return count;
}

static void saved_with_exif(void)
{
    igi_context *ctx = test_context(1);
    for (int levels = 256; levels <= 65536; levels *= 256) {
        uint16_t codes[4 * 3 * 3];
        igi_photo photo = {.width = 4,
                           .height = 3,
                           .channels = 3,
                           .levels = levels,
                           .codes = codes,
                           .time_s = 1 / 59.,
                           .f_number = 5.6,
                           .iso = 400,
                           .focal_mm = 35,
                           .orientation = 6,
                           .camera = "Test Camera"};
        igi_photo *back = NULL;
        for (int i = 0; i < 36; i++) codes[i] = (uint16_t)(i * (levels - 1) / 35);
        CHECK_OK(ctx, igi_photo_save_png(ctx, &photo, "test_photo.png"));
        CHECK(count_chunks("test_photo.png", "eXIf") == 1);
        CHECK_OK(ctx, igi_photo_load(ctx, "test_photo.png", &back));
        if (!back) continue;
        CHECK(back->orientation == 6 && back->width == 4 && back->height == 3);
        CHECK(back->levels == levels && memcmp(back->codes, codes, sizeof codes) == 0);
        CHECK_NEAR(back->time_s, 1 / 59., 1e-8);
        CHECK_NEAR(back->f_number, 5.6, 1e-6);
        CHECK_NEAR(back->iso, 400, 0);
        CHECK_NEAR(back->focal_mm, 35, 1e-6);
        CHECK_STR(back->camera, "Test Camera");
        igi_photo_destroy(back);
    }
    igi_photo none = {
        .width = 1, .height = 1, .channels = 1, .levels = 256, .codes = (uint16_t[1]){0}};
    CHECK(igi_photo_save_png(ctx, &none, "test_photo.png/below.png") == IGI_E_SYSTEM);
    remove("test_photo.png");
    igi_context_destroy(ctx);
}

static void write_tiff(const char *path, int bits, int samples, int orientation, const void *rows)
{
    TIFF *tiff = TIFFOpen(path, "w");
    if (!tiff) abort();
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, 6);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, 2);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, bits);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, samples);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC,
                 samples == 1 ? PHOTOMETRIC_MINISBLACK : PHOTOMETRIC_RGB);
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_LZW);
    TIFFSetField(tiff, TIFFTAG_MODEL, "Test Camera");
    TIFFSetField(tiff, TIFFTAG_ORIENTATION, orientation);
    for (uint32_t y = 0; y < 2; y++) {
        uint16_t row[18]; /* TIFFWriteScanline may change what it is given */
        size_t bytes = (size_t)(6 * samples * bits / 8);
        memcpy(row, (const uint8_t *)rows + y * bytes, bytes);
        if (TIFFWriteScanline(tiff, row, y, 0) != 1) abort();
    }
    TIFFClose(tiff);
}

/* As stored, whatever way up they are to be shown. */
static void tiff_of_8_and_16_bits(void)
{
    static const int orientations[] = {1, 3, 6};
    igi_context *ctx = test_context(1);
    uint16_t words[36];
    uint8_t bytes[36];
    for (unsigned i = 0; i < 36; i++) words[i] = (uint16_t)(i * 1777), bytes[i] = (uint8_t)(i * 7);
    for (int k = 0; k < 3 * 2; k++)
        for (int bits = 8; bits <= 16; bits += 8) {
            igi_photo *photo = NULL;
            int samples = k % 2 ? 3 : 1, orientation = orientations[k / 2];
            write_tiff("test_photo.tif", bits, samples, orientation,
                       bits == 8 ? (void *)bytes : (void *)words);
            CHECK_OK(ctx, igi_photo_load(ctx, "test_photo.tif", &photo));
            if (!photo) continue;
            int wrong = 0;
            for (int i = 0; i < 12 * samples; i++)
                wrong += photo->codes[i] != (bits == 8 ? bytes[i] : words[i]);
            CHECK(photo->channels == samples && photo->levels == 1 << bits && wrong == 0);
            CHECK(photo->orientation == orientation);
            CHECK_STR(photo->camera, "Test Camera");
            igi_photo_destroy(photo);
        }
    remove("test_photo.tif");
    igi_context_destroy(ctx);
}

/* Loads every file of a folder; returns how many there are and counts those that loaded. */
static int load_all(const char *folder, int *loaded)
{
    igi_context *ctx = test_context(1);
    int count = 0;
    DIR *dir = opendir(folder);
    for (struct dirent *entry; dir && (entry = readdir(dir));) {
        char path[1200];
        igi_photo *photo = NULL;
        if (entry->d_name[0] == '.') continue;
        snprintf(path, sizeof path, "%s/%s", folder, entry->d_name);
        DIR *below = opendir(path);
        if (below) {
            closedir(below);
            count += load_all(path, loaded);
            continue;
        }
        igi_status status = igi_photo_load(ctx, path, &photo);
        CHECK(status == IGI_OK ? photo && photo->codes : status == IGI_E_DATA && !photo);
        if (status == IGI_E_DATA) CHECK_CONTAINS(igi_context_message(ctx), entry->d_name);
        *loaded += status == IGI_OK;
        igi_photo_destroy(photo);
        count++;
    }
    if (dir) closedir(dir);
    igi_context_destroy(ctx);
    return count;
}

static void broken_files_are_survived(void)
{
    static const char *const folders[] = {"real/bad_inputs/jpeg", "real/bad_inputs/png",
                                          "real/bad_inputs/oiio", "real/bad_inputs/exr_damaged"};
    for (size_t i = 0; i < sizeof folders / sizeof folders[0]; i++) {
        char path[600];
        int loaded = 0;
        if (!test_shared_data(folders[i], path, sizeof path)) continue;
        int count = load_all(path, &loaded);
        printf("%s: %d of %d files load\n", folders[i], loaded, count);
        CHECK(count > 40);
        if (i == 3) CHECK(loaded == 0);
    }
}

static void png_suite(void)
{
    char path[600];
    int loaded = 0;
    if (test_shared_data("real/bad_inputs/png/pngsuite/primary", path, sizeof path)) {
        int count = load_all(path, &loaded);
        CHECK(count > 0 && loaded == count);
    }
    loaded = 0;
    if (test_shared_data("real/bad_inputs/png/pngsuite/corrupt", path, sizeof path)) {
        CHECK(load_all(path, &loaded) > 0);
        CHECK(loaded == 0);
    }
}

static void what_is_no_photograph_is_refused(void)
{
    igi_context *ctx = test_context(1);
    igi_photo *photo = (igi_photo *)1;
    CHECK(igi_photo_load(ctx, "nosuch.jpg", &photo) == IGI_E_DATA && !photo);
    CHECK(igi_photo_load(ctx, ".", &photo) == IGI_E_DATA && !photo);
    FILE *file = fopen("test_photo.txt", "w");
    if (!file) abort();
    fputs("not a photograph at all, though long enough", file);
    fclose(file);
    CHECK(igi_photo_load(ctx, "test_photo.txt", &photo) == IGI_E_DATA && !photo);
    CHECK_CONTAINS(igi_context_message(ctx), "test_photo.txt: not a whole photograph");
    remove("test_photo.txt");
    igi_context_destroy(ctx);
}

TEST_MAIN({"real_photographs", real_photographs}, {"png_of_16_bits", png_of_16_bits},
          {"saved_with_exif", saved_with_exif}, {"tiff_of_8_and_16_bits", tiff_of_8_and_16_bits},
          {"broken_files_are_survived", broken_files_are_survived}, {"png_suite", png_suite},
          {"what_is_no_photograph_is_refused", what_is_no_photograph_is_refused})
