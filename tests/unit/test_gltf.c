/* SPDX-License-Identifier: Apache-2.0
 *
 * scene.glb, read back by Assimp.
 */
#include "test.h"

#include "base/context.h"

#include <assimp/cimport.h>
#include <assimp/material.h>
#include <assimp/postprocess.h>
#include <assimp/scene.h>

static float positions[] = {0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0, 0, 0, 1};
static uint32_t triangles[] = {0, 1, 2, 0, 2, 3, 0, 1, 4};
static uint32_t regions[] = {0, 0, 1};
static float uvs[] = {0, 0, 1, 0, 1, 1, 0, 0, 1, 1, 0, 1, 0, 0, 0, 0, 0, 0};

/* A textured ward square and a lamp of one triangle, with a spot light beside. */
static igi_status save(igi_context *ctx, const char *path, igi_image *map)
{
    char square[] = "square \"1\"", lamp[] = "lamp", name[] = "glb";
    igi_region parts[] = {{square, false, IGI_YES, true, false},
                          {lamp, true, IGI_AUTO, false, false}};
    igi_scene scene = {.name = name,
                       .bands = 3,
                       .region_count = 2,
                       .regions = parts,
                       .mesh = {5, 3, positions, triangles, regions, uvs}};
    igi_material of[] = {{.region = square,
                          .model = IGI_WARD,
                          .albedo = {.5, .4, .3},
                          .specular = .08,
                          .alpha = .25,
                          .textured = map != NULL,
                          .map = map},
                         {.region = lamp, .emitter = true}};
    igi_light lights[] = {{.type = IGI_LIGHT_AREA, .region = 1, .known = true, .value = {10, 5, 2}},
                          {.type = IGI_LIGHT_SPOT,
                           .region = -1,
                           .position = {1, 2, 3},
                           .direction = {0, 0, -1},
                           .cutoff_deg = 40,
                           .beam_deg = 30,
                           .known = true,
                           .value = {3, 3, 1}}};
    igi_materials all = {
        .scene = name, .bands = 3, .count = 2, .materials = of, .light_count = 2, .lights = lights};
    return igi_materials_save_glb(ctx, &all, &scene, path);
}

static const struct aiMesh *mesh_of(const struct aiScene *scene, const char *material)
{
    for (unsigned i = 0; i < scene->mNumMeshes; i++) {
        struct aiString name;
        aiGetMaterialString(scene->mMaterials[scene->mMeshes[i]->mMaterialIndex], AI_MATKEY_NAME,
                            &name);
        if (strcmp(name.data, material) == 0) return scene->mMeshes[i];
    }
    return NULL;
}

static void check_square(const struct aiScene *scene, bool textured)
{
    const struct aiMesh *mesh = mesh_of(scene, "square \"1\"");
    CHECK(mesh && mesh->mNumFaces == 2);
    if (!mesh) return;
    const struct aiMaterial *material = scene->mMaterials[mesh->mMaterialIndex];
    struct aiColor4D base = {0, 0, 0, 0};
    float roughness = 0;
    aiGetMaterialColor(material, "$clr.base", 0, 0, &base);
    CHECK(aiGetMaterialFloatArray(material, "$mat.roughnessFactor", 0, 0, &roughness, NULL) ==
          aiReturn_SUCCESS);
    CHECK_NEAR((double)roughness, .5, 1e-6); /* sqrt(alpha) */
    /* Base colour less what the lobe reflects (.0878 of a GGX lobe with Schlick's F, by quadrature),
     * and that, is albedo and rho_s; a texture holds it all. */
    double g = (double)base.g, lobe = .0878;
    CHECK_NEAR(textured ? g : g * (1 - lobe) + lobe, textured ? 1 : .4 + .08, textured ? 0 : .002);
    CHECK(scene->mNumTextures == (textured ? 1 : 0));
    CHECK((mesh->mTextureCoords[0] != NULL) == textured);
    if (!textured) return;
    CHECK(memcmp(scene->mTextures[0]->pcData, "\x89PNG", 4) == 0);
    /* Assimp turns v back to the bottom left. */
    for (unsigned i = 0; i < mesh->mNumVertices; i++) {
        CHECK_NEAR((double)mesh->mTextureCoords[0][i].x, (double)mesh->mVertices[i].x, 1e-6);
        CHECK_NEAR((double)mesh->mTextureCoords[0][i].y, (double)mesh->mVertices[i].y, 1e-6);
    }
}

static void check_file(igi_context *ctx, igi_image *map)
{
    CHECK_OK(ctx, save(ctx, "gltf_test.glb", map));
    const struct aiScene *scene = aiImportFile("gltf_test.glb", aiProcess_ValidateDataStructure);
    CHECK(scene != NULL);
    if (!scene) {
        printf("%s\n", aiGetErrorString());
        return;
    }
    CHECK(scene->mNumMeshes == 2 && scene->mNumLights == 1);
    check_square(scene, map != NULL);
    const struct aiMesh *lamp = mesh_of(scene, "lamp");
    CHECK(lamp && lamp->mNumFaces == 1);
    struct aiColor4D light = {0, 0, 0, 0};
    if (lamp)
        aiGetMaterialColor(scene->mMaterials[lamp->mMaterialIndex], AI_MATKEY_COLOR_EMISSIVE,
                           &light);
    CHECK_NEAR((double)light.g, .5, 1e-6);
    if (scene->mNumLights == 1) {
        CHECK_NEAR((double)scene->mLights[0]->mAngleOuterCone, 40 * 3.14159265 / 180, 1e-5);
        CHECK(scene->mLights[0]->mType == aiLightSource_SPOT);
    }
    aiReleaseImport(scene);
}

static void read_back(void)
{
    igi_context *ctx = test_context(1);
    igi_image *map = NULL;
    check_file(ctx, NULL);
    CHECK_OK(ctx, igi_image_create(ctx, 5, 3, 4, &map));
    check_file(ctx, map);
    igi_image_destroy(map);
    igi_context_destroy(ctx);
}

static void unwritable(void)
{
    igi_context *ctx = test_context(1);
    CHECK(save(ctx, "/dev/null/scene.glb", NULL) == IGI_E_SYSTEM);
    CHECK_CONTAINS(igi_context_message(ctx), "/dev/null/scene.glb");
    igi_context_destroy(ctx);
}

TEST_MAIN({"read_back", read_back}, {"unwritable", unwritable})
