/* SPDX-License-Identifier: Apache-2.0
 *
 * Raw photographs: DNGs of a camera whose black level, mosaic, colour matrix and exposures are known,
 * and the linear radiance that must come out.
 */
#include "test.h"

#include <tiffio.h>

#define SIDE 24 /* of a patch, pixels */
#define COLUMNS 5
#define ROWS 2
#define WIDTH (SIDE * COLUMNS)
#define HEIGHT (SIDE * ROWS)
#define BLACK 512
#define WHITE 4095

/* Linear Rec.709; the last is brighter than the longest exposure can hold. */
static const double patches[ROWS * COLUMNS][3] = {
    {.02, .02, .02}, {.1, .1, .1},    {.4, .4, .4},   {.8, .8, .8},  {.3, .15, .1},
    {.1, .25, .15},  {.12, .15, .35}, {.35, .3, .12}, {.5, .4, .45}, {1.8, 1.9, 1.7},
};

/* What the sensor makes of Rec.709: its colours overlap, and it is least sensitive to red. */
static const double sensor[3][3] = {{.40, .10, 0}, {.1, .8, .1}, {0, .12, .48}};
static const double xyz_to_rec709[3][3] = {{3.2404542, -1.5371385, -.4985314},
                                           {-.9692660, 1.8760108, .0415560},
                                           {.0556434, -.2040259, 1.0572252}};

static uint16_t code_at(int x, int y, double exposure)
{
    const double *rgb = patches[y / SIDE * COLUMNS + x / SIDE];
    int colour = y % 2 + x % 2; /* RG over GB */
    double light = 0;
    for (int c = 0; c < 3; c++) light += sensor[colour][c] * rgb[c] * exposure;
    double code = BLACK + light * (WHITE - BLACK);
    return (uint16_t)fmin(WHITE, floor(code + .5));
}

static void set_tags(TIFF *tiff, const float as_shot_neutral[3])
{
    static const uint8_t version[4] = {1, 4, 0, 0}, pattern[4] = {0, 1, 1, 2};
    static const uint16_t repeat[2] = {2, 2};
    static const uint32_t white = WHITE;
    static const float black = BLACK;
    float matrix[9] = {0};
    for (int i = 0; i < 27; i++)
        matrix[i / 3] += (float)(sensor[i / 9][i % 3] * xyz_to_rec709[i % 3][i / 3 % 3]);
    TIFFSetField(tiff, TIFFTAG_SUBFILETYPE, 0);
    TIFFSetField(tiff, TIFFTAG_IMAGEWIDTH, WIDTH);
    TIFFSetField(tiff, TIFFTAG_IMAGELENGTH, HEIGHT);
    TIFFSetField(tiff, TIFFTAG_BITSPERSAMPLE, 16);
    TIFFSetField(tiff, TIFFTAG_SAMPLESPERPIXEL, 1);
    TIFFSetField(tiff, TIFFTAG_ROWSPERSTRIP, HEIGHT);
    TIFFSetField(tiff, TIFFTAG_PLANARCONFIG, PLANARCONFIG_CONTIG);
    TIFFSetField(tiff, TIFFTAG_PHOTOMETRIC, PHOTOMETRIC_CFA);
    TIFFSetField(tiff, TIFFTAG_COMPRESSION, COMPRESSION_NONE);
    TIFFSetField(tiff, TIFFTAG_MAKE, "Example");
    TIFFSetField(tiff, TIFFTAG_MODEL, "Raw One");
    TIFFSetField(tiff, TIFFTAG_UNIQUECAMERAMODEL, "Example Raw One");
    TIFFSetField(tiff, TIFFTAG_DNGVERSION, version);
    TIFFSetField(tiff, TIFFTAG_DNGBACKWARDVERSION, version);
    TIFFSetField(tiff, TIFFTAG_CFAREPEATPATTERNDIM, repeat);
    TIFFSetField(tiff, TIFFTAG_CFAPATTERN, 4, pattern);
    TIFFSetField(tiff, TIFFTAG_BLACKLEVEL, 1, &black);
    TIFFSetField(tiff, TIFFTAG_WHITELEVEL, 1, &white);
    TIFFSetField(tiff, TIFFTAG_CALIBRATIONILLUMINANT1, 21); /* D65 */
    TIFFSetField(tiff, TIFFTAG_COLORMATRIX1, 9, matrix);
    TIFFSetField(tiff, TIFFTAG_ASSHOTNEUTRAL, 3, as_shot_neutral);
}

static void write_dng(const char *path, double time_s, double exposure,
                      const float as_shot_neutral[3])
{
    static uint16_t codes[HEIGHT][WIDTH];
    uint64_t exif = 0;
    uint16_t iso = 200;
    TIFF *tiff = TIFFOpen(path, "w");
    if (!tiff) abort();
    set_tags(tiff, as_shot_neutral);
    for (int y = 0; y < HEIGHT; y++)
        for (int x = 0; x < WIDTH; x++) codes[y][x] = code_at(x, y, exposure);
    if (TIFFWriteEncodedStrip(tiff, 0, codes, sizeof codes) < 0 || !TIFFWriteDirectory(tiff) ||
        TIFFCreateEXIFDirectory(tiff) != 0)
        abort();
    TIFFSetField(tiff, EXIFTAG_EXPOSURETIME, time_s);
    TIFFSetField(tiff, EXIFTAG_FNUMBER, 8.);
    TIFFSetField(tiff, EXIFTAG_FOCALLENGTH, 35.);
    TIFFSetField(tiff, EXIFTAG_ISOSPEEDRATINGS, 1, &iso);
    if (!TIFFWriteCustomDirectory(tiff, &exif) || !TIFFSetDirectory(tiff, 0)) abort();
    TIFFSetField(tiff, TIFFTAG_EXIFIFD, exif);
    if (!TIFFRewriteDirectory(tiff)) abort();
    TIFFClose(tiff);
}

/* The middle pixel of a patch. */
static size_t middle_of(int patch)
{
    return (size_t)(patch / COLUMNS * SIDE + SIDE / 2) * WIDTH +
           (size_t)(patch % COLUMNS * SIDE + SIDE / 2);
}

static const float daylight[3] = {.5f, 1, .6f}, tungsten[3] = {.9f, 1, .3f};

static void develops_linearly(void)
{
    igi_context *ctx = test_context(1);
    static const double exposures[2] = {1, .125};
    for (int k = 0; k < 2; k++) {
        igi_photo *photo = NULL;
        /* The camera's own white balance differs from one to the next; the result must not. */
        write_dng("test_raw.dng", exposures[k] / 50, exposures[k], k ? tungsten : daylight);
        CHECK_OK(ctx, igi_photo_load(ctx, "test_raw.dng", &photo));
        if (!photo) continue;
        CHECK(photo->linear && photo->channels == 3 && photo->levels == 65536);
        CHECK(photo->width == WIDTH && photo->height == HEIGHT);
        CHECK_NEAR(photo->time_s, exposures[k] / 50, 1e-6);
        CHECK_NEAR(photo->f_number, 8, 1e-6);
        CHECK_NEAR(photo->iso, 200, 1e-6);
        CHECK_NEAR(photo->focal_mm, 35, 1e-6);
        CHECK_STR(photo->camera, "Raw One");
        for (int p = 0; p + 1 < ROWS * COLUMNS; p++)
            for (int c = 0; c < 3; c++) {
                double code = photo->codes[middle_of(p) * 3 + (size_t)c] / 65535.;
                /* One code of the sensor, as the matrix spreads it. */
                CHECK_NEAR(code, patches[p][c] * exposures[k], 2.5 / (WHITE - BLACK));
            }
        igi_photo_destroy(photo);
    }
    remove("test_raw.dng");
    igi_context_destroy(ctx);
}

static void brackets_share_one_unit(void)
{
    igi_context *ctx = test_context(1);
    char names[3][40];
    const char *paths[3];
    igi_exposure *exposures = NULL;
    igi_merged *merged = NULL;
    for (int i = 0; i < 3; i++) {
        double exposure = pow(.25, i);
        snprintf(names[i], sizeof names[i], "test_raw_%d.dng", i);
        paths[i] = names[i];
        write_dng(names[i], exposure / 10, exposure, i == 1 ? tungsten : daylight);
    }
    CHECK_OK(ctx, igi_exposures_probe(ctx, paths, 3, &exposures));
    if (exposures) CHECK_OK(ctx, igi_merge(ctx, exposures, 3, NULL, &merged));
    /* h = 1/10 s at ISO 200, f/8 is where full scale means 1. */
    double unit = .1 * 2 / 64;
    for (int p = 0; merged && p < ROWS * COLUMNS; p++) {
        const float *pixel = merged->image->samples +
                             middle_of(p) * (size_t)merged->image->channels;
        CHECK(pixel[3] == 0);
        for (int c = 0; c < 3; c++)
            CHECK_NEAR((double)pixel[c] * unit, patches[p][c], .003 * patches[p][c] + 5e-4);
    }
    for (int i = 0; merged && i < 3; i++)
        CHECK_NEAR(merged->frames[i].used / merged->frames[i].stated, 1, .003);
    igi_merged_destroy(merged);
    igi_exposures_destroy(exposures, 3);
    for (int i = 0; i < 3; i++) remove(paths[i]);
    igi_context_destroy(ctx);
}

TEST_MAIN({"develops_linearly", develops_linearly},
          {"brackets_share_one_unit", brackets_share_one_unit})
