/* SPDX-License-Identifier: Apache-2.0
 *
 * scene.json: what it says arrives; what is wrong is named with its line and key.
 */
#include "scene_fixture.h"

#define FOLDER "scratch_scene_json"

static void good_scene(void)
{
    write_fixture(FOLDER);
    igi_context *ctx = test_context(1);
    igi_scene *scene = NULL, *same = NULL;
    CHECK_OK(ctx, igi_scene_load(ctx, FOLDER "/", &scene));
    CHECK_OK(ctx, igi_scene_load(ctx, FOLDER "/scene.json", &same));
    if (scene && same) {
        CHECK_STR(scene->name, "box");
        CHECK_STR(scene->folder, FOLDER);
        CHECK_STR(same->folder, FOLDER);
        CHECK(scene->bands == 3 && scene->frame_count == 2 && scene->region_count == 3);
        CHECK(scene->warning_count == 0);
        CHECK_STR(scene->regions[0].name, "floor");
        CHECK(scene->regions[0].textured == IGI_YES && !scene->regions[0].emitter);
        CHECK(scene->regions[1].emitter && scene->regions[1].textured == IGI_AUTO);
        CHECK(!scene->regions[2].emitter && scene->regions[2].textured == IGI_AUTO);
        CHECK(scene->light_count == 1 && scene->lights[0].type == IGI_LIGHT_AREA);
        CHECK(scene->lights[0].region == 1 && scene->lights[0].known);
        for (int k = 0; k < 3; k++) CHECK_NEAR(scene->lights[0].value[k], k + 1, 0);
        CHECK_STR(scene->frames[1].name, "b");
        CHECK_STR(scene->frames[1].path, FOLDER "/images/b.exr");
    }
    igi_scene_destroy(scene);
    igi_scene_destroy(same);
    igi_scene_destroy(NULL);
    igi_context_destroy(ctx);
}

static void every_light(void)
{
    write_fixture(FOLDER);
    write_text("lamp.ies", "IESNA:LM-63-1995\n");
    write_image("sky.exr", 8, 4, 3);
    write_scene(
        "{\"type\":\"point\",\"position\":[1,2,3],\"intensity\":[4,5,6]},"
        "{\"type\":\"spot\",\"position\":[1,2,3],\"direction\":[0,0,-2],\"cutoff_deg\":40,"
        "\"beam_deg\":30},"
        "{\"type\":\"line\",\"from\":[1,2,3],\"to\":[4,5,6],\"intensity\":[1,1,1]},"
        "{\"type\":\"goniometric\",\"position\":[1,2,3],\"profile\":\"lamp.ies\",\"scale\":2},"
        "{\"type\":\"directional\",\"direction\":[3,0,4],\"irradiance\":[1,1,1]},"
        "{\"type\":\"env\",\"image\":\"sky.exr\",\"rotation_deg\":30},"
        "{\"type\":\"ambient\",\"radiance\":[1,0,0]}",
        BOX_REGIONS);
    igi_context *ctx = test_context(1);
    igi_scene *scene = NULL;
    CHECK_OK(ctx, igi_scene_load(ctx, FOLDER, &scene));
    if (scene) {
        const igi_light *l = scene->lights;
        CHECK(scene->light_count == 8);
        CHECK(l[0].type == IGI_LIGHT_POINT && l[0].position[2] == 3 && l[0].value[2] == 6);
        CHECK(l[0].region == -1);
        CHECK(l[1].type == IGI_LIGHT_SPOT && !l[1].known && l[1].direction[2] == -1);
        CHECK(l[1].cutoff_deg == 40 && l[1].beam_deg == 30);
        CHECK(l[2].type == IGI_LIGHT_LINE && l[2].position[0] == 1 && l[2].end[2] == 6);
        CHECK(l[3].type == IGI_LIGHT_GONIOMETRIC && l[3].value[0] == 2 && l[3].value[2] == 2);
        CHECK_STR(l[3].file, FOLDER "/lamp.ies");
        CHECK(l[4].type == IGI_LIGHT_DIRECTIONAL);
        CHECK_NEAR(l[4].direction[0], .6, 1e-15);
        CHECK_NEAR(l[4].direction[2], .8, 1e-15);
        CHECK(l[5].type == IGI_LIGHT_ENV && l[5].known && l[5].value[1] == 1);
        CHECK(l[5].rotation_deg == 30);
        CHECK_STR(l[5].file, FOLDER "/sky.exr");
        CHECK(l[6].type == IGI_LIGHT_AMBIENT && l[6].value[0] == 1 && l[6].value[1] == 0);
        /* the emitter that has no light gets one of unknown radiance */
        CHECK(l[7].type == IGI_LIGHT_AREA && l[7].region == 1 && !l[7].known);
    }
    igi_scene_destroy(scene);
    igi_context_destroy(ctx);
}

static void unknown_keys(void)
{
    write_fixture(FOLDER);
    write_text("scene.json", "{ \"igi\": 1,\n  \"mash\": \"scene.obj\" }\n");
    CHECK_REFUSED(IGI_E_DATA,
                  FOLDER "/scene.json:2: \"mash\": unknown key; did you mean \"mesh\"?");
    write_text("scene.json", "{ \"igi\": 1,\n\n\"author\": \"x\" }\n");
    CHECK_REFUSED(IGI_E_DATA, FOLDER "/scene.json:3: \"author\": unknown key; remove it");
    write_scene(BOX_LIGHT, "\"floor\": {\n \"texturd\": true }");
    CHECK_REFUSED(IGI_E_DATA, "scene.json:8: \"regions.floor.texturd\": unknown key; did you mean "
                              "\"textured\"?");
    write_scene("{ \"type\": \"area\",\n \"region\": \"lamp\",\n \"intensity\": [1,2,3] }",
                BOX_REGIONS);
    CHECK_REFUSED(IGI_E_DATA, "scene.json:7: \"lights[0].intensity\": unknown key");
    write_scene(BOX_LIGHT ",\n" BOX_LIGHT, BOX_REGIONS);
    CHECK_REFUSED(IGI_E_DATA,
                  "scene.json:6: \"lights[1]\": another light is region \"lamp\" already");
    write_scene("{ \"type\": \"aera\", \"region\": \"lamp\" }", BOX_REGIONS);
    CHECK_REFUSED(IGI_E_DATA, "scene.json:5: \"lights[0].type\": no kind of light is \"aera\"; did "
                              "you mean \"area\"?");
    write_scene("{ \"type\": \"laser\" }", BOX_REGIONS);
    CHECK_REFUSED(IGI_E_DATA, "there are area, volume, point");
}

/* The line is found behind strings that hold brackets, quotes and commas, and in any nesting. */
static void lines_of_awkward_text(void)
{
    write_fixture(FOLDER);
    write_text("scene.json", "\xef\xbb\xbf{ \"igi\": 1, \"name\": \"a \\\"]},{ b\\\\\",\r\n"
                             "  \"mesh\": \"scene.obj\", \"cameras\": \"transforms.json\",\r\n"
                             "  \"lights\": [ { \"type\": \"ambient\", \"radiance\": [1,\r\n"
                             "  2, \"}\"\r\n ] } ] }");
    CHECK_REFUSED(IGI_E_DATA,
                  "scene.json:4: \"lights[0].radiance[2]\": is a string; give a number");
}

static void types_and_values(void)
{
    static const struct {
        const char *light, *sentence;
    } cases[] = {
        {"3", "\"lights[0]\": is a number; give an object"},
        {"{}", "\"lights[0].type\": is missing; give a string"},
        {"{\"type\":\"area\",\"region\":\"lamp\",\"radiance\":[1,2]}",
         "\"lights[0].radiance\": has 2 bands, but the images have 3; give 3 numbers"},
        {"{\"type\":\"area\",\"region\":\"lamp\",\"radiance\":7}",
         "\"lights[0].radiance\": is a number; give an array"},
        {"{\"type\":\"area\",\"region\":\"lamp\",\"radiance\":[1,-2,3]}",
         "\"lights[0].radiance\": is -2 in band 1; light cannot be negative"},
        {"{\"type\":\"area\",\"region\":\"lam\",\"radiance\":[1,2,3]}",
         "\"lights[0].region\": the mesh has no region \"lam\"; did you mean \"lamp\"?"},
        {"{\"type\":\"area\",\"region\":\"\"}", "\"lights[0].region\": is empty; give a name"},
        {"{\"type\":\"point\",\"position\":[1,2]}",
         "\"lights[0].position\": has 2 numbers; give 3"},
        {"{\"type\":\"point\"}", "\"lights[0].position\": is missing"},
        {"{\"type\":\"directional\",\"direction\":[0,0,0]}",
         "\"lights[0].direction\": has no length"},
        {"{\"type\":\"spot\",\"position\":[0,0,0],\"direction\":[0,0,1],\"cutoff_deg\":-4}",
         "\"lights[0].cutoff_deg\": is -4; give a half angle"},
        {"{\"type\":\"spot\",\"position\":[0,0,0],\"direction\":[0,0,1],\"cutoff_deg\":4,\"beam_"
         "deg\":5}",
         "\"lights[0].beam_deg\": is 5; give a half angle from 0 to cutoff_deg"},
        {"{\"type\":\"line\",\"from\":[0,0,0],\"to\":[0,0,0]}", "are one point"},
        {"{\"type\":\"env\",\"image\":\"none.exr\"}",
         "\"lights[0].image\": no readable file " FOLDER "/none.exr"},
        {"{\"type\":\"goniometric\",\"position\":[0,0,0],\"profile\":\"none.ies\"}",
         "\"lights[0].profile\": no readable file"},
        {"{\"type\":\"env\",\"image\":\"images/a.exr\",\"scale\":[1]}",
         "\"lights[0].scale\": is an array; give a number"},
    };
    write_fixture(FOLDER);
    for (size_t i = 0; i < sizeof cases / sizeof cases[0]; i++) {
        write_scene(cases[i].light, BOX_REGIONS);
        CHECK_REFUSED(IGI_E_DATA, cases[i].sentence);
        CHECK_REFUSED(IGI_E_DATA, FOLDER "/scene.json:5: ");
    }
}

static void regions_that_are_not_there(void)
{
    write_fixture(FOLDER);
    write_scene(BOX_LIGHT, "\"flor\": {}");
    CHECK_REFUSED(IGI_E_DATA,
                  "scene.json:7: \"regions.flor\": the mesh has no region \"flor\"; did "
                  "you mean \"floor\"?");
    write_scene(BOX_LIGHT, "\"chandelier\": {}");
    CHECK_REFUSED(IGI_E_DATA, "the mesh has no region \"chandelier\" with any area");
    write_scene(BOX_LIGHT, "\"floor\": { \"emitter\": 1 }");
    CHECK_REFUSED(IGI_E_DATA, "\"regions.floor.emitter\": is a number; give true or false");
    write_scene(BOX_LIGHT, "\"lamp\": { \"emitter\": false }");
    CHECK_REFUSED(IGI_E_DATA,
                  "\"regions.lamp.emitter\": is false, but an area light names the region");
    write_scene(BOX_LIGHT, "\"floor\": []");
    CHECK_REFUSED(IGI_E_DATA, "\"regions.floor\": is an array; give an object");
    write_scene(BOX_LIGHT, ""); /* regions that the manifest leaves out are as igi finds them */
    CHECK_LOADS();
}

static void head(void)
{
    write_fixture(FOLDER);
    write_text("scene.json", "{ \"igi\": 2 }");
    CHECK_REFUSED(IGI_E_DATA, "\"igi\": is 2; this program reads version 1");
    write_text("scene.json", "{ }");
    CHECK_REFUSED(IGI_E_DATA, "scene.json:1: \"igi\": is missing");
    write_text("scene.json", "{ \"igi\": 1,\n \"mesh\": 5 }");
    CHECK_REFUSED(IGI_E_DATA, "scene.json:2: \"mesh\": is a number; give a string");
    write_text("scene.json", "{ \"igi\": 1,\n \"mesh\": \"none.obj\" }");
    CHECK_REFUSED(IGI_E_DATA, "scene.json:2: \"mesh\": no readable file " FOLDER "/none.obj");
    write_text("scene.json", "{ \"igi\": 1, \"mesh\": \"scene.obj\" }");
    CHECK_REFUSED(IGI_E_DATA, "\"cameras\": is missing");
    (void)remove(FOLDER "/b.json"); /* of an earlier run */
    write_text("scene.json", "{ \"igi\": 1, \"mesh\": \"scene.obj\", \"cameras\": "
                             "\"transforms.json\",\n \"brackets\": \"b.json\" }");
    CHECK_REFUSED(IGI_E_DATA, "scene.json:2: \"brackets\": no readable file " FOLDER "/b.json");
    write_text("b.json", "{ \"igi\": 1,\n \"images\": { \"a\": [ \"images/a.exr\", 5 ] } }");
    CHECK_REFUSED(IGI_E_DATA, "images/a.exr: ");
    write_text("b.json", "{ \"igi\": 1,\n \"images\": { \"a\": [ 5 ] } }");
    CHECK_REFUSED(IGI_E_DATA, "b.json:2: \"images.a[0]\": is a number; give a string");
    write_text("b.json", "{ \"igi\": 1,\n \"images\": { \"a\": [ ] } }");
    CHECK_REFUSED(IGI_E_DATA, "b.json:2: \"images.a\": has 0 exposures; give 1 to");
    write_text("scene.json", "[1]");
    CHECK_REFUSED(IGI_E_DATA, "scene.json:1: is an array; give an object");
}

static void no_json(void)
{
    write_fixture(FOLDER);
    write_text("scene.json", "{ \"igi\": 1,\n \"mesh\" }");
    CHECK_REFUSED(IGI_E_DATA, FOLDER "/scene.json:2: no valid JSON");
    write_text("scene.json", "{ \"igi\": 1,\n \"igi\": 1 }");
    CHECK_REFUSED(IGI_E_DATA, "scene.json:2: no valid JSON: duplicate object key");
    write_text("scene.json", "");
    CHECK_REFUSED(IGI_E_DATA, "scene.json:1: no valid JSON");
    write_bytes("scene.json", "{ \"igi\": 1\0, \"mesh\": 2 }", 24);
    CHECK_REFUSED(IGI_E_DATA, "scene.json: no valid JSON: byte 10 is a NUL");
    char deep[20001];
    memset(deep, '[', sizeof deep - 1);
    deep[sizeof deep - 1] = 0;
    write_text("scene.json", deep);
    CHECK_REFUSED(IGI_E_DATA, "maximum parsing depth");
}

static void no_file(void)
{
    igi_status status;
    fixture_folder = "scratch_scene_nowhere";
    CHECK_STR(load_sentence(&status),
              "scratch_scene_nowhere: no such file or folder; check the path");
    CHECK(status == IGI_E_DATA);
    write_fixture(FOLDER);
    (void)unlink(FOLDER "/scene.json");
    CHECK_REFUSED(IGI_E_DATA, FOLDER ": no scene.json in it; give the folder that has one");
    (void)mkdir(FOLDER "/scene.json", 0777);
    CHECK_REFUSED(IGI_E_SYSTEM, FOLDER "/scene.json: not a plain file");
    (void)rmdir(FOLDER "/scene.json");
    write_fixture(FOLDER);
    if (geteuid() == 0) return; /* root may read everything */
    (void)chmod(FOLDER "/scene.json", 0);
    CHECK_REFUSED(IGI_E_SYSTEM, FOLDER "/scene.json: cannot be opened");
    (void)unlink(FOLDER "/scene.json");
}

static void lights_alone(void)
{
    write_fixture(FOLDER);
    igi_context *ctx = test_context(1);
    igi_scene *scene = NULL;
    igi_light *lights = NULL;
    size_t count = 7;
    CHECK_OK(ctx, igi_scene_load(ctx, FOLDER, &scene));
    if (!scene) return;
    write_text("lights.json",
               "{ \"lights\": [" BOX_LIGHT
               ",\n{\"type\":\"point\",\"position\":[1,2,3],\"intensity\":[4,5,6]}] }");
    CHECK_OK(ctx, igi_lights_load(ctx, scene, FOLDER "/lights.json", &lights, &count));
    CHECK(count == 2 && lights[0].region == 1 && lights[1].value[1] == 5);
    igi_lights_destroy(lights, count);
    write_text("lights.json", "{ \"lights\": [] }"); /* all is dark */
    CHECK_OK(ctx, igi_lights_load(ctx, scene, FOLDER "/lights.json", &lights, &count));
    CHECK(count == 0);
    igi_lights_destroy(lights, count);
    write_text("lights.json", "{ \"lights\": [\n{\"type\":\"area\",\"region\":\"wall\"}] }");
    CHECK(igi_lights_load(ctx, scene, FOLDER "/lights.json", &lights, &count) == IGI_E_DATA);
    CHECK_CONTAINS(igi_context_message(ctx),
                   "lights.json:2: \"lights[0]\": region \"wall\" is no emitter");
    CHECK(!lights && count == 0);
    write_text("lights.json", "{ \"light\": [] }");
    CHECK(igi_lights_load(ctx, scene, FOLDER "/lights.json", &lights, &count) == IGI_E_DATA);
    CHECK_CONTAINS(igi_context_message(ctx), "\"light\": unknown key; did you mean \"lights\"?");
    igi_lights_destroy(NULL, 3);
    igi_scene_destroy(scene);
    igi_context_destroy(ctx);
}

TEST_MAIN({"good scene", good_scene}, {"every light", every_light}, {"unknown keys", unknown_keys},
          {"lines of awkward text", lines_of_awkward_text}, {"types and values", types_and_values},
          {"regions that are not there", regions_that_are_not_there}, {"head", head},
          {"no JSON", no_json}, {"no file", no_file}, {"lights alone", lights_alone})
