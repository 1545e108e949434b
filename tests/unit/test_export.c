/* SPDX-License-Identifier: Apache-2.0
 *
 * A result, exported and read back.
 */
#include "test.h"

#include "base/context.h"
#include "base/vec.h"
#include "image/srgb.h"
#include "material/result.h"
#include "scene/mesh.h"

#include <sys/stat.h>

static float positions[] = {0, 0, 0, 2, 0, 0, 2, 1, 0, 0, 1, 0, 0, 0, 1};
static uint32_t triangles[] = {0, 1, 2, 0, 2, 3, 0, 1, 4};
static uint32_t regions[] = {0, 0, 1};

/* A textured floor without texture coordinates, and a lamp; materials in the other order. */
static void save_result(igi_context *ctx, const char *folder)
{
    char floor[] = "the floor & \"all\"", lamp[] = "lamp", name[] = "export", path[256];
    igi_region parts[] = {{floor, false, IGI_YES, false, false},
                          {lamp, true, IGI_AUTO, false, false}};
    igi_light light = {.type = IGI_LIGHT_AREA, .region = 1, .known = true, .value = {4, 5, 6}};
    igi_scene scene = {.name = name,
                       .bands = 3,
                       .region_count = 2,
                       .regions = parts,
                       .mesh = {5, 3, positions, triangles, regions, NULL}};
    igi_material of[] = {{.region = floor,
                          .model = IGI_WARD,
                          .albedo = {.5, .4, .3},
                          .specular = .08,
                          .alpha = .25,
                          .observed = 1,
                          .textured = true},
                         {.region = lamp, .emitter = true}};
    igi_materials all = {
        .scene = name, .bands = 3, .count = 2, .materials = of, .light_count = 1, .lights = &light};
    (void)mkdir(folder, 0777);
    CHECK_OK(ctx, igi_image_create(ctx, 4, 4, 4, &of[0].map));
    for (int i = 0; i < 64; i++) of[0].map->samples[i] = (float)i / 64;
    CHECK_OK(ctx, igi_materials_save(ctx, &all, &scene, folder));
    snprintf(path, sizeof path, "%s/scene.glb", folder);
    CHECK_OK(ctx, igi_materials_save_glb(ctx, &all, &scene, path));
    igi_image_destroy(of[0].map);
}

/* The map of a region without texture coordinates comes along with those of its atlas. */
static void atlas(void)
{
    igi_context *ctx = test_context(1);
    igi_scene *scene;
    igi_materials *materials;
    save_result(ctx, "export_atlas");
    CHECK_OK(ctx, igi_result_load(ctx, "export_atlas", &scene, &materials));
    if (!scene) return;
    CHECK(scene->region_count == 2 && materials->count == 2 && scene->mesh.uvs);
    for (size_t r = 0; r < scene->region_count; r++) {
        CHECK_STR(scene->regions[r].name, materials->materials[r].region);
        CHECK(scene->regions[r].emitter == (strcmp(scene->regions[r].name, "lamp") == 0));
        CHECK(scene->regions[r].has_uvs != scene->regions[r].emitter);
        CHECK(!scene->regions[r].uvs_wrap);
    }
    CHECK_STR(scene->regions[materials->lights[0].region].name, "lamp");
    igi_materials_destroy(materials);
    igi_scene_destroy(scene);
    igi_context_destroy(ctx);
}

static double area_of(const igi_scene *scene, const char *region)
{
    double sum = 0;
    const igi_mesh *mesh = &scene->mesh;
    for (size_t t = 0; t < mesh->triangle_count; t++) {
        const float *p[3];
        double a[3], b[3];
        if (strcmp(scene->regions[mesh->regions[t]].name, region) != 0) continue;
        for (size_t k = 0; k < 3; k++) p[k] = mesh->positions + 3 * mesh->triangles[3 * t + k];
        for (int i = 0; i < 3; i++) {
            a[i] = (double)(p[1][i] - p[0][i]);
            b[i] = (double)(p[2][i] - p[0][i]);
        }
        double c[3] = {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2],
                       a[0] * b[1] - a[1] * b[0]};
        sum += sqrt(c[0] * c[0] + c[1] * c[1] + c[2] * c[2]) / 2;
    }
    return sum;
}

static void read_file(const char *path, char *text, size_t size)
{
    FILE *file = fopen(path, "r");
    text[0] = 0;
    CHECK(file != NULL);
    if (!file) return;
    text[fread(text, 1, size - 1, file)] = 0;
    fclose(file);
}

static void obj(void)
{
    igi_context *ctx = test_context(1);
    igi_scene *scene = calloc(1, sizeof *scene);
    igi_export_options options;
    char text[4096];
    igi_export_options_init(&options);
    options.format = IGI_EXPORT_OBJ;
    save_result(ctx, "export_obj");
    CHECK_OK(ctx, igi_export(ctx, "export_obj", &options, "export_test.obj"));
    CHECK_OK(ctx, igi_mesh_load(ctx, scene, "export_test.obj"));
    CHECK(scene->region_count == 2 && scene->mesh.triangle_count == 3);
    CHECK_NEAR(area_of(scene, "the floor & \"all\""), 2, 1e-5);
    CHECK_NEAR(area_of(scene, "lamp"), 1, 1e-5);
    float highest = 0;
    for (size_t i = 0; i < scene->mesh.vertex_count; i++)
        highest = fmaxf(highest, scene->mesh.positions[3 * i + 2]);
    CHECK_NEAR((double)highest, 1, 1e-6); /* of the lamp: Z is up */
    read_file("export_test.obj_files/scene.mtl", text, sizeof text);
    CHECK_CONTAINS(text, "newmtl the floor & \"all\"\nillum 2\nKa 0 0 0\nKd 0.5 0.4 0.3\n"
                         "Ks 0.08 0.08 0.08\nNs 30\nPr 0.5\n");
    CHECK_CONTAINS(text, "map_Kd the floor & %22all%22.png");
    CHECK_CONTAINS(text, "Ke 4 5 6\n");
    igi_scene_destroy(scene);
    igi_context_destroy(ctx);
}

static void export_as(igi_context *ctx, igi_export_format format, const char *path, char *text,
                      size_t size)
{
    igi_export_options options;
    igi_export_options_init(&options);
    options.format = format;
    CHECK_OK(ctx, igi_export(ctx, "export_lit", &options, path));
    read_file(path, text, size);
}

/* A phong floor under a spot and a line. */
static void save_lit(igi_context *ctx)
{
    char floor[] = "floor", name[] = "lit";
    igi_region region = {floor, false, IGI_NO, false, false};
    igi_light lights[] = {{.type = IGI_LIGHT_SPOT,
                           .region = -1,
                           .position = {1, 1, 3},
                           .direction = {0, 0, -1},
                           .cutoff_deg = 40,
                           .beam_deg = 25,
                           .known = true,
                           .value = {2, 2, 2}},
                          {.type = IGI_LIGHT_LINE,
                           .region = -1,
                           .position = {0, 0, 2},
                           .end = {3, 0, 2},
                           .known = true,
                           .value = {5, 5, 5}}};
    igi_scene scene = {.name = name,
                       .bands = 3,
                       .region_count = 1,
                       .regions = &region,
                       .mesh = {5, 2, positions, triangles, regions, NULL}};
    igi_material of = {.region = floor,
                       .model = IGI_PHONG,
                       .albedo = {.5, .5, .5},
                       .specular = .1,
                       .alpha = .5,
                       .observed = 1};
    igi_materials all = {.scene = name,
                         .bands = 3,
                         .count = 1,
                         .materials = &of,
                         .light_count = 2,
                         .lights = lights};
    (void)mkdir("export_lit", 0777);
    CHECK_OK(ctx, igi_materials_save(ctx, &all, &scene, "export_lit"));
    CHECK_OK(ctx, igi_materials_save_glb(ctx, &all, &scene, "export_lit/scene.glb"));
}

/* Sum of the numbers behind `word`, wherever it stands; *count: how often it does. */
static double sum_behind(const char *text, const char *word, int *count)
{
    double sum = 0;
    *count = 0;
    for (const char *at = text; (at = strstr(at, word)); (*count)++) {
        at += strlen(word);
        sum += strtod(at, NULL);
    }
    return sum;
}

/* Power of the spot that is full to b and falls to 0 at c, linearly in angle, for an intensity of 1. */
static double spot_power(double b, double c)
{
    const int steps = 20000;
    double sum = 0;
    for (int i = 0; i < steps; i++) {
        double angle = (i + .5) / steps * c;
        sum += 2 * IGI_PI * sin(angle) * fmin(1, (c - angle) / (c - b)) * c / steps;
    }
    return sum;
}

/* Each program's numbers for one spot, one line and one phong lobe. */
static void lit(void)
{
    igi_context *ctx = test_context(1);
    static char text[1 << 16];
    int count;
    const double degree = IGI_PI / 180;
    save_lit(ctx);
    export_as(ctx, IGI_EXPORT_PBRT, "export_lit.pbrt", text, sizeof text);
    CHECK_CONTAINS(text, "\"float coneangle\" 40 \"float conedeltaangle\" 15");
    CHECK_NEAR(sum_behind(text, "\"rgb I\" [ ", &count), 2 + 5 * 3,
               1e-5); /* the line: 5 W/sr/m, 3 m */
    CHECK(count > 2);
    /* Near its peak the lobe is exp(-(2 delta)^2/alpha^2) of the half vector: half as wide. */
    CHECK_NEAR(sum_behind(text, "\"float roughness\" ", &count), .5 / sqrt(4 - 3 * .25), 1e-6);
    export_as(ctx, IGI_EXPORT_MITSUBA, "export_lit.xml", text, sizeof text);
    CHECK_NEAR(sum_behind(text, "\"cutoff_angle\" value=\"", &count), 40, 0);
    CHECK_NEAR(sum_behind(text, "\"beam_width\" value=\"", &count), 25, 0);
    export_as(ctx, IGI_EXPORT_RADIANCE, "export_lit.rad", text, sizeof text);
    const char *spot = strstr(text, "spotlight light_0");
    double n[4] = {0};
    CHECK(spot &&
          sscanf(spot, "spotlight light_0 0 0 7 %lf %lf %lf %lf", n, n + 1, n + 2, n + 3) == 4);
    CHECK_NEAR(2 * IGI_PI * (1 - cos(n[3] / 2 * degree)), spot_power(25 * degree, 40 * degree),
               1e-6);
    igi_context_destroy(ctx);
}

/* Radiance's pixels: a mantissa of 8 bits for each, 2^(e - 128) / 256. */
static void rgbe(void)
{
    uint8_t bytes[4];
    igi_rgbe((const float[3]){1, .5f, 3}, bytes);
    for (int k = 0; k < 3; k++)
        CHECK_NEAR(ldexp(bytes[k] / 256., bytes[3] - 128), k == 0 ? 1 : k == 1 ? .5 : 3, 1e-6);
}

static void names(void)
{
    igi_export_format format;
    CHECK(igi_export_format_from_name("pbrt", &format) && format == IGI_EXPORT_PBRT);
    CHECK(!igi_export_format_from_name("PBRT", &format));
    CHECK_STR(igi_export_format_name(IGI_EXPORT_MITSUBA), "mitsuba");
}

TEST_MAIN({"atlas", atlas}, {"obj", obj}, {"lit", lit}, {"rgbe", rgbe}, {"names", names})
