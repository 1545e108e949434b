/* SPDX-License-Identifier: Apache-2.0
 *
 * Meshes: OBJ as exporters write it and as it should not be; PLY and glTF through Assimp.
 */
#include "scene_fixture.h"

#include "scene/file_text.h"
#include "scene/mesh.h"
#include "trace/trace.h"

#define FOLDER "scratch_scene_mesh"

static igi_context *ctx;
static igi_scene *loaded;

/* The mesh of a file of that text; NULL, with the sentence in ctx, if it is refused. */
static igi_scene *mesh_of(const char *name, const char *text)
{
    char path[512];
    igi_scene_destroy(loaded);
    igi_context_destroy(ctx);
    ctx = test_context(1);
    (void)mkdir(FOLDER, 0777);
    fixture_folder = FOLDER;
    write_text(name, text);
    snprintf(path, sizeof path, FOLDER "/%s", name);
    if (IGI_ALLOC(ctx, 1, &loaded) != IGI_OK) abort();
    igi_status status = igi_mesh_load(ctx, loaded, path);
    if (status == IGI_OK) return loaded;
    CHECK(status == IGI_E_DATA);
    return NULL;
}

static igi_scene *obj_of(const char *text)
{
    return mesh_of("m.obj", text);
}

static void check_refused(const char *text, const char *sentence)
{
    CHECK(!obj_of(text));
    CHECK_CONTAINS(igi_context_message(ctx), sentence);
}

static void finish(void)
{
    igi_scene_destroy(loaded);
    igi_context_destroy(ctx);
    loaded = NULL;
    ctx = NULL;
}

#define SQUARE "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n"

static bool has_triangle(const igi_scene *s, size_t i, uint32_t a, uint32_t b, uint32_t c)
{
    const uint32_t *t = s->mesh.triangles + 3 * i;
    return t[0] == a && t[1] == b && t[2] == c;
}

static void polygons(void)
{
    igi_scene *s = obj_of(SQUARE "v .5 1.5 0\nf 1 2 3 5 4\n");
    CHECK(s && s->mesh.triangle_count == 3 && s->mesh.vertex_count == 5);
    if (s)
        CHECK(has_triangle(s, 0, 0, 1, 2) && has_triangle(s, 1, 0, 2, 4) &&
              has_triangle(s, 2, 0, 4, 3));
    if (s) CHECK_STR(s->regions[0].name, "default");
    if (s) CHECK(!s->mesh.uvs && !s->regions[0].has_uvs && !s->regions[0].uvs_wrap);
    finish();
}

/* The areas of the triangles' shadows on z = 0, with sign: those of a fan that leaves the polygon
 * would have both signs. */
static void check_areas(const igi_scene *s, double want)
{
    double sum = 0, least = 1;
    for (size_t i = 0; s && i < s->mesh.triangle_count; i++) {
        const float *p[3];
        for (int k = 0; k < 3; k++)
            p[k] = s->mesh.positions + 3 * s->mesh.triangles[3 * i + (size_t)k];
        double area = .5 * (double)((p[1][0] - p[0][0]) * (p[2][1] - p[0][1]) -
                                    (p[1][1] - p[0][1]) * (p[2][0] - p[0][0]));
        sum += area;
        least = fmin(least, area * (want < 0 ? -1 : 1));
    }
    CHECK_NEAR(sum, want, 1e-6);
    CHECK(least > 0);
}

static void concave_polygons(void)
{
    /* a floor in the shape of an L, begun at any corner, seen from either side */
    static const int l[6][2] = {{0, 0}, {4, 0}, {4, 1}, {1, 1}, {1, 3}, {0, 3}};
    for (int start = 0; start < 6; start++)
        for (int side = -1; side <= 1; side += 2) {
            char text[256], *at = text;
            for (int i = 0; i < 6; i++) {
                int k = (start + side * i + 6) % 6;
                at += sprintf(at, "v %d %d 2\nvt %d %d\n", l[k][0], l[k][1], l[k][0], l[k][1]);
            }
            sprintf(at, "f 1/1 2/2 3/3 4/4 5/5 6/6\n");
            igi_scene *s = obj_of(text);
            CHECK(s && s->mesh.triangle_count == 4 && s->regions[0].has_uvs);
            check_areas(s, side * 6);
            for (size_t i = 0; s && s->mesh.uvs && i < 12; i++) { /* the corners kept their own */
                const float *p = s->mesh.positions + 3 * s->mesh.triangles[i];
                CHECK(s->mesh.uvs[2 * i] == p[0] && s->mesh.uvs[2 * i + 1] == p[1]);
            }
        }
    /* a wall around a door, upright; and a dart whose fan folds over */
    check_areas(obj_of("v 0 0 0\nv 4 0 0\nv 1 1 0\nv 0 4 0\nf 2 3 4 1\n"), 4);
    igi_scene *s = obj_of("v 0 5 0\nv 1 5 0\nv 1 5 2\nv 2 5 2\nv 2 5 0\nv 3 5 0\nv 3 5 3\nv 0 5 3\n"
                          "f 1 2 3 4 5 6 7 8\n");
    double area = 0;
    CHECK(s && s->mesh.triangle_count == 6);
    for (uint32_t i = 0; s && i < 6; i++) area += (double)igi_triangle_area(&s->mesh, i);
    CHECK_NEAR(area, 7, 1e-5);
    /* what crosses itself ends, too */
    s = obj_of("v 0 0 0\nv 1 1 0\nv 1 0 0\nv 0 1 0\nv .5 3 0\nf 1 2 3 4 5\n");
    CHECK(s && s->mesh.triangle_count >= 1);
    finish();
}

/* Relative indices count back from the last vertex so far; positive ones may look ahead. */
static void indices(void)
{
    igi_scene *s = obj_of("v 9 9 9\n" SQUARE "f -4 -3 -2\nf 6 7 8\nv 0 0 5\nv 1 0 5\nv 0 1 5\n");
    CHECK(s && s->mesh.triangle_count == 2);
    if (s) CHECK(has_triangle(s, 0, 1, 2, 3) && has_triangle(s, 1, 5, 6, 7));
    finish();
    check_refused(SQUARE "f 1 2 0\n", "m.obj:5: a face names a vertex that cannot be");
    check_refused(SQUARE "f 1 2 -5\n", "m.obj:5: a face names a vertex that cannot be");
    check_refused(SQUARE "f 1 2 3\n\nf 1 2 9\n",
                  "m.obj:7: a face names vertex 9, but there are only 4");
    check_refused(SQUARE "f 1 2 99999999999999999999\n",
                  "m.obj:5: a face names a vertex that cannot");
    check_refused(SQUARE "vt 0 0\nf 1/1 2/2 3/1\n",
                  "m.obj:6: a face names texture coordinate 2, but");
    check_refused(SQUARE "vt 0 0\nf 1/1 2/0 3/1\n",
                  "m.obj:6: a face names a texture coordinate that");
    check_refused(SQUARE "f 1 2 x\n", "m.obj:5: a face names a vertex that cannot be");
    check_refused(SQUARE "f 1 2\n", "m.obj:5: a face of less than three corners");
    check_refused(SQUARE "f\n", "m.obj:5: a face of less than three corners");
    finish();
}

static void corner_forms(void)
{
    igi_scene *s = obj_of(SQUARE
                          "vt 0 0\nvt 1 0\nvt 1 1\nvn 0 0 1\n"
                          "usemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 1//1 2//1 3//1\n"
                          "usemtl c\nf 1/1/1 2/2/-1 3/3/1\nusemtl d\nf -4/-3 -3/-2/-1 -2/-1\n"
                          "usemtl e\nf 1/1 2/2 3\n");
    CHECK(s && s->mesh.triangle_count == 5 && s->region_count == 5 && s->mesh.uvs);
    if (!s || !s->mesh.uvs) return;
    const bool has_uvs[5] = {true, false, true, true, false};
    for (size_t i = 0; i < 5; i++) {
        CHECK(has_triangle(s, i, 0, 1, 2));
        CHECK(s->regions[i].has_uvs == has_uvs[i]);
        CHECK(s->mesh.regions[i] == i);
        if (!has_uvs[i]) continue;
        CHECK(s->mesh.uvs[6 * i + 2] == 1 && s->mesh.uvs[6 * i + 3] == 0);
        CHECK(s->mesh.uvs[6 * i + 4] == 1 && s->mesh.uvs[6 * i + 5] == 1);
    }
    finish();
}

static void regions(void)
{
    igi_scene *s = obj_of(SQUARE
                          "usemtl unused\nusemtl  two words \t\nf 1 2 3\nusemtl b\r\nf 1 3 4\n"
                          "usemtl two words\nf 2 3 4\nusemtl\nf 1 2 4\n");
    CHECK(s && s->region_count == 3);
    if (s) {
        CHECK_STR(s->regions[0].name, "two words");
        CHECK_STR(s->regions[1].name, "b");
        CHECK_STR(s->regions[2].name, "default");
        CHECK(s->mesh.regions[0] == 0 && s->mesh.regions[1] == 1 && s->mesh.regions[2] == 0);
    }
    finish();
    check_refused(SQUARE "usemtl \xff\nf 1 2 3\n", "m.obj:5: a material's name is not UTF-8");
    finish();
}

static void many_regions(void)
{
    const int count = 3000; /* the table of names grows several times */
    char *text = malloc(100000), *at = text, name[16];
    at += sprintf(at, SQUARE);
    for (int i = 0; i < count; i++) at += sprintf(at, "usemtl m%d\nf 1 2 3\n", i);
    igi_scene *s = obj_of(text);
    int alike = 0;
    CHECK(s && s->region_count == (size_t)count);
    for (int i = 0; s && i < count; i++) {
        snprintf(name, sizeof name, "m%d", i);
        alike += strcmp(s->regions[i].name, name) == 0 && s->mesh.regions[i] == (uint32_t)i;
    }
    CHECK(alike == count);
    free(text);
    finish();
}

static void layout_of_lines(void)
{
    igi_scene *s = obj_of(
        "# made by hand \\\nv 0 0 0 # origin\r\n\tv 1 0 \\\n 0\nv 1 1 0 .5 .5 .5\n\n"
        "v 0 1 0 1\no thing\ng a b\ns off\nmtllib x.mtl\nl 1 2\np 1\nvn 0 0 1\n"
        "f 1 2 \\\r\n 3\nf 1 3 4");
    CHECK(s && s->mesh.vertex_count == 4 && s->mesh.triangle_count == 2);
    if (s) CHECK(s->mesh.positions[3] == 1 && s->mesh.positions[5] == 0);
    finish();
    /* the lines of a continued statement count */
    check_refused(SQUARE "f 1 \\\n 2 \\\n 3\nv 1 2\n", "m.obj:8: \"v\" without three numbers");
    check_refused(SQUARE "vt\n", "m.obj:5: \"vt\" without a number");
    check_refused("v 1 x 2\n", "m.obj:1: \"v\" without three numbers");
    check_refused(SQUARE "f 1 2 3 \\", "m.obj:5: a face names a vertex that cannot be");
    finish();
}

static void not_finite(void)
{
    check_refused("v 0 0 0\nv nan 0 0\n", "m.obj:2: a coordinate is not a finite number");
    check_refused("v 0 -inf 0\n", "m.obj:1: a coordinate is not a finite number");
    check_refused("v 0 1e39 0\n", "m.obj:1: a coordinate is not a finite number");
    check_refused("vt 0 1e999\n", "m.obj:1: a texture coordinate is not a finite number");
    finish();
}

static void zero_area(void)
{
    igi_scene *s = obj_of(SQUARE "f 1 2 3\nf 1 1 2\n\nf 2 3 3\nusemtl thin\nf 4 4 4\n");
    CHECK(s && s->mesh.triangle_count == 1 && s->region_count == 1);
    if (s) {
        CHECK(s->warning_count == 1);
        CHECK_STR(s->warnings[0],
                  FOLDER "/m.obj:6: 3 triangles without area left out, this the first");
    }
    s = obj_of("v 0 0 0\nv 1 1 1\nv 2 2 2\nv 1 1 1.001\nf 1 2 3\nf 1 2 4\n"); /* one on a line */
    CHECK(s && s->mesh.triangle_count == 1 && s->warning_count == 1);
    if (s && s->warning_count == 1)
        CHECK_CONTAINS(s->warnings[0], "m.obj:5: 1 triangle without area");
    check_refused(SQUARE "f 1 1 1\n", "m.obj: no triangle has any area; mend the mesh");
    check_refused(SQUARE, "m.obj: no triangles; the mesh needs faces");
    check_refused("", "m.obj: no triangles");
    s = obj_of("v 0 0 0\nv 1e-6 0 0\nv 0 1e-6 0\nf 1 2 3\n"); /* small is not degenerate */
    CHECK(s && s->mesh.triangle_count == 1 && s->warning_count == 0);
    finish();
}

static void texture_coordinates(void)
{
    igi_scene *s = obj_of(SQUARE "vt 0 0\nvt 1.00001 0\nvt 1 1\nvt 2.5 1\nvt -1 0\nvt .5\n"
                                 "usemtl in\nf 1/1 2/2 3/3\nusemtl wrap\nf 1/1 2/2 3/4\n"
                                 "usemtl left\nf 1/1 2/5 3/4\nusemtl flat\nf 1/1 2/2 3/6\n"
                                 "v 0 0 .9\nv 0 0 1.1\nusemtl less\nf 1/1 2/2 3/3\nf 1/1 2/1 5/1\n"
                                 "usemtl more\nf 1/1 2/2 3/3\nf 1/1 2/1 6/1\n");
    CHECK(s && s->region_count == 6);
    if (s) {
        CHECK(s->regions[0].has_uvs && !s->regions[0].uvs_wrap);
        CHECK(s->regions[1].has_uvs && s->regions[1].uvs_wrap);
        CHECK(s->regions[2].has_uvs && s->regions[2].uvs_wrap);
        CHECK(!s->regions[3].has_uvs && !s->regions[3].uvs_wrap); /* on a line: no area */
        CHECK(s->regions[4].has_uvs &&
              !s->regions[5].has_uvs); /* less, more than half on a point */
    }
    finish();
}

static void numbers(void)
{
    static const struct {
        const char *text;
        double value;
        const char *rest;
    } cases[] = {{"0", 0, ""},
                 {"-12.5e-1x", -1.25, "x"},
                 {"+.5 ", .5, " "},
                 {"5.", 5, ""},
                 {"1e", 1, "e"},
                 {"1e+", 1, "e+"},
                 {"1E3", 1000, ""},
                 {"123456789.123456789", 123456789.123456789, ""},
                 {"0.1", .1, ""},
                 {"-0.882903", -0.882903, ""},
                 {"3.4028234e38", 3.4028234e38, ""},
                 {"1234567890123456789012345678901234567890", 1.2345678901234568e39, ""},
                 {"0.00000000000000000000000000000000000000000000001", 1e-47, ""},
                 {"1e-999", 0, ""},
                 {"0e99999999999", 0, ""},
                 {"inf", HUGE_VAL, ""},
                 {"-Infinity", -HUGE_VAL, ""}};
    double value;
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        const char *at = cases[i].text;
        CHECK(igi_scan_number(&at, &value));
        if (isinf(cases[i].value)) CHECK(value == cases[i].value);
        else CHECK_NEAR(value, cases[i].value, fabs(cases[i].value) * 4e-16);
        CHECK_STR(at, cases[i].rest);
    }
    const char *const none[] = {"", "-", ".", "e5", "+-1", "x1", "--1", "-.e1"};
    for (size_t i = 0; i < sizeof none / sizeof none[0]; i++) {
        const char *at = none[i];
        CHECK(!igi_scan_number(&at, &value));
        CHECK_STR(at, none[i]);
    }
}

#define PLY                                                                                  \
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\n"          \
    "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n" \
    "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n"

static void ply(void)
{
    igi_scene *s = mesh_of("m.ply", PLY);
    CHECK(s && s->mesh.triangle_count == 2 && s->region_count == 1 && !s->mesh.uvs);
    if (s) CHECK_STR(s->regions[0].name, "default");
    /* Two ways to be damaged; the second, which Assimp 5.2 reads for ever, is ended. */
    CHECK(!mesh_of("m.ply", "ply\nformat ascii 1.0\nelement vertex 4\nend_header\n0 0 0\n"));
    CHECK_CONTAINS(igi_context_message(ctx), FOLDER "/m.ply: ");
    CHECK(!mesh_of("m.ply", "ply\nformat ascii 1.0\nelement vertex 4\n"));
    CHECK_CONTAINS(igi_context_message(ctx), FOLDER "/m.ply: ");
    CHECK(!mesh_of("m.what", "what"));
    CHECK_CONTAINS(igi_context_message(ctx), "m.what: no readable mesh: ");
    finish();
}

/* One triangle, twice: as it is, and mirrored in x and moved by a node of material "red". */
#define GLTF                                                                                       \
    "{\"asset\":{\"version\":\"2.0\"},\"scene\":0,\"scenes\":[{\"nodes\":[0,1]}],"                 \
    "\"nodes\":[{\"mesh\":0},{\"scale\":[-1,1,1],\"translation\":[10,0,0],\"children\":[2]},"      \
    "{\"mesh\":1,\"translation\":[0,0,3]}],\"materials\":[{\"name\":\"white\"},{\"name\":\"red\"}" \
    "],"                                                                                           \
    "\"meshes\":[{\"primitives\":[{\"attributes\":{\"POSITION\":0,\"TEXCOORD_0\":1},\"indices\":"  \
    "2,"                                                                                           \
    "\"material\":0}]},{\"primitives\":[{\"attributes\":{\"POSITION\":0},\"indices\":2,"           \
    "\"material\":1}]}],\"buffers\":[{\"byteLength\":66,\"uri\":\"data:application/"               \
    "octet-stream;base64,"                                                                         \
    "AAAAAAAAAAAAAAAAAACAPwAAAAAAAAAAAAAAAAAAgD8AAAAAAAAAAAAAAAAAAIA/"                             \
    "AAAAAAAAAAAAAIA+AAABAAIA\"}],"                                                                \
    "\"bufferViews\":[{\"buffer\":0,\"byteLength\":36},{\"buffer\":0,\"byteOffset\":36,"           \
    "\"byteLength\":24},{\"buffer\":0,\"byteOffset\":60,\"byteLength\":6}],"                       \
    "\"accessors\":[{\"bufferView\":0,\"componentType\":5126,\"count\":3,\"type\":\"VEC3\","       \
    "\"min\":[0,0,0],\"max\":[1,1,0]},{\"bufferView\":1,\"componentType\":5126,\"count\":3,"       \
    "\"type\":\"VEC2\"},{\"bufferView\":2,\"componentType\":5123,\"count\":3,\"type\":\"SCALAR\"}" \
    "]}"

static void gltf(void)
{
    igi_scene *s = mesh_of("m.gltf", GLTF);
    CHECK(s && s->mesh.triangle_count == 2 && s->region_count == 2);
    if (s && s->region_count == 2 && s->mesh.uvs) {
        CHECK_STR(s->regions[0].name, "white");
        CHECK_STR(s->regions[1].name, "red");
        CHECK(s->regions[0].has_uvs && !s->regions[1].has_uvs);
        CHECK_NEAR((double)s->mesh.uvs[5], .75, 1e-6); /* glTF's origin is at the top */
        const float *p = s->mesh.positions;
        const uint32_t *t = s->mesh.triangles + 3;
        double e[2][3];
        for (int k = 0; k < 3; k++) {
            e[0][k] = (double)(p[3 * t[1] + k] - p[3 * t[0] + k]);
            e[1][k] = (double)(p[3 * t[2] + k] - p[3 * t[0] + k]);
            CHECK_NEAR((double)p[3 * 3 + k], k == 0 ? 10 : k == 2 ? 3 : 0, 0);
        }
        CHECK_NEAR(e[0][0] * e[1][1] - e[0][1] * e[1][0], 1, 1e-6); /* the front is still +z */
    } else {
        printf("%s\n", igi_context_message(ctx));
        CHECK(false);
    }
    finish();
}

static void one_triangle(void)
{
    write_fixture(FOLDER);
    write_text("scene.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
    write_scene("", "");
    CHECK_LOADS();
}

TEST_MAIN({"polygons", polygons}, {"concave polygons", concave_polygons}, {"indices", indices},
          {"corner forms", corner_forms}, {"regions", regions}, {"many regions", many_regions},
          {"layout of lines", layout_of_lines}, {"not finite", not_finite},
          {"zero area", zero_area}, {"texture coordinates", texture_coordinates},
          {"numbers", numbers}, {"PLY", ply}, {"glTF", gltf}, {"one triangle", one_triangle})
