/* SPDX-License-Identifier: Apache-2.0
 *
 * libFuzzer against scene.json; the mesh m.obj, the cameras t.json and the image a.exr are good.
 */
#include "fuzz_file.h"

static void make_folder(void)
{
    static const char mesh[] = "v 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl lamp\nf 1 2 3\n";
    static const char cameras[] = "{\"w\":2,\"h\":2,\"fl_x\":2,\"frames\":[{\"file_path\":\"a\","
                                  "\"transform_matrix\":[[1,0,0,0],[0,1,0,0],[0,0,1,0]]}]}";
    igi_context *ctx = fuzz_context();
    igi_image *image = NULL;
    (void)fuzz_file("m.obj", mesh, sizeof mesh - 1);
    (void)fuzz_file("t.json", cameras, sizeof cameras - 1);
    if (igi_image_create(ctx, 2, 2, 3, &image) != IGI_OK ||
        igi_image_save_exr(ctx, image, IGI_EXR_HALF, fuzz_file("a.exr", "", 0)) != IGI_OK)
        abort();
    igi_image_destroy(image);
    igi_context_destroy(ctx);
}

int LLVMFuzzerTestOneInput(const uint8_t *bytes, size_t size)
{
    static bool made;
    if (!made) make_folder();
    made = true;
    igi_context *ctx = fuzz_context();
    igi_scene *scene;
    igi_status status = igi_scene_load(ctx, fuzz_file("scene.json", bytes, size), &scene);
    if (status != IGI_E_SYSTEM) fuzz_judge(ctx, status, scene); /* "mesh" may be any path: ".." */
    igi_scene_destroy(scene);
    igi_context_destroy(ctx);
    return 0;
}
