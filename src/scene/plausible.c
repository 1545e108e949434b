/* SPDX-License-Identifier: Apache-2.0
 *
 * Scenes that can be read and cannot be meant: mesh and cameras of different units; without a light.
 */
#include "scene/plausible.h"

#include "scene/camera.h"
#include "scene/mesh.h"
#include "scene/scene_notes.h"

#include "base/context.h"

#define HALL 80.0       /* metres across: few rooms that are photographed from one corner */
#define CORNER_SHARE 20 /* mesh across over cameras across; rooms have 1 to 5 */

igi_status igi_scene_check_plausible(igi_context *ctx, igi_scene *scene)
{
    igi_box mesh = igi_mesh_box(&scene->mesh), eyes = igi_box_empty();
    for (size_t i = 0; i < scene->frame_count; i++)
        igi_box_add(&eyes, igi_camera_centre(&scene->frames[i].camera));
    double size = (double)igi_box_diagonal(&mesh), spread = (double)igi_box_diagonal(&eyes);
    if (size > HALL && scene->frame_count > 2 && spread < size / CORNER_SHARE)
        IGI_TRY(igi_scene_warn(ctx, scene,
                               "the mesh is %.3g m across, and all cameras stand within %.2g m: is "
                               "the mesh in centimetres? export it in metres",
                               size, spread));
    if (scene->light_count == 0)
        IGI_TRY(igi_scene_warn(
            ctx, scene,
            "scene.json lists no light: what shines is taken for a surface, its albedo above 1; "
            "name the lamps, { \"type\": \"area\", \"region\": NAME }, and what else shines"));
    return IGI_OK;
}
