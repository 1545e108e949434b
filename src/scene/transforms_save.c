/* SPDX-License-Identifier: Apache-2.0
 *
 * Cameras as nerfstudio and instant-ngp read them.
 */
#include "scene/frame.h"
#include "base/file.h"

#include <errno.h>
#include <jansson.h>
#include <unistd.h>
#include <stdio.h>
#include <string.h>

/* As seen from the folder of the file that names it; absolute where it lies elsewhere. */
static igi_status name_from(igi_context *ctx, const char *folder, const char *path, char **name)
{
    char here[4096];
    size_t length = strlen(folder);
    if (path[0] == '/') return igi_strdup(ctx, path, name);
    if (strcmp(folder, ".") == 0) return igi_strdup(ctx, path, name);
    if (strncmp(path, folder, length) == 0 && path[length] == '/')
        return igi_strdup(ctx, path + length + 1, name);
    if (!getcwd(here, sizeof here))
        return igi_fail(ctx, IGI_E_SYSTEM, "%s: no path to the working folder (%s)", path,
                        strerror(errno));
    return igi_strprintf(ctx, name, "%s/%s", here, path);
}

static json_t *pack_frame(const igi_camera *c, const char *name)
{
    json_t *rows = json_array();
    for (int r = 0; r < 3; r++) {
        const double *m = c->camera_to_world[r];
        json_array_append_new(rows, json_pack("[ffff]", m[0], m[1], m[2], m[3]));
    }
    json_array_append_new(rows, json_pack("[ffff]", 0.0, 0.0, 0.0, 1.0));
    return json_pack("{ss si si sf sf sf sf sf sf sf sf sf so}", "file_path", name, "w", c->width,
                     "h", c->height, "fl_x", c->fl_x, "fl_y", c->fl_y, "cx", c->cx, "cy", c->cy,
                     "k1", c->k1, "k2", c->k2, "k3", c->k3, "p1", c->p1, "p2", c->p2,
                     "transform_matrix", rows);
}

igi_status igi_frames_save(igi_context *ctx, const igi_frame *frames, size_t count,
                           const char *path)
{
    igi_status status = IGI_OK;
    char *folder = NULL, *name = NULL;
    json_t *list = json_array();
    json_t *root = json_pack("{ss sO}", "camera_model", "OPENCV", "frames", list);
    IGI_TRY_GOTO(igi_path_folder(ctx, path, &folder));
    for (size_t i = 0; i < count; i++) {
        igi_free(name);
        IGI_TRY_GOTO(name_from(ctx, folder, frames[i].path, &name));
        if (json_array_append_new(list, pack_frame(&frames[i].camera, name)) != 0) {
            status = igi_fail(ctx, IGI_E_DATA, "%s: the name is not UTF-8; rename it",
                              frames[i].path);
            goto cleanup;
        }
    }
    status = igi_file_save_json(ctx, path, root, 12);
cleanup:
    json_decref(list);
    json_decref(root);
    igi_free(folder);
    igi_free(name);
    return status;
}
