/* SPDX-License-Identifier: Apache-2.0
 *
 * Scenes that can be read and cannot be meant: mesh and cameras of different units; without a light.
 */
#include "scene/plausible.h"

#include "scene/scene_notes.h"

#include "base/context.h"

#include <math.h>

#define HALL 80.0       /* metres across: few rooms that are photographed from one corner */
#define CORNER_SHARE 20 /* mesh across over cameras across; rooms have 1 to 5 */

typedef struct box {
    double low[3], high[3];
} box;

static void add(box *b, int k, double x)
{
    b->low[k] = fmin(b->low[k], x);
    b->high[k] = fmax(b->high[k], x);
}

static double across(const box *b)
{
    return hypot(hypot(b->high[0] - b->low[0], b->high[1] - b->low[1]), b->high[2] - b->low[2]);
}

igi_status igi_scene_check_plausible(igi_context *ctx, igi_scene *scene)
{
    const double far = (double)INFINITY;
    box mesh = {{far, far, far}, {-far, -far, -far}}, eyes = mesh;
    for (size_t i = 0; i < 3 * scene->mesh.vertex_count; i++)
        add(&mesh, (int)(i % 3), (double)scene->mesh.positions[i]);
    for (size_t i = 0; i < 3 * scene->frame_count; i++)
        add(&eyes, (int)(i % 3), scene->frames[i / 3].camera.camera_to_world[i % 3][3]);
    double size = across(&mesh), spread = across(&eyes);
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
