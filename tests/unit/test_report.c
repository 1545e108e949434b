/* SPDX-License-Identifier: Apache-2.0
 *
 * Errors against truth, resampling, and a page made of awkward content; tests/report/page.sh loads
 * that page in a browser.
 */
#include "test.h"

#include "report/colour.h"
#include "image/resample.h"
#include "report/sphere.h"

#include <sys/stat.h>

#define FOLDER "report_test"

static void put(const char *path, const char *text)
{
    FILE *file = fopen(path, "w");
    if (!file) abort();
    fputs(text, file);
    fclose(file);
}

static void errors_by_hand(void)
{
    igi_context *ctx = test_context(1);
    igi_validation *v = NULL;
    mkdir("report_got", 0777);
    mkdir("report_want", 0777);
    put("report_want/truth.json",
        "{\"regions\": {"
        "\"a\": {\"albedo\": [0.5, 0.01], \"model\": \"lambert\"},"
        "\"b\": {\"albedo\": [0.5, 0.5], \"model\": \"ward\", \"specular\": 0.1, \"alpha\": 0.2},"
        "\"c\": {\"albedo\": [0.5, 0.5], \"model\": \"lambert\"},"
        "\"dim\": {\"albedo\": [0.5, 0.5], \"model\": \"lambert\", \"seen1\": 0.19},"
        "\"lamp\": {\"albedo\": [0, 0], \"model\": \"lambert\", \"emitter\": true}}}");
    put("report_got/materials.json",
        "{\"igi\": 1, \"regions\": {"
        "\"a\": {\"albedo\": [0.55, 0.02], \"albedo_std\": [0.1, 0.002], \"model\": \"lambert\"},"
        "\"b\": {\"albedo\": [0.5, 0.5], \"model\": \"ward\", \"specular\": 0.12, \"alpha\": "
        "0.15, \"specular_std\": 0.01, \"alpha_std\": 0.02}}}");
    CHECK_OK(ctx, igi_validate(ctx, "report_got", "report_want", &v));
    if (v) {
        CHECK(v->region_count == 5);
        CHECK_NEAR(v->regions[0].albedo, (.05 / .5 + .01 / .02) / 2, 1e-12); /* floor of .02 */
        CHECK_NEAR(v->regions[0].sigmas, 5, 1e-9);
        CHECK(isnan(v->regions[1].sigmas) && isnan(v->regions[0].texture_median));
        CHECK_NEAR(v->regions[1].specular, .2, 1e-9);
        CHECK_NEAR(v->regions[1].alpha, .25, 1e-9);
        CHECK_NEAR(v->regions[1].specular_z, 2, 1e-9);
        CHECK_NEAR(v->regions[1].alpha_z, -2.5, 1e-9);
        CHECK(v->regions[2].missing && v->regions[2].judged);
        CHECK(!v->regions[3].judged && !v->regions[4].judged);
        CHECK_NEAR(v->albedo_mean, (.3 + 0 + 1) / 3, 1e-12);
        CHECK_NEAR(v->albedo_median, .3, 1e-12);
        CHECK_NEAR(v->albedo_max, 1, 0);
        CHECK(v->models == 2 && v->models_right == 2 && v->glossy_right == 1);
    }
    igi_validation_destroy(v);
    put("report_want/truth.json", "{\"regions\": {\"a\": {\"albedo\": [1]}}}");
    CHECK(igi_validate(ctx, "report_got", "report_want", &v) == IGI_E_DATA);
    CHECK_CONTAINS(igi_context_message(ctx), "has 2 bands");
    igi_context_destroy(ctx);
}

static void put_map(igi_context *ctx, const char *path, const float (*texels)[4])
{
    igi_image *map = NULL;
    CHECK_OK(ctx, igi_image_create(ctx, 2, 2, 4, &map));
    if (!map) abort();
    snprintf(map->names[3], sizeof map->names[3], "A");
    memcpy(map->samples, texels, 16 * sizeof **texels);
    CHECK_OK(ctx, igi_image_save_exr(ctx, map, IGI_EXR_FLOAT, path));
    igi_image_destroy(map);
}

/* Texels that are filled in (A of 0) are nobody's error; those that are determined are. */
static void errors_of_texels(void)
{
    static const float got[4][4] = {
        {.11f, .11f, .11f, 1}, {.9f, .9f, .9f, 0}, {.33f, .33f, .33f, .6f}, {.9f, .9f, .9f, .4f}};
    static const float want[4][4] = {
        {.1f, .1f, .1f, 1}, {.2f, .2f, .2f, 1}, {.3f, .3f, .3f, 1}, {.4f, .4f, .4f, 1}};
    igi_context *ctx = test_context(1);
    igi_validation *v = NULL;
    mkdir("report_got", 0777);
    mkdir("report_want", 0777);
    put_map(ctx, "report_got/map.exr", got);
    put_map(ctx, "report_want/map.exr", want);
    put("report_want/truth.json",
        "{\"regions\": {\"a\": {\"albedo\": [0.25, 0.25, 0.25], \"model\": \"lambert\", "
        "\"texture\": \"map.exr\"}}}");
    put("report_got/materials.json",
        "{\"igi\": 1, \"regions\": {\"a\": {\"albedo\": [0.5, 0.5, 0.5], \"model\": \"lambert\", "
        "\"textured\": true, \"albedo_map\": \"map.exr\"}}}");
    CHECK_OK(ctx, igi_validate(ctx, "report_got", "report_want", &v));
    if (v) {
        CHECK_NEAR(v->regions[0].texture_median, .1, 1e-6);
        CHECK_NEAR(v->regions[0].texture_mean, .1, 1e-6);
        CHECK_NEAR(v->regions[0].texture_seen, .5, 0);
        CHECK_NEAR(v->regions[0].albedo, .1, 1e-6); /* .22 of .2, where it is determined */
    }
    igi_validation_destroy(v);
    igi_context_destroy(ctx);
}

static igi_image *ramp(igi_context *ctx, int width, int height, int channels)
{
    igi_image *image = NULL;
    CHECK_OK(ctx, igi_image_create(ctx, width, height, channels, &image));
    for (int y = 0; y < height; y++)
        for (int x = 0; x < width; x++)
            for (int c = 0; c < channels; c++)
                image->samples[((size_t)y * (size_t)width + (size_t)x) * (size_t)channels +
                               (size_t)c] = (float)(x + 1) + 10 * (float)y;
    return image;
}

static void resampling(void)
{
    igi_context *ctx = test_context(1);
    igi_image *image = ramp(ctx, 6, 4, 1), *small = NULL, *large = NULL;
    CHECK_OK(ctx, igi_image_resample(ctx, image, 4, 2, &small));
    CHECK_OK(ctx, igi_image_resample(ctx, image, 12, 4, &large));
    if (small) { /* pixels of 1.5: (1 + 2/2)/1.5, rows 0 and 1 averaged */
        CHECK_NEAR((double)small->samples[0], (1 + .5 * 2) / 1.5 + 5, 1e-5);
        CHECK_NEAR((double)small->samples[5], (.5 * 2 + 3) / 1.5 + 25, 1e-5);
    }
    if (large) {
        CHECK_NEAR((double)large->samples[0], 1, 1e-6);
        CHECK_NEAR((double)large->samples[1], 1.25, 1e-6);
        CHECK_NEAR((double)large->samples[11], 6, 1e-6);
    }
    igi_image_destroy(small);
    igi_image_destroy(large);
    igi_image_destroy(image);
    igi_context_destroy(ctx);
}

static void colours(void)
{
    igi_srgb table;
    uint8_t rgb[3];
    igi_srgb_make(&table);
    CHECK(igi_srgb_byte(&table, 0) == 0 && igi_srgb_byte(&table, 1) == 255);
    CHECK(igi_srgb_byte(&table, -1) == 0 && igi_srgb_byte(&table, (float)NAN) == 0);
    CHECK(igi_srgb_byte(&table, .214f) == 127 || igi_srgb_byte(&table, .214f) == 128);
    igi_ramp_colour(igi_ramp_spread, .5f, rgb);
    CHECK(rgb[0] == 247 && rgb[1] == 247 && rgb[2] == 247);
    igi_ramp_colour(igi_ramp_heat, 2, rgb);
    CHECK(rgb[0] == 253 && rgb[2] == 37);
    CHECK(igi_band_of(2, 3) == 2 && igi_band_of(2, 1) == 0 && igi_band_of(2, 7) == 2);
}

/* Mean over the ball of its first band, and its largest value. */
static void measure(igi_context *ctx, const igi_material *m, double *mean, double *largest)
{
    igi_image *ball = NULL;
    double sum = 0, cover = 0;
    *largest = 0;
    CHECK_OK(ctx, igi_sphere_draw(ctx, m, 2, 64, &ball));
    if (!ball) abort();
    for (int i = 0; i < 64 * 64; i++) {
        const float *p = ball->samples + 3 * i;
        sum += (double)(p[0] * p[2]);
        cover += (double)p[2];
        if (p[2] >= 1) *largest = fmax(*largest, (double)p[0]);
    }
    CHECK_NEAR(cover, 3.14159 * 31.5 * 31.5, 20);
    *mean = sum / cover;
    igi_image_destroy(ball);
}

static void balls(void)
{
    igi_context *ctx = test_context(1);
    igi_material white = {.model = IGI_LAMBERT, .albedo = {1, .5}}, grey = white, glossy = {0};
    double mean[3], largest[3];
    measure(ctx, &white, &mean[0], &largest[0]);
    CHECK_NEAR(largest[0], 1, .02); /* by definition */
    grey.albedo[0] = .25;
    measure(ctx, &grey, &mean[1], &largest[1]);
    CHECK_NEAR(mean[1], .25 * mean[0], 1e-4);
    /* both ways of summing a lobe agree where they meet, and it sends on about its coefficient */
    glossy.model = IGI_WARD;
    glossy.specular = .2;
    glossy.alpha = .1199;
    measure(ctx, &glossy, &mean[1], &largest[1]);
    glossy.alpha = .1201;
    measure(ctx, &glossy, &mean[2], &largest[2]);
    CHECK_NEAR(mean[1] / mean[2], 1, .05);
    CHECK(mean[2] > .1 * mean[0] && mean[2] < .3 * mean[0]);
    glossy.alpha = .3;
    measure(ctx, &glossy, &mean[2], &largest[2]);
    CHECK(largest[2] < .4 * largest[1]); /* broader is dimmer */
    igi_context_destroy(ctx);
}

/* Region names and warnings that would break a careless page; maps with and without texels seen;
 * photographs with lamps, black pixels and NaN. */
static igi_recovery *awkward(igi_context *ctx)
{
    static const char *const names[] = {"</script><b>x", "a & \"b\"/c", "lamp", "wänd"};
    igi_recovery *r = igi_calloc(ctx, 1, sizeof *r);
    igi_materials *m = r->materials = igi_calloc(ctx, 1, sizeof *m);
    CHECK_OK(ctx, igi_strdup(ctx, "<room> & 'co'", &m->scene));
    m->bands = 3;
    m->count = 4;
    m->materials = igi_calloc(ctx, 4, sizeof *m->materials);
    for (int i = 0; i < 4; i++) {
        igi_material *one = &m->materials[i];
        CHECK_OK(ctx, igi_strdup(ctx, names[i], &one->region));
        *one = (igi_material){.region = one->region,
                              .emitter = i == 2,
                              .determined = i < 2,
                              .albedo = {.3, .2 * i, .9},
                              .albedo_std = {.001, i == 3 ? HUGE_VAL : .01},
                              .observed = i < 2 ? .7 : 0,
                              .views = i};
        one->model = i == 1 ? IGI_WARD : IGI_LAMBERT;
        one->alpha = i == 1 ? .1 : 0;
    }
    for (int i = 0; i < 2; i++) {
        m->materials[i].map = ramp(ctx, 300 - 299 * i, 40, 4);
        m->materials[i].map_std = ramp(ctx, 300 - 299 * i, 40, 3);
    }
    m->materials[0].map_std->samples[7] = (float)NAN;
    r->evidence = igi_calloc(ctx, 4, sizeof *r->evidence);
    r->evidence[0] = (igi_region_evidence){.gathered_rays = 123400,
                                           .lobe_rays = 5600,
                                           .count = 1,
                                           .tried = {{.model = IGI_WARD,
                                                      .look = "glance",
                                                      .gain = 3,
                                                      .residuals = 100,
                                                      .plain_noise = .05}}};
    r->evidence[1] = (igi_region_evidence){
        .count = 2,
        .tried = {{.model = IGI_WARD, .look = "search", .gain = (double)NAN, .residuals = 0},
                  {.model = IGI_WARD,
                   .look = "refine",
                   .gain = 300,
                   .residuals = 100,
                   .noise = .05,
                   .plain_noise = .2,
                   .specular = .1,
                   .specular_std = .01}}};
    m->warnings = igi_calloc(ctx, 1, sizeof(char *));
    m->warning_count = 1;
    CHECK_OK(ctx, igi_strdup(ctx, "1 < 2 & <script>throw 1</script>", &m->warnings[0]));
    r->comparison_count = 9;
    r->comparisons = igi_calloc(ctx, 9, sizeof *r->comparisons);
    for (int i = 0; i < 9; i++) {
        igi_comparison *c = &r->comparisons[i];
        CHECK_OK(ctx, igi_strprintf(ctx, &c->frame, "view <%d>/x", i));
        c->photo = ramp(ctx, 64, 48, 3);
        c->prediction = ramp(ctx, 64, 48, 3);
        if (i > 0) c->albedo = ramp(ctx, 64, 48, 3); /* an older result has none */
        c->regions = i;
        c->photo->samples[0] = (float)NAN;
        c->photo->samples[9] = -1;
        memset(c->prediction->samples + 300, 0, 200 * sizeof(float));
    }
    return r;
}

static void a_page_of_awkward_content(void)
{
    igi_context *ctx = test_context(1);
    igi_recovery *r = awkward(ctx);
    const char *inputs[] = {FOLDER "/materials.json"};
    igi_setting settings[] = {{"method", "<patches>"}};
    igi_manifest manifest = {"igi recover '<a>' & b", 1, settings, 1, inputs};
    mkdir(FOLDER, 0777);
    igi_stage_begin(ctx, "a stage");
    igi_stage_begin(ctx, NULL);
    CHECK_OK(ctx, igi_materials_save(ctx, r->materials, NULL, FOLDER));
    CHECK_OK(ctx, igi_comparisons_save(ctx, r, FOLDER));
    CHECK_OK(ctx, igi_manifest_save(ctx, &manifest, FOLDER));
    CHECK_OK(ctx, igi_evidence_save(ctx, r, FOLDER));
    CHECK_OK(ctx, igi_report(ctx, FOLDER, FOLDER)); /* its own truth */
    FILE *page = fopen(FOLDER "/report.html", "r");
    CHECK(page != NULL);
    static char text[1 << 20];
    size_t n = page ? fread(text, 1, sizeof text - 1, page) : 0;
    text[n] = 0;
    if (page) fclose(page);
    CHECK_CONTAINS(text, "&lt;script&gt;throw 1&lt;/script&gt;");
    CHECK_CONTAINS(text, "w\xc3\xa4nd");
    CHECK_CONTAINS(text, "<td>123.4</td><td>5.6</td>"); /* thousands of rays */
    CHECK_CONTAINS(text, "not seen");
    CHECK_CONTAINS(text, "gives no hint of a lobe");
    CHECK_CONTAINS(text, "ward&nbsp;+3.000");
    CHECK_CONTAINS(text, "fall from 20.00 to 5.00&nbsp;%");
    CHECK_CONTAINS(text, "truth: lambert, &rho;&nbsp;");
    CHECK(strstr(text, "<b>x") == NULL && strstr(text, "http") == NULL);
    CHECK(igi_report(ctx, "/nonexistent", NULL) == IGI_E_DATA);
    igi_recovery_destroy(r);
    igi_context_destroy(ctx);
}

TEST_MAIN({"errors_by_hand", errors_by_hand}, {"errors_of_texels", errors_of_texels},
          {"resampling", resampling}, {"colours", colours}, {"balls", balls},
          {"a_page_of_awkward_content", a_page_of_awkward_content})
