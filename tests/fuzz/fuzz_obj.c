/* SPDX-License-Identifier: Apache-2.0
 *
 * libFuzzer against the OBJ reader.
 */
#include "fuzz_file.h"
#include "scene/mesh.h"

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    igi_context *ctx = fuzz_context();
    igi_scene *scene;
    if (IGI_ALLOC(ctx, 1, &scene) != IGI_OK) abort();
    igi_status status = igi_mesh_load(ctx, scene, fuzz_file("m.obj", bytes, size));
    fuzz_judge(ctx, status, status == IGI_OK ? scene->mesh.triangles : NULL);
    for (size_t i = 0; status == IGI_OK && i < 3 * scene->mesh.triangle_count; i++)
        if (scene->mesh.triangles[i] >= scene->mesh.vertex_count) abort();
    igi_scene_destroy(scene);
    igi_context_destroy(ctx);
    return 0;
}
